/* What the mould's boundary hides: places on two sides of a wall thinner than the kernel's reach. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "cast/geometry/surface_internal.h"
#include "tests/support/random_numbers.h"
#include "tests/support/shaped_mould.h"
#include "tests/support/surface_of.h"

static void release(Surface *surface, RomData *rom)
{
  surface_destroy(&surface);
  rom_destroy(&rom);
}

/* A tub with a fin of thickness t standing on its floor z = -10; the fin's top is z = 0. */
static ShapedMould tub_with_fin(double t, ShapedBox box[2])
{
  box[0] = (ShapedBox){{-10, -10, -10}, {10, 10, 30}, false};
  box[1] = (ShapedBox){{-10, -0.5 * t, -10}, {10, 0.5 * t, 0}, true};
  return (ShapedMould){{-15, -15, -15}, {15, 15, 15}, 2, box, 2.0, NULL, NULL};
}

static void a_thin_wall_hides_and_its_end_and_corners_do_not(void **state)
{
  (void)state;
  ShapedBox box[2];
  const ShapedMould shape = tub_with_fin(1.0, box);
  RomData *rom = shaped_mould_create(&shape);
  Surface *s = surface_of(rom, 2.6);
  assert_true(surface_separates(s, (const double[3]){1, -1, -5}, (const double[3]){1.5, 1, -5.5}));
  assert_true(surface_separates(s, (const double[3]){1, -0.51, -5}, (const double[3]){1.5, 0.51, -5.5}));
  assert_false(surface_separates(s, (const double[3]){1, -1, -5}, (const double[3]){1.5, -0.6, -3.5}));
  assert_false(surface_separates(s, (const double[3]){1, -1, 0.5}, (const double[3]){1.2, 1, 0.4})); // over the end
  assert_false(surface_separates(s, (const double[3]){1, -0.9, -0.6}, (const double[3]){1.2, 0.1, 0.5})); // clips it
  assert_true(surface_separates(s, (const double[3]){1, -0.9, -0.6}, (const double[3]){1.2, 0.9, -0.1}));
  // the foot of a wall particle, a little above its face
  assert_true(surface_separates(s, (const double[3]){1, -1, -5}, (const double[3]){1, 0.501, -5}));
  assert_false(surface_separates(s, (const double[3]){1, -1, -5}, (const double[3]){1.4, -0.501, -5.5}));
  release(s, rom);
}

static void ends_that_dip_into_a_thin_wall_count_for_their_side(void **state)
{
  (void)state;
  ShapedBox box[2];
  const ShapedMould shape = tub_with_fin(1.0, box);
  RomData *rom = shaped_mould_create(&shape);
  Surface *s = surface_of(rom, 2.6);
  assert_true(surface_separates(s, (const double[3]){1, -0.45, -5}, (const double[3]){1.5, 1, -5.5}));
  assert_true(surface_separates(s, (const double[3]){1.5, 1, -5.5}, (const double[3]){1, -0.45, -5}));
  assert_true(surface_separates(s, (const double[3]){1, -0.45, -5}, (const double[3]){1, 0.45, -5.2})); // both dip
  assert_false(surface_separates(s, (const double[3]){1, 0.45, -5}, (const double[3]){1.5, 1, -5.5}));
  assert_true(surface_separates(s, (const double[3]){1, -0.2, -5}, (const double[3]){1.5, 1, -5.5})); // deep
  assert_false(surface_separates(s, (const double[3]){1, 0.2, -5}, (const double[3]){1.5, 1, -5.5}));
  release(s, rom);
}

static void a_thick_mould_hides_nothing_and_is_known_to(void **state)
{
  (void)state;
  ShapedBox box[2];
  const ShapedMould shape = tub_with_fin(4.0, box);
  RomData *rom = shaped_mould_create(&shape);
  Surface *s = surface_of(rom, 2.6);
  uint64_t seed = 3;
  for (int i = 0; i < 5000; i++) {
    double x[3];
    random_point(&seed, (const double[3]){-12, -12, -12}, (const double[3]){12, 12, 12}, x);
    assert_false(surface_thin_near(s, x));
  }
  // round the fin's upper edge: two pools of one melt
  assert_false(surface_separates(s, (const double[3]){1, 2.2, -1.1}, (const double[3]){1.2, 1.2, 0.3}));
  release(s, rom);
}

static void thin_walls_are_flagged_wherever_they_may_hide(void **state)
{
  (void)state;
  ShapedBox box[2];
  const ShapedMould shape = tub_with_fin(1.0, box);
  RomData *rom = shaped_mould_create(&shape);
  Surface *s = surface_of(rom, 2.6);
  uint64_t seed = 4;
  int hidden = 0;
  for (int i = 0; i < 200000; i++) {
    double a[3], b[3], d[3];
    random_point(&seed, (const double[3]){-9, -3, -9.9}, (const double[3]){9, 3, 2}, a);
    random_point(&seed, (const double[3]){-1.5, -1.5, -1.5}, (const double[3]){1.5, 1.5, 1.5}, d);
    vec_axpy(1.0, d, a, b);
    if (fabs(a[1]) < 0.5 || fabs(b[1]) < 0.5 || b[2] < -10.0 || fabs(b[0]) > 10.0 || a[1] * b[1] > 0.0) continue;
    // across the fin's plane: hidden if both faces are passed below the end
    const double at_low = (-0.5 - a[1]) / d[1], at_high = (0.5 - a[1]) / d[1];
    const bool through = a[2] + at_low * d[2] < 0.0 && a[2] + at_high * d[2] < 0.0;
    if (surface_separates(s, a, b) != through)
      fail_msg("(%g, %g, %g) and (%g, %g, %g): hidden %d", a[0], a[1], a[2], b[0], b[1], b[2], !through);
    assert_int_equal(surface_separates(s, b, a), through);
    if (!through) continue;
    hidden++;
    assert_true(surface_thin_near(s, a) && surface_thin_near(s, b));
  }
  assert_true(hidden > 1000);
  release(s, rom);
}

/* Every straight way across a thin wall is blocked, aimed exactly at the mesh's points and edges as well. */
static void nothing_passes_between_triangles(void **state)
{
  (void)state;
  ShapedBox box[2];
  ShapedMould shape = tub_with_fin(1.0, box);
  const Turn turn = {{0.0, 0.6, 0.8}, 0.7, {0.1, 0.2, 0.3}};
  for (int turned = 0; turned < 2; turned++) {
    shape.bend = turned ? bend_turn : NULL;
    shape.context = &turn;
    RomData *rom = shaped_mould_create(&shape);
    Surface *s = surface_of(rom, 2.6);
    uint64_t seed = 8;
    int tried = 0;
    for (ptrdiff_t t = 0; t < s->n_triangles; t++) {
      const Facet *facet = &s->facet[t];
      double back[3]; // the fin's own frame
      for (int k = 0; k < 3; k++) back[k] = facet->centre[k] - (turned ? turn.shift[k] : 0.0);
      const Turn undo = {{0.0, 0.6, 0.8}, turned ? -0.7 : 0.0, {0, 0, 0}};
      bend_turn(&undo, back);
      if (fabs(fabs(back[1]) - 0.5) > 1e-9 || back[2] > -3.0 || back[2] < -8.0 || fabs(back[0]) > 7.0) continue;
      for (int k = 0; k < 6; k++) {
        double target[3], slant[3], a[3], b[3];
        for (int d = 0; d < 3; d++)
          target[d] = k < 3 ? facet->corner[k][d] : 0.5 * (facet->corner[k - 3][d] + facet->corner[(k - 2) % 3][d]);
        random_point(&seed, (const double[3]){-0.5, -0.5, -0.5}, (const double[3]){0.5, 0.5, 0.5}, slant);
        if (k % 2) slant[0] = slant[1] = slant[2] = 0.0;
        vec_axpy(1.0, facet->normal, slant, slant);
        vec_axpy(0.5, slant, target, a);
        vec_axpy(-2.0, slant, target, b);
        if (surface_inside_mould(s, b) || surface_inside_mould(s, a)) continue;
        assert_true(surface_separates(s, a, b));
        assert_true(surface_separates(s, b, a));
        tried++;
      }
    }
    assert_true(tried > 300);
    release(s, rom);
  }
}

/* Between two round pins the mould is thin at one line only; ways that pass beside it are hidden all the same. */
static void round_pins_side_by_side_do_not_see_each_other(void **state)
{
  (void)state;
  const double radius = 2.0, wall = 0.5, ab[2] = {radius, 2.1};
  const ShapedBox pin = {{-2, -2, -20}, {2, 2, 0}, false};
  const ShapedMould one = {{-2.2, -4, -22}, {2.2, 4, 2}, 1, &pin, 0.4, bend_cylinder, ab};
  RomData *rom = shaped_mould_create(&one), *twin = shaped_mould_create(&one);
  const size_t n = rom->n_points; // two separate blocks with a pin each would leave a gap: join them into one list
  assert_int_equal(n, twin->n_points);
  rom->points = realloc(rom->points, 6 * n * sizeof *rom->points);
  rom->triangles = realloc(rom->triangles, 6 * rom->n_triangles * sizeof *rom->triangles);
  rom->triangle_patch = realloc(rom->triangle_patch, 2 * rom->n_triangles * sizeof *rom->triangle_patch);
  size_t kept = 0;
  for (size_t t = 0; t < rom->n_triangles; t++) // the pins alone, as closed voids in a mould without end
    if (rom->triangle_patch[t] == 0) {
      memmove(rom->triangles + 3 * kept, rom->triangles + 3 * t, 3 * sizeof *rom->triangles);
      rom->triangle_patch[kept++] = 0;
    }
  for (size_t t = 0; t < kept; t++) {
    for (size_t k = 0; k < 3; k++) rom->triangles[3 * (kept + t) + k] = rom->triangles[3 * t + k] + (int32_t)n;
    rom->triangle_patch[kept + t] = 0;
  }
  rom->n_triangles = 2 * kept;
  rom->n_points = 2 * n;
  for (size_t p = 0; p < n; p++)
    for (size_t k = 0; k < 3; k++)
      rom->points[3 * (n + p) + k] = rom->points[3 * p + k] + (k == 0 ? 2.0 * radius + wall : 0.0);
  Surface *s = surface_of(rom, 2.6);
  uint64_t seed = 11;
  int tried = 0;
  for (int i = 0; i < 200000 && tried < 3000; i++) {
    double a[3], b[3];
    random_point(&seed, (const double[3]){0, -2, -15}, (const double[3]){2, 2, -5}, a);
    random_point(&seed, (const double[3]){2.5, -2, -15}, (const double[3]){4.5, 2, -5}, b);
    const double in_a = hypot(a[0], a[1]), in_b = hypot(b[0] - 4.5, b[1]);
    if (in_a > 1.9 || in_b > 1.9 || vec_distance2(a, b) > 2.6 * 2.6) continue;
    tried++;
    assert_true(surface_separates(s, a, b));
  }
  assert_int_equal(tried, 3000);
  surface_destroy(&s);
  rom_destroy(&rom);
  rom_destroy(&twin);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_thin_wall_hides_and_its_end_and_corners_do_not),
      cmocka_unit_test(ends_that_dip_into_a_thin_wall_count_for_their_side),
      cmocka_unit_test(a_thick_mould_hides_nothing_and_is_known_to),
      cmocka_unit_test(thin_walls_are_flagged_wherever_they_may_hide),
      cmocka_unit_test(nothing_passes_between_triangles),
      cmocka_unit_test(round_pins_side_by_side_do_not_see_each_other),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
