/* H4: melt on mould without latent heat. Two half-spaces in perfect contact:
 *   T_c = (e_1 T_1 + e_2 T_2)/(e_1 + e_2), e = sqrt(kappa rho c);  T = T_c + (T_far - T_c) erf(|z|/(2 sqrt(alpha t)))
 * A periodic block of SPH melt at rest on the exact modes of a slab, both ways of coupling. */
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

static const double hot = 1423.15, cold = 1073.15, target = 0.5; // K, K, % of the difference
static const double from = 10e-3, until = 20e-3;                 // s

typedef struct Errors {               // largest over the time, % of the temperature difference
  double contact, melt, mould, first; // first: of the contact temperature at t = from
  double contact_temperature;         // K, at t = from
} Errors;

static MeltCase contact_case(CouplingKind kind, double spacing)
{
  const double layer = sqrt(30.0 / (7000.0 * 560.0) * until);
  return (MeltCase){.spacing = spacing,
                    .columns = 8,
                    .layers = (int)ceil(6.0 * layer / spacing),
                    .slab = {.depth = 1.5e-3,
                             .kappa = 1.0,
                             .rho = 1800.0,
                             .c = 1100.0,
                             .modes = 6000,
                             .band = 0.6e-3,
                             .band_layers = 60,
                             .cells = {1, 1}},
                    .coupling = {.kind = kind, .h_contact = (double)INFINITY},
                    .kappa = 30.0,
                    .rho = 7000.0,
                    .c = 560.0,
                    .hot = hot,
                    .preheat = cold,
                    .ambient = 300.0};
}

static void keep_largest(double *largest, double error)
{
  *largest = fmax(*largest, 100.0 * fabs(error) / (hot - cold));
}

static void measure(const MeltOnMould *melt, Errors *errors)
{
  const double e_melt = sqrt(30.0 * 7000.0 * 560.0), e_mould = sqrt(1.0 * 1800.0 * 1100.0);
  const double contact = (e_melt * hot + e_mould * cold) / (e_melt + e_mould);
  const double wide = 2.0 * sqrt(30.0 / (7000.0 * 560.0) * melt->time),
               narrow = 2.0 * sqrt(melt->time / (1800.0 * 1100.0));
  const double found = rom_state_patch_temperature(melt->mould)[0], dx = melt->given.spacing;
  keep_largest(&errors->contact, found - contact);
  if (errors->first == 0.0) {
    keep_largest(&errors->first, found - contact);
    errors->contact_temperature = found;
  }
  for (int layer = 0; (layer + 0.5) * dx < 2.5 * wide; layer++) {
    const double z = (layer + 0.5) * dx, exact = contact + (hot - contact) * erf(z / wide);
    keep_largest(&errors->melt, melt_on_mould_temperature(melt, z) - exact);
  }
  double *T = malloc(melt->rom->n_points * sizeof *T);
  rom_state_point_temperature(melt->mould, T);
  for (size_t p = 0; p < melt->rom->n_points; p++) {
    const double depth = -melt->rom->points[3 * p + 2];
    keep_largest(&errors->mould, T[p] - (contact + (cold - contact) * erf(depth / narrow)));
  }
  free(T);
}

static Errors run(CouplingKind kind, double spacing)
{
  const MeltCase given = contact_case(kind, spacing);
  MeltOnMould melt;
  Errors errors = {0};
  melt_on_mould_create(&given, &melt);
  const double limit = melt_on_mould_time_step(&melt);
  const int steps = (int)ceil(from / limit), more = (int)ceil((until - from) / limit);
  for (int n = 0; n < steps; n++) melt_on_mould_step(&melt, from / steps);
  measure(&melt, &errors);
  for (int n = 0; n < more; n++) {
    melt_on_mould_step(&melt, (until - from) / more);
    if (n % 10 == 9 || n == more - 1) measure(&melt, &errors);
  }
  melt_on_mould_destroy(&melt);
  return errors;
}

static void report(const char *kind, double spacing, const Errors *errors, double order, double seconds)
{
  const ValidationRow contact = {"H4",
                                 validation_text("contact temperature, `%s`, 10-20 ms", kind),
                                 "1109.80 degC (closed form)",
                                 validation_text("%.2f degC at 10 ms", errors->contact_temperature - 273.15),
                                 validation_text("%.3f %% of T difference", errors->contact),
                                 validation_text("%.1f %%", target),
                                 validation_text("spacing %g mm, order %.1f", 1e3 * spacing, order),
                                 seconds};
  validation_write(&contact);
  const double worst = fmax(errors->melt, errors->mould);
  const ValidationRow profile = {"H4",
                                 validation_text("profiles in melt and mould, `%s`, 10-20 ms", kind),
                                 "erf on both sides",
                                 validation_text("melt %.3f %%, mould %.3f %%", errors->melt, errors->mould),
                                 validation_text("%.3f %% of T difference", worst),
                                 validation_text("%.1f %%", target),
                                 validation_text("spacing %g mm", 1e3 * spacing),
                                 seconds};
  validation_write(&profile);
}

static void check(CouplingKind kind, const char *name, double spacing, double least_order)
{
  const Errors coarse = run(kind, 2.0 * spacing);
  const double start = validation_cpu_time();
  const Errors fine = run(kind, spacing);
  const double seconds = validation_cpu_time() - start, order = log2(coarse.first / fine.first);
  report(name, spacing, &fine, order, seconds);
  assert_true(fine.contact < target && fine.melt < target && fine.mould < target);
  assert_true(order > least_order);
}

static void surface_coupling_meets_the_contact_temperature_and_both_profiles(void **state)
{
  (void)state;
  check(COUPLING_SURFACE, "surface", 1e-4, 1.5); // second order in the spacing
}

/* The wall particles must resolve the mould's own thermal layer, 0.07 mm at 10 ms. */
static void embedded_coupling_meets_them_with_a_spacing_below_the_mould_s_layer(void **state)
{
  (void)state;
  check(COUPLING_EMBEDDED, "embedded", 2.5e-5, 1.0);
}

int main(void)
{
  omp_set_num_threads(1); // too few particles for more
  validation_begin("H4");
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(surface_coupling_meets_the_contact_temperature_and_both_profiles),
      cmocka_unit_test(embedded_coupling_meets_them_with_a_spacing_below_the_mould_s_layer),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
