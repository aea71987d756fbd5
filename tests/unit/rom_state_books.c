/* The books of the mould's modal state: heat that came in is held or was lost, with both schemes and with many patches.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/assert_close.h"
#include "tests/support/random_numbers.h"
#include "tests/support/rom_state_case.h"

/* Random flows and steps from 1e-7 to 1 s: what came in is held or was lost. */
static void check_conservation(RomScheme scheme)
{
  RomData *rom = slab(&losing);
  RomState *state = start(rom, scheme, ambient);
  uint64_t seed = 12345;
  long double given = 0.0L, size = 0.0L;
  double q[4];
  for (int n = 0; n < 100000; n++) {
    const double dt = n % 100 == 0 ? pow(10.0, -7.0 + 7.0 * random_unit(&seed)) : 1e-5;
    for (size_t l = 0; l < rom->m; l++) {
      q[l] = 20.0 * random_unit(&seed) - 8.0;
      given += (long double)q[l] * dt;
      size += fabsl((long double)q[l] * dt);
    }
    rom_state_step(state, q, dt);
  }
  assert_true(fabs(rom_state_lost(state)) > 0.01 * (double)size); // else the test would not look at the losses
  assert_close(rom_state_heat(state) + rom_state_lost(state), (double)given, 1e-12 * (double)size);
  rom_state_destroy(&state);
  rom_destroy(&rom);
}

static void exponential_scheme_conserves_heat_over_100000_steps(void **unused)
{
  (void)unused;
  check_conservation(ROM_EXPONENTIAL);
}

static void backward_euler_conserves_heat_over_100000_steps(void **unused)
{
  (void)unused;
  check_conservation(ROM_BACKWARD_EULER);
}

/* Twenty by twenty patches: the rows of so many are kept in single precision. */
static RomData *many_patches(void)
{
  SyntheticSlab given = losing;
  given.patches[0] = given.patches[1] = 20;
  given.cells[0] = given.cells[1] = 1;
  given.modes_lateral[0] = given.modes_lateral[1] = 16;
  given.modes = 12;
  RomData *rom = slab(&given);
  assert_true((double)rom->r * (double)rom->m > 1e6);
  return rom;
}

static void a_model_of_many_patches_conserves_heat_too(void **unused)
{
  (void)unused;
  RomData *rom = many_patches();
  RomState *state = start(rom, ROM_EXPONENTIAL, ambient);
  double *q = calloc(rom->m, sizeof *q), given = 0.0, size = 0.0;
  uint64_t seed = 4;
  for (int n = 0; n < 300; n++) {
    for (size_t l = 0; l < rom->m; l++) {
      q[l] = 20.0 * random_unit(&seed) - 8.0;
      given += q[l] * 0.01;
      size += fabs(q[l] * 0.01);
    }
    rom_state_step(state, q, 0.01);
  }
  assert_close(rom_state_heat(state) + rom_state_lost(state), given, 1e-12 * size); // single precision alone: 1e-8
  free(q);
  rom_state_destroy(&state);
  rom_destroy(&rom);
}

static void a_model_of_many_patches_has_its_temperatures_to_a_millionth_of_the_rise(void **unused)
{
  (void)unused;
  RomData *rom = many_patches();
  const size_t r = rom->r, m = rom->m;
  RomState *state = start(rom, ROM_EXPONENTIAL, preheat); // no drive from outside
  double *q = calloc(m, sizeof *q), *T = calloc(m, sizeof *T), *ahead = calloc(m, sizeof *ahead), rise = 0.0;
  uint64_t seed = 5;
  for (size_t l = 0; l < m; l++) q[l] = random_unit(&seed);
  rom_state_step_ahead(state, q, 0.02, ahead);
  for (int turn = 0; turn < 2; turn++) {
    memset(T, 0, m * sizeof *T);
    for (size_t k = 0; k < r; k++) {
      double u = 0.0;
      for (size_t l = 0; l < m; l++) u += rom->B[k * m + l] * q[l];
      const double x = rom->lambda[k] * 0.02 * (turn + 1),
                   z = x > 0.0 ? -expm1(-x) / rom->lambda[k] * u : 0.02 * (turn + 1) * u;
      for (size_t l = 0; l < m; l++) T[l] += rom->B[k * m + l] * z;
    }
    for (size_t l = 0; l < m; l++) rise = fmax(rise, T[l]);
    const double *found = turn == 0 ? rom_state_patch_temperature(state) : ahead;
    for (size_t l = 0; l < m; l++) assert_close(found[l] - preheat, T[l], 1e-6 * rise);
  }
  free(q);
  free(T);
  free(ahead);
  rom_state_destroy(&state);
  rom_destroy(&rom);
}

/* The loss of one long step against h A (T_bottom - T_ambient), Simpson's rule over the exact history. */
static void lost_heat_is_the_integral_of_the_outer_wall_s_flux(void **unused)
{
  (void)unused;
  RomData *rom = slab(&losing);
  RomState *whole = start(rom, ROM_EXPONENTIAL, ambient), *fine = start(rom, ROM_EXPONENTIAL, ambient);
  const double q[] = {3.0, 1.0, 0.0, 0.0}, time = 20.0;
  const size_t bottom = 2;
  enum { PARTS = 4000 };
  double integral = 0.0;
  for (int n = 0; n <= PARTS; n++) {
    const double flux = losing.h_bottom * (rom_state_patch_temperature(fine)[bottom] - ambient);
    integral += flux * rom->patch[bottom].area * (n == 0 || n == PARTS ? 1.0 : n % 2 ? 4.0 : 2.0) * time / PARTS / 3.0;
    if (n < PARTS) rom_state_step(fine, q, time / PARTS);
  }
  rom_state_step(whole, q, time);
  // the bottom's first instants, when its modes are still excited by the jump of the ambient, limit Simpson's rule
  assert_close(rom_state_lost(whole), integral, 1e-4 * fabs(integral));
  rom_state_destroy(&whole);
  rom_state_destroy(&fine);
  rom_destroy(&rom);
}

static void steady_flow_is_lost_as_fast_as_it_comes(void **unused)
{
  (void)unused;
  for (int scheme = 0; scheme < 2; scheme++) {
    RomData *rom = slab(&losing);
    RomState *state = start(rom, scheme ? ROM_BACKWARD_EULER : ROM_EXPONENTIAL, ambient);
    const double q[] = {2.0, 2.0, 0.0, 0.0};
    for (int n = 0; n < 200; n++) rom_state_step(state, q, 100.0);
    const double before = rom_state_lost(state);
    rom_state_step(state, q, 100.0);
    assert_close(rom_state_lost(state) - before, 400.0, 1e-9 * 400.0);
    const double resistance = (losing.depth / losing.kappa + 1.0 / losing.h_bottom) / (4e-3 * 2e-3);
    // the tail of the modes in depth: 2 L q/(kappa A pi^2 modes)
    assert_close(rom_state_patch_temperature(state)[0], ambient + 4.0 * resistance, 2e-3 * 4.0 * resistance);
    rom_state_destroy(&state);
    rom_destroy(&rom);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(exponential_scheme_conserves_heat_over_100000_steps),
      cmocka_unit_test(backward_euler_conserves_heat_over_100000_steps),
      cmocka_unit_test(lost_heat_is_the_integral_of_the_outer_wall_s_flux),
      cmocka_unit_test(steady_flow_is_lost_as_fast_as_it_comes),
      cmocka_unit_test(a_model_of_many_patches_conserves_heat_too),
      cmocka_unit_test(a_model_of_many_patches_has_its_temperatures_to_a_millionth_of_the_rise),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
