/* No gaps and no overlaps: from any place in the void near the wall, fluid on the full lattice and wall particles
 * together fill the kernel. Spacing 1, Wendland C2, h = 1.3. The fluid is the void part of each lattice cell, as one
 * point at its centroid, as far as it is in sight. A kernel of 1.3 spacings is summed over points, so with cells cut in
 * two close to the particle a few per cent are the sum's own error: a plane wall shows how much. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <cmocka.h>

#include "cast/geometry/cut.h"
#include "cast/geometry/walls.h"
#include "cast/kernel/kernel.h"
#include "tests/support/random_numbers.h"
#include "tests/support/shaped_mould.h"
#include "tests/support/surface_of.h"

#define H 1.3
#define REACH 2.6
static const double ORIGIN[3] = {0.13, 0.31, -0.27};

typedef struct Bounds {
  double worst, rms; // of the kernel's sum from 1
} Bounds;

/* Of the void in a cell, cut in 6 x 6 x 6, the share that x sees, and its centroid. */
static double share_in_sight(const Surface *surface, const double x[3], const int at[3], double centre[3])
{
  enum { PARTS = 6 };
  double seen = 0.0, all = 0.0, moment[3] = {0.0, 0.0, 0.0}, y[3];
  for (int p = 0; p < PARTS * PARTS * PARTS; p++) {
    const int part[3] = {p % PARTS, p / PARTS % PARTS, p / PARTS / PARTS};
    for (int k = 0; k < 3; k++) y[k] = ORIGIN[k] + at[k] + (part[k] + 0.5) / PARTS;
    if (surface_inside_mould(surface, y)) continue;
    all += 1.0;
    if (surface_separates(surface, x, y)) continue;
    seen += 1.0;
    vec_axpy(1.0, y, moment, moment);
  }
  if (seen > 0.0 && seen < all)
    for (int k = 0; k < 3; k++) centre[k] = moment[k] / seen;
  return seen > 0.0 ? seen / all : 0.0;
}

/* Kernel sum over the void in one lattice cell: exact volume and centroid where all of it is in sight. */
static double cell_sum(const Surface *surface, const double x[3], const int at[3])
{
  CutBox box;
  CutPart part, mould;
  for (int k = 0; k < 3; k++) {
    box.low[k] = ORIGIN[k] + at[k];
    box.high[k] = ORIGIN[k] + at[k] + 1.0;
  }
  cut_whole(&box, &part);
  cut_box(surface, &box, NULL, &mould);
  cut_add(&part, -1.0, &mould);
  if (part.volume < 1e-9) return 0.0;
  double centre[3], share = 1.0;
  for (int k = 0; k < 3; k++) centre[k] = part.moment[k] / part.volume;
  if (vec_distance2(x, centre) > (REACH + 0.9) * (REACH + 0.9)) return 0.0;
  if (surface_thin_near(surface, x)) share = share_in_sight(surface, x, at, centre);
  return share * part.volume * kernel_value(KERNEL_WENDLAND_C2, sqrt(vec_distance2(x, centre)), H);
}

static double fluid_sum(const Surface *surface, const double x[3])
{
  int home[3], at[3];
  double sum = 0.0;
  for (int k = 0; k < 3; k++) home[k] = (int)floor(x[k] - ORIGIN[k]);
  for (at[2] = home[2] - 4; at[2] <= home[2] + 4; at[2]++)
    for (at[1] = home[1] - 4; at[1] <= home[1] + 4; at[1]++)
      for (at[0] = home[0] - 4; at[0] <= home[0] + 4; at[0]++) sum += cell_sum(surface, x, at);
  return sum;
}

static double wall_sum(const Surface *surface, const WallSet *walls, const double x[3])
{
  double sum = 0.0;
  for (ptrdiff_t k = 0; k < walls->n; k++) {
    const double place[3] = {walls->x[0][k], walls->x[1][k], walls->x[2][k]};
    const double foot[3] = {walls->foot[0][k], walls->foot[1][k], walls->foot[2][k]};
    const double normal[3] = {walls->normal[0][k], walls->normal[1][k], walls->normal[2][k]};
    const double r2 = vec_distance2(x, place);
    if (r2 < REACH * REACH && walls_seen(surface, x, place, foot, normal, walls->echo[k]))
      sum += walls->volume[k] * kernel_value(KERNEL_WENDLAND_C2, sqrt(r2), H);
  }
  return sum;
}

/* Random places in [low, high] that are void, within reach of the wall and a quarter of a spacing off it at least. */
static void check_coverage(const ShapedMould *shape, const double low[3], const double high[3], Bounds bounds)
{
  enum { PLACES = 25 };
  RomData *rom = shaped_mould_create(shape);
  WallSet walls;
  CastError err = {0};
  Surface *surface = surface_of(rom, REACH);
  if (walls_generate(surface, 1.0, REACH, ORIGIN, &walls, &err) != CAST_OK) fail_msg("%s", err.message);
  uint64_t seed = 7;
  double square = 0.0;
  for (int n = 0; n < PLACES;) {
    double x[3];
    SurfaceHit hit;
    random_point(&seed, low, high, x);
    if (!surface_nearest(surface, x, REACH, &hit) || hit.distance < 0.25) continue;
    const double off = fluid_sum(surface, x) + wall_sum(surface, &walls, x) - 1.0;
    if (fabs(off) > bounds.worst) fail_msg("at (%g, %g, %g) the kernel is filled to %g", x[0], x[1], x[2], 1.0 + off);
    square += off * off;
    n++;
  }
  if (sqrt(square / PLACES) > bounds.rms) fail_msg("the kernel is off by %g in the mean", sqrt(square / PLACES));
  walls_destroy(&walls);
  surface_destroy(&surface);
  rom_destroy(&rom);
}

static const Bounds LIKE_A_PLANE = {0.05, 0.022}; // a plane wall at the worst offsets to the lattice: 0.050 and 0.018

static void plane_walls_and_corners_of_the_void_are_covered(void **state)
{
  (void)state;
  const ShapedBox tub = {{-10, -10, -10}, {10, 10, 20}, false};
  const Turn turn = {{0.0, 0.6, 0.8}, 0.5, {0.3, 0.0, 0.0}};
  ShapedMould shape = {{-15, -15, -15}, {15, 15, 10}, 1, &tub, 2.0, NULL, NULL};
  check_coverage(&shape, (const double[3]){-5, -5, -10}, (const double[3]){5, 5, -7}, LIKE_A_PLANE);
  check_coverage(&shape, (const double[3]){-10, -10, -10}, (const double[3]){-7, -7, -7}, LIKE_A_PLANE);
  shape.bend = bend_turn;
  shape.context = &turn;
  check_coverage(&shape, (const double[3]){-8, -8, -8}, (const double[3]){8, 8, 8}, LIKE_A_PLANE);
}

static void corners_of_the_mould_are_covered(void **state)
{
  (void)state;
  const ShapedBox box[2] = {{{-20, -20, -10}, {20, 20, 30}, false}, {{-10, -10, -10}, {0, 0, 0}, true}};
  const ShapedMould shape = {{-23, -23, -13}, {23, 23, 23}, 2, box, 2.0, NULL, NULL};
  check_coverage(&shape, (const double[3]){-4, -4, -4}, (const double[3]){4, 4, 4}, LIKE_A_PLANE);
}

static void a_pin_four_spacings_wide_is_covered(void **state)
{
  (void)state;
  const double ab[2] = {2.0, 2.4};
  const ShapedBox box[2] = {{{-2, -2, -12}, {2, 2, 0}, false}, {{-6, -6, 0}, {6, 6, 12}, false}};
  ShapedMould shape = {{-10, -10, -17}, {10, 10, 6}, 2, box, 0.5, NULL, NULL};
  for (int round = 0; round < 2; round++) {
    shape.bend = round ? bend_cylinder : NULL;
    shape.context = ab;
    check_coverage(&shape, (const double[3]){-2, -2, -8}, (const double[3]){2, 2, -4}, LIKE_A_PLANE);
    check_coverage(&shape, (const double[3]){-2, -2, -12}, (const double[3]){2, 2, -9}, LIKE_A_PLANE);
    check_coverage(&shape, (const double[3]){-3, -3, -3}, (const double[3]){3, 3, 3}, LIKE_A_PLANE);
  }
}

static void a_mould_wall_one_spacing_thick_is_covered(void **state)
{
  (void)state;
  const ShapedBox fin[2] = {{{-10, -10, -10}, {10, 10, 30}, false}, {{-10, -0.5, -10}, {10, 0.5, 0}, true}};
  const Turn turn = {{0.0, 0.6, 0.8}, 0.5, {0.3, 0.0, 0.0}};
  ShapedMould shape = {{-13, -13, -13}, {13, 13, 13}, 2, fin, 2.0, NULL, NULL};
  check_coverage(&shape, (const double[3]){-4, -3, -7}, (const double[3]){4, 3, -4}, LIKE_A_PLANE);  // its plain
  check_coverage(&shape, (const double[3]){-4, -3, -3}, (const double[3]){4, 3, 3}, LIKE_A_PLANE);   // its end
  check_coverage(&shape, (const double[3]){-4, -3, -10}, (const double[3]){4, 3, -7}, LIKE_A_PLANE); // its foot
  shape.bend = bend_turn;
  shape.context = &turn;
  check_coverage(&shape, (const double[3]){-5, -5, -5}, (const double[3]){5, 5, 5}, LIKE_A_PLANE);
}

static void pins_a_spacing_apart_are_covered(void **state)
{
  (void)state;
  const ShapedBox pins[3] = {
      {{-4.5, -2, -12}, {-0.5, 2, 0}, false}, {{0.5, -2, -12}, {4.5, 2, 0}, false}, {{-8, -8, 0}, {8, 8, 12}, false}};
  const ShapedMould shape = {{-11, -11, -16}, {11, 11, 6}, 3, pins, 2.0, NULL, NULL};
  check_coverage(&shape, (const double[3]){-4.5, -2, -8}, (const double[3]){4.5, 2, -4}, LIKE_A_PLANE);
  check_coverage(&shape, (const double[3]){-4.5, -2, -12}, (const double[3]){4.5, 2, -9}, LIKE_A_PLANE);
  check_coverage(&shape, (const double[3]){-5, -3, -3}, (const double[3]){5, 3, 3}, LIKE_A_PLANE);
}

static void a_core_thinner_than_the_kernel_is_covered(void **state)
{
  (void)state;
  const double ab[2] = {0.75, 1.2};
  const ShapedBox core[2] = {{{-10, -10, -10}, {10, 10, 30}, false}, {{-0.75, -0.75, -10}, {0.75, 0.75, 5}, true}};
  ShapedMould shape = {{-13, -13, -13}, {13, 13, 13}, 2, core, 0.75, NULL, NULL};
  check_coverage(&shape, (const double[3]){-4, -4, -3}, (const double[3]){4, 4, 3}, LIKE_A_PLANE);
  shape.bend = bend_cylinder;
  shape.context = ab;
  check_coverage(&shape, (const double[3]){-4, -4, -3}, (const double[3]){4, 4, 3}, LIKE_A_PLANE);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(plane_walls_and_corners_of_the_void_are_covered),
      cmocka_unit_test(corners_of_the_mould_are_covered),
      cmocka_unit_test(a_pin_four_spacings_wide_is_covered),
      cmocka_unit_test(a_mould_wall_one_spacing_thick_is_covered),
      cmocka_unit_test(pins_a_spacing_apart_are_covered),
      cmocka_unit_test(a_core_thinner_than_the_kernel_is_covered),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
