/* P4, P5: melt that is one lumped body.
 * P4  A plate of 200 um between mould walls of one temperature, conductance h = 2000 W/m2K, Bi = 0.007; a = 100 um.
 *       superheat  (rho c a/h) ln[(T_p - T_0)/(T_m - T_0)],   freezing to fs  rho L a fs/[h (T_m - T_0)]
 * P5  Constant extraction of 50 J/cm3/s: T(t) is the enthalpy curve read backwards (the paper's Fig. 3). */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "tests/support/melt_on_mould.h"
#include "tests/support/validation.h"

static const double T0 = 273.15;

/* ---- P4 ---- */

static const char BRONZE[] = "{ density: 6900 kg/m^3, specific_heat: 560 J/kg/K, latent_heat: 230 kJ/kg, solidus: "
                             "1037.9 degC, liquidus: 1038 degC, conductivity: 30 W/m/K, viscosity: 5 mPa.s }";
static const double half = 1e-4, h = 2000.0, pour = 1150.0, melting = 1038.0, fraction = 0.3; // m, W/m2K, degC

/* When the mean enthalpy of half a plate falls below that of solid fraction fs, s; by explicit or implicit steps. */
static double time_to(double mould, double fs, bool implicit)
{
  const MeltCase given = {
      .spacing = 0.5 * half,
      .columns = 8,
      .layers = 2,
      .slab = {.depth = 1e-3, .kappa = 1.0, .rho = 1800.0, .c = 1100.0, .modes = 2, .cells = {1, 1}},
      .coupling = {.kind = COUPLING_SURFACE, .h_contact = h, .mould_frozen = true},
      .material = BRONZE,
      .hot = T0 + pour,
      .preheat = T0 + mould,
      .ambient = 300.0};
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  const double goal = material_enthalpy(&melt.melt, material_temperature_of_fraction(&melt.melt, fs));
  const double mass = melt.particles.mass[0] * (double)melt.particles.n_fluid;
  CastError err;
  Cool *cool = implicit ? melt_on_mould_begin_cooling(&melt, 0.2, 1e-4) : NULL;
  double before = 0.0, E_before = 0.0, E = sph_enthalpy(&melt.particles) / mass;
  while (E > goal) {
    before = melt.time;
    E_before = E;
    double dt = fmin(melt_on_mould_time_step(&melt), 2e-5);
    if (implicit)
      assert_int_equal(cool_step(cool, 1.0, &dt, &err), CAST_OK);
    else
      melt_on_mould_step(&melt, dt);
    melt.time = before + dt;
    E = sph_enthalpy(&melt.particles) / mass;
  }
  const double t = before + (melt.time - before) * (E_before - goal) / (E_before - E);
  cool_destroy(&cool);
  melt_on_mould_destroy(&melt);
  return t;
}

static void a_thin_plate_loses_superheat_and_latent_heat_through_the_contact_in_the_time_it_must(void **state)
{
  (void)state;
  validation_begin("P4");
  for (int k = 0; k < 4; k++) {
    const double mould = k % 2 ? 900.0 : 700.0, start = validation_cpu_time();
    const bool implicit = k >= 2;
    const double superheat = 6900.0 * 560.0 * half / h * log((pour - mould) / (melting - mould));
    const double freezing = 6900.0 * 230e3 * half * fraction / (h * (melting - mould));
    const double first = time_to(mould, 0.0, implicit), second = time_to(mould, fraction, implicit) - first;
    const double error = 100.0 * fmax(fabs(first / superheat - 1.0), fabs(second / freezing - 1.0));
    validation_write(
        &(ValidationRow){"P4",
                         validation_text("CuAl10, 0.2 mm, mould %g degC: superheat, then to fs = 0.3; %s steps", mould,
                                         implicit ? "implicit" : "explicit"),
                         validation_text("%.4f s, %.4f s (closed form)", superheat, freezing),
                         validation_text("%.4f s, %.4f s", first, second), validation_text("%.2f %%", error), "1 %",
                         "4 particles across, Bi = 0.007", validation_cpu_time() - start});
    assert_true(error < 1.0);
  }
}

/* ---- P5 ---- */

/* As a microstructure simulation gives it: superheat, an undercooled start, a plateau of about L rho/50e6 = 32 s that
 * tilts, and 14 K/s in the solid. */
static const char MICRESS[] =
    "{ density: 6900 kg/m^3, cooling_curve: { rate: 50 J/cm^3/s, curve: [[0 s, 1060 degC], [1.7 s, 1038 degC], [5 s, "
    "1037.2 degC], [20 s, 1035 degC], [30 s, 1031 degC], [33.7 s, 1027 degC], [43.7 s, 887 degC]] }, solidus: 1027 "
    "degC, liquidus: 1038 degC, conductivity: 30 W/m/K, viscosity: 5 mPa.s }";
static const double curve_time[] = {0.0, 1.7, 5.0, 20.0, 30.0, 33.7, 43.7},
                    curve_T[] = {1060.0, 1038.0, 1037.2, 1035.0, 1031.0, 1027.0, 887.0};

static void under_constant_extraction_temperature_is_the_cooling_curve_read_forwards(void **state)
{
  (void)state;
  const double start = validation_cpu_time(), dt = 0.01, rate = 50e6; // s, W/m3
  const MeltCase given = {
      .spacing = 1e-3,
      .columns = 8,
      .layers = 1,
      .slab = {.depth = 1e-3, .kappa = 1.0, .rho = 1800.0, .c = 1100.0, .modes = 2, .cells = {1, 1}},
      .coupling = {.kind = COUPLING_SURFACE, .h_contact = 1.0},
      .material = MICRESS,
      .hot = T0 + 1060.0,
      .preheat = 1000.0,
      .ambient = 300.0};
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  Particles *p = &melt.particles;
  const Table curve = {sizeof curve_time / sizeof *curve_time, (double *)(uintptr_t)curve_time,
                       (double *)(uintptr_t)curve_T};
  double worst = 0.0, after_plateau = 0.0;
  CastError err;
  for (int n = 1; n <= 4370; n++) {
    for (ptrdiff_t i = 0; i < p->n_fluid; i++) p->heat[i] = -rate * p->volume[i];
    assert_int_equal(sph_finish(&melt.sph, p, dt, &err), CAST_OK);
    worst = fmax(worst, fabs(p->T[0] - T0 - table_evaluate(&curve, n * dt)));
    if (n == 3870) after_plateau = p->T[0];
  }
  const double slope = (after_plateau - p->T[0]) / 5.0;
  validation_begin("P5");
  validation_write(&(ValidationRow){"P5", "cooling curve at 50 J/cm3/s, and its slope in the solid",
                                    "the curve given (table), 14 K/s",
                                    validation_text("largest difference over 43.7 s %.1e K; %.4f K/s", worst, slope),
                                    validation_text("%.1e K", worst), "exact to the table (1e-6 K)",
                                    "4370 steps of 10 ms", validation_cpu_time() - start});
  assert_true(worst < 1e-6); // rounding over 4370 steps
  assert_true(fabs(slope - 14.0) < 1e-6);
  melt_on_mould_destroy(&melt);
}

int main(void)
{
  omp_set_num_threads(1); // too few particles for more
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_thin_plate_loses_superheat_and_latent_heat_through_the_contact_in_the_time_it_must),
      cmocka_unit_test(under_constant_extraction_temperature_is_the_cooling_curve_read_forwards),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
