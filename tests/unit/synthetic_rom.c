/* The synthetic ROMs against closed forms: what other tests build on. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/support/assert_close.h"
#include "tests/support/synthetic_rom.h"

static RomData *make_slab(const SyntheticSlab *slab)
{
  CastError err = {0};
  RomData *rom = NULL;
  if (synthetic_rom_slab(slab, &rom, &err) != CAST_OK) fail_msg("%s", err.message);
  return rom;
}

static RomData *make_box(const SyntheticBox *box)
{
  CastError err = {0};
  RomData *rom = NULL;
  if (synthetic_rom_box_cavity(box, &rom, &err) != CAST_OK) fail_msg("%s", err.message);
  return rom;
}

/* Temperature rise, K, of patch `out` at time t after 1 W was switched on at patch `in`; t = INFINITY: steady state. */
static double step_response(const RomData *rom, size_t in, size_t out, double t)
{
  double sum = 0.0;
  for (size_t k = 0; k < rom->r; k++) {
    const double x = rom->lambda[k] * t;
    const double phi = x < 1e-12 ? t : -expm1(-x) / rom->lambda[k];
    sum += rom->B[k * rom->m + in] * rom->B[k * rom->m + out] * phi;
  }
  return sum;
}

static void flux_step_on_a_deep_slab_follows_the_half_space(void **state)
{
  (void)state;
  // 1e5 W/m2 for 1 s on effusivity 1407: 80.2 K. Heat has gone 0.7 mm by then; 20 mm are as good as endless
  const SyntheticSlab slab = {
      .size = {1e-3, 1e-3}, .depth = 20e-3, .kappa = 1.0, .rho = 1800.0, .c = 1100.0, .modes = 8000};
  RomData *rom = make_slab(&slab);
  const double area = 1e-6, effusivity = sqrt(1.0 * 1800.0 * 1100.0);
  for (double t = 1e-2; t < 2.0; t *= 10.0) {
    const double exact = 2.0 * 1e5 * sqrt(t / M_PI) / effusivity;
    const double truncated = 2.0 * 1e5 * slab.depth / (slab.kappa * M_PI * M_PI * (double)slab.modes);
    assert_close(step_response(rom, 0, 0, t) * 1e5 * area, exact - truncated, 1e-4 * exact);
  }
  rom_destroy(&rom);
}

static void slab_cooled_below_reaches_its_steady_state(void **state)
{
  (void)state;
  const SyntheticSlab slab = {.size = {2e-3, 1e-3},
                              .depth = 4e-3,
                              .kappa = 2.0,
                              .rho = 1800.0,
                              .c = 1100.0,
                              .h_bottom = 50.0,
                              .modes = 400,
                              .modes_lateral = {1, 1}};
  RomData *rom = make_slab(&slab);
  const double area = 2e-6, exact = (4e-3 / 2.0 + 1.0 / 50.0) / area;    // K/W: slab and film in series
  assert_close(step_response(rom, 0, 0, INFINITY), exact, 1e-3 * exact); // tail of the series: 1/(pi^2 400)
  // 1 W into the top leaves through the bottom's film, whatever the truncation
  assert_close(step_response(rom, 0, 1, INFINITY) * 50.0 * area, 1.0, 1e-9);
  rom_destroy(&rom);
}

static void patches_of_a_slab_warm_alone_at_first_and_together_at_last(void **state)
{
  (void)state;
  const SyntheticSlab slab = {.size = {4e-3, 4e-3},
                              .depth = 4e-3,
                              .kappa = 1.0,
                              .rho = 1800.0,
                              .c = 1100.0,
                              .modes = 60,
                              .modes_lateral = {24, 24},
                              .patches = {2, 2}};
  RomData *rom = make_slab(&slab);
  const double first = 1e-3, alone = step_response(rom, 0, 0, first);
  assert_true(fabs(step_response(rom, 0, 3, first)) < 1e-2 * alone); // the patch across the corner feels nothing yet
  assert_close(step_response(rom, 0, 1, first), step_response(rom, 1, 0, first), 1e-12 * alone); // reciprocity
  assert_close(step_response(rom, 0, 1, first), step_response(rom, 0, 2, first), 1e-9 * alone);  // symmetry
  const double late = 1e5, mean = late / rom->heat_capacity;
  for (size_t l = 0; l < rom->m; l++) assert_close(step_response(rom, 0, l, late) / mean, 1.0, 1e-2);
  rom_destroy(&rom);
}

static void box_keeps_its_heat_and_its_measures(void **state)
{
  (void)state;
  const SyntheticBox box = {.outer = {20e-3, 18e-3, 16e-3},
                            .cavity = {8e-3, 6e-3, 7e-3},
                            .pin_width = 2e-3,
                            .pin_depth = 3e-3,
                            .cell = 1e-3,
                            .patch_size = 2e-3,
                            .kappa = 1.0,
                            .rho = 1800.0,
                            .c = 1100.0,
                            .nodes = 3};
  RomData *rom = make_box(&box);
  const double volume = 20e-3 * 18e-3 * 16e-3 - 8e-3 * 6e-3 * 7e-3 - 2e-3 * 2e-3 * 3e-3;
  assert_close(rom->heat_capacity, 1800.0 * 1100.0 * volume, 1e-9 * rom->heat_capacity);
  double cavity = 0.0, pin = 0.0;
  for (size_t l = 0; l < rom->m; l++) {
    if (rom->patch[l].surface[0] == 'c') cavity += rom->patch[l].area;
    if (rom->patch[l].surface[0] == 'p') pin += rom->patch[l].area;
  }
  assert_close(pin, 4 * 2e-3 * 3e-3 + 4e-6, 1e-15);
  assert_close(cavity, 2 * 7e-3 * (8e-3 + 6e-3) + 48e-6 - 4e-6, 1e-15);
  const double late = 1e7, mean = late / rom->heat_capacity; // insulated: all the heat is still there
  for (size_t l = 0; l < rom->m; l++) assert_close(step_response(rom, 0, l, late) / mean, 1.0, 1e-3);
  rom_destroy(&rom);
}

static void plain_box_needs_no_pin(void **state)
{
  (void)state;
  const SyntheticBox box = {.outer = {20e-3, 20e-3, 16e-3},
                            .cavity = {8e-3, 8e-3, 8e-3},
                            .cell = 2e-3,
                            .kappa = 1.0,
                            .rho = 1800.0,
                            .c = 1100.0,
                            .h_outside = 10.0};
  RomData *rom = make_box(&box);
  assert_int_equal(rom->m, 7); // floor, four walls, rim, outside
  rom_destroy(&rom);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(flux_step_on_a_deep_slab_follows_the_half_space),
      cmocka_unit_test(slab_cooled_below_reaches_its_steady_state),
      cmocka_unit_test(patches_of_a_slab_warm_alone_at_first_and_together_at_last),
      cmocka_unit_test(box_keeps_its_heat_and_its_measures),
      cmocka_unit_test(plain_box_needs_no_pin),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
