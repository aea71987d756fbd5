/* Neighbour lists against all pairs, sorting, periodic domains, thin mould walls, threads. */
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
#include "cast/particles/vicinity.h"
#include "tests/support/assert_ok.h"
#include "tests/support/listed_cloud.h"
#include "tests/support/random_numbers.h"
#include "tests/support/shaped_mould.h"

static const double reach = CLOUD_REACH, skin = 0.02;

static void lists_hold_exactly_the_pairs_within_reach_and_skin(void **unused)
{
  (void)unused;
  for (int far_one = 0; far_one < 2; far_one++) {
    ListedCloud cloud = listed_cloud_create(7, skin);
    if (far_one) cloud.p.x[1][CLOUD_FLUID / 2] = 37.0;
    assert_true(listed_cloud_update(&cloud));
    listed_cloud_check(&cloud);
    listed_cloud_destroy(&cloud);
  }
}

static void a_periodic_domain_pairs_nearest_images(void **unused)
{
  (void)unused;
  CastError err;
  const double periods[3][3] = {{1.0, 1.0, 1.0}, {0.0, 1.0, 0.0}, {1.0, 0.0, 2.5}};
  for (int k = 0; k < 3; k++) {
    ListedCloud cloud = {.p = cloud_create(11, 0.5), .skin = skin};
    ok(neighbours_create_periodic(reach, skin, periods[k], &cloud.neighbours, &err), &err);
    for (int i = 0; i < cloud.p.n_fluid; i++) // some start beyond the domain and are brought back
      for (int d = 0; d < 3; d++) cloud.p.x[d][i] += periods[k][d] * (double)(i % 5 - 2);
    assert_true(listed_cloud_update(&cloud));
    listed_cloud_check(&cloud);
    listed_cloud_destroy(&cloud);
  }
}

static void a_period_too_short_is_refused(void **unused)
{
  (void)unused;
  CastError err;
  Neighbours *nb = NULL;
  const double period[3] = {1.0, 2.4 * neighbours_range(reach, skin), 0.0};
  assert_int_equal(neighbours_create_periodic(reach, skin, period, &nb, &err), CAST_ERR_ARGUMENT);
  assert_null(nb);
  assert_non_null(strstr(err.message, "axis 1"));
}

static void sorting_moves_all_fields_of_a_particle_together(void **unused)
{
  (void)unused;
  ListedCloud cloud = listed_cloud_create(3, skin);
  Particles before = cloud_create(3, 0.5);
  ParticleField field[PARTICLE_FIELDS], old[PARTICLE_FIELDS];
  particles_fields(&cloud.p, field);
  particles_fields(&before, old);
  for (int f = 0; f < PARTICLE_FIELDS; f++) {
    for (int g = 0; g < f; g++) assert_true(field[f].data != field[g].data);
    for (int i = 0; f >= 3 && i < CLOUD_FLUID; i++) field[f].data[i] = old[f].data[i] = 1000.0 * f + i;
  }
  assert_true(listed_cloud_update(&cloud));
  int moved = 0;
  for (int i = 0; i < CLOUD_FLUID; i++) {
    const int32_t id = cloud.p.id[i];
    moved += id != i;
    for (int f = 0; f < PARTICLE_FIELDS; f++) assert_true(field[f].data[i] == old[f].data[id]);
  }
  assert_true(moved > CLOUD_FLUID / 2);
  for (ptrdiff_t i = CLOUD_FLUID; i < cloud.p.n; i++) assert_int_equal(cloud.p.id[i], i); // walls stay
  listed_cloud_destroy(&cloud);
  particles_destroy(&before);
}

static void a_position_that_is_not_finite_is_told_with_its_particle(void **unused)
{
  (void)unused;
  CastError err;
  ListedCloud cloud = listed_cloud_create(5, skin);
  cloud.p.x[2][41] = (double)NAN;
  assert_int_equal(neighbours_update(cloud.neighbours, &cloud.p, false, NULL, &err), CAST_ERR_NUMERIC);
  assert_non_null(strstr(err.message, "particle 41"));
  listed_cloud_destroy(&cloud);
}

static const PairList *(*const LISTS[3])(const Neighbours *) = {neighbours_fluid_fluid, neighbours_fluid_wall,
                                                                neighbours_wall_fluid};

static void lists_are_the_same_on_any_number_of_threads(void **unused)
{
  (void)unused;
  ListedCloud cloud[3];
  const int had = omp_get_max_threads();
  for (int t = 0; t < 3; t++) {
    omp_set_num_threads(1 << t);
    cloud[t] = listed_cloud_create(9, skin);
    cloud[t].p.x[1][CLOUD_FLUID / 2] = 37.0;
    assert_true(listed_cloud_update(&cloud[t]));
    for (int l = 0; l < 3; l++) {
      const PairList *first = LISTS[l](cloud[0].neighbours), *list = LISTS[l](cloud[t].neighbours);
      assert_memory_equal(list->start, first->start, (size_t)(first->n + 1) * sizeof *first->start);
      assert_memory_equal(list->index, first->index, (size_t)first->start[first->n] * sizeof *first->index);
    }
  }
  omp_set_num_threads(had);
  for (int t = 0; t < 3; t++) listed_cloud_destroy(&cloud[t]);
}

/* Particles known to be clear of the mould are asked for quickly, others slowly: the same lists. */
static void check_clear_melt_has_the_same_lists(const Surface *surface, const Particles *p, const PairList *slow)
{
  CastError err;
  Particles clear;
  Neighbours *nb = NULL;
  ok(particles_create(p->n, p->x, 0.05, 1000.0, NULL, &clear, &err), &err);
  long known = 0;
  for (ptrdiff_t i = 0; i < p->n; i++) {
    const double x[3] = {clear.x[0][i], clear.x[1][i], clear.x[2][i]};
    SurfaceHit hit;
    if (surface_nearest(surface, x, 1.0, &hit)) clear.clearance[i] = hit.distance;
    known += clear.clearance[i] > 0.0;
  }
  ok(neighbours_create(reach, skin, surface, &nb, &err), &err);
  ok(neighbours_update(nb, &clear, false, NULL, &err), &err);
  const PairList *quick = neighbours_fluid_fluid(nb);
  assert_true(known > p->n / 2);
  for (ptrdiff_t i = 0; i <= p->n; i++) assert_int_equal(quick->start[i], slow->start[i]);
  assert_memory_equal(quick->index, slow->index, (size_t)slow->start[p->n] * sizeof *slow->index);
  neighbours_destroy(&nb);
  particles_destroy(&clear);
}

/* Two basins side by side with a mould wall of 0.05 between them, thinner than the reach: melt in one must not feel
 * melt in the other, though it does over the rim, above the wall. */
static void a_thin_mould_wall_keeps_two_basins_apart(void **unused)
{
  (void)unused;
  CastError err;
  const ShapedBox basins[2] = {{{-0.525, -0.5, -0.5}, {-0.025, 0.5, 0.01}, false},
                               {{0.025, -0.5, -0.5}, {0.525, 0.5, 0.01}, false}};
  const ShapedMould shape = {
      .low = {-1.0, -1.0, -1.0}, .high = {1.0, 1.0, 0.0}, .n_boxes = 2, .box = basins, .cell = 0.2};
  RomData *rom = shaped_mould_create(&shape);
  Surface *surface = NULL;
  ok(surface_create(rom, 2.0 * (reach + skin), &surface, &err), &err);
  enum { N = 2000 };
  static double x[3][N];
  uint64_t seed = 21;
  for (int i = 0; i < N; i++) { // near the wall on both sides, and some above the rim
    x[0][i] = (i % 2 ? 1.0 : -1.0) * (0.026 + 0.1 * random_unit(&seed));
    x[1][i] = 0.6 * random_unit(&seed) - 0.3;
    x[2][i] = i < N / 4 ? 0.05 * random_unit(&seed) : -0.4 + 0.2 * random_unit(&seed);
  }
  double *const places[3] = {x[0], x[1], x[2]};
  Particles p;
  Neighbours *nb = NULL;
  ok(particles_create(N, places, 0.05, 1000.0, NULL, &p, &err), &err);
  ok(neighbours_create(reach, skin, surface, &nb, &err), &err);
  ok(neighbours_update(nb, &p, false, NULL, &err), &err);
  const PairList *list = neighbours_fluid_fluid(nb);
  long across_rim = 0, same_side = 0;
  for (ptrdiff_t i = 0; i < N; i++)
    for (ptrdiff_t k = list->start[i]; k < list->start[i + 1]; k++) {
      const int32_t j = list->index[k];
      const bool crossing = p.x[0][i] * p.x[0][j] < 0.0, below = p.x[2][i] < 0.0 || p.x[2][j] < 0.0;
      assert_false(crossing && below);
      across_rim += crossing;
      same_side += !crossing;
    }
  assert_true(across_rim > 1000);
  assert_true(same_side > 10000);
  check_clear_melt_has_the_same_lists(surface, &p, list);
  neighbours_destroy(&nb);
  particles_destroy(&p);
  surface_destroy(&surface);
  rom_destroy(&rom);
}

static void points_near_a_place_are_found_with_and_without_vectors(void **unused)
{
  (void)unused;
  CastError err;
  Particles p = cloud_create(23, 0.5);
  Cells cells = {0};
  Vicinity near = {0};
  const double period[3] = {1.0, 0.0, 0.0};
  double *sorted[3];
  ok(cells_sort(&cells, CLOUD_FLUID, p.x, reach, period, &err), &err);
  for (int d = 0; d < 3; d++) {
    sorted[d] = malloc(CLOUD_FLUID * sizeof(double));
    for (int k = 0; k < CLOUD_FLUID; k++) sorted[d][k] = p.x[d][cells.order[k]];
  }
  const SortedPoints points = {&cells, sorted, cells.order, 1000};
  long found = 0;
  for (int i = 0; i < CLOUD_FLUID; i++) {
    const double x[3] = {p.x[0][i], p.x[1][i], p.x[2][i]};
    vicinity_move_to(&near, &points, x);
    int32_t fast[2 * CLOUD_FLUID], plain[2 * CLOUD_FLUID];
    assert_true(near.room <= 2 * CLOUD_FLUID);
    const ptrdiff_t n = vicinity_select(&near, &points, x, reach * reach, fast);
    assert_int_equal(n, vicinity_select_plain(&near, &points, x, reach * reach, plain));
    assert_memory_equal(fast, plain, (size_t)n * sizeof *fast);
    found += n;
  }
  assert_true(found > 10 * CLOUD_FLUID);
  cells_free(&cells);
  for (int d = 0; d < 3; d++) free(sorted[d]);
  particles_destroy(&p);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lists_hold_exactly_the_pairs_within_reach_and_skin),
      cmocka_unit_test(a_periodic_domain_pairs_nearest_images),
      cmocka_unit_test(a_period_too_short_is_refused),
      cmocka_unit_test(sorting_moves_all_fields_of_a_particle_together),
      cmocka_unit_test(points_near_a_place_are_found_with_and_without_vectors),
      cmocka_unit_test(a_position_that_is_not_finite_is_told_with_its_particle),
      cmocka_unit_test(lists_are_the_same_on_any_number_of_threads),
      cmocka_unit_test(a_thin_mould_wall_keeps_two_basins_apart),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
