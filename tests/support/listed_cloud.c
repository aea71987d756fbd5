#include "tests/support/listed_cloud.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/assert_ok.h"
#include "tests/support/random_numbers.h"

Particles cloud_create(uint64_t seed, double height)
{
  static double x[3][CLOUD_FLUID], w[3][CLOUD_WALLS], zero[CLOUD_WALLS], one[CLOUD_WALLS];
  static int32_t patch[CLOUD_WALLS];
  static uint8_t echo[CLOUD_WALLS];
  for (int i = 0; i < CLOUD_FLUID; i++)
    for (int d = 0; d < 3; d++) x[d][i] = random_unit(&seed);
  for (int k = 0; k < CLOUD_WALLS; k++) {
    for (int d = 0; d < 3; d++) w[d][k] = random_unit(&seed) * (d == 2 ? height : 1.0);
    one[k] = 1e-6;
  }
  const WallSet walls = {.n = CLOUD_WALLS,
                         .x = {w[0], w[1], w[2]},
                         .volume = one,
                         .foot = {zero, zero, zero},
                         .normal = {zero, zero, zero},
                         .depth = zero,
                         .patch = patch,
                         .echo = echo};
  double *const places[3] = {x[0], x[1], x[2]};
  Particles p;
  CastError err;
  ok(particles_create(CLOUD_FLUID, places, CLOUD_SPACING, 1000.0, &walls, &p, &err), &err);
  for (int i = 0; i < CLOUD_FLUID; i++) p.E[i] = (double)i;
  return p;
}

ListedCloud listed_cloud_create(uint64_t seed, double skin)
{
  CastError err;
  ListedCloud cloud = {.p = cloud_create(seed, 0.5), .skin = skin};
  ok(neighbours_create(CLOUD_REACH, skin, NULL, &cloud.neighbours, &err), &err);
  return cloud;
}

bool listed_cloud_update(ListedCloud *cloud)
{
  CastError err;
  bool rebuilt;
  ok(neighbours_update(cloud->neighbours, &cloud->p, false, &rebuilt, &err), &err);
  return rebuilt;
}

void listed_cloud_destroy(ListedCloud *cloud)
{
  neighbours_destroy(&cloud->neighbours);
  particles_destroy(&cloud->p);
}

double cloud_distance2(const Particles *p, ptrdiff_t i, ptrdiff_t j, const double period[3])
{
  double sum = 0.0;
  for (int d = 0; d < 3; d++) {
    double s = fabs(p->x[d][i] - p->x[d][j]);
    if (period[d] > 0.0) s = fmin(s, period[d] - s);
    sum += s * s;
  }
  return sum;
}

static void check_list(const ListedCloud *cloud, const PairList *list, ptrdiff_t row_base, ptrdiff_t from, ptrdiff_t to)
{
  const bool walls = row_base > 0 || from > 0;
  const double range = walls ? neighbours_range(CLOUD_REACH, cloud->skin) : CLOUD_REACH + cloud->skin,
               limit = range * range;
  const double *period = neighbours_period(cloud->neighbours);
  const Particles *p = &cloud->p;
  unsigned char *seen = calloc((size_t)p->n, 1);
  for (ptrdiff_t row = 0; row < list->n; row++) {
    memset(seen, 0, (size_t)p->n);
    for (ptrdiff_t k = list->start[row]; k < list->start[row + 1]; k++) {
      const int32_t j = list->index[k];
      assert_true(j >= from && j < to);
      assert_false(seen[j]);
      seen[j] = 1;
    }
    for (ptrdiff_t j = from; j < to; j++) {
      const bool near = j != row_base + row && cloud_distance2(p, row_base + row, j, period) < limit;
      assert_int_equal(near, seen[j]);
    }
  }
  free(seen);
}

void listed_cloud_check(const ListedCloud *cloud)
{
  const Particles *p = &cloud->p;
  const Neighbours *nb = cloud->neighbours;
  assert_int_equal(neighbours_fluid_fluid(nb)->n, p->n_fluid);
  assert_int_equal(neighbours_wall_fluid(nb)->n, p->n - p->n_fluid);
  check_list(cloud, neighbours_fluid_fluid(nb), 0, 0, p->n_fluid);
  check_list(cloud, neighbours_fluid_wall(nb), 0, p->n_fluid, p->n);
  check_list(cloud, neighbours_wall_fluid(nb), p->n_fluid, 0, p->n_fluid);
}
