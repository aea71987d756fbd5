/* P3: metal at its melting point freezes on a semi-infinite mould, SPH and reduced mould together (Schwarz; Carslaw &
 * Jaeger 1959, section 11.2): the front is at s = 2 l sqrt(alpha_s t),
 *   l exp(l^2) (erf(l) + e_s/e_m) = c_s (T_m - T_0)/(sqrt(pi) L),   e = sqrt(kappa rho c). */
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

static const double T0 = 273.15, target = 2.0; // K, %

typedef struct Casting {
  const char *name;
  double kappa, rho, c, latent, melting;  // of the solid; K
  double mould_kappa, mould_rho, mould_c; //
  double preheat, until, spacing;         // K, s, m
  double l, growth;                       // of the reference problem; m/s^(1/2)
} Casting;

static double coefficient(const Casting *c)
{
  const double right = c->c * (c->melting - c->preheat) / (sqrt(M_PI) * c->latent);
  const double ratio = sqrt(c->kappa * c->rho * c->c / (c->mould_kappa * c->mould_rho * c->mould_c));
  double low = 0.0, high = 2.0;
  for (int k = 0; k < 100; k++) {
    const double l = 0.5 * (low + high);
    *(l * exp(l * l) * (erf(l) + ratio) > right ? &high : &low) = l;
  }
  return low;
}

static double front(const Casting *c, double spacing, CoolCounts *counts)
{
  char material[1024];
  snprintf(material, sizeof material,
           "{ density: %.17g kg/m^3, specific_heat: %.17g J/kg/K, latent_heat: %.17g J/kg, solidus: %.17g K, "
           "liquidus: %.17g K, conductivity: %.17g W/m/K, viscosity: 1 mPa.s }",
           c->rho, c->c, c->latent, c->melting - 0.2, c->melting, c->kappa);
  const double alpha = c->mould_kappa / (c->mould_rho * c->mould_c);
  const MeltCase given = {.spacing = spacing,
                          .columns = 8,
                          .layers = (int)ceil(1.5 * c->growth * sqrt(c->until) / spacing) + 2,
                          .slab = {.depth = 6.0 * sqrt(alpha * c->until),
                                   .kappa = c->mould_kappa,
                                   .rho = c->mould_rho,
                                   .c = c->mould_c,
                                   .modes = 1500,
                                   .cells = {1, 1}},
                          .coupling = {.kind = COUPLING_SURFACE, .h_contact = (double)INFINITY},
                          .material = material,
                          .hot = c->melting,
                          .preheat = c->preheat,
                          .ambient = 300.0};
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  *counts = melt_on_mould_cool(&melt, 0.5, 1e-5, c->until);
  double sum = 0.0;
  for (ptrdiff_t i = 0; i < melt.particles.n_fluid; i++)
    sum += table_evaluate(&melt.melt.solid_fraction, melt.particles.T[i]);
  melt_on_mould_destroy(&melt);
  return sum * spacing / 64.0;
}

static void check(const Casting *c)
{
  const double start = validation_cpu_time(), l = coefficient(c);
  const double exact = 2.0 * l * sqrt(c->kappa / (c->rho * c->c)) * sqrt(c->until);
  CoolCounts counts, coarse_counts;
  const double fine = front(c, c->spacing, &counts), coarse = front(c, 2.0 * c->spacing, &coarse_counts);
  const double error = 100.0 * fabs(fine / exact - 1.0);
  validation_write(&(ValidationRow){"P3", validation_text("%s, front at %g s", c->name, c->until),
                                    validation_text("%.4f mm (l = %.5f, closed form)", 1e3 * exact, l),
                                    validation_text("%.4f mm", 1e3 * fine), validation_text("%.2f %%", error),
                                    validation_text("%.0f %%", target),
                                    validation_text("spacing %g mm, %.0f implicit steps; at twice the spacing %.2f %%",
                                                    1e3 * c->spacing, counts.steps, 100.0 * fabs(coarse / exact - 1.0)),
                                    validation_cpu_time() - start});
  if (c->l > 0.0) assert_true(fabs(l - c->l) < 1e-4 * (1.0 + c->l));
  assert_true(fabs(exact / sqrt(c->until) - c->growth) < 0.025 * c->growth); // that of the reference problem, to what
                                                                             // 2 K of melting point change in it
  assert_true(error < target);
}

static void aluminium_freezes_on_gypsum(void **state)
{
  (void)state;
  check(&(Casting){"aluminium at 660 degC on gypsum at 25 degC", 210.0, 2550.0, 3.0e6 / 2550.0, 397e3, T0 + 660.0, 0.5,
                   1100.0, 1000.0, T0 + 25.0, 4.0, 5e-5, 0.03130, 0.5238e-3});
}

static void aluminium_bronze_freezes_on_hot_phosphate(void **state)
{
  (void)state;
  const double preheat[2] = {700.0, 900.0}, growth[2] = {0.309e-3, 0.125e-3};
  for (int k = 0; k < 2; k++)
    check(&(Casting){validation_text("CuAl10 at 1038 degC on phosphate at %g degC", preheat[k]), 59.0, 7450.0, 440.0,
                     230e3, T0 + 1038.0, 1.0, 1800.0, 1100.0, T0 + preheat[k], 4.0, 0.05 * growth[k] * 2.0, 0.0,
                     growth[k]});
}

int main(void)
{
  omp_set_num_threads(1); // too few particles for more
  validation_begin("P3");
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(aluminium_freezes_on_gypsum),
      cmocka_unit_test(aluminium_bronze_freezes_on_hot_phosphate),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
