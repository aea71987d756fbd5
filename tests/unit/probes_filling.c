/* What is looked at during a run: temperatures at fixed places, and how full the cavity is. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/geometry/placement.h"
#include "cast/results/filling.h"
#include "cast/results/probes.h"
#include "tests/support/assert_close.h"
#include "tests/support/assert_ok.h"
#include "tests/support/cast_case.h"
#include "tests/support/lattice_melt.h"

static RomData *rom; // of the case
static Surface *surface;

static int set_up(void **state)
{
  (void)state;
  CastError err = {0};
  CastStatus status = cast_case_create(&casting, &err);
  if (status == CAST_OK) status = cast_case_rom(&casting, &rom, &err);
  if (status == CAST_OK) status = surface_create(rom, 1.2e-3, &surface, &err);
  if (status != CAST_OK) fprintf(stderr, "%s\n", err.message);
  return status != CAST_OK;
}

static int clean_up(void **state)
{
  (void)state;
  surface_destroy(&surface);
  rom_destroy(&rom);
  cast_case_remove(&casting);
  return 0;
}

/* ---- probes ---- */

/* T = 1300 + 1e4 x is linear and the place a lattice point's centre of symmetry: the kernel's average is exact. */
static void a_probe_in_the_melt_averages_a_linear_field_exactly(void **state)
{
  (void)state;
  CastError err = {0};
  const SphParameters sph = {.kernel = KERNEL_WENDLAND_C2, .h = 0.6e-3};
  const double corner[3] = {-2e-3, -2e-3, -4e-3};
  Particles p = lattice_melt(corner, (const int[3]){10, 10, 10}, 0.4e-3);
  const double x[3][3] = {{0.0, 0.0, -2e-3}, {0.0, 0.0, 3e-3}, {3e-3, 0.0, -2e-3}};
  Probes *probes = NULL;
  RomState *mould = NULL;
  ok(rom_state_create(rom, ROM_EXPONENTIAL, 1000.0, 300.0, &mould, &err), &err);
  ok(probes_create(3, x, rom, surface, &sph, &probes, &err), &err);
  assert_close(probes_melt_temperature(probes, 0, &p), 1300.0, 1e-9);
  assert_true(isnan(probes_mould_temperature(probes, 0, mould)));
  assert_true(isnan(probes_melt_temperature(probes, 1, &p))); // above the mould, no melt
  assert_int_equal(probes_home(probes, 2), PROBE_BAND);       // 1 mm behind the cavity wall
  assert_true(isnan(probes_melt_temperature(probes, 2, &p)));
  assert_close(probes_mould_temperature(probes, 2, mould), 1000.0, 1e-9);
  probes_destroy(&probes);
  rom_state_destroy(&mould);
  particles_destroy(&p);
}

/* At a node of the mesh the probe is what the ROM says of that point. */
static void a_probe_in_the_mould_interpolates_the_basis(void **state)
{
  (void)state;
  CastError err = {0};
  const SphParameters sph = {.kernel = KERNEL_WENDLAND_C2, .h = 1e-3};
  const size_t node = (size_t)rom->tetrahedra[4 * (rom->n_tetrahedra / 2)];
  double x[1][3], *q = calloc(rom->m, sizeof *q), *T = malloc(rom->n_points * sizeof *T);
  assert_non_null(q);
  assert_non_null(T);
  double centre[3] = {0};
  for (int c = 0; c < 4; c++) // a hair's breadth into the tetrahedron, so that it is inside whatever the rounding
    for (int d = 0; d < 3; d++)
      centre[d] += 0.25 * rom->points[3 * rom->tetrahedra[4 * (rom->n_tetrahedra / 2) + (size_t)c] + d];
  for (int d = 0; d < 3; d++)
    x[0][d] = rom->points[3 * node + (size_t)d] + 1e-7 * (centre[d] - rom->points[3 * node + (size_t)d]);
  Probes *probes = NULL;
  RomState *mould = NULL;
  ok(rom_state_create(rom, ROM_EXPONENTIAL, 1000.0, 300.0, &mould, &err), &err);
  for (size_t l = 0; l < rom->m; l++) q[l] = 1.0 + (double)l;
  rom_state_step(mould, q, 0.5);
  rom_state_point_temperature(mould, T);
  ok(probes_create(1, (const double(*)[3])x, rom, surface, &sph, &probes, &err), &err);
  assert_int_equal(probes_home(probes, 0), PROBE_BAND);
  assert_true(fabs(T[node] - 1000.0) > 1e-3);
  // 1e-7 of the way to the middle, over which T changes by less than its whole rise
  assert_close(probes_mould_temperature(probes, 0, mould), T[node], 2e-7 * fabs(T[node] - 1000.0) + 1e-4);
  probes_destroy(&probes);
  rom_state_destroy(&mould);
  free(q);
  free(T);
}

/* ---- filling ---- */

static void half_a_cavity_of_melt_is_half_filled(void **state)
{
  (void)state;
  CastError err = {0};
  const double spacing = 0.4e-3, origin[3] = {-2e-3, -2e-3, -4e-3}, corner[3] = {-2e-3, -2e-3, -4e-3};
  Filling *filling = NULL;
  ok(filling_create(surface, rom, spacing, origin, &filling, &err), &err);
  const size_t all = filling_n_features(filling);
  assert_int_equal(all, 2); // cavity and pin
  double sum = 0.0;
  for (size_t s = 0; s < all; s++) sum += filling_volume(filling, s);
  assert_close(sum, filling_volume(filling, all), 1e-18);
  // the box of 4 mm and the pin of 1.6 x 1.6 x 2 mm
  assert_close(filling_volume(filling, all), 64e-9 + 1.6 * 1.6 * 2.0e-9, 1e-3 * 64e-9);
  Particles p = lattice_melt(corner, (const int[3]){10, 10, 5}, spacing);
  filling_update(filling, &p, 0.25);
  const double volume = 0.5 * 64e-9 / filling_volume(filling, all);
  // the cells above the melt are a whole cell away from it: none of them counts
  assert_close(filling_fraction(filling, all), volume, 1e-3);
  assert_true(isnan(filling_time(filling, all, 0))); // 46 % of cavity and pin
  Particles more = lattice_melt(corner, (const int[3]){10, 10, 6}, spacing);
  filling_update(filling, &more, 0.5);
  assert_close(filling_time(filling, all, 0), 0.5, 0.0);
  assert_true(isnan(filling_time(filling, all, 1)));
  particles_destroy(&more);
  particles_destroy(&p);
  filling_destroy(&filling);
}

static void a_full_cavity_is_filled_and_its_times_survive_a_checkpoint(void **state)
{
  (void)state;
  CastError err = {0};
  const double spacing = 0.4e-3, origin[3] = {-2e-3, -2e-3, -4e-3};
  Filling *filling = NULL, *again = NULL;
  ok(filling_create(surface, rom, spacing, origin, &filling, &err), &err);
  ok(filling_create(surface, rom, spacing, origin, &again, &err), &err);
  PointSet points = {0};
  ok(placement_add_cavity_below(surface, spacing, origin, 0.0, &points, &err), &err);
  Particles p = {0};
  ok(particles_create(points.n, points.x, spacing, 7000.0, NULL, &p, &err), &err);
  filling_update(filling, &p, 0.75);
  for (size_t s = 0; s <= filling_n_features(filling); s++) {
    assert_close(filling_fraction(filling, s), 1.0, 1e-12);
    assert_close(filling_time(filling, s, 2), 0.75, 0.0);
  }
  double *saved = malloc(filling_state_size(filling) * sizeof *saved);
  assert_non_null(saved);
  filling_save(filling, saved);
  filling_restore(again, saved);
  assert_close(filling_time(again, 0, 0), 0.75, 0.0);
  free(saved);
  points_destroy(&points);
  particles_destroy(&p);
  filling_destroy(&filling);
  filling_destroy(&again);
}

static void the_part_is_what_the_user_names(void **state)
{
  (void)state;
  CastError err = {0};
  const double spacing = 0.4e-3, origin[3] = {-2e-3, -2e-3, -4e-3}, corner[3] = {-2e-3, -2e-3, -4e-3};
  Filling *filling = NULL;
  ok(filling_create(surface, rom, spacing, origin, &filling, &err), &err);
  const size_t all = filling_n_features(filling);
  char names[1][ROM_NAME_LENGTH] = {"nothing"};
  assert_int_equal(filling_set_part(filling, 1, names, &err), CAST_ERR_INPUT);
  assert_non_null(strstr(err.message, "no surface 'nothing'; it has cavity, pin"));
  snprintf(names[0], sizeof names[0], "cavity");
  ok(filling_set_part(filling, 1, names, &err), &err);
  assert_string_equal(filling_name(filling, all), "part");
  Particles p = lattice_melt(corner, (const int[3]){10, 10, 10}, spacing); // the box, not the pin
  filling_update(filling, &p, 0.25);
  assert_close(filling_volume(filling, all), filling_volume(filling, 0), 1e-18);
  assert_close(filling_fraction(filling, all), 1.0, 1e-12);
  assert_true(filling_fraction(filling, 1) < 0.5);
  particles_destroy(&p);
  filling_destroy(&filling);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_probe_in_the_melt_averages_a_linear_field_exactly),
      cmocka_unit_test(a_probe_in_the_mould_interpolates_the_basis),
      cmocka_unit_test(half_a_cavity_of_melt_is_half_filled),
      cmocka_unit_test(the_part_is_what_the_user_names),
      cmocka_unit_test(a_full_cavity_is_filled_and_its_times_survive_a_checkpoint),
  };
  return cmocka_run_group_tests(tests, set_up, clean_up);
}
