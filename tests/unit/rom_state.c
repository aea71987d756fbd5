/* The mould's modal state: exact for constant flows, how stiff an exchange with it is, the same on any threads. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/assert_close.h"
#include "tests/support/rom_state_case.h"

/* ---- the step ---- */

static void constant_flow_gives_the_exact_state_at_any_step(void **unused)
{
  (void)unused;
  RomData *rom = slab(&losing);
  rom->lambda[3] = 0.0; // a mode that keeps everything, as the constant of an insulated mould
  const double steps[] = {1e-12, 1e-6, 1e-2, 10.0, 1e5}, q[] = {3.0, -1.0, 0.5, 0.0};
  for (size_t n = 0; n < sizeof steps / sizeof *steps; n++) {
    RomState *state = start(rom, ROM_EXPONENTIAL, ambient);
    rom_state_step(state, q, steps[n]);
    for (size_t k = 0; k < rom->r; k++) {
      double u = rom->ambient[k] * (ambient - preheat);
      for (size_t l = 0; l < rom->m; l++) u += rom->B[k * rom->m + l] * q[l];
      const long double x = (long double)rom->lambda[k] * steps[n];
      const long double exact = x > 0.0L ? -expm1l(-x) / rom->lambda[k] * u : steps[n] * (long double)u;
      // a few roundings of the dot product and the gain
      assert_close(rom_state_z(state)[k], (double)exact, 1e-14 * (fabs((double)exact) + 1e-3 * steps[n]));
    }
    rom_state_destroy(&state);
  }
  rom_destroy(&rom);
}

static void many_short_steps_equal_one_long_step(void **unused)
{
  (void)unused;
  RomData *rom = slab(&losing);
  const double q[] = {3.0, -1.0, 0.5, 0.0};
  RomState *one = start(rom, ROM_EXPONENTIAL, ambient), *many = start(rom, ROM_EXPONENTIAL, ambient);
  rom_state_step(one, q, 7.0);
  for (int n = 0; n < 10000; n++) rom_state_step(many, q, 7e-4);
  for (size_t l = 0; l < rom->m; l++) // 1e4 roundings of the time itself
    assert_close(rom_state_patch_temperature(many)[l], rom_state_patch_temperature(one)[l], 1e-9);
  assert_close(rom_state_lost(many), rom_state_lost(one), 1e-11 * fabs(rom_state_lost(one)));
  assert_close(rom_state_time(many), 7.0, 1e-9);
  rom_state_destroy(&one);
  rom_state_destroy(&many);
  rom_destroy(&rom);
}

static void flow_into_the_top_warms_it_as_a_half_space(void **unused)
{
  (void)unused;
  const SyntheticSlab deep = {
      .size = {1e-3, 1e-3}, .depth = 20e-3, .kappa = 1.0, .rho = 1800.0, .c = 1100.0, .modes = 4000};
  RomData *rom = slab(&deep);
  RomState *state = start(rom, ROM_EXPONENTIAL, preheat);
  const double flux = 1e5, q[] = {flux * 1e-6, 0.0, 0.0};
  for (int n = 0; n < 100; n++) rom_state_step(state, q, 0.01);
  const double exact = 2.0 * flux * sqrt(1.0 / M_PI) / sqrt(1.0 * 1800.0 * 1100.0); // 80.2 K
  const double truncated = 2.0 * flux * deep.depth / (deep.kappa * M_PI * M_PI * (double)deep.modes);
  assert_close(rom_state_patch_temperature(state)[0] - preheat, exact - truncated, 1e-4 * exact);
  rom_state_destroy(&state);
  rom_destroy(&rom);
}

/* ---- stability ---- */

static void stiffness_of_one_patch_is_its_step_response(void **unused)
{
  (void)unused;
  const SyntheticSlab one = {
      .size = {1e-3, 1e-3}, .depth = 20e-3, .kappa = 1.0, .rho = 1800.0, .c = 1100.0, .modes = 20000};
  RomData *rom = slab(&one);
  RomState *state = start(rom, ROM_EXPONENTIAL, preheat);
  const double h = 1e5, q[] = {1.0, 0.0, 0.0};
  for (double dt = 1e-5; dt < 1.0; dt *= 10.0) {
    RomState *fresh = start(rom, ROM_EXPONENTIAL, preheat);
    rom_state_step(fresh, q, dt);
    const double response = rom_state_patch_temperature(fresh)[0] - preheat;
    assert_close(rom_state_stiffness(state, h, dt), h * 1e-6 * response, 1e-9 * h * 1e-6 * response);
    rom_state_destroy(&fresh);
  }
  // a half-space gives h 2 sqrt(dt/pi)/e; the modes left out are worth 2 h L/(kappa pi^2 modes)
  const double dt = 1e-4, estimate = h * 2.0 * sqrt(dt / M_PI) / sqrt(1800.0 * 1100.0);
  const double truncated = 2.0 * h * one.depth / (one.kappa * M_PI * M_PI * (double)one.modes);
  assert_close(rom_state_stiffness(state, h, dt), estimate - truncated, 1e-3 * estimate);
  assert_true(isinf(rom_state_stiffness(state, (double)INFINITY, dt)));
  rom_state_destroy(&state);
  rom_destroy(&rom);
}

/* Two equal patches: the matrix has the eigenvectors (1, 1) and (1, -1). */
static void stiffness_of_two_patches_is_the_larger_eigenvalue(void **unused)
{
  (void)unused;
  RomData *rom = slab(&losing);
  for (int scheme = 0; scheme < 2; scheme++) {
    RomState *state = start(rom, scheme ? ROM_BACKWARD_EULER : ROM_EXPONENTIAL, preheat);
    const double q[] = {1.0, 0.0, 0.0, 0.0}, h = 500.0, dt = 0.3;
    const double stiffness = rom_state_stiffness(state, h, dt);
    rom_state_step(state, q, dt);
    const double *T = rom_state_patch_temperature(state);
    const double expected = h * 4e-6 * ((T[0] - preheat) + fabs(T[1] - preheat));
    assert_close(stiffness, expected, 1e-5 * expected); // the power iteration stops at 1e-7 a step
    rom_state_destroy(&state);
  }
  rom_destroy(&rom);
}

/* ---- what it tells ---- */

static void points_on_the_wall_have_the_patches_temperature(void **unused)
{
  (void)unused;
  const SyntheticSlab one = {
      .size = {1e-3, 1e-3}, .depth = 5e-3, .kappa = 1.0, .rho = 1800.0, .c = 1100.0, .modes = 100};
  RomData *rom = slab(&one);
  RomState *state = start(rom, ROM_EXPONENTIAL, preheat);
  const double q[] = {1.0, 0.0, 0.0};
  rom_state_step(state, q, 0.5);
  double *T = malloc(rom->n_points * sizeof *T);
  rom_state_point_temperature(state, T);
  const double rise = rom_state_patch_temperature(state)[0] - preheat;
  for (size_t p = 0; p < rom->n_points; p++) {
    if (rom->points[3 * p + 2] < -1e-12)
      assert_true(T[p] < preheat + rise);
    else
      assert_close(T[p], preheat + rise, 1e-5 * rise); // the basis is stored in float
  }
  free(T);
  rom_state_destroy(&state);
  rom_destroy(&rom);
}

static void steps_have_the_same_bits_on_any_number_of_threads(void **unused)
{
  (void)unused;
  const SyntheticSlab large = {.size = {4e-3, 4e-3},
                               .depth = 5e-3,
                               .kappa = 1.0,
                               .rho = 1800.0,
                               .c = 1100.0,
                               .h_bottom = 10.0,
                               .modes = 30,
                               .modes_lateral = {6, 6},
                               .patches = {10, 10},
                               .cells = {1, 1}};
  RomData *rom = slab(&large);
  assert_true(rom->r * rom->m > 65536); // threads are used from there
  double *last[2], q[102];
  for (size_t l = 0; l < rom->m; l++) q[l] = sin((double)l);
  for (int run = 0; run < 2; run++) {
    omp_set_num_threads(run == 0 ? 1 : 3);
    RomState *state = start(rom, ROM_EXPONENTIAL, ambient);
    for (int n = 0; n < 20; n++) rom_state_step(state, q, 1e-4);
    last[run] = malloc(rom_state_size(state) * sizeof(double));
    rom_state_save(state, last[run]);
    if (run == 1) assert_memory_equal(last[0], last[1], rom_state_size(state) * sizeof(double));
    rom_state_destroy(&state);
  }
  free(last[0]);
  free(last[1]);
  rom_destroy(&rom);
}

static void a_restored_state_goes_on_with_the_same_bits(void **unused)
{
  (void)unused;
  RomData *rom = slab(&losing);
  RomState *whole = start(rom, ROM_EXPONENTIAL, ambient), *later = start(rom, ROM_EXPONENTIAL, ambient);
  const size_t size = rom_state_size(whole);
  double *buffer = malloc(2 * size * sizeof *buffer);
  const double q[] = {3.0, -1.0, 0.5, 0.0};
  for (int n = 0; n < 50; n++) rom_state_step(whole, q, 1e-3);
  rom_state_save(whole, buffer);
  rom_state_restore(later, buffer);
  for (int n = 0; n < 50; n++) {
    rom_state_step(whole, q, 2e-3);
    rom_state_step(later, q, 2e-3);
  }
  rom_state_save(whole, buffer);
  rom_state_save(later, buffer + size);
  assert_memory_equal(buffer, buffer + size, size * sizeof *buffer);
  free(buffer);
  rom_state_destroy(&whole);
  rom_state_destroy(&later);
  rom_destroy(&rom);
}

static void temperatures_that_are_not_numbers_are_refused(void **unused)
{
  (void)unused;
  RomData *rom = slab(&losing);
  RomState *state = NULL;
  CastError err = {0};
  assert_int_equal(rom_state_create(rom, ROM_EXPONENTIAL, NAN, 300.0, &state, &err), CAST_ERR_ARGUMENT);
  assert_null(state);
  assert_non_null(strstr(err.message, "preheat"));
  rom_destroy(&rom);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(constant_flow_gives_the_exact_state_at_any_step),
      cmocka_unit_test(many_short_steps_equal_one_long_step),
      cmocka_unit_test(flow_into_the_top_warms_it_as_a_half_space),
      cmocka_unit_test(stiffness_of_one_patch_is_its_step_response),
      cmocka_unit_test(stiffness_of_two_patches_is_the_larger_eigenvalue),
      cmocka_unit_test(points_on_the_wall_have_the_patches_temperature),
      cmocka_unit_test(steps_have_the_same_bits_on_any_number_of_threads),
      cmocka_unit_test(a_restored_state_goes_on_with_the_same_bits),
      cmocka_unit_test(temperatures_that_are_not_numbers_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
