/* Where melt stands at the start, the cavity's volume by feature, its thinnest gap. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "cast/geometry/placement.h"
#include "cast/geometry/surface_internal.h"
#include "tests/support/assert_close.h"
#include "tests/support/shaped_mould.h"
#include "tests/support/surface_of.h"
#include "tests/support/synthetic_rom.h"

#define PI 3.14159265358979323846

static const double ZERO[3] = {0.0, 0.0, 0.0};
static const double ASKEW[3] = {0.013, 0.031, -0.027};

/* A tub of 2 x 2 x 1 with a pin of 0.4 x 0.4 x 0.8 below its floor; the rim is the plane z = 0. */
static RomData *tub_with_pin(void)
{
  const ShapedBox box[2] = {{{-1, -1, -1}, {1, 1, 1}, false}, {{-0.2, -0.2, -1.8}, {0.2, 0.2, -1}, false}};
  const ShapedMould shape = {{-2, -2, -3}, {2, 2, 0}, 2, box, 0.3, NULL, NULL};
  return shaped_mould_create(&shape);
}

static void a_block_takes_the_lattice_points_outside_the_mould(void **state)
{
  (void)state;
  RomData *rom = tub_with_pin();
  Surface *surface = surface_of(rom, 0.26);
  PointSet points = {0};
  CastError err = {0};
  // lattice points at (i + 1/2)/10, so 0.05 from the walls: those in the cavity's outermost layers stand
  assert_int_equal(placement_add_block(surface, 0.1, ZERO, (const double[3]){-2, -2, -0.5},
                                       (const double[3]){4, 4, 0.5}, &points, &err),
                   CAST_OK);
  assert_int_equal(points.n, 20 * 20 * 5);
  for (ptrdiff_t i = 0; i < points.n; i++)
    for (int k = 0; k < 3; k++) {
      const double cells = points.x[k][i] / 0.1 - 0.5;
      assert_close(cells, round(cells), 1e-9);
    }
  // the lattice half a cell off: points on the walls themselves are too near
  points_destroy(&points);
  assert_int_equal(placement_add_block(surface, 0.1, (const double[3]){0.05, 0.05, 0}, (const double[3]){-1, -1, -0.5},
                                       (const double[3]){2, 2, 0.5}, &points, &err),
                   CAST_OK);
  assert_int_equal(points.n, 19 * 19 * 5);
  // one more block is appended
  assert_int_equal(placement_add_block(surface, 0.1, ZERO, (const double[3]){0, 0, 1}, (const double[3]){0.2, 0.2, 0.2},
                                       &points, &err),
                   CAST_OK);
  assert_int_equal(points.n, 19 * 19 * 5 + 8);
  assert_int_equal(placement_add_block(surface, 0.1, ZERO, (const double[3]){-1.9, -1.9, -2.9},
                                       (const double[3]){0.5, 0.5, 0.5}, &points, &err),
                   CAST_ERR_INPUT);
  assert_int_equal(points.n, 19 * 19 * 5 + 8);
  points_destroy(&points);
  surface_destroy(&surface);
  rom_destroy(&rom);
}

static void the_cavity_below_a_level_is_filled_and_nothing_else(void **state)
{
  (void)state;
  RomData *rom = tub_with_pin();
  Surface *surface = surface_of(rom, 0.26);
  PointSet points = {0};
  CastError err = {0};
  assert_int_equal(placement_add_cavity_below(surface, 0.1, ZERO, -0.5, &points, &err), CAST_OK);
  assert_int_equal(points.n, 20 * 20 * 5 + 4 * 4 * 8);
  points_destroy(&points);
  assert_int_equal(placement_add_cavity_below(surface, 0.1, ZERO, 5.0, &points, &err), CAST_OK); // ends at the rim
  assert_int_equal(points.n, 20 * 20 * 10 + 4 * 4 * 8);
  points_destroy(&points);
  assert_int_equal(placement_add_cavity_below(surface, 0.1, ZERO, -1.9, &points, &err), CAST_ERR_INPUT);
  points_destroy(&points);
  surface_destroy(&surface);
  rom_destroy(&rom);
}

static double cavity_volume(const CavityCells *cells, int32_t surface)
{
  double sum = 0.0;
  for (ptrdiff_t i = 0; i < cells->n; i++)
    if (surface < 0 || cells->surface[i] == surface) sum += cells->volume[i];
  return sum;
}

static void cells_add_up_to_the_cavity(void **state)
{
  (void)state;
  RomData *rom = tub_with_pin();
  Surface *surface = surface_of(rom, 0.26);
  const double exact = 2.0 * 2.0 * 1.0 + 0.4 * 0.4 * 0.8;
  for (int pass = 0; pass < 4; pass++) {
    CavityCells cells;
    CastError err = {0};
    const double spacing = pass < 2 ? 0.1 : 0.17;
    assert_int_equal(cavity_cells_create(surface, rom, spacing, pass % 2 ? ASKEW : ZERO, &cells, &err), CAST_OK);
    assert_close(cavity_volume(&cells, -1), exact, 1e-5 * exact); // exact but for cells at the corners of the mouth
    for (ptrdiff_t i = 0; i < cells.n; i++) {
      assert_true(cells.volume[i] > 0.0 && cells.volume[i] <= pow(spacing, 3.0) * (1.0 + 1e-9));
      for (int k = 0; k < 3; k++) assert_true(fabs(cells.x[k][i]) < 1.8);
    }
    cavity_cells_destroy(&cells);
  }
  surface_destroy(&surface);
  rom_destroy(&rom);
}

static void cells_of_a_round_closed_cavity_add_up_too(void **state)
{
  (void)state;
  const double ab[2] = {1.0, 1.6};
  const ShapedBox ball = {{-1, -1, -1}, {1, 1, 1}, false};
  const ShapedMould shape = {{-2, -2, -2}, {2, 2, 2}, 1, &ball, 0.1, bend_ball, ab};
  RomData *rom = shaped_mould_create(&shape);
  Surface *surface = surface_of(rom, 0.26);
  CavityCells cells;
  CastError err = {0};
  assert_int_equal(cavity_cells_create(surface, rom, 0.15, ASKEW, &cells, &err), CAST_OK);
  assert_close(cavity_volume(&cells, -1), 4.0 / 3.0 * PI, 0.01 * 4.0 / 3.0 * PI); // chords of a tenth: 0.4 %
  cavity_cells_destroy(&cells);
  surface_destroy(&surface);
  rom_destroy(&rom);
}

/* Distance, m, from x to the nearest triangle of a named cavity surface. */
static double distance_to_name(const Surface *surface, const RomData *rom, const char *name, const double x[3])
{
  double best = INFINITY, foot[3];
  for (size_t t = 0; t < rom->n_triangles; t++) {
    if (strcmp(rom->patch[rom->triangle_patch[t]].surface, name) != 0) continue;
    best = fmin(best, surface_triangle_distance(surface, (int32_t)t, x, foot));
  }
  return best;
}

/* Returns the volume of "pin". */
static double check_names(const Surface *surface, const RomData *rom, double spacing, ptrdiff_t stride)
{
  CavityCells cells;
  CastError err = {0};
  assert_int_equal(cavity_cells_create(surface, rom, spacing, ASKEW, &cells, &err), CAST_OK);
  const int32_t pin = strcmp(cells.names[0], "pin") == 0 ? 0 : 1;
  for (ptrdiff_t i = 0; i < cells.n; i += stride) {
    const double x[3] = {cells.x[0][i], cells.x[1][i], cells.x[2][i]};
    const double own = distance_to_name(surface, rom, cells.names[cells.surface[i]], x);
    assert_true(own <= distance_to_name(surface, rom, cells.names[1 - cells.surface[i]], x) + 1e-9);
  }
  const double volume = cavity_volume(&cells, pin);
  cavity_cells_destroy(&cells);
  return volume;
}

static void no_other_feature_is_nearer_and_the_spacing_does_not_matter(void **state)
{
  (void)state;
  const SyntheticBox box = {.outer = {4, 4, 3},
                            .cavity = {2, 2, 1},
                            .pin_width = 0.4,
                            .pin_depth = 0.8,
                            .cell = 0.2,
                            .kappa = 1.0,
                            .rho = 1800.0,
                            .c = 1100.0,
                            .h_outside = 10.0};
  RomData *rom;
  CastError err = {0};
  ok(synthetic_rom_box_cavity(&box, &rom, &err), &err);
  Surface *surface = surface_of(rom, 0.26);
  const double coarse = check_names(surface, rom, 0.05, 7), fine = check_names(surface, rom, 0.02, 301);
  // over the rim of its mouth the pin has half of the space before the edge: cells there count as a whole, one or other
  assert_close(coarse, fine, 0.02 * fine);
  surface_destroy(&surface);
  rom_destroy(&rom);
}

static void cells_are_named_by_the_nearest_feature(void **state)
{
  (void)state;
  const SyntheticBox box = {.outer = {4, 4, 3},
                            .cavity = {2, 2, 1},
                            .pin_width = 0.4,
                            .pin_depth = 0.8,
                            .cell = 0.2,
                            .kappa = 1.0,
                            .rho = 1800.0,
                            .c = 1100.0,
                            .h_outside = 10.0};
  RomData *rom;
  CavityCells cells;
  CastError err = {0};
  ok(synthetic_rom_box_cavity(&box, &rom, &err), &err);
  Surface *surface = surface_of(rom, 0.26);
  assert_int_equal(cavity_cells_create(surface, rom, 0.1, ASKEW, &cells, &err), CAST_OK);
  assert_int_equal(cells.n_surfaces, 2);
  const int32_t pin = strcmp(cells.names[0], "pin") == 0 ? 0 : 1;
  assert_string_equal(cells.names[pin], "pin");
  assert_string_equal(cells.names[1 - pin], "cavity");
  assert_close(cavity_volume(&cells, -1), 2.0 * 2.0 * 1.0 + 0.4 * 0.4 * 0.8, 1e-5);
  for (ptrdiff_t i = 0; i < cells.n; i++) {
    if (cells.x[2][i] < -1.1) assert_int_equal(cells.surface[i], pin);
    // over the pin's mouth its rim is nearer than the walls within some height; far from it the cavity's walls are
    if (fmax(fabs(cells.x[0][i]), fabs(cells.x[1][i])) > 0.5) assert_int_equal(cells.surface[i], 1 - pin);
  }
  cavity_cells_destroy(&cells);
  surface_destroy(&surface);
  rom_destroy(&rom);
}

static void the_thinnest_gap_is_the_pins_width(void **state)
{
  (void)state;
  RomData *rom = tub_with_pin();
  Surface *surface = surface_of(rom, 0.26);
  CastError err = {0};
  double gap, where[3];
  assert_int_equal(cavity_thinnest_gap(surface, &gap, where, &err), CAST_OK);
  assert_close(gap, 0.4, 1e-5);
  assert_true(where[2] < -1.0 && fabs(where[0]) < 0.2 + 1e-9 && fabs(where[1]) < 0.2 + 1e-9);
  surface_destroy(&surface);
  rom_destroy(&rom);
}

static void a_flat_wall_without_a_cavity_has_no_cells_and_no_gap(void **state)
{
  (void)state;
  const SyntheticSlab slab = {.size = {1, 1}, .depth = 0.5, .kappa = 1.0, .rho = 1800.0, .c = 1100.0, .modes = 3};
  RomData *rom;
  CavityCells cells;
  PointSet points = {0};
  CastError err = {0};
  double gap, where[3];
  ok(synthetic_rom_slab(&slab, &rom, &err), &err);
  Surface *surface = surface_of(rom, 0.26);
  assert_int_equal(cavity_cells_create(surface, rom, 0.1, ZERO, &cells, &err), CAST_OK);
  assert_int_equal(cells.n, 0);
  assert_int_equal(placement_add_cavity_below(surface, 0.1, ZERO, 1.0, &points, &err), CAST_ERR_INPUT);
  assert_int_equal(cavity_thinnest_gap(surface, &gap, where, &err), CAST_OK);
  assert_close(gap, 1.0, 1e-12); // nothing faces the wall: its own extent
  cavity_cells_destroy(&cells);
  surface_destroy(&surface);
  rom_destroy(&rom);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_block_takes_the_lattice_points_outside_the_mould),
      cmocka_unit_test(the_cavity_below_a_level_is_filled_and_nothing_else),
      cmocka_unit_test(cells_add_up_to_the_cavity),
      cmocka_unit_test(cells_of_a_round_closed_cavity_add_up_too),
      cmocka_unit_test(cells_are_named_by_the_nearest_feature),
      cmocka_unit_test(no_other_feature_is_nearer_and_the_spacing_does_not_matter),
      cmocka_unit_test(the_thinnest_gap_is_the_pins_width),
      cmocka_unit_test(a_flat_wall_without_a_cavity_has_no_cells_and_no_gap),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
