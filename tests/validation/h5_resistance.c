/* H5: as H4 through an interface of conductance h. With H = h (1/e_1 + 1/e_2):
 *   q = h (T_1 - T_2) exp(H^2 t) erfc(H sqrt(t)),
 *   T(z) = T_far - (T_far - T_c) [erfc(x) - exp(H z/sqrt(alpha) + H^2 t) erfc(x + H sqrt(t))], x = z/(2 sqrt(alpha t)),
 * from the jump of temperature at z = 0 (Carslaw & Jaeger 1959, section 2.7, two half-spaces). */
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

int main(void)
{
  omp_set_num_threads(1); // too few particles for more
  validation_begin("H5");
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(heat_through_an_interface_resistance_follows_the_closed_form),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
