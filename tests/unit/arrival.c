/* When and how warm melt came to each place, and what follows for misrun and cold shut: melt on a lattice that is
 * poured into a box cavity by hand, from one side or from both. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cast/results/defects.h"
#include "cast/results/wall_maps.h"
#include "tests/support/assert_close.h"
#include "tests/support/assert_ok.h"
#include "tests/support/synthetic_rom.h"

enum { ALONG = 20, ACROSS = 10 }; // cells of the cavity
static const double DX = 0.2e-3, ORIGIN[3] = {-2e-3, -1e-3, -2e-3};
static const double T_range[2] = {1000.0, 1100.0}, fractions[2] = {1.0, 0.0};
static Material melt = {.liquidus = 1100.0,
                        .solidus = 1000.0,
                        .coherency_fraction = 0.5,
                        .solid_fraction = {2, (double *)(uintptr_t)T_range, (double *)(uintptr_t)fractions}};

typedef struct Pour {
  RomData *rom;
  Surface *surface;
  Filling *filling;
  Arrival *arrival;
} Pour;

static Pour begin(void)
{
  CastError err = {0};
  Pour pour = {0};
  const SyntheticBox box = {.outer = {8e-3, 6e-3, 6e-3},
                            .cavity = {4e-3, 2e-3, 2e-3},
                            .cell = 0.25e-3,
                            .kappa = 1.0,
                            .rho = 1800.0,
                            .c = 1100.0,
                            .h_outside = 10.0};
  ok(synthetic_rom_box_cavity(&box, &pour.rom, &err), &err);
  ok(surface_create(pour.rom, 1e-3, &pour.surface, &err), &err);
  ok(filling_create(pour.surface, pour.rom, DX, ORIGIN, &pour.filling, &err), &err);
  ok(arrival_create(filling_cells(pour.filling), pour.rom, DX, ALONG * ACROSS * ACROSS, &pour.arrival, &err), &err);
  return pour;
}

static void end(Pour *pour)
{
  arrival_destroy(&pour->arrival);
  assert_null(pour->arrival);
  filling_destroy(&pour->filling);
  surface_destroy(&pour->surface);
  rom_destroy(&pour->rom);
}

/* Melt of this temperature in the columns [0, left) and [right, ALONG). */
static Particles melt_in(int left, int right, double T)
{
  static double x[3][ALONG * ACROSS * ACROSS];
  double *const places[3] = {x[0], x[1], x[2]};
  CastError err = {0};
  ptrdiff_t n = 0;
  for (int i = 0; i < ALONG; i++)
    for (int j = 0; j < ACROSS * ACROSS && (i < left || i >= right); j++, n++) {
      x[0][n] = ORIGIN[0] + (i + 0.5) * DX;
      x[1][n] = ORIGIN[1] + (j % ACROSS + 0.5) * DX;
      x[2][n] = ORIGIN[2] + (j / ACROSS + 0.5) * DX; // NOLINT(bugprone-integer-division): a row's number
    }
  Particles p = {0};
  ok(particles_create(n, places, DX, 7000.0, NULL, &p, &err), &err);
  for (ptrdiff_t i = 0; i < n; i++) p.T[i] = T;
  return p;
}

/* A column a millisecond from the left, and as many from the right if wished; 10 K colder with each. */
static void pour_in(Pour *pour, int columns, bool both)
{
  for (int k = 1; k <= columns; k++) {
    Particles p = melt_in(k, both ? ALONG - k : ALONG, 1150.0 - 10.0 * k);
    arrival_update(pour->arrival, &p, 1e-3 * k);
    if (k == columns) filling_update(pour->filling, &p, 1e-3 * k);
    particles_destroy(&p);
  }
}

static ptrdiff_t column_of(const Pour *pour, ptrdiff_t cell)
{
  return (ptrdiff_t)floor((filling_cells(pour->filling)->x[0][cell] - ORIGIN[0]) / DX);
}

static void each_place_keeps_when_melt_first_came_and_how_warm_it_was(void **state)
{
  (void)state;
  Pour pour = begin();
  pour_in(&pour, 12, false);
  const CavityCells *cells = filling_cells(pour.filling);
  assert_int_equal(cells->n, ALONG * ACROSS * ACROSS);
  for (ptrdiff_t i = 0; i < cells->n; i++) {
    const double column = (double)column_of(&pour, i) + 1.0;
    const double time = arrival_cell_time(pour.arrival, i), T = arrival_cell_temperature(pour.arrival, i);
    if (column > 12.0) assert_true(isnan(time) && isnan(T));
    if (column > 12.0) continue;
    assert_close(time, 1e-3 * column, 1e-12);
    assert_close(T, 1150.0 - 10.0 * column, 1e-9);
  }
  size_t reached = 0;
  for (size_t i = 0; i < arrival_n_triangles(pour.arrival); i++) {
    const ptrdiff_t t = (ptrdiff_t)i;
    const double x = arrival_triangle_place(pour.arrival, t)[0], time = arrival_triangle_time(pour.arrival, t);
    // a particle reaches 0.87 of a spacing beside it, 1.25 before it
    const double at = (x - ORIGIN[0]) / DX;
    if (isnan(time)) assert_true(at > 11.5);
    if (isnan(time)) continue;
    reached++;
    assert_true(time > 1e-3 * (at - 1.3) && time < 1e-3 * (at + 1.6));
  }
  assert_true(reached > arrival_n_triangles(pour.arrival) / 3);
  end(&pour);
}

static void what_is_known_survives_a_checkpoint_and_later_melt_does_not_change_it(void **state)
{
  (void)state;
  Pour whole = begin(), broken = begin(), resumed = begin();
  pour_in(&whole, 12, false);
  pour_in(&broken, 7, false);
  const size_t n = arrival_size(whole.arrival);
  double *buffer = malloc(2 * n * sizeof *buffer);
  assert_non_null(buffer);
  arrival_save(broken.arrival, buffer);
  arrival_restore(resumed.arrival, buffer);
  pour_in(&resumed, 12, false); // from the first column again: those known must not move
  arrival_save(whole.arrival, buffer);
  arrival_save(resumed.arrival, buffer + n);
  assert_memory_equal(buffer, buffer + n, n * sizeof *buffer);
  free(buffer);
  end(&whole);
  end(&broken);
  end(&resumed);
}

static void a_box_of_the_input_is_a_feature_of_its_own_and_may_be_the_part(void **state)
{
  (void)state;
  CastError err = {0};
  Pour pour = begin();
  const FeatureBox boxes[2] = {{"end", {1e-3, -1.0, -1.0}, {1.0, 1.0, 1.0}},
                               {"nowhere", {1.0, 1.0, 1.0}, {2.0, 2.0, 2.0}}};
  const FeatureBox taken = {"cavity", {-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}};
  assert_int_equal(filling_add_boxes(pour.filling, 1, &taken, &err), CAST_ERR_INPUT);
  assert_int_equal(filling_add_boxes(pour.filling, 1, &boxes[1], &err), CAST_ERR_INPUT);
  assert_non_null(strstr(err.message, "'nowhere' holds nothing"));
  end(&pour);
  pour = begin();
  ok(filling_add_boxes(pour.filling, 1, boxes, &err), &err);
  char names[1][ROM_NAME_LENGTH] = {"end"};
  ok(filling_set_part(pour.filling, 1, names, &err), &err);
  assert_int_equal(filling_n_features(pour.filling), filling_n_surfaces(pour.filling) + 1);
  assert_close(filling_volume(pour.filling, 1), 1e-3 * 2e-3 * 2e-3, 1e-13); // five columns
  pour_in(&pour, 17, false);                                                // two of them
  assert_close(filling_fraction(pour.filling, 1), 0.4, 1e-9);
  assert_close(filling_fraction(pour.filling, 2), 0.4, 1e-9); // the part
  assert_close(filling_fraction(pour.filling, 0), 0.85, 1e-9);
  end(&pour);
}

static void the_misrun_index_is_one_where_empty_and_the_front_s_solid_over_coherency_elsewhere(void **state)
{
  (void)state;
  CastError err = {0};
  Pour pour = begin();
  Defects defects;
  pour_in(&pour, 12, false); // column 5 at the liquidus, then 0.1 of solid more each
  ok(defects_find(pour.filling, pour.arrival, &melt, &defects, &err), &err);
  double sum = 0.0;
  for (ptrdiff_t i = 0; i < defects.n; i++) {
    const double solid = 0.1 * ((double)column_of(&pour, i) + 1.0 - 5.0);
    const double expected = solid > 0.701 ? 1.0 : fmin(fmax(solid, 0.0) / 0.5, 1.0); // empty beyond column 12
    assert_close(defects.misrun[i], expected, 1e-9);
    assert_true(isnan(defects.cold_shut[i])); // one front only
    sum += expected / (double)defects.n;
  }
  const FeatureDefects all = defects_of_feature(pour.filling, pour.arrival, &defects, filling_n_features(pour.filling));
  assert_close(all.misrun, sum, 1e-9);
  assert_close(all.unfilled, 0.4, 1e-9);
  assert_close(all.front_coldest, 1030.0, 1e-9);
  assert_close(all.front_solid, 0.7, 1e-9);
  assert_true(isnan(all.cold_shut));
  defects_free(&defects);
  end(&pour);
}

static void fronts_from_both_sides_make_a_cold_shut_where_they_meet(void **state)
{
  (void)state;
  CastError err = {0};
  Pour pour = begin();
  Defects defects;
  pour_in(&pour, 10, true); // they meet between columns 10 and 11, with a solid fraction of 0.5
  ok(defects_find(pour.filling, pour.arrival, &melt, &defects, &err), &err);
  ptrdiff_t found = 0;
  for (ptrdiff_t i = 0; i < defects.n; i++) {
    if (isnan(defects.cold_shut[i])) continue;
    found++;
    assert_true(column_of(&pour, i) == 9 || column_of(&pour, i) == 10);
    assert_close(defects.cold_shut[i], 0.5, 1e-9);
  }
  assert_int_equal(found, 2 * ACROSS * ACROSS);
  const FeatureDefects all = defects_of_feature(pour.filling, pour.arrival, &defects, filling_n_features(pour.filling));
  assert_close(all.cold_shut_volume, 2.0 * ACROSS * ACROSS * DX * DX * DX, 1e-15);
  assert_true(fabs(all.cold_shut_at[0]) < DX);
  defects_free(&defects);
  end(&pour);
}

static void maps_have_the_wall_s_times_and_the_melt_s_freezing_and_nothing_outside(void **state)
{
  (void)state;
  CastError err = {0};
  Pour pour = begin();
  Defects defects;
  Freezing *freezing = NULL;
  WallMaps maps;
  pour_in(&pour, 10, false);
  ok(defects_find(pour.filling, pour.arrival, &melt, &defects, &err), &err);
  Particles p = melt_in(10, ALONG, 1150.0);
  ok(freezing_create(&melt, p.n_fluid, &freezing, &err), &err);
  freezing_update(freezing, &p, 0.0);
  for (ptrdiff_t i = 0; i < p.n_fluid; i++) p.T[i] = 950.0;
  freezing_update(freezing, &p, 4.0); // solid at 3 s everywhere
  const WallMapsInput input = {pour.rom, &melt, &p, DX, pour.filling, pour.arrival, &defects, freezing};
  ok(wall_maps_create(&input, &maps, &err), &err);
  const int32_t *surface = maps.values[0];
  const float *fill = maps.values[1], *misrun = maps.values[4], *solidus = maps.values[WALL_MAPS_OWN + 1];
  assert_string_equal(maps.field[WALL_MAPS_OWN + 1].name, "solidus_time");
  size_t cavity = 0, frozen = 0;
  for (size_t t = 0; t < pour.rom->n_triangles; t++) {
    const bool outer = pour.rom->patch[pour.rom->triangle_patch[t]].outer;
    assert_int_equal(surface[t], outer ? -1 : 0);
    if (outer) assert_true(isnan(fill[t]) && isnan(solidus[t]));
    if (outer) continue;
    cavity++;
    assert_true(isnan(fill[t]) ? misrun[t] == 1.0f : fill[t] <= 0.010001f);
    if (isnan(solidus[t])) continue;
    frozen++;
    assert_close((double)solidus[t], 3.0, 1e-6);
  }
  assert_int_equal(cavity, arrival_n_triangles(pour.arrival));
  assert_true(frozen > cavity / 3 && frozen < cavity);
  wall_maps_free(&maps);
  freezing_destroy(&freezing);
  defects_free(&defects);
  particles_destroy(&p);
  end(&pour);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_place_keeps_when_melt_first_came_and_how_warm_it_was),
      cmocka_unit_test(what_is_known_survives_a_checkpoint_and_later_melt_does_not_change_it),
      cmocka_unit_test(a_box_of_the_input_is_a_feature_of_its_own_and_may_be_the_part),
      cmocka_unit_test(the_misrun_index_is_one_where_empty_and_the_front_s_solid_over_coherency_elsewhere),
      cmocka_unit_test(fronts_from_both_sides_make_a_cold_shut_where_they_meet),
      cmocka_unit_test(maps_have_the_wall_s_times_and_the_melt_s_freezing_and_nothing_outside),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
