/* Cooling in implicit steps: what explicit steps give, in books that close, with the same bits however it is run. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cast/cool/mould_response.h"
#include "tests/support/assert_close.h"
#include "tests/support/assert_ok.h"
#include "tests/support/melt_on_mould.h"

static const double dx = 2e-4, hot = 1320.0, cold = 1073.0;

/* A metal of real kinks: freezes over 10 K, conducts half as well when liquid. */
static const char BRONZE[] =
    "{ name: bronze, density: 7000 kg/m^3, specific_heat: { solid: 440 J/kg/K, liquid: 560 J/kg/K }, "
    "latent_heat: 230 kJ/kg, solidus: 1300 K, liquidus: 1310 K, conductivity: [[1300 K, 59 W/m/K], [1310 K, 30 "
    "W/m/K]], "
    "viscosity: 5 mPa.s }";

/* A block on a slab of 3 x 3 patches that loses heat below: it freezes from its foot upwards. */
static MeltCase block(double h_contact)
{
  return (MeltCase){.spacing = dx,
                    .corner = {4.0 * dx, 4.0 * dx, 0.0},
                    .count = {8, 8, 10},
                    .slab = {.size = {16.0 * dx, 16.0 * dx},
                             .depth = 4e-3,
                             .kappa = 1.0,
                             .rho = 1800.0,
                             .c = 1100.0,
                             .h_bottom = 50.0,
                             .modes = 30,
                             .modes_lateral = {5, 5},
                             .patches = {3, 3},
                             .band = 0.6e-3,
                             .band_layers = 8,
                             .cells = {1, 1}},
                    .coupling = {.kind = COUPLING_SURFACE, .h_contact = h_contact},
                    .material = BRONZE,
                    .hot = hot,
                    .preheat = cold,
                    .ambient = 300.0};
}

static double most_difference(const MeltOnMould *a, const MeltOnMould *b)
{
  double most = 0.0;
  for (ptrdiff_t i = 0; i < a->particles.n_fluid; i++) most = fmax(most, fabs(a->particles.E[i] - b->particles.E[i]));
  return most;
}

static double mean_difference(const MeltOnMould *a, const MeltOnMould *b)
{
  double squares = 0.0;
  for (ptrdiff_t i = 0; i < a->particles.n_fluid; i++) squares += pow(a->particles.E[i] - b->particles.E[i], 2.0);
  return sqrt(squares / (double)a->particles.n_fluid);
}

static void implicit_steps_agree_with_explicit_ones_to_a_thousandth(void **state)
{
  (void)state;
  const MeltCase given = block(5000.0);
  MeltOnMould slow, fast;
  melt_on_mould_create(&given, &slow);
  melt_on_mould_create(&given, &fast);
  const double until = 0.2;
  const int n = (int)ceil(4.0 * until / melt_on_mould_time_step(&slow)); // its own error is of first order
  for (int k = 0; k < n; k++) melt_on_mould_step(&slow, until / n);
  melt_on_mould_cool(&fast, 0.5, 1e-4, until); // the default tolerance
  const double lost = coupling_ledger(slow.coupling, slow.mould, &slow.particles).melt_start / slow.particles.mass[0] /
                          (double)slow.particles.n_fluid -
                      material_enthalpy(&slow.melt, cold);
  assert_true(mean_difference(&slow, &fast) < 1e-3 * lost); // of the heat there is to lose
  assert_true(most_difference(&slow, &fast) < 1.5e-3 * lost);
  for (size_t l = 0; l < 9; l++)
    assert_close(rom_state_patch_temperature(fast.mould)[l], rom_state_patch_temperature(slow.mould)[l],
                 1e-3 * (hot - cold));
  double freezing = 0.0;
  for (ptrdiff_t i = 0; i < fast.particles.n_fluid; i++)
    freezing += fast.particles.T[i] > 1300.0 && fast.particles.T[i] < 1310.0;
  assert_true(freezing > 60.0); // latent heat is at work
  melt_on_mould_destroy(&slow);
  melt_on_mould_destroy(&fast);
}

static void the_books_close_in_implicit_steps(void **state)
{
  (void)state;
  for (int kind = 0; kind < 4; kind++) {
    MeltCase given = block(kind == 1 ? (double)INFINITY : 2000.0);
    given.scheme = kind == 2 ? ROM_BACKWARD_EULER : ROM_EXPONENTIAL;
    given.coupling.mould_frozen = kind == 3;
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    melt_on_mould_cool(&melt, 2.0, 1e-3, 50.0);
    const EnergyLedger e = coupling_ledger(melt.coupling, melt.mould, &melt.particles);
    assert_true(e.exchanged > 0.1 && e.lost > 1e-3);
    assert_close(e.residual, 0.0, 1e-9 * e.exchanged); // R4; rounding alone gives about 1e-13
    melt_on_mould_destroy(&melt);
  }
}

/* Long after, melt and mould are at one temperature that the heats alone decide. */
static void melt_and_insulated_mould_end_at_one_temperature(void **state)
{
  (void)state;
  MeltCase given = block(2000.0);
  given.slab.h_bottom = 0.0;
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  melt_on_mould_cool(&melt, 1.0, 1e-3, 2000.0);
  const double C = 1800.0 * 1100.0 * 4e-3 * pow(16.0 * dx, 2.0), M = 640.0 * melt.particles.mass[0];
  const double start = M * material_enthalpy(&melt.melt, hot);
  double low = cold, high = hot;
  for (int k = 0; k < 60; k++) {
    const double T = 0.5 * (low + high), found = M * material_enthalpy(&melt.melt, T) + C * (T - cold);
    *(found > start ? &high : &low) = T;
  }
  for (ptrdiff_t i = 0; i < melt.particles.n_fluid; i++) assert_close(melt.particles.T[i], low, 0.01);
  assert_close(rom_state_patch_temperature(melt.mould)[4], low, 0.01);
  melt_on_mould_destroy(&melt);
}

/* Root mean square against a run of a hundredth of the tolerance, while most particles pass a kink of T(E). Steps go by
 * the tolerance's root, and at a kink extrapolation gains nothing: the error falls with the power 0.5. It is far below
 * what the tolerance says. */
static void the_error_follows_the_tolerance(void **state)
{
  (void)state;
  const double tolerance[3] = {4.0, 0.4, 0.004};
  MeltOnMould melt[3];
  for (int k = 0; k < 3; k++) {
    const MeltCase given = block(2000.0);
    melt_on_mould_create(&given, &melt[k]);
    melt_on_mould_cool(&melt[k], tolerance[k], 1e-4, 0.5);
  }
  const double coarse = mean_difference(&melt[0], &melt[2]), fine = mean_difference(&melt[1], &melt[2]);
  assert_true(coarse < 0.2 * 4.0 * 560.0);  // 0.05 when written
  assert_true(log10(coarse / fine) > 0.45); // 0.495
  for (int k = 0; k < 3; k++) melt_on_mould_destroy(&melt[k]);
}

static void cooling_has_the_same_bits_on_any_number_of_threads(void **state)
{
  (void)state;
  MeltOnMould melt[2];
  for (int k = 0; k < 2; k++) {
    const MeltCase given = block(2000.0);
    omp_set_num_threads(k == 0 ? 1 : 3);
    melt_on_mould_create(&given, &melt[k]);
    melt_on_mould_cool(&melt[k], 1.0, 1e-3, 0.3);
  }
  omp_set_num_threads(1);
  assert_memory_equal(melt[0].particles.E, melt[1].particles.E, 640 * sizeof(double));
  assert_memory_equal(rom_state_z(melt[0].mould), rom_state_z(melt[1].mould), melt[0].rom->r * sizeof(double));
  for (int k = 0; k < 2; k++) melt_on_mould_destroy(&melt[k]);
}

static Cool *start(MeltOnMould *melt)
{
  return melt_on_mould_begin_cooling(melt, 1.0, 1e-3);
}

static void cooling_saved_and_restored_goes_on_with_the_same_bits(void **state)
{
  (void)state;
  const MeltCase given = block(2000.0);
  CastError err;
  MeltOnMould whole, broken;
  double taken;
  melt_on_mould_create(&given, &whole);
  melt_on_mould_create(&given, &broken);
  Cool *one = start(&whole), *first = start(&broken);
  for (int k = 0; k < 20; k++) ok(cool_step(one, 1.0, &taken, &err), &err);
  for (int k = 0; k < 8; k++) ok(cool_step(first, 1.0, &taken, &err), &err);
  double buffer[COOL_SIZE];
  cool_save(first, buffer);
  cool_destroy(&first);
  Cool *second = start(&broken);
  cool_restore(second, buffer);
  for (int k = 0; k < 12; k++) ok(cool_step(second, 1.0, &taken, &err), &err);
  assert_memory_equal(whole.particles.E, broken.particles.E, 640 * sizeof(double));
  assert_close(cool_counts(one).steps, cool_counts(second).steps, 0.0);
  assert_close(cool_counts(one).gradients, cool_counts(second).gradients, 0.0);
  cool_destroy(&one);
  cool_destroy(&second);
  melt_on_mould_destroy(&whole);
  melt_on_mould_destroy(&broken);
}

/* T = T0 + G (S - D T), found by elimination, fulfils its own definition. */
static void patch_temperatures_are_those_of_the_flows_that_they_cause(void **state)
{
  (void)state;
  const MeltCase given = block(20000.0);
  CastError err;
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  MouldResponse response;
  const size_t m = melt.rom->m;
  ok(mould_response_create(m, melt.mould, &response, &err), &err);
  const CouplingContacts contacts = coupling_conductances(melt.coupling, &melt.particles);
  const double dt = 0.7;
  ok(mould_response_prepare(&response, &contacts, melt.mould, false, dt, &err), &err);
  double *D = calloc(m, sizeof *D), *S = calloc(m, sizeof *S), *Q = calloc(m, sizeof *Q);
  assert_true(D && S && Q);
  for (size_t l = 0; l < m; l++)
    for (ptrdiff_t k = contacts.of_patch_start[l]; k < contacts.of_patch_start[l + 1]; k++)
      D[l] += contacts.conductance[contacts.of_patch[k]];
  for (size_t l = 0; l < m; l++) S[l] = D[l] * (1200.0 + 10.0 * (double)l); // each patch's melt at its own temperature
  mould_response_temperatures(&response, S);
  for (size_t l = 0; l < m; l++) Q[l] = S[l] - D[l] * response.T[l];
  rom_state_step(melt.mould, Q, dt);
  for (size_t l = 0; l < m; l++)
    if (D[l] > 0.0) assert_close(rom_state_patch_temperature(melt.mould)[l], response.T[l], 1e-9);
  free(D);
  free(S);
  free(Q);
  mould_response_destroy(&response);
  melt_on_mould_destroy(&melt);
}

static void a_state_that_cannot_be_is_refused(void **state)
{
  (void)state;
  const MeltCase given = block(2000.0);
  CastError err = {0};
  MeltOnMould melt;
  double taken;
  melt_on_mould_create(&given, &melt);
  Cool *cool = start(&melt);
  melt.particles.E[639] = (double)NAN;
  assert_int_equal(cool_step(cool, 1.0, &taken, &err), CAST_ERR_NUMERIC);
  assert_non_null(strstr(err.message, "cooling"));
  cool_destroy(&cool);
  melt_on_mould_destroy(&melt);
}

int main(void)
{
  omp_set_num_threads(1); // too few particles for more
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(implicit_steps_agree_with_explicit_ones_to_a_thousandth),
      cmocka_unit_test(the_books_close_in_implicit_steps),
      cmocka_unit_test(melt_and_insulated_mould_end_at_one_temperature),
      cmocka_unit_test(the_error_follows_the_tolerance),
      cmocka_unit_test(cooling_has_the_same_bits_on_any_number_of_threads),
      cmocka_unit_test(cooling_saved_and_restored_goes_on_with_the_same_bits),
      cmocka_unit_test(patch_temperatures_are_those_of_the_flows_that_they_cause),
      cmocka_unit_test(a_state_that_cannot_be_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
