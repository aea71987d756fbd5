/* The mould's modal state: exact for constant flows, conserving with both schemes, the same on any threads. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cast/mould/rom_state.h"
#include "tests/support/assert_close.h"
#include "tests/support/random_numbers.h"
#include "tests/support/synthetic_rom.h"

static const double preheat = 973.0, ambient = 300.0;

static RomData *slab(const SyntheticSlab *given)
{
  CastError err = {0};
  RomData *rom = NULL;
  if (synthetic_rom_slab(given, &rom, &err) != CAST_OK) fail_msg("%s", err.message);
  return rom;
}

static const SyntheticSlab losing = {.size = {4e-3, 2e-3},
                                     .depth = 5e-3,
                                     .kappa = 1.0,
                                     .rho = 1800.0,
                                     .c = 1100.0,
                                     .h_bottom = 100.0,
                                     .modes = 60,
                                     .modes_lateral = {4, 2},
                                     .patches = {2, 1}};

static RomState *start(const RomData *rom, RomScheme scheme, double outside)
{
  CastError err = {0};
  RomState *state = NULL;
  if (rom_state_create(rom, scheme, preheat, outside, &state, &err) != CAST_OK) fail_msg("%s", err.message);
  return state;
}

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

/* ---- books ---- */

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
      cmocka_unit_test(exponential_scheme_conserves_heat_over_100000_steps),
      cmocka_unit_test(backward_euler_conserves_heat_over_100000_steps),
      cmocka_unit_test(lost_heat_is_the_integral_of_the_outer_wall_s_flux),
      cmocka_unit_test(steady_flow_is_lost_as_fast_as_it_comes),
      cmocka_unit_test(stiffness_of_one_patch_is_its_step_response),
      cmocka_unit_test(stiffness_of_two_patches_is_the_larger_eigenvalue),
      cmocka_unit_test(points_on_the_wall_have_the_patches_temperature),
      cmocka_unit_test(steps_have_the_same_bits_on_any_number_of_threads),
      cmocka_unit_test(a_restored_state_goes_on_with_the_same_bits),
      cmocka_unit_test(temperatures_that_are_not_numbers_are_refused),
      cmocka_unit_test(a_model_of_many_patches_conserves_heat_too),
      cmocka_unit_test(a_model_of_many_patches_has_its_temperatures_to_a_millionth_of_the_rise),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
