/* What part of a box the mould fills: volumes and first moments against closed forms. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <cmocka.h>

#include "cast/geometry/cut.h"
#include "tests/support/assert_close.h"
#include "tests/support/random_numbers.h"
#include "tests/support/shaped_mould.h"
#include "tests/support/surface_of.h"

/* Sum over the lattice of unit cells that covers [low, high]. */
static CutPart sum_cells(const Surface *surface, const double low[3], int n, double cell)
{
  CutPart sum = {0};
  for (int c = 0; c < n * n * n; c++) {
    const int at[3] = {c % n, c / n % n, c / n / n};
    CutBox box;
    CutPart part;
    for (int k = 0; k < 3; k++) {
      box.low[k] = low[k] + at[k] * cell;
      box.high[k] = low[k] + (at[k] + 1) * cell;
    }
    cut_box(surface, &box, NULL, &part);
    cut_add(&sum, 1.0, &part);
  }
  return sum;
}

/* The lattice cuts a block at random angles and offsets: faces, edges and corners. */
static void cells_of_a_turned_block_add_up_to_its_volume_and_moment(void **state)
{
  (void)state;
  uint64_t seed = 2;
  for (int trial = 0; trial < 5; trial++) {
    Turn turn = {.angle = 3.0 * random_unit(&seed)};
    random_point(&seed, (const double[3]){-1, -1, -1}, (const double[3]){1, 1, 1}, turn.axis);
    random_point(&seed, (const double[3]){-1, -1, -1}, (const double[3]){1, 1, 1}, turn.shift);
    vec_normalise(turn.axis);
    const ShapedMould shape = {{-3, -2, -2.5}, {2, 3, 2}, 0, NULL, 1.7, bend_turn, &turn};
    RomData *rom = shaped_mould_create(&shape);
    Surface *surface = surface_of(rom, 2.6);
    double centre[3] = {-0.5, 0.5, -0.25};
    bend_turn(&turn, centre);
    const CutPart sum = sum_cells(surface, (const double[3]){-8, -8, -8}, 16, 1.0);
    assert_close(sum.volume, 5.0 * 5.0 * 4.5, 1e-9);
    for (int k = 0; k < 3; k++) assert_close(sum.moment[k], 5.0 * 5.0 * 4.5 * centre[k], 1e-8);
    surface_destroy(&surface);
    rom_destroy(&rom);
  }
}

static void a_lattice_that_falls_on_the_wall_counts_each_cell_once(void **state)
{
  (void)state;
  const ShapedBox cavity = {{-2, -2, -2}, {2, 2, 2}, false};
  const ShapedMould shape = {{-4, -4, -4}, {4, 4, 4}, 1, &cavity, 1.0, NULL, NULL};
  RomData *rom = shaped_mould_create(&shape);
  Surface *surface = surface_of(rom, 2.6);
  const CutPart sum = sum_cells(surface, (const double[3]){-5, -5, -5}, 10, 1.0);
  assert_close(sum.volume, 8.0 * 8.0 * 8.0 - 4.0 * 4.0 * 4.0, 1e-9);
  surface_destroy(&surface);
  rom_destroy(&rom);
}

/* Volume of a closed mesh by the divergence theorem. */
static double mesh_volume(const Surface *s)
{
  double sum = 0.0;
  for (ptrdiff_t t = 0; t < s->n_triangles; t++) {
    double n[3];
    vec_cross(s->facet[t].corner[0], s->facet[t].corner[1], n);
    sum += vec_dot(n, s->facet[t].corner[2]) / 6.0;
  }
  return sum;
}

/* A ball-shaped void meshed finer than the lattice, and a wavy block with saddles, where the cells must be divided. */
static void curved_walls_are_cut_to_a_thousandth_of_a_cell(void **state)
{
  (void)state;
  const double ab[2] = {3.0, 3.9};
  const ShapedBox ball = {{-3, -3, -3}, {3, 3, 3}, false};
  const ShapedMould shape = {{-4, -4, -4}, {4, 4, 4}, 1, &ball, 0.4, bend_ball, ab};
  RomData *rom = shaped_mould_create(&shape);
  Surface *surface = surface_of(rom, 2.6);
  const CutPart sum = sum_cells(surface, (const double[3]){-5.3, -5.1, -5.2}, 11, 1.0);
  assert_close(sum.volume, mesh_volume(surface), 0.02); // some 200 cut cells, each within 1e-4 of its volume
  surface_destroy(&surface);
  rom_destroy(&rom);
}

static void bend_wave(const void *context, double x[3])
{
  (void)context;
  x[2] += 0.6 * sin(0.8 * x[0]) * cos(0.7 * x[1]);
}

static void a_saddle_shaped_wall_is_cut_by_division(void **state)
{
  (void)state;
  const ShapedMould shape = {{-4, -4, -4}, {4, 4, 0}, 0, NULL, 0.4, bend_wave, NULL};
  RomData *rom = shaped_mould_create(&shape);
  Surface *surface = surface_of(rom, 2.6);
  const CutPart sum = sum_cells(surface, (const double[3]){-5.3, -5.1, -5.2}, 11, 1.0);
  assert_close(sum.volume, mesh_volume(surface), 1e-3 * 2 * 64); // two wavy faces of 64 cells each
  surface_destroy(&surface);
  rom_destroy(&rom);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cells_of_a_turned_block_add_up_to_its_volume_and_moment),
      cmocka_unit_test(a_lattice_that_falls_on_the_wall_counts_each_cell_once),
      cmocka_unit_test(curved_walls_are_cut_to_a_thousandth_of_a_cell),
      cmocka_unit_test(a_saddle_shaped_wall_is_cut_by_division),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
