/* P6: an alloy that freezes on a wall of given temperature. With a solid fraction linear in T the mush has the constant
 * specific heat c + L/(T_l - T_s), and solid, mush and liquid each an error function of eta = x/(2 sqrt(alpha t))
 * (Ozisik & Uzzell 1979, J. Heat Transfer 101:331):
 *   T = T_0 + (T_s - T_0) erf(eta)/erf(l_s),  T_s + (T_l - T_s)(erf(m eta) - erf(m l_s))/D,  T_far - .. erfc(eta)
 * with D = erf(m l_l) - erf(m l_s), m^2 = 1 + L/(c (T_l - T_s)), and one flow of heat at l_s and at l_l. Then
 *   G = T'(eta)/(2 sqrt(alpha t)),  -dT/dt = T'(eta) eta/(2 t),  Niyama = sqrt(T'(eta)/(2 alpha eta)): one number for
 * the whole casting, wherever and whenever it froze. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "cast/results/freezing.h"
#include "tests/support/melt_on_mould.h"
#include "tests/support/validation.h"

static const double KAPPA = 100.0, RHO = 2400.0, C = 1100.0, LATENT = 389e3, SOLIDUS = 828.0, LIQUIDUS = 888.0,
                    WALL = 600.0, HOT = 950.0;

typedef struct Exact {
  double m, l_s, l_l, D;
} Exact;

/* l_l by the flow of heat at l_s; 9: none */
static void set_liquidus_front(Exact *e)
{
  const double flow = (SOLIDUS - WALL) * exp(-e->l_s * e->l_s) / erf(e->l_s);
  e->D = (LIQUIDUS - SOLIDUS) * e->m * exp(-e->m * e->m * e->l_s * e->l_s) / flow;
  double low = e->l_s, high = 9.0;
  for (int k = 0; k < 200; k++) {
    const double middle = 0.5 * (low + high);
    *(erf(e->m * middle) - erf(e->m * e->l_s) > e->D ? &high : &low) = middle;
  }
  e->l_l = low;
}

static Exact solve(void)
{
  Exact e = {.m = sqrt(1.0 + LATENT / (C * (LIQUIDUS - SOLIDUS)))};
  double low = 0.05, high = 2.0;
  for (int k = 0; k < 200; k++) {
    e.l_s = 0.5 * (low + high);
    set_liquidus_front(&e);
    const double mush = (LIQUIDUS - SOLIDUS) * e.m * exp(-e.m * e.m * e.l_l * e.l_l) / e.D;
    const double liquid = (HOT - LIQUIDUS) * exp(-e.l_l * e.l_l) / erfc(e.l_l);
    *(e.l_l < 8.9 && mush > liquid ? &low : &high) = e.l_s; // more flow than the liquid brings: the front goes on
  }
  return e;
}

static double eta_at(const Exact *e, double share) // of the freezing range above the solidus
{
  double low = e->l_s, high = e->l_l;
  for (int k = 0; k < 200; k++) {
    const double middle = 0.5 * (low + high);
    *(erf(e->m * middle) - erf(e->m * e->l_s) > share * e->D ? &high : &low) = middle;
  }
  return low;
}

typedef struct Found { // largest errors over the particles looked at, 1
  double time, gradient, rate, niyama, steps;
} Found;

static void compare(const MeltOnMould *melt, const Freezing *freezing, const Exact *e, Found *found)
{
  const double alpha = KAPPA / (RHO * C), at_N = eta_at(e, 0.1);
  const double slope =
      (LIQUIDUS - SOLIDUS) / e->D * 2.0 / sqrt(M_PI) * e->m * exp(-e->m * e->m * at_N * at_N); // T'(eta)
  const double niyama = sqrt(slope / (2.0 * alpha * at_N));
  const Particles *p = &melt->particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const double x = p->x[2][i], root = x / (2.0 * sqrt(alpha));
    if (x < 5e-3 || x > 10e-3) continue;
    const double t_N = pow(root / at_N, 2.0), t_s = pow(root / e->l_s, 2.0);
    const double G = slope / (2.0 * sqrt(alpha * t_N)), rate = slope * at_N / (2.0 * t_N);
    found->time = fmax(found->time, fabs(freezing_value(freezing, FREEZING_SOLIDUS_TIME, p->id[i]) / t_s - 1.0));
    found->gradient = fmax(found->gradient, fabs(freezing_value(freezing, FREEZING_GRADIENT, p->id[i]) / G - 1.0));
    found->rate = fmax(found->rate, fabs(freezing_value(freezing, FREEZING_FINAL_RATE, p->id[i]) / rate - 1.0));
    found->niyama = fmax(found->niyama, fabs(freezing_value(freezing, FREEZING_NIYAMA, p->id[i]) / niyama - 1.0));
  }
}

static Found run(const Exact *e, double spacing)
{
  char material[512];
  snprintf(material, sizeof material,
           "{ density: %g kg/m^3, specific_heat: { solid: %g J/kg/K, liquid: %g J/kg/K }, latent_heat: %g J/kg, "
           "solidus: %g K, liquidus: %g K, conductivity: %g W/m/K, viscosity: 1 mPa.s }",
           RHO, C, C, LATENT, SOLIDUS, LIQUIDUS, KAPPA);
  const MeltCase given = {
      .spacing = spacing,
      .columns = 8,
      .layers = (int)lround(45e-3 / spacing),
      .slab = {.depth = 1e-3, .kappa = 1.0, .rho = 1800.0, .c = 1100.0, .modes = 2, .cells = {1, 1}},
      .coupling = {.kind = COUPLING_SURFACE, .h_contact = (double)INFINITY, .mould_frozen = true},
      .material = material,
      .hot = HOT,
      .preheat = WALL,
      .ambient = 300.0};
  MeltOnMould melt;
  CastError err;
  Freezing *freezing = NULL;
  melt_on_mould_create(&given, &melt);
  assert_int_equal(freezing_create(&melt.melt, melt.particles.n_fluid, &freezing, &err), CAST_OK);
  freezing_watch_gradient(freezing, &melt.sph, melt.neighbours);
  freezing_update(freezing, &melt.particles, 0.0);
  Cool *cool = melt_on_mould_begin_cooling(&melt, 0.1, 1e-4);
  const double until = 1.2 * pow(10e-3 / (2.0 * sqrt(KAPPA / (RHO * C)) * e->l_s), 2.0);
  while (melt.time < until) {
    double taken = 0.0;
    assert_int_equal(cool_step(cool, until - melt.time, &taken, &err), CAST_OK);
    melt.time += taken;
    freezing_update(freezing, &melt.particles, melt.time);
  }
  Found found = {.steps = cool_counts(cool).steps};
  compare(&melt, freezing, e, &found);
  cool_destroy(&cool);
  freezing_destroy(&freezing);
  melt_on_mould_destroy(&melt);
  return found;
}

static void gradient_cooling_rate_and_niyama_are_those_of_the_similarity_solution(void **state)
{
  (void)state;
  const Exact e = solve();
  assert_true(e.l_l < 8.0);
  const double start = validation_cpu_time(), alpha = KAPPA / (RHO * C), at_N = eta_at(&e, 0.1);
  const Found coarse = run(&e, 0.5e-3), fine = run(&e, 0.25e-3);
  const double cpu = validation_cpu_time() - start;
  const double slope = (LIQUIDUS - SOLIDUS) / e.D * 2.0 / sqrt(M_PI) * e.m * exp(-e.m * e.m * at_N * at_N);
  const double niyama = sqrt(slope / (2.0 * alpha * at_N));
  const struct {
    const char *name, *reference;
    double fine, coarse;
  } rows[] = {
      {"when it became solid, 5 to 10 mm from the wall", validation_text("l = %.5f (closed form)", e.l_s), fine.time,
       coarse.time},
      {"gradient a tenth of the range above the solidus", "closed form", fine.gradient, coarse.gradient},
      {"cooling rate there, mean over the last fifth of the range", "closed form", fine.rate, coarse.rate},
      {"Niyama", validation_text("%.1f K^0.5 s^0.5/m everywhere (closed form)", niyama), fine.niyama, coarse.niyama},
  };
  validation_begin("P6");
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
    validation_write(&(ValidationRow){
        "P6", validation_text("alloy on a cold wall: %s", rows[k].name), rows[k].reference, "",
        validation_text("%.2f %% at most", 100.0 * rows[k].fine), "3 %",
        validation_text("spacing 0.25 mm, %.0f implicit steps; at 0.5 mm %.2f %%", fine.steps, 100.0 * rows[k].coarse),
        cpu / 4.0});
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) assert_true(rows[k].fine < 0.03);
}

int main(void)
{
  omp_set_num_threads(1); // too few particles for more
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(gradient_cooling_rate_and_niyama_are_those_of_the_similarity_solution),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
