/* The mould's boundary: distances against closed forms, what hides what, samples. Lengths in mm would do as well: the
 * surface knows no unit. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "cast/geometry/surface_internal.h"
#include "tests/support/assert_close.h"
#include "tests/support/random_numbers.h"
#include "tests/support/shaped_mould.h"

#define PI 3.14159265358979323846

static Surface *make_surface(const ShapedMould *shape, double reach, RomData **rom)
{
  CastError err = {0};
  Surface *surface;
  *rom = shaped_mould_create(shape);
  if (surface_create(*rom, reach, &surface, &err) != CAST_OK) fail_msg("%s", err.message);
  return surface;
}

static void release(Surface *surface, RomData *rom)
{
  surface_destroy(&surface);
  rom_destroy(&rom);
}

/* Signed distance to the box [low, high], negative inside it. */
static double box_distance(const double x[3], const double low[3], const double high[3])
{
  double outside = 0.0, inside = -INFINITY;
  for (int k = 0; k < 3; k++) {
    const double over = fmax(low[k] - x[k], x[k] - high[k]);
    inside = fmax(inside, over);
    outside += over > 0.0 ? over * over : 0.0;
  }
  return outside > 0.0 ? sqrt(outside) : inside;
}

static const double OUTER[2][3] = {{-3.0, -3.0, -3.0}, {3.0, 2.5, 3.5}};
static const double CAVITY[2][3] = {{-1.0, -1.2, -0.7}, {1.1, 0.9, 1.3}};

static ShapedMould box_in_box(const ShapedBox *cavity)
{
  ShapedMould shape = {.n_boxes = 1, .box = cavity, .cell = 0.35};
  memcpy(shape.low, OUTER[0], sizeof shape.low);
  memcpy(shape.high, OUTER[1], sizeof shape.high);
  return shape;
}

/* Mould = outer box less cavity: its distance is positive in the cavity and in the open. */
static double mould_distance(const double x[3])
{
  const double outer = box_distance(x, OUTER[0], OUTER[1]), cavity = box_distance(x, CAVITY[0], CAVITY[1]);
  if (outer > 0.0) return outer;
  if (cavity < 0.0) return -cavity;
  return -fmin(-outer, cavity);
}

static void nearest_matches_closed_form_of_box_in_box(void **state)
{
  (void)state;
  const ShapedBox cavity = {{-1.0, -1.2, -0.7}, {1.1, 0.9, 1.3}, false};
  const ShapedMould shape = box_in_box(&cavity);
  RomData *rom;
  Surface *surface = make_surface(&shape, 0.6, &rom);
  const double low[3] = {-4.0, -4.0, -4.0}, high[3] = {4.0, 4.0, 4.5};
  uint64_t seed = 1;
  int hits = 0;
  for (int i = 0; i < 20000; i++) {
    double x[3];
    SurfaceHit hit;
    random_point(&seed, low, high, x);
    const double exact = mould_distance(x);
    assert_int_equal(surface_nearest(surface, x, 0.6, &hit), fabs(exact) <= 0.6);
    assert_int_equal(surface_inside_mould(surface, x), exact < 0.0);
    if (fabs(exact) > 0.6) continue;
    hits++;
    assert_close(hit.distance, exact, 1e-12); // rounding of coordinates of order 1
    assert_close(sqrt(vec_distance2(x, hit.foot)), fabs(exact), 1e-12);
    assert_int_equal(hit.patch, rom->triangle_patch[hit.triangle]);
    double foot[3];
    assert_close(surface_triangle_distance(surface, hit.triangle, x, foot), fabs(exact), 1e-12);
  }
  assert_true(hits > 5000);
  release(surface, rom);
}

static void normals_at_edges_and_corners_weigh_the_faces_by_angle(void **state)
{
  (void)state;
  const ShapedBox cavity = {{-1.0, -1.2, -0.7}, {1.1, 0.9, 1.3}, false};
  const ShapedMould shape = box_in_box(&cavity);
  RomData *rom;
  Surface *surface = make_surface(&shape, 0.6, &rom);
  SurfaceHit hit;
  assert_true(surface_nearest(surface, (const double[3]){3.1, 2.6, 3.6}, 0.6, &hit)); // outer corner
  for (int k = 0; k < 3; k++) assert_close(hit.normal[k], 1.0 / sqrt(3.0), 1e-12);
  assert_true(surface_nearest(surface, (const double[3]){1.2, 1.0, 0.1}, 0.6, &hit)); // in the mould at a cavity's edge
  assert_close(hit.distance, -sqrt(0.02), 1e-12);
  assert_close(hit.normal[0], -sqrt(0.5), 1e-12);
  assert_close(hit.normal[1], -sqrt(0.5), 1e-12);
  assert_close(hit.normal[2], 0.0, 1e-12);
  release(surface, rom);
}

static void inside_is_right_at_any_distance(void **state)
{
  (void)state;
  const ShapedBox cavity = {{-1.0, -1.2, -0.7}, {1.1, 0.9, 1.3}, false};
  const ShapedMould shape = box_in_box(&cavity);
  RomData *rom;
  Surface *surface = make_surface(&shape, 0.05, &rom);
  assert_true(surface_inside_mould(surface, (const double[3]){2.0, 0.0, 0.0}));
  assert_false(surface_inside_mould(surface, (const double[3]){0.0, 0.0, 0.3}));
  assert_false(surface_inside_mould(surface, (const double[3]){1e6, -1e6, 1e5}));
  assert_false(surface_inside_mould(surface, (const double[3]){-3.01, 0.0, 0.0}));
  assert_true(surface_inside_mould(surface, (const double[3]){-2.99, 0.0, 0.0}));
  release(surface, rom);
}

/* Largest error of the distance to a ball of radius 1 that a mesh of n cells across stands for. */
static double ball_error(int n)
{
  const double ab[2] = {1.0, 1.6};
  const ShapedBox ball = {{-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}, false};
  const ShapedMould shape = {{-2, -2, -2}, {2, 2, 2}, 1, &ball, 2.0 / n, bend_ball, ab};
  RomData *rom;
  Surface *surface = make_surface(&shape, 0.5, &rom);
  uint64_t seed = 5;
  double worst = 0.0;
  for (int i = 0; i < 4000; i++) {
    double x[3];
    SurfaceHit hit;
    random_point(&seed, (const double[3]){-1.2, -1.2, -1.2}, (const double[3]){1.2, 1.2, 1.2}, x);
    const double exact = 1.0 - vec_norm(x);
    if (fabs(exact) > 0.3) continue;
    assert_true(surface_nearest(surface, x, 0.5, &hit));
    worst = fmax(worst, fabs(hit.distance - exact));
  }
  release(surface, rom);
  return worst;
}

static void distance_to_a_ball_converges_with_order_two(void **state)
{
  (void)state;
  const double coarse = ball_error(8), fine = ball_error(16);
  assert_true(fine < 0.02); // a chord of a sixth of the radius sags by a 280th, the mesh's longest by more
  assert_close(log2(coarse / fine), 2.0, 0.25); // the mesh is not uniform: its worst spot moves
}

static void a_boundary_that_is_open_torn_or_flat_is_refused(void **state)
{
  (void)state;
  const ShapedBox cavity = {{-1.0, -1.2, -0.7}, {1.1, 0.9, 1.3}, false};
  const ShapedMould shape = box_in_box(&cavity);
  CastError err = {0};
  Surface *surface;
  RomData *rom = shaped_mould_create(&shape);
  rom->n_triangles--;
  assert_int_equal(surface_create(rom, 0.6, &surface, &err), CAST_ERR_FORMAT);
  assert_null(surface);
  assert_non_null(strstr(err.message, "not closed"));
  rom->n_triangles++;
  const int32_t kept = rom->triangles[1];
  rom->triangles[1] = rom->triangles[2];
  rom->triangles[2] = kept; // wound the other way
  assert_int_equal(surface_create(rom, 0.6, &surface, &err), CAST_ERR_FORMAT);
  rom->triangles[2] = rom->triangles[1];
  assert_int_equal(surface_create(rom, 0.6, &surface, &err), CAST_ERR_FORMAT);
  rom->triangles[2] = (int32_t)rom->n_points;
  assert_int_equal(surface_create(rom, 0.6, &surface, &err), CAST_ERR_FORMAT);
  assert_int_equal(surface_create(rom, 0.0, &surface, &err), CAST_ERR_ARGUMENT);
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
  RomData *rom;
  Surface *s = make_surface(&shape, 2.6, &rom);
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
  RomData *rom;
  Surface *s = make_surface(&shape, 2.6, &rom);
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
  RomData *rom;
  Surface *s = make_surface(&shape, 2.6, &rom);
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
  RomData *rom;
  Surface *s = make_surface(&shape, 2.6, &rom);
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
    RomData *rom;
    Surface *s = make_surface(&shape, 2.6, &rom);
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
  CastError err = {0};
  Surface *s;
  if (surface_create(rom, 2.6, &s, &err) != CAST_OK) fail_msg("%s", err.message);
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

static void samples_have_the_area_of_each_patch(void **state)
{
  (void)state;
  const ShapedBox cavity = {{-1.0, -1.2, -0.7}, {1.1, 0.9, 1.3}, false};
  const Turn turn = {{0.0, 0.6, 0.8}, 0.7, {0.1, 0.2, 0.3}};
  ShapedMould shape = box_in_box(&cavity);
  const double exact = 2.0 * (2.1 * 2.1 + 2.0 * 2.1 * 2.0), spacings[3] = {0.05, 0.2, 0.7};
  for (int pass = 0; pass < 6; pass++) {
    shape.bend = pass < 3 ? NULL : bend_turn;
    shape.context = &turn;
    RomData *rom;
    Surface *surface = make_surface(&shape, 0.6, &rom);
    SurfaceSamples samples;
    CastError err = {0};
    assert_int_equal(surface_samples_create(surface, spacings[pass % 3], &samples, &err), CAST_OK);
    double sum = 0.0, most = 0.0;
    for (ptrdiff_t i = 0; i < samples.n; i++) {
      SurfaceHit hit;
      const double x[3] = {samples.x[0][i], samples.x[1][i], samples.x[2][i]};
      assert_true(surface_nearest(surface, x, 1e-9, &hit));
      assert_int_equal(samples.patch[i], 0);
      sum += samples.area[i];
      most = fmax(most, samples.area[i]);
    }
    const double share = spacings[pass % 3] * spacings[pass % 3];
    assert_close(sum, exact, 1e-11 * exact);
    assert_true(most <= 2.5 * share); // the largest cut of a plane through a cube is 1.3, and shares are not cut
    assert_true((double)samples.n > 0.5 * exact / share && (double)samples.n < 3.0 * exact / share);
    surface_samples_destroy(&samples);
    release(surface, rom);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(nearest_matches_closed_form_of_box_in_box),
      cmocka_unit_test(normals_at_edges_and_corners_weigh_the_faces_by_angle),
      cmocka_unit_test(inside_is_right_at_any_distance),
      cmocka_unit_test(distance_to_a_ball_converges_with_order_two),
      cmocka_unit_test(a_boundary_that_is_open_torn_or_flat_is_refused),
      cmocka_unit_test(a_thin_wall_hides_and_its_end_and_corners_do_not),
      cmocka_unit_test(ends_that_dip_into_a_thin_wall_count_for_their_side),
      cmocka_unit_test(a_thick_mould_hides_nothing_and_is_known_to),
      cmocka_unit_test(thin_walls_are_flagged_wherever_they_may_hide),
      cmocka_unit_test(nothing_passes_between_triangles),
      cmocka_unit_test(round_pins_side_by_side_do_not_see_each_other),
      cmocka_unit_test(samples_have_the_area_of_each_patch),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
