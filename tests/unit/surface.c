/* The mould's boundary: distances against closed forms, samples. Lengths in mm would do as well: the surface knows no
 * unit. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "common/vector.h"
#include "tests/support/assert_close.h"
#include "tests/support/random_numbers.h"
#include "tests/support/shaped_mould.h"
#include "tests/support/surface_of.h"

#define PI 3.14159265358979323846

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
  RomData *rom = shaped_mould_create(&shape);
  Surface *surface = surface_of(rom, 0.6);
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
  RomData *rom = shaped_mould_create(&shape);
  Surface *surface = surface_of(rom, 0.6);
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
  RomData *rom = shaped_mould_create(&shape);
  Surface *surface = surface_of(rom, 0.05);
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
  RomData *rom = shaped_mould_create(&shape);
  Surface *surface = surface_of(rom, 0.5);
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
    RomData *rom = shaped_mould_create(&shape);
    Surface *surface = surface_of(rom, 0.6);
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
      cmocka_unit_test(samples_have_the_area_of_each_patch),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
