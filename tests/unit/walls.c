/* Wall particles: what they add up to, what they stand for, which of them a fluid particle feels. Spacing 1. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include <omp.h>

#include "cast/geometry/surface_internal.h"
#include "cast/geometry/walls.h"
#include "cast/kernel/kernel.h"
#include "tests/support/assert_close.h"
#include "tests/support/random_numbers.h"
#include "tests/support/shaped_mould.h"
#include "tests/support/surface_of.h"

#define PI 3.14159265358979323846

typedef struct Case {
  RomData *rom;
  Surface *surface;
  WallSet walls;
} Case;

static Case make_case(const ShapedMould *shape, double reach, const double origin[3])
{
  Case made = {.rom = shaped_mould_create(shape)};
  CastError err = {0};
  made.surface = surface_of(made.rom, reach);
  if (walls_generate(made.surface, 1.0, reach, origin, &made.walls, &err) != CAST_OK) fail_msg("%s", err.message);
  return made;
}

static void release(Case *made)
{
  walls_destroy(&made->walls);
  surface_destroy(&made->surface);
  rom_destroy(&made->rom);
}

static void wall_at(const WallSet *walls, ptrdiff_t k, double place[3], double foot[3], double normal[3])
{
  for (int d = 0; d < 3; d++) {
    place[d] = walls->x[d][k];
    foot[d] = walls->foot[d][k];
    normal[d] = walls->normal[d][k];
  }
}

/* Sum of V W over the wall particles that x feels. */
static double wall_sum(const Case *made, const double x[3], double h)
{
  double sum = 0.0;
  for (ptrdiff_t k = 0; k < made->walls.n; k++) {
    double place[3], foot[3], normal[3];
    wall_at(&made->walls, k, place, foot, normal);
    const double r2 = vec_distance2(x, place);
    if (r2 < 4.0 * h * h && walls_seen(made->surface, x, place, foot, normal, made->walls.echo[k]))
      sum += made->walls.volume[k] * kernel_value(KERNEL_WENDLAND_C2, sqrt(r2), h);
  }
  return sum;
}

/* Integral of W over the half-space at distance d > 0: spheres of radius r have 2 pi r^2 (1 - d/r) of their area there.
 * Simpson's rule; the integrand is smooth. */
static double half_space(double d, double h)
{
  enum { N = 2000 };
  const double step = (2.0 * h - d) / N;
  double sum = 0.0;
  for (int i = 0; i <= N; i++) {
    const double r = d + i * step, weight = i == 0 || i == N ? 1.0 : i % 2 ? 4.0 : 2.0;
    sum += weight * kernel_value(KERNEL_WENDLAND_C2, r, h) * 2.0 * PI * r * (r - d);
  }
  return sum * step / 3.0;
}

/* What one point for a cube of edge 1 leaves out: the sum falls short of the integral of W by that of (1/24) lap W, to
 * second order, and over the half-space that is the slope of W summed over the plane. Fluid particles before the wall
 * leave out the opposite. */
static double point_defect(double d, double h)
{
  const double e = 1e-3;
  return -(half_space(d + e, h) - 2.0 * half_space(d, h) + half_space(d - e, h)) / (e * e) / 24.0;
}

typedef struct PlaneErrors {
  double plain, corrected; // root mean squares
} PlaneErrors;

/* A plane wall at random angles and offsets (the first one along the lattice). */
static PlaneErrors plane_errors(double h)
{
  uint64_t seed = 3;
  PlaneErrors errors = {0.0, 0.0};
  int n = 0;
  for (int trial = 0; trial < 8; trial++) {
    Turn turn = {.angle = trial ? 3.0 * random_unit(&seed) : 0.0};
    random_point(&seed, (const double[3]){-1, -1, -1}, (const double[3]){1, 1, 1}, turn.axis);
    random_point(&seed, (const double[3]){0, 0, 0}, (const double[3]){1, 1, 1}, turn.shift);
    vec_normalise(turn.axis);
    const ShapedBox tub = {{-8, -8, 0}, {8, 8, 20}, false};
    const ShapedMould shape = {{-14, -14, -8}, {14, 14, 8}, 1, &tub, 2.1, bend_turn, &turn};
    Case made = make_case(&shape, 2.0 * h, (const double[3]){0, 0, 0});
    for (int q = 0; q < 30; q++, n++) {
      double x[3];
      random_point(&seed, (const double[3]){-2, -2, 0.25}, (const double[3]){2, 2, 1.0}, x);
      const double exact = half_space(x[2], h), defect = point_defect(x[2], h);
      bend_turn(&turn, x);
      const double sum = wall_sum(&made, x, h);
      errors.plain += pow(sum - exact, 2.0);
      errors.corrected += pow(sum - exact - defect, 2.0);
    }
    release(&made);
  }
  errors.plain = sqrt(errors.plain / n);
  errors.corrected = sqrt(errors.corrected / n);
  return errors;
}

static void sums_over_a_plane_wall_are_those_of_a_half_space_to_second_order(void **state)
{
  (void)state;
  const PlaneErrors coarse = plane_errors(1.3), fine = plane_errors(2.0);
  assert_close(log(coarse.plain / fine.plain) / log(2.0 / 1.3), 2.0, 0.4);
  // orders above two, and the part of a wall cell that is cut away: 0.005 of a full kernel at h = 1.3, in the mean
  assert_true(coarse.corrected < 0.006);
  assert_true(fine.corrected < 0.0025);
}

static void check_particle(const Case *made, ptrdiff_t k, double reach)
{
  const WallSet *walls = &made->walls;
  double place[3], foot[3], normal[3];
  SurfaceHit hit;
  wall_at(walls, k, place, foot, normal);
  assert_true(walls->volume[k] > 0.0 && walls->volume[k] < 1.2); // a full cell and the slivers of its neighbours
  assert_true(walls->depth[k] > 0.0 && walls->depth[k] <= reach + 1e-12);
  assert_close(vec_norm(normal), 1.0, 1e-12);
  assert_true(surface_nearest(made->surface, foot, 1e-9, &hit)); // the foot is a point of the surface
  if (walls->echo[k]) return;
  assert_true(surface_nearest(made->surface, place, 2.0 * reach, &hit));
  assert_close(walls->depth[k], fabs(hit.distance), 2e-3); // at least a thousandth of the spacing is kept
  assert_close(sqrt(vec_distance2(foot, hit.foot)), 0.0, 1e-9);
  assert_int_equal(walls->patch[k], hit.patch);
}

static void each_particle_lies_behind_its_foot(void **state)
{
  (void)state;
  const double ab[2] = {2.0, 2.4};
  const ShapedBox box[2] = {{{-2, -2, -12}, {2, 2, 0}, false}, {{-6, -6, 0}, {6, 6, 12}, false}};
  const ShapedMould shape = {{-12, -12, -18}, {12, 12, 6}, 2, box, 0.5, bend_cylinder, ab};
  Case made = make_case(&shape, 2.6, (const double[3]){0.13, 0.31, -0.27});
  ptrdiff_t slivers = 0, outer = 0;
  assert_true(made.walls.n > 2000);
  for (ptrdiff_t k = 0; k < made.walls.n; k++) {
    check_particle(&made, k, 2.6);
    assert_int_equal(made.walls.echo[k], 0); // nothing is thin here
    slivers += made.walls.volume[k] < 0.05;
    outer += made.walls.patch[k] == 1;
    if (made.walls.patch[k] == 1) assert_true(fabs(made.walls.foot[2][k] - 6.0) < 1e-9); // only round the rim
  }
  assert_int_equal(slivers, 0);
  assert_true(outer > 100);
  release(&made);
}

/* A tub, and in it a fin from y = -t to 0 standing on the floor z = -8 up to z = 4. */
static ShapedMould tub_with_fin(double t, ShapedBox box[2])
{
  box[0] = (ShapedBox){{-10, -10, -8}, {10, 10, 30}, false};
  box[1] = (ShapedBox){{-10, -t, -8}, {10, 0, 4}, true};
  return (ShapedMould){{-15, -15, -15}, {15, 15, 10}, 2, box, 2.0, NULL, NULL};
}

/* A fin one spacing thick, at an offset to the lattice, and one that fills half the tub: from the free side both are
 * the same wall, on the plain, at the foot and below the floor. */
static void a_thin_wall_feels_like_a_thick_one(void **state)
{
  (void)state;
  ShapedBox thin_box[2], thick_box[2];
  const ShapedMould thin_shape = tub_with_fin(1.0, thin_box), thick_shape = tub_with_fin(10.0, thick_box);
  const double origin[3] = {0.13, 0.31, -0.27};
  Case thin = make_case(&thin_shape, 2.6, origin), thick = make_case(&thick_shape, 2.6, origin);
  uint64_t seed = 6;
  double strongest = 0.0, square = 0.0;
  for (int i = 0; i < 300; i++) {
    double x[3];
    random_point(&seed, (const double[3]){-5, 0.05, -7.9}, (const double[3]){5, 2.5, 0}, x);
    const double wanted = wall_sum(&thick, x, 1.3), found = wall_sum(&thin, x, 1.3);
    // echoes below a thousandth of a cell are left out; at the foot a cell is taken for mould or echo as a whole
    assert_close(found, wanted, x[2] > -5.0 ? 2e-4 : 5e-3);
    square += pow(found - wanted, 2.0);
    strongest = fmax(strongest, wanted);
  }
  assert_true(strongest > 0.5);
  assert_true(sqrt(square / 300.0) < 5e-4);
  release(&thin);
  release(&thick);
}

static void nothing_is_felt_of_a_thin_walls_other_side(void **state)
{
  (void)state;
  ShapedBox box[2];
  const ShapedMould shape = tub_with_fin(1.0, box);
  Case made = make_case(&shape, 2.6, (const double[3]){0.13, 0.31, -0.27});
  uint64_t seed = 7;
  ptrdiff_t echoes = 0;
  for (ptrdiff_t k = 0; k < made.walls.n; k++) {
    check_particle(&made, k, 2.6);
    echoes += made.walls.echo[k];
  }
  assert_true(echoes > 700); // 20 x 12 on each of two sides, 1.6 deep
  for (int i = 0; i < 200; i++) {
    double x[3], place[3], foot[3], normal[3];
    const double side = i % 2 ? 1.0 : -1.0;
    random_point(&seed, (const double[3]){-5, 0.05, -7.9}, (const double[3]){5, 1.5, 0}, x);
    if (side < 0.0) x[1] = -1.0 - x[1];
    for (ptrdiff_t k = 0; k < made.walls.n; k++) {
      wall_at(&made.walls, k, place, foot, normal);
      if (vec_distance2(x, place) > 2.6 * 2.6 || foot[2] > 1.5 || foot[2] < -7.9) continue; // below: common ground
      if (side * normal[1] < -0.5) assert_false(walls_seen(made.surface, x, place, foot, normal, made.walls.echo[k]));
    }
  }
  release(&made);
}

static void melt_over_the_rim_is_borne_by_the_top_face(void **state)
{
  (void)state;
  const ShapedBox tub = {{-5, -5, -6}, {5, 5, 6}, false};
  const ShapedMould shape = {{-15, -15, -15}, {15, 15, 0}, 1, &tub, 2.0, NULL, NULL};
  Case made = make_case(&shape, 2.6, (const double[3]){0.13, 0.31, -0.27});
  // right over the rim a quarter of space is mould; half a reach aside the particles end half a reach further out
  const double over[3] = {5.0, 0.4, 0.5}, aside[3] = {5.0 + 1.3, 0.4, 0.5}, full = half_space(0.5, 1.3);
  assert_close(wall_sum(&made, over, 1.3), 0.5 * full, 0.15 * full);
  assert_true(wall_sum(&made, aside, 1.3) > 0.7 * full);
  release(&made);
}

static void walls_have_the_same_bits_at_any_thread_count(void **state)
{
  (void)state;
  ShapedBox box[2];
  ShapedMould shape = tub_with_fin(1.0, box);
  const Turn turn = {{0.0, 0.6, 0.8}, 0.7, {0.1, 0.2, 0.3}};
  shape.bend = bend_turn;
  shape.context = &turn;
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  Case one = make_case(&shape, 2.6, (const double[3]){0.13, 0.31, -0.27});
  omp_set_num_threads(3);
  Case three = make_case(&shape, 2.6, (const double[3]){0.13, 0.31, -0.27});
  omp_set_num_threads(threads);
  const size_t n = (size_t)one.walls.n;
  assert_int_equal(one.walls.n, three.walls.n);
  for (int d = 0; d < 3; d++) {
    assert_memory_equal(one.walls.x[d], three.walls.x[d], n * sizeof(double));
    assert_memory_equal(one.walls.foot[d], three.walls.foot[d], n * sizeof(double));
    assert_memory_equal(one.walls.normal[d], three.walls.normal[d], n * sizeof(double));
  }
  assert_memory_equal(one.walls.volume, three.walls.volume, n * sizeof(double));
  assert_memory_equal(one.walls.echo, three.walls.echo, n);
  release(&one);
  release(&three);
}

static void a_spacing_that_no_cavity_can_bear_is_refused(void **state)
{
  (void)state;
  const ShapedBox tub = {{-5, -5, -6}, {5, 5, 6}, false};
  const ShapedMould shape = {{-15, -15, -15}, {15, 15, 0}, 1, &tub, 2.0, NULL, NULL};
  RomData *rom = shaped_mould_create(&shape);
  Surface *surface;
  WallSet walls;
  CastError err = {0};
  assert_int_equal(surface_create(rom, 30.0, &surface, &err), CAST_OK);
  assert_int_equal(walls_generate(surface, 12.0, 30.0, (const double[3]){0, 0, 0}, &walls, &err), CAST_ERR_INPUT);
  assert_non_null(strstr(err.message, "cannot resolve"));
  assert_int_equal(walls_generate(surface, 0.0, 30.0, (const double[3]){0, 0, 0}, &walls, &err), CAST_ERR_ARGUMENT);
  surface_destroy(&surface);
  rom->patch[0].outer = true;
  assert_int_equal(surface_create(rom, 3.0, &surface, &err), CAST_OK);
  assert_int_equal(walls_generate(surface, 1.0, 3.0, (const double[3]){0, 0, 0}, &walls, &err), CAST_ERR_INPUT);
  surface_destroy(&surface);
  rom_destroy(&rom);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sums_over_a_plane_wall_are_those_of_a_half_space_to_second_order),
      cmocka_unit_test(each_particle_lies_behind_its_foot),
      cmocka_unit_test(a_thin_wall_feels_like_a_thick_one),
      cmocka_unit_test(nothing_is_felt_of_a_thin_walls_other_side),
      cmocka_unit_test(melt_over_the_rim_is_borne_by_the_top_face),
      cmocka_unit_test(walls_have_the_same_bits_at_any_thread_count),
      cmocka_unit_test(a_spacing_that_no_cavity_can_bear_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
