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
#include "tests/support/random_numbers.h"
#include "tests/support/shaped_mould.h"

enum { FLUID = 1500, WALLS = 700 };
static const double reach = 0.13, skin = 0.02;

/* A cloud of fluid in [0, 1]^3 with walls in its lower half, at random; one fluid particle far away. */
static Particles cloud(uint64_t seed, bool far_one)
{
  static double x[3][FLUID], w[3][WALLS], zero[WALLS], one[WALLS];
  static int32_t patch[WALLS];
  static uint8_t echo[WALLS];
  for (int i = 0; i < FLUID; i++)
    for (int d = 0; d < 3; d++) x[d][i] = random_unit(&seed);
  if (far_one) x[1][FLUID / 2] = 37.0;
  for (int k = 0; k < WALLS; k++) {
    for (int d = 0; d < 3; d++) w[d][k] = random_unit(&seed) * (d == 2 ? 0.5 : 1.0);
    one[k] = 1e-6;
  }
  const WallSet walls = {.n = WALLS,
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
  ok(particles_create(FLUID, places, 0.05, 1000.0, &walls, &p, &err), &err);
  for (int i = 0; i < FLUID; i++) p.E[i] = (double)i; // so that sorting can be followed
  return p;
}

static double distance2(const Particles *p, ptrdiff_t i, ptrdiff_t j, const double period[3])
{
  double sum = 0.0;
  for (int d = 0; d < 3; d++) {
    double s = fabs(p->x[d][i] - p->x[d][j]);
    if (period[d] > 0.0) s = fmin(s, period[d] - s);
    sum += s * s;
  }
  return sum;
}

/* Each row holds exactly the pairs nearer than reach and skin, each once, none twice. */
static void check_list(const Particles *p, const PairList *list, ptrdiff_t row_base, ptrdiff_t from, ptrdiff_t to,
                       const double period[3])
{
  const bool walls = row_base > 0 || from > 0;
  const double range = walls ? neighbours_range(reach, skin) : reach + skin, limit = range * range;
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
      const bool near = j != row_base + row && distance2(p, row_base + row, j, period) < limit;
      assert_int_equal(near, seen[j]);
    }
  }
  free(seen);
}

static void check_lists(const Particles *p, const Neighbours *nb)
{
  const double *period = neighbours_period(nb);
  assert_int_equal(neighbours_fluid_fluid(nb)->n, p->n_fluid);
  assert_int_equal(neighbours_wall_fluid(nb)->n, p->n - p->n_fluid);
  check_list(p, neighbours_fluid_fluid(nb), 0, 0, p->n_fluid, period);
  check_list(p, neighbours_fluid_wall(nb), 0, p->n_fluid, p->n, period);
  check_list(p, neighbours_wall_fluid(nb), p->n_fluid, 0, p->n_fluid, period);
}

static void lists_hold_exactly_the_pairs_within_reach_and_skin(void **unused)
{
  (void)unused;
  CastError err;
  for (int far_one = 0; far_one < 2; far_one++) {
    Particles p = cloud(7, far_one == 1);
    Neighbours *nb = NULL;
    bool rebuilt = false;
    ok(neighbours_create(reach, skin, NULL, &nb, &err), &err);
    ok(neighbours_update(nb, &p, false, &rebuilt, &err), &err);
    assert_true(rebuilt);
    check_lists(&p, nb);
    neighbours_destroy(&nb);
    particles_destroy(&p);
  }
}

static void a_periodic_domain_pairs_nearest_images(void **unused)
{
  (void)unused;
  CastError err;
  const double periods[3][3] = {{1.0, 1.0, 1.0}, {0.0, 1.0, 0.0}, {1.0, 0.0, 2.5}};
  for (int k = 0; k < 3; k++) {
    Particles p = cloud(11, false);
    Neighbours *nb = NULL;
    ok(neighbours_create_periodic(reach, skin, periods[k], &nb, &err), &err);
    for (int i = 0; i < p.n_fluid; i++) // some start beyond the domain and are brought back
      for (int d = 0; d < 3; d++) p.x[d][i] += periods[k][d] * (double)(i % 5 - 2);
    ok(neighbours_update(nb, &p, false, NULL, &err), &err);
    check_lists(&p, nb);
    neighbours_destroy(&nb);
    particles_destroy(&p);
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
  CastError err;
  Particles p = cloud(3, false), before = cloud(3, false);
  ParticleField field[PARTICLE_FIELDS], old[PARTICLE_FIELDS];
  particles_fields(&p, field);
  particles_fields(&before, old);
  for (int f = 0; f < PARTICLE_FIELDS; f++) {
    for (int g = 0; g < f; g++) assert_true(field[f].data != field[g].data);
    for (int i = 0; f >= 3 && i < FLUID; i++) field[f].data[i] = old[f].data[i] = 1000.0 * f + i;
  }
  Neighbours *nb = NULL;
  ok(neighbours_create(reach, skin, NULL, &nb, &err), &err);
  ok(neighbours_update(nb, &p, false, NULL, &err), &err);
  int moved = 0;
  for (int i = 0; i < FLUID; i++) {
    const int32_t id = p.id[i];
    moved += id != i;
    for (int f = 0; f < PARTICLE_FIELDS; f++) assert_true(field[f].data[i] == old[f].data[id]);
  }
  assert_true(moved > FLUID / 2);
  for (ptrdiff_t i = FLUID; i < p.n; i++) assert_int_equal(p.id[i], i); // walls stay
  neighbours_destroy(&nb);
  particles_destroy(&p);
  particles_destroy(&before);
}

static void lists_last_until_particles_may_have_come_nearer_by_the_skin(void **unused)
{
  (void)unused;
  CastError err;
  Particles p = cloud(5, false);
  Neighbours *nb = NULL;
  bool rebuilt;
  ok(neighbours_create(reach, skin, NULL, &nb, &err), &err);
  ok(neighbours_update(nb, &p, false, &rebuilt, &err), &err);
  const int32_t near = neighbours_fluid_fluid(nb)->index[neighbours_fluid_fluid(nb)->start[17]];
  p.x[1][17] += 0.49 * skin;
  p.x[1][near] -= 0.49 * skin;
  ok(neighbours_update(nb, &p, false, &rebuilt, &err), &err);
  assert_false(rebuilt);
  p.x[1][17] += 0.03 * skin;
  ok(neighbours_update(nb, &p, false, &rebuilt, &err), &err);
  assert_true(rebuilt);
  ok(neighbours_update(nb, &p, true, &rebuilt, &err), &err);
  assert_true(rebuilt);
  assert_int_equal(neighbours_builds(nb), 3);
  check_lists(&p, nb);
  neighbours_destroy(&nb);
  particles_destroy(&p);
}

/* Two halves fly apart, faster than the skin would allow if they were near each other. */
static void melt_far_apart_may_go_different_ways(void **unused)
{
  (void)unused;
  CastError err;
  Particles p = cloud(5, false);
  Neighbours *nb = NULL;
  bool rebuilt;
  for (int i = 0; i < FLUID; i++) p.x[0][i] += i % 2 ? 2.0 : 0.0;
  ok(neighbours_create(reach, skin, NULL, &nb, &err), &err);
  ok(neighbours_update(nb, &p, false, &rebuilt, &err), &err);
  for (int i = 0; i < FLUID; i++) p.x[0][i] += (p.x[0][i] > 1.5 ? 0.9 : -0.9) * skin;
  ok(neighbours_update(nb, &p, false, &rebuilt, &err), &err);
  assert_false(rebuilt);
  neighbours_destroy(&nb);
  particles_destroy(&p);
}

/* Melt that moves as one keeps its pairs, but not its walls. */
static void melt_that_moves_as_one_needs_new_lists_for_the_walls_alone(void **unused)
{
  (void)unused;
  CastError err;
  Particles p = cloud(5, false);
  Neighbours *nb = NULL;
  bool rebuilt;
  ok(neighbours_create(reach, skin, NULL, &nb, &err), &err);
  ok(neighbours_update(nb, &p, false, &rebuilt, &err), &err);
  const double wall_skin = neighbours_range(reach, skin) - reach;
  for (int i = 0; i < FLUID; i++) p.x[0][i] += 0.98 * wall_skin;
  ok(neighbours_update(nb, &p, false, &rebuilt, &err), &err);
  assert_false(rebuilt);
  for (int i = 0; i < FLUID; i++) p.x[0][i] += 0.03 * wall_skin;
  ok(neighbours_update(nb, &p, false, &rebuilt, &err), &err);
  assert_true(rebuilt);
  neighbours_destroy(&nb);
  particles_destroy(&p);
}

/* Whatever way particles go until lists are made anew, no pair within reach is missing from them. */
static void no_pair_comes_within_reach_unlisted(void **unused)
{
  (void)unused;
  CastError err;
  Particles p = cloud(6, false);
  Neighbours *nb = NULL;
  ok(neighbours_create(reach, skin, NULL, &nb, &err), &err);
  ok(neighbours_update(nb, &p, false, NULL, &err), &err);
  uint64_t seed = 31;
  int kept = 0;
  for (int step = 0; step < 40; step++) { // a flow that turns one way below and the other above, and noise
    for (int i = 0; i < FLUID; i++) {
      const double turn = 0.3 * skin * (p.x[2][i] < 0.5 ? 1.0 : -1.0);
      p.x[0][i] -= turn * (p.x[1][i] - 0.5);
      p.x[1][i] += turn * (p.x[0][i] - 0.5);
      for (int d = 0; d < 3; d++) p.x[d][i] += 0.04 * skin * (random_unit(&seed) - 0.5);
    }
    bool rebuilt;
    ok(neighbours_update(nb, &p, false, &rebuilt, &err), &err);
    kept += !rebuilt;
    const PairList *lists[2] = {neighbours_fluid_fluid(nb), neighbours_fluid_wall(nb)};
    long near = 0, listed = 0;
    for (ptrdiff_t i = 0; i < FLUID; i++)
      for (ptrdiff_t j = 0; j < p.n; j++) near += j != i && distance2(&p, i, j, neighbours_period(nb)) < reach * reach;
    for (int l = 0; l < 2; l++)
      for (ptrdiff_t i = 0; i < FLUID; i++)
        for (ptrdiff_t k = lists[l]->start[i]; k < lists[l]->start[i + 1]; k++)
          listed += distance2(&p, i, lists[l]->index[k], neighbours_period(nb)) < reach * reach;
    assert_int_equal(near, listed);
  }
  assert_true(kept > 10);
  neighbours_destroy(&nb);
  particles_destroy(&p);
}

static void a_position_that_is_not_finite_is_told_with_its_particle(void **unused)
{
  (void)unused;
  CastError err;
  Particles p = cloud(5, false);
  Neighbours *nb = NULL;
  ok(neighbours_create(reach, skin, NULL, &nb, &err), &err);
  p.x[2][41] = (double)NAN;
  assert_int_equal(neighbours_update(nb, &p, false, NULL, &err), CAST_ERR_NUMERIC);
  assert_non_null(strstr(err.message, "particle 41"));
  neighbours_destroy(&nb);
  particles_destroy(&p);
}

static void lists_are_the_same_on_any_number_of_threads(void **unused)
{
  (void)unused;
  CastError err;
  Neighbours *nb[3] = {NULL};
  Particles p[3];
  const int had = omp_get_max_threads();
  for (int t = 0; t < 3; t++) {
    omp_set_num_threads(1 << t);
    p[t] = cloud(9, true);
    ok(neighbours_create(reach, skin, NULL, &nb[t], &err), &err);
    ok(neighbours_update(nb[t], &p[t], false, NULL, &err), &err);
    const PairList *first[3] = {neighbours_fluid_fluid(nb[0]), neighbours_fluid_wall(nb[0]),
                                neighbours_wall_fluid(nb[0])};
    const PairList *list[3] = {neighbours_fluid_fluid(nb[t]), neighbours_fluid_wall(nb[t]),
                               neighbours_wall_fluid(nb[t])};
    for (int l = 0; l < 3; l++) {
      assert_memory_equal(list[l]->start, first[l]->start, (size_t)(first[l]->n + 1) * sizeof *first[l]->start);
      assert_memory_equal(list[l]->index, first[l]->index, (size_t)first[l]->start[first[l]->n] * sizeof(int32_t));
    }
  }
  omp_set_num_threads(had);
  for (int t = 0; t < 3; t++) {
    neighbours_destroy(&nb[t]);
    particles_destroy(&p[t]);
  }
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
  Particles p = cloud(23, false);
  Cells cells = {0};
  Vicinity near = {0};
  const double period[3] = {1.0, 0.0, 0.0};
  double *sorted[3];
  ok(cells_sort(&cells, FLUID, p.x, reach, period, &err), &err);
  for (int d = 0; d < 3; d++) {
    sorted[d] = malloc(FLUID * sizeof(double));
    for (int k = 0; k < FLUID; k++) sorted[d][k] = p.x[d][cells.order[k]];
  }
  const SortedPoints points = {&cells, sorted, cells.order, 1000};
  long found = 0;
  for (int i = 0; i < FLUID; i++) {
    const double x[3] = {p.x[0][i], p.x[1][i], p.x[2][i]};
    vicinity_move_to(&near, &points, x);
    int32_t fast[2 * FLUID], plain[2 * FLUID];
    assert_true(near.room <= 2 * FLUID);
    const ptrdiff_t n = vicinity_select(&near, &points, x, reach * reach, fast);
    assert_int_equal(n, vicinity_select_plain(&near, &points, x, reach * reach, plain));
    assert_memory_equal(fast, plain, (size_t)n * sizeof *fast);
    found += n;
  }
  assert_true(found > 10 * FLUID);
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
      cmocka_unit_test(lists_last_until_particles_may_have_come_nearer_by_the_skin),
      cmocka_unit_test(melt_far_apart_may_go_different_ways),
      cmocka_unit_test(melt_that_moves_as_one_needs_new_lists_for_the_walls_alone),
      cmocka_unit_test(no_pair_comes_within_reach_unlisted),
      cmocka_unit_test(points_near_a_place_are_found_with_and_without_vectors),
      cmocka_unit_test(a_position_that_is_not_finite_is_told_with_its_particle),
      cmocka_unit_test(lists_are_the_same_on_any_number_of_threads),
      cmocka_unit_test(a_thin_mould_wall_keeps_two_basins_apart),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
