/* H1: a slab at T = 1 whose faces are held at 0: centre temperature against the series, and the order.
 * Symmetric, so the melt repeats across the slab: a half slab [0, L/2] would need an insulated face; here the faces are
 * held by melt particles beyond them that carry the mirrored temperature -T, as an image charge does, exactly. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <cmocka.h>
#include "tests/support/lattice_tank.h"
#include "tests/support/validation.h"

static const double L = 1e-2, KAPPA = 30.0, RHO = 7000.0, C = 560.0, PI = 3.14159265358979323846;
enum { TIMES = 3 };
static const double FOURIER[TIMES] = {0.05, 0.1, 0.2};

static double centre(double Fo)
{
  double sum = 0.0;
  for (int n = 0; n < 100; n++) {
    const double k = (2 * n + 1) * PI;
    sum += 4.0 / k * (n % 2 ? -1.0 : 1.0) * exp(-k * k * Fo);
  }
  return sum;
}

/* Temperatures are shifted by this, K, since a melt's enthalpy table begins at absolute zero. */
static const double SHIFT = 1000.0;

/* A periodic train of slabs of alternating sign, 2L long: zero at every face for all time by symmetry. */
static double run(int n, double temperature[TIMES], long *steps)
{
  const double dx = L / n, T[2] = {0.0, 2000.0}, E[2] = {0.0, 2000.0 * C}, one = 1.0, at = 0.0;
  CastError err;
  Material melt = {.density = RHO, .specific_heat = C, .conductivity = KAPPA};
  assert_int_equal(table_create(2, T, E, &melt.enthalpy, &err), CAST_OK);
  assert_int_equal(table_create(1, &at, &KAPPA, &melt.conductivity_of_t, &err), CAST_OK);
  assert_int_equal(table_create(1, &at, &one, &melt.viscosity_of_t, &err), CAST_OK);
  LatticeTank tank = {.fluid = {10, 10, 2 * n},
                      .box = {10, 10, 2 * n},
                      .sph = {.kernel = KERNEL_WENDLAND_C2,
                              .h = 1.5 * dx,
                              .spacing = dx,
                              .rho0 = RHO,
                              .c0 = 1.0,
                              .gamma = 7.0,
                              .melt = &melt,
                              .frozen_flow = true}};
  lattice_tank_create(&tank);
  Particles *p = &tank.particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) p->E[i] = C * (SHIFT + (p->x[2][i] < L ? 1.0 : -1.0));
  double worst = 0.0;
  for (int k = 0; k < TIMES; k++) {
    const double end = FOURIER[k] * L * L * RHO * C / KAPPA;
    sph_initialise(&tank.sph, p);
    while (tank.time < end * (1.0 - 1e-12))
      lattice_tank_step(&tank, fmin(sph_time_step(&tank.sph, p).step, end - tank.time));
    double sum = 0.0, count = 0.0;
    for (ptrdiff_t i = 0; i < p->n_fluid; i++)
      if (fabs(p->x[2][i] - 0.5 * L) < 0.4 * dx) { // n is odd: a layer stands at the centre
        sum += p->T[i] - SHIFT;
        count += 1.0;
      }
    temperature[k] = sum / count;
    worst = fmax(worst, fabs(temperature[k] - centre(FOURIER[k])));
  }
  *steps = tank.steps;
  lattice_tank_destroy(&tank);
  material_destroy(&melt);
  return worst;
}

static void the_centre_of_a_slab_cools_as_the_series_says(void **unused)
{
  (void)unused;
  double coarse[TIMES], fine[TIMES];
  long steps;
  const double start = validation_cpu_time();
  const double coarse_error = run(15, coarse, &steps), fine_error = run(45, fine, &steps);
  const double order = log(coarse_error / fine_error) / log(3.0), cpu = validation_cpu_time() - start;
  validation_begin("H1");
  for (int k = 0; k < TIMES; k++) {
    const double reference = centre(FOURIER[k]), error = fabs(fine[k] - reference) / reference;
    validation_write(&(ValidationRow){"H1", validation_text("centre of the slab at Fo = %g", FOURIER[k]),
                                      validation_text("%.5f (series)", reference), validation_text("%.5f", fine[k]),
                                      validation_text("%.2f %%", 100.0 * error), "1 %",
                                      validation_text("45 particles across, order %.2f from 15", order), cpu / TIMES});
    assert_true(error < 0.01); // the target of the reference problem
  }
  assert_true(order > 1.0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_centre_of_a_slab_cools_as_the_series_says)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
