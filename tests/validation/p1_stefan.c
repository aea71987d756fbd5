/* P1, P2: solidification on a wall of given temperature, in implicit steps, against Stefan's and Neumann's similarity
 * solutions (Carslaw & Jaeger 1959, section 11.2):  the front is at s = 2 l sqrt(alpha_s t), where
 *   one phase   sqrt(pi) l exp(l^2) erf(l) = Ste
 *   two phases  exp(-l^2)/erf(l) - e_l/e_s (T_far - T_m)/(T_m - T_0) exp(-n^2 l^2)/erfc(n l)
 *               = l sqrt(pi) L/(c_s (T_m - T_0)),   n = sqrt(alpha_s/alpha_l), e = sqrt(kappa rho c). */
/* At a fixed place the enthalpy method follows Neumann's curve in stairs, one for each layer of particles that freezes:
 * P2's error is that of its tread, half a spacing times the gradient, and its target needs layers of 0.25 mm. */
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

typedef struct Metal {
  double kappa_s, kappa_l, c_s, c_l, rho, latent, melting, width; // SI; K below the melting point where it is solid
} Metal;

typedef struct Casting {
  Metal metal;
  double wall, hot; // K
  double l;         // front's coefficient
} Casting;

static double one_phase(const Casting *c, double l)
{
  return sqrt(M_PI) * l * exp(l * l) * erf(l) - c->metal.c_s * (c->metal.melting - c->wall) / c->metal.latent;
}

static double two_phases(const Casting *c, double l)
{
  const Metal *m = &c->metal;
  const double below = m->melting - c->wall, above = c->hot - m->melting;
  const double n = sqrt(m->kappa_s / m->c_s / (m->kappa_l / m->c_l)),
               ratio = sqrt(m->kappa_l * m->c_l / (m->kappa_s * m->c_s));
  return l * sqrt(M_PI) * m->latent / (m->c_s * below) - exp(-l * l) / erf(l) +
         ratio * above / below * exp(-n * n * l * l) / erfc(n * l);
}

static double solve(double (*f)(const Casting *c, double l), const Casting *c)
{
  double low = 1e-6, high = 3.0;
  for (int k = 0; k < 100; k++) {
    const double middle = 0.5 * (low + high);
    *(f(c, middle) > 0.0 ? &high : &low) = middle;
  }
  return low;
}

static MeltCase column(const Casting *c, double spacing, int layers, char material[1024])
{
  const Metal *m = &c->metal;
  snprintf(material, 1024,
           "{ density: %.17g kg/m^3, specific_heat: { solid: %.17g J/kg/K, liquid: %.17g J/kg/K }, latent_heat: %.17g "
           "J/kg, solidus: %.17g K, liquidus: %.17g K, conductivity: [[%.17g K, %.17g W/m/K], [%.17g K, %.17g W/m/K]], "
           "viscosity: 1 mPa.s }",
           m->rho, m->c_s, m->c_l, m->latent, m->melting - m->width, m->melting, m->melting - m->width, m->kappa_s,
           m->melting, m->kappa_l);
  return (MeltCase){.spacing = spacing,
                    .columns = 8,
                    .layers = layers,
                    .slab = {.depth = 1e-3, .kappa = 1.0, .rho = 1800.0, .c = 1100.0, .modes = 2, .cells = {1, 1}},
                    .coupling = {.kind = COUPLING_SURFACE, .h_contact = (double)INFINITY, .mould_frozen = true},
                    .material = material,
                    .hot = c->hot,
                    .preheat = c->wall,
                    .ambient = 300.0};
}

/* Thickness of what has frozen, m: solid fractions, summed over the layers. */
static double frozen(const MeltOnMould *melt)
{
  double sum = 0.0;
  for (ptrdiff_t i = 0; i < melt->particles.n_fluid; i++)
    sum += table_evaluate(&melt->melt.solid_fraction, melt->particles.T[i]);
  return sum * melt->given.spacing / (melt->given.columns * melt->given.columns);
}

static double stefan_front(const Casting *c, double spacing, double thickness, double tolerance, double until,
                           CoolCounts *counts)
{
  char material[1024];
  const MeltCase given = column(c, spacing, (int)lround(thickness / spacing), material);
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  *counts = melt_on_mould_cool(&melt, tolerance, 1e-3, until);
  const double s = frozen(&melt);
  melt_on_mould_destroy(&melt);
  return s;
}

static void a_pure_metal_freezes_on_a_cold_wall_as_stefan_says(void **state)
{
  (void)state;
  Casting c = {{60.0, 60.0, 500.0, 500.0, 7000.0, 200e3, 1000.0, 0.02}, 996.0, 1000.0, 0.0};
  c.l = solve(one_phase, &c);
  const double start = validation_cpu_time(), alpha = 60.0 / (7000.0 * 500.0), until = 40.0;
  const double exact = 2.0 * c.l * sqrt(alpha * until);
  CoolCounts counts, coarse_counts;
  const double coarse = stefan_front(&c, 4e-4, 6e-3, 0.5, until, &coarse_counts);
  const double fine = stefan_front(&c, 2e-4, 6e-3, 0.5, until, &counts);
  const double error = 100.0 * fabs(fine / exact - 1.0), coarse_error = 100.0 * fabs(coarse / exact - 1.0);
  validation_begin("P1");
  validation_write(&(ValidationRow){
      "P1", "front at 40 s, Ste = 0.01", validation_text("%.4f mm (l = %.6f, closed form)", 1e3 * exact, c.l),
      validation_text("%.4f mm", 1e3 * fine), validation_text("%.2f %%", error), "1 %",
      validation_text("spacing 0.2 mm, %.0f implicit steps; at 0.4 mm %.2f %%", counts.steps, coarse_error),
      validation_cpu_time() - start});
  assert_true(fabs(c.l - 0.070593) < 2e-6);
  assert_true(error < 1.0);
}

static void aluminium_freezes_on_a_cold_wall_as_neumann_says(void **state)
{
  (void)state;
  enum { TIMES = 3 };
  const double rho = 2550.0, T0 = 273.15, z = 5e-3, time[TIMES] = {0.5, 1.0, 2.0};
  const double given_T[TIMES] = {684.84, 664.63, 642.53}; // degC, of the reference problem
  Casting c = {
      {210.0, 95.0, 3.0e6 / rho, 2.58e6 / rho, rho, 1.08048e9 / rho, T0 + 660.0, 0.2}, T0 + 580.0, T0 + 740.0, 0.0};
  c.l = solve(two_phases, &c);
  assert_true(fabs(c.l - 0.27296) < 1e-4); // that of the reference problem
  const double start = validation_cpu_time();
  double found[2][TIMES];
  for (int k = 0; k < 2; k++) {
    char material[1024];
    const double spacing = k == 0 ? 0.5e-3 : 0.25e-3;
    const MeltCase given = column(&c, spacing, (int)lround(45e-3 / spacing), material);
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    for (int t = 0; t < TIMES; t++) {
      melt_on_mould_cool(&melt, 0.5, t ? 1e-2 : 1e-4, time[t]);
      found[k][t] = melt_on_mould_temperature(&melt, z) - T0;
    }
    melt_on_mould_destroy(&melt);
  }
  const double alpha_s = 210.0 / 3.0e6, alpha_l = 95.0 / 2.58e6, n = sqrt(alpha_s / alpha_l);
  validation_begin("P2");
  for (int t = 0; t < TIMES; t++) {
    const double x = z / (2.0 * sqrt(alpha_s * time[t])), y = z / (2.0 * sqrt(alpha_l * time[t]));
    const double exact = x < c.l ? 580.0 + 80.0 * erf(x) / erf(c.l) : 740.0 - 80.0 * erfc(y) / erfc(n * c.l);
    const double error = fabs(found[1][t] - exact);
    validation_write(&(ValidationRow){"P2", validation_text("aluminium, 5 mm from the wall, %g s", time[t]),
                                      validation_text("%.2f degC (closed form)", exact),
                                      validation_text("%.2f degC", found[1][t]), validation_text("%.2f K", error),
                                      "0.5 K",
                                      validation_text("spacing 0.25 mm; at 0.5 mm %.2f K", fabs(found[0][t] - exact)),
                                      (validation_cpu_time() - start) / TIMES});
    assert_true(fabs(exact - given_T[t]) < 0.05);
    assert_true(error < 0.5);
  }
}

int main(void)
{
  omp_set_num_threads(1); // too few particles for more
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_pure_metal_freezes_on_a_cold_wall_as_stefan_says),
      cmocka_unit_test(aluminium_freezes_on_a_cold_wall_as_neumann_says),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
