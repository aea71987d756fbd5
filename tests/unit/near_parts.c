/* Near parts of the neighbour lists' rows: what may lie within reach comes first, and nothing within reach is missing
 * while particles move, however seldom lists are made anew. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cast/particles/neighbours.h"
#include "cast/particles/pair_prune.h"
#include "tests/support/assert_ok.h"
#include "tests/support/listed_cloud.h"
#include "tests/support/random_numbers.h"

static const double spacing = CLOUD_SPACING, reach = CLOUD_REACH;

/* Walls everywhere among the melt, which goes about at random, each particle at its own speed of at most one. */
static Particles swarm(uint64_t seed)
{
  Particles p = cloud_create(seed, 1.0);
  seed += 4711; // not the numbers of the places again
  for (ptrdiff_t i = 0; i < p.n_fluid; i++)
    for (int d = 0; d < 3; d++) p.v[d][i] = (random_unit(&seed) - 0.5) * pow(random_unit(&seed), 3.0);
  return p;
}

static void move(Particles *p, double dt)
{
  for (ptrdiff_t i = 0; i < p->n_fluid; i++)
    for (int d = 0; d < 3; d++) p->x[d][i] += p->v[d][i] * dt;
}

/* Every pair within reach stands in the near part of its row. Returns how many entries the near parts have. */
static long check_near(const Particles *p, const PairList *list, ptrdiff_t base, ptrdiff_t from, ptrdiff_t to,
                       const double period[3])
{
  unsigned char *seen = calloc((size_t)p->n, 1);
  long near = 0;
  for (ptrdiff_t row = 0; row < list->n; row++) {
    memset(seen, 0, (size_t)p->n);
    assert_in_range(list->near[row], 0, list->start[row + 1] - list->start[row]);
    for (ptrdiff_t k = list->start[row]; k < pair_list_end(list, row); k++) {
      assert_false(seen[list->index[k]]);
      seen[list->index[k]] = 1;
    }
    near += list->near[row];
    double d[3];
    for (ptrdiff_t j = from; j < to; j++)
      if (j != base + row && particles_offset(p, base + row, j, period, d) < reach * reach) assert_true(seen[j]);
  }
  free(seen);
  return near;
}

/* Near parts get shorter than their rows, and are told apart more often than lists are made. */
static void near_parts_hold_all_pairs_within_reach_as_particles_move(void **unused)
{
  (void)unused;
  CastError err;
  const double periods[2][3] = {{0.0, 0.0, 0.0}, {1.0, 0.0, 1.0}};
  for (int c = 0; c < 2; c++) {
    enum { STEPS = 60 };
    const double dt = 0.0015;
    Particles p = swarm(5);
    Neighbours *nb = NULL;
    ok(neighbours_create_periodic(reach, neighbours_skin(spacing), periods[c], &nb, &err), &err);
    neighbours_suit_skin(nb, spacing, dt);
    long near = 0, listed = 0, changes = 0, before = 0;
    for (int k = 0; k < STEPS; k++) {
      ok(neighbours_update(nb, &p, false, NULL, &err), &err);
      const PairList *fluid = neighbours_fluid_fluid(nb), *wall = neighbours_fluid_wall(nb);
      const long now = check_near(&p, fluid, 0, 0, p.n_fluid, periods[c]);
      check_near(&p, wall, 0, p.n_fluid, p.n, periods[c]);
      check_near(&p, neighbours_wall_fluid(nb), p.n_fluid, 0, p.n_fluid, periods[c]);
      near += now;
      listed += fluid->start[fluid->n];
      changes += now != before;
      before = now;
      move(&p, dt);
    }
    assert_true(near < 0.9 * (double)listed);
    assert_true(neighbours_builds(nb) < STEPS / 3);
    assert_true(changes > neighbours_builds(nb));
    neighbours_destroy(&nb);
    particles_destroy(&p);
  }
}

static void rows_are_split_alike_with_and_without_vectors(void **unused)
{
  (void)unused;
  uint64_t seed = 3;
  Particles p = swarm(seed);
  PrunePlace *room = aligned_alloc(16, (size_t)p.n * sizeof *room);
  const PrunePlaces places = prune_places(&p, reach, (const double[3]){1.0, 0.0, 0.0}, room);
  for (ptrdiff_t n = 0; n < 150; n++) {
    int32_t row[2][150], far[150 + PRUNE_LANES], entry[150];
    for (ptrdiff_t k = 0; k < n; k++) row[0][k] = row[1][k] = entry[k] = (int32_t)(random_unit(&seed) * (double)p.n);
    const float reach2 = 0.16F; // a quarter of all
    const ptrdiff_t near = prune_row(&places, &room[n], reach2, row[0], n, far);
    assert_int_equal(near, prune_row_plain(&places, &room[n], reach2, row[1], n, far));
    assert_memory_equal(row[0], row[1], (size_t)n * sizeof **row);
    for (ptrdiff_t k = 0; k < n; k++) {
      double d[3];
      const double r2 = particles_offset(&p, n, row[0][k], (const double[3]){1.0, 0.0, 0.0}, d);
      assert_true(fabs(r2 - 0.16) < 1e-6 || (r2 < 0.16) == (k < near)); // single precision's digits
    }
    for (ptrdiff_t k = 0, a = 0, b = near; k < n; k++) { // either part keeps its order
      if (a < near && row[0][a] == entry[k])
        a++;
      else
        assert_int_equal(row[0][b++], entry[k]);
    }
  }
  free(room);
  particles_destroy(&p);
}

static void near_parts_are_the_same_on_any_number_of_threads(void **unused)
{
  (void)unused;
  CastError err;
  const int most = omp_get_max_threads();
  Particles p[2] = {swarm(9), swarm(9)};
  Neighbours *nb[2] = {NULL, NULL};
  for (int t = 0; t < 2; t++) {
    ok(neighbours_create(reach, neighbours_skin(spacing), NULL, &nb[t], &err), &err);
    neighbours_suit_skin(nb[t], spacing, 0.006);
    omp_set_num_threads(t == 0 ? 1 : 4);
    for (int k = 0; k < 20; k++) {
      ok(neighbours_update(nb[t], &p[t], false, NULL, &err), &err);
      move(&p[t], 0.006);
    }
  }
  omp_set_num_threads(most);
  const PairList *a[3] = {neighbours_fluid_fluid(nb[0]), neighbours_fluid_wall(nb[0]), neighbours_wall_fluid(nb[0])};
  const PairList *b[3] = {neighbours_fluid_fluid(nb[1]), neighbours_fluid_wall(nb[1]), neighbours_wall_fluid(nb[1])};
  for (int l = 0; l < 3; l++) {
    assert_memory_equal(a[l]->near, b[l]->near, (size_t)a[l]->n * sizeof *a[l]->near);
    assert_memory_equal(a[l]->index, b[l]->index, (size_t)a[l]->start[a[l]->n] * sizeof *a[l]->index);
  }
  for (int t = 0; t < 2; t++) {
    neighbours_destroy(&nb[t]);
    particles_destroy(&p[t]);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(near_parts_hold_all_pairs_within_reach_as_particles_move),
      cmocka_unit_test(rows_are_split_alike_with_and_without_vectors),
      cmocka_unit_test(near_parts_are_the_same_on_any_number_of_threads),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
