/* H5: as H4 through an interface of conductance h. With H = h (1/e_1 + 1/e_2):
 *   q = h (T_1 - T_2) exp(H^2 t) erfc(H sqrt(t)),
 *   T(z) = T_far - (T_far - T_c) [erfc(x) - exp(H z/sqrt(alpha) + H^2 t) erfc(x + H sqrt(t))], x = z/(2 sqrt(alpha t)),
 * from the jump of temperature at z = 0 (Carslaw & Jaeger 1959, section 2.7, two half-spaces).
 * Where h is a table: a film of melt, one particle thick, on a mould that keeps its temperature is one lumped body,
 *   rho delta dE/dt = -(T - T_mould)/(1/h + delta/(2 kappa)), h = h(T) or h(f_s(T)), T = T(E),
 * integrated by Runge and Kutta's fourth-order method. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/support/assert_close.h"
#include "tests/support/melt_on_mould.h"
#include "tests/support/validation.h"

static const double hot = 1423.15, cold = 1073.15, target = 1.0; // K, K, %
static const double from = 10e-3, until = 40e-3;                 // s

typedef struct Errors { // largest over the time
  double rise, flux;    // %, of the mould's surface temperature rise and of the heat flux
  double melt;          // % of the temperature difference
  double at_end;        // K, mould's surface
} Errors;

/* exp(a) erfc(y) with a <= y^2: by the asymptotic series where exp overflows or erfc vanishes. */
static double damped_erfc(double a, double y)
{
  if (y < 20.0) return exp(a) * erfc(y);
  const double s = 1.0 / (2.0 * y * y);
  return exp(a - y * y) / (y * sqrt(M_PI)) * (1.0 - s + 3.0 * s * s);
}

static double profile(double z, double t, double alpha, double H, double far, double contact)
{
  const double x = z / (2.0 * sqrt(alpha * t)), y = x + H * sqrt(t);
  return far - (far - contact) * (erfc(x) - damped_erfc(y * y - x * x, y));
}

static void measure(const MeltOnMould *melt, double h, Errors *errors)
{
  const double e_melt = sqrt(30.0 * 7000.0 * 560.0), e_mould = sqrt(1.0 * 1800.0 * 1100.0), t = melt->time;
  const double contact = (e_melt * hot + e_mould * cold) / (e_melt + e_mould), H = h * (1.0 / e_melt + 1.0 / e_mould);
  const double surface = profile(0.0, t, 1.0 / (1800.0 * 1100.0), H, cold, contact);
  const double flux = h * (hot - cold) * damped_erfc(H * H * t, H * sqrt(t));
  const double found = coupling_flow(melt->coupling)[0] / melt->rom->patch[0].area;
  errors->at_end = rom_state_patch_temperature(melt->mould)[0];
  errors->rise = fmax(errors->rise, 100.0 * fabs(errors->at_end - surface) / (surface - cold));
  errors->flux = fmax(errors->flux, 100.0 * fabs(found / flux - 1.0));
  for (int layer = 0; layer < melt->given.layers; layer++) {
    const double z = (layer + 0.5) * melt->given.spacing;
    const double off = melt_on_mould_temperature(melt, z) - profile(z, t, 30.0 / (7000.0 * 560.0), H, hot, contact);
    errors->melt = fmax(errors->melt, 100.0 * fabs(off) / (hot - cold));
  }
}

static Errors run(double h, double spacing)
{
  const MeltCase given = {.spacing = spacing,
                          .columns = 8,
                          .layers = (int)ceil(6.0 * sqrt(30.0 / (7000.0 * 560.0) * until) / spacing),
                          .slab = {.depth = 1.5e-3,
                                   .kappa = 1.0,
                                   .rho = 1800.0,
                                   .c = 1100.0,
                                   .modes = 4000,
                                   .band = 0.6e-3,
                                   .band_layers = 8,
                                   .cells = {1, 1}},
                          .coupling = {.kind = COUPLING_SURFACE, .h_contact = h},
                          .kappa = 30.0,
                          .rho = 7000.0,
                          .c = 560.0,
                          .hot = hot,
                          .preheat = cold,
                          .ambient = 300.0};
  MeltOnMould melt;
  Errors errors = {0};
  melt_on_mould_create(&given, &melt);
  const double dt = until / ceil(until / melt_on_mould_time_step(&melt));
  while (melt.time < until - 0.5 * dt) {
    melt_on_mould_step(&melt, dt);
    if (melt.time > from) measure(&melt, h, &errors);
  }
  melt_on_mould_destroy(&melt);
  return errors;
}

static void heat_through_an_interface_resistance_follows_the_closed_form(void **state)
{
  (void)state;
  const double conductances[] = {500.0, 2000.0, 10000.0}, spacing = 1e-4;
  for (size_t k = 0; k < 3; k++) {
    const double h = conductances[k], start = validation_cpu_time();
    const Errors fine = run(h, spacing);
    const double seconds = validation_cpu_time() - start;
    const Errors coarse = run(h, 2.0 * spacing);
    const double H = h * (1.0 / sqrt(30.0 * 7000.0 * 560.0) + 1.0 / sqrt(1800.0 * 1100.0));
    const double e_ratio = sqrt(30.0 * 7000.0 * 560.0) / (sqrt(30.0 * 7000.0 * 560.0) + sqrt(1800.0 * 1100.0));
    const double exact = cold + (hot - cold) * e_ratio * (1.0 - damped_erfc(H * H * until, H * sqrt(until)));
    const ValidationRow row = {"H5",
                               validation_text("mould surface, h = %g W/m2K, 10-40 ms", h),
                               validation_text("%.2f degC at 40 ms (closed form)", exact - 273.15),
                               validation_text("%.2f degC", fine.at_end - 273.15),
                               validation_text("%.3f %% of its rise (flux %.3f %%, melt %.3f %% of T difference)",
                                               fine.rise, fine.flux, fine.melt),
                               validation_text("%.0f %%", target),
                               validation_text("spacing 0.1 mm; at 0.2 mm %.3f %%", coarse.rise),
                               seconds};
    validation_write(&row);
    assert_true(fine.rise < target && fine.flux < target && fine.melt < target);
  }
}

/* ---- h from a table ---- */

/* Freezes over 100 K; conducts so well that the film is one temperature. */
static const char FILM[] = "{ name: film, density: 7000 kg/m^3, specific_heat: 500 J/kg/K, latent_heat: 200 kJ/kg, "
                           "solidus: 1250 K, liquidus: 1350 K, conductivity: 60 W/m/K, viscosity: 5 mPa.s }";
static const double film_thickness = 1e-4, film_time = 0.5; // m, s
enum { FILM_STEPS = 10000, ODE_STEPS = 20000 };

static double film_rate(const Material *melt, const ContactLaw *law, double E)
{
  const double T = material_temperature(melt, E), kappa = table_evaluate(&melt->conductivity_of_t, T);
  const double resistance = 1.0 / contact_law_at(law, melt, T) + 0.5 * film_thickness / kappa;
  return -(T - cold) / (resistance * melt->density * film_thickness);
}

static double film_enthalpy(const Material *melt, const ContactLaw *law)
{
  double E = material_enthalpy(melt, hot);
  const double dt = film_time / ODE_STEPS;
  for (int n = 0; n < ODE_STEPS; n++) {
    const double k1 = film_rate(melt, law, E), k2 = film_rate(melt, law, E + 0.5 * dt * k1);
    const double k3 = film_rate(melt, law, E + 0.5 * dt * k2), k4 = film_rate(melt, law, E + dt * k3);
    E += dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return E;
}

static void check_film(const char *what, const ContactLaw *law)
{
  const double start = validation_cpu_time();
  const ContactLaws laws = {.elsewhere = *law};
  const MeltCase given = {
      .spacing = film_thickness,
      .columns = 8,
      .layers = 1,
      .slab = {.depth = 1.5e-3, .kappa = 1.0, .rho = 1800.0, .c = 1100.0, .modes = 2, .cells = {1, 1}},
      .coupling = {.kind = COUPLING_SURFACE, .mould_frozen = true, .contact = &laws},
      .material = FILM,
      .hot = hot,
      .preheat = cold,
      .ambient = 300.0};
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  for (int n = 0; n < FILM_STEPS; n++) melt_on_mould_step(&melt, film_time / FILM_STEPS);
  const double E = film_enthalpy(&melt.melt, law), E_hot = material_enthalpy(&melt.melt, hot);
  const double T = material_temperature(&melt.melt, E), found = melt.particles.T[0];
  const double error = 100.0 * fabs(melt.particles.E[0] - E) / (E_hot - E);
  validation_write(&(ValidationRow){
      "H5", validation_text("film of 0.1 mm at %g s, %s", film_time, what),
      validation_text("%.2f degC (ordinary differential equation)", T - 273.15),
      validation_text("%.2f degC", found - 273.15), validation_text("%.3f %% of the heat given up", error),
      validation_text("%.0f %%", target), validation_text("%d steps", FILM_STEPS), validation_cpu_time() - start});
  assert_true(error < target);
  assert_true(T < 1350.0 && T > cold + 10.0); // it is freezing or frozen, and not yet cold: the table matters
  melt_on_mould_destroy(&melt);
}

static void a_film_cools_as_a_table_of_temperature_says(void **state)
{
  (void)state;
  double T[] = {1100.0, 1300.0, 1400.0}, h[] = {200.0, 1000.0, 4000.0};
  check_film("h of temperature", &(ContactLaw){.basis = CONTACT_OF_TEMPERATURE, .table = {3, T, h}});
}

static void a_film_cools_in_three_stages_as_a_gap_opens(void **state)
{
  (void)state;
  double fraction[] = {0.3, 0.8}, h[] = {2000.0, 200.0};
  check_film("h of solid fraction, three stages",
             &(ContactLaw){.basis = CONTACT_OF_SOLID_FRACTION, .table = {2, fraction, h}});
}

int main(void)
{
  omp_set_num_threads(1); // too few particles for more
  validation_begin("H5");
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(heat_through_an_interface_resistance_follows_the_closed_form),
      cmocka_unit_test(a_film_cools_as_a_table_of_temperature_says),
      cmocka_unit_test(a_film_cools_in_three_stages_as_a_gap_opens),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
