/* F2: start-up of Couette and Poiseuille flow between plates: velocity in the middle of the gap and the whole profile
 * against the series, and the order.  L = 1 mm, nu = 1e-6 m2/s, V0 = 1.25e-5 m/s, F = 1e-4 m/s2 (Morris, Fox & Zhu
 * 1997). */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "cast/kernel/pair.h"
#include "tests/support/lattice_tank.h"
#include "tests/support/validation.h"

static const double gap = 1e-3, nu = 1e-6, v0 = 1.25e-5, force = 1e-4, rho0 = 1000.0;
enum { TIMES = 5, FINE = 41, COARSE = 21 }; // odd: a layer of particles stands in the middle
static const double instants[TIMES] = {0.0225, 0.045, 0.1125, 0.225, 1.0};

static double couette(double y, double t)
{
  double v = v0 * y / gap;
  for (int n = 1; n < 200; n++) {
    const double k = n * pair_pi / gap;
    v += 2.0 * v0 / (n * pair_pi) * (n % 2 ? -1.0 : 1.0) * sin(k * y) * exp(-nu * k * k * t);
  }
  return v;
}

static double poiseuille(double y, double t)
{
  double v = force / (2.0 * nu) * y * (gap - y);
  for (int n = 0; n < 200; n++) {
    const double odd = 2 * n + 1, k = odd * pair_pi / gap;
    v -= 4.0 * force * gap * gap / (nu * pow(odd * pair_pi, 3)) * sin(k * y) * exp(-nu * k * k * t);
  }
  return v;
}

typedef struct Flow {
  const char *name;
  bool moving; // the upper plate moves; else a force drives the melt
  double (*exact)(double y, double t);
} Flow;

typedef struct Run {
  double middle[TIMES]; // m/s
  double profile;       // largest error of a particle's velocity at any of the instants, over v0
  long steps;
} Run;

/* Plates at z = 0 and z = gap; the channel repeats every 9 particles along x and y. */
static LatticeTank make_channel(const Flow *flow, int across)
{
  const double dx = gap / across;
  LatticeTank tank = {.fluid = {9, 9, across},
                      .box = {9, 9, across},
                      .layers = 3,
                      .low = {false, false, true},
                      .high = {false, false, true},
                      .sph = {.kernel = KERNEL_WENDLAND_C2,
                              .h = 1.5 * dx,
                              .spacing = dx,
                              .rho0 = rho0,
                              .c0 = 20.0 * v0,
                              .gamma = 7.0,
                              .delta = 0.1,
                              .extra = {flow->moving ? 0.0 : force, 0.0, 0.0}}};
  lattice_tank_create(&tank);
  Particles *p = &tank.particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) p->mu[i] = rho0 * nu;
  for (ptrdiff_t k = 0; flow->moving && k < p->n - p->n_fluid; k++)
    p->wall_v[0][k] = p->x[2][p->n_fluid + k] > gap ? v0 : 0.0;
  return tank;
}

static double middle_velocity(const LatticeTank *tank)
{
  const Particles *p = &tank->particles;
  double sum = 0.0, count = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++)
    if (fabs(p->x[2][i] - 0.5 * gap) < 0.5 * tank->sph.spacing) {
      sum += p->v[0][i];
      count += 1.0;
    }
  return sum / count;
}

static double profile_error(const LatticeTank *tank, const Flow *flow)
{
  const Particles *p = &tank->particles;
  double worst = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++)
    worst = fmax(worst, fabs(p->v[0][i] - flow->exact(p->x[2][i], tank->time)));
  return worst / v0;
}

static Run run_channel(const Flow *flow, int across)
{
  LatticeTank tank = make_channel(flow, across);
  Run run = {.profile = 0.0};
  for (int k = 0; k < TIMES; k++) {
    while (tank.time < instants[k] - 1e-12)
      lattice_tank_step(&tank, fmin(sph_time_step(&tank.sph, &tank.particles).step, instants[k] - tank.time));
    run.middle[k] = middle_velocity(&tank);
    run.profile = fmax(run.profile, profile_error(&tank, flow));
  }
  run.steps = tank.steps;
  lattice_tank_destroy(&tank);
  return run;
}

static void check_flow(const Flow *flow)
{
  omp_set_num_threads(1); // a few thousand particles are too few to share
  const double start = validation_cpu_time();
  const Run coarse = run_channel(flow, COARSE), fine = run_channel(flow, FINE);
  const double cpu = validation_cpu_time() - start,
               order = log(coarse.profile / fine.profile) / log((double)FINE / COARSE);
  double worst = 0.0;
  for (int k = 0; k < TIMES; k++) {
    const double exact = flow->exact(0.5 * gap, instants[k]), error = fabs(fine.middle[k] - exact) / exact;
    worst = fmax(worst, error);
    validation_write(&(ValidationRow){
        "F2", validation_text("%s, velocity in mid-gap at %g s", flow->name, instants[k]),
        validation_text("%.4g m/s (series)", exact), validation_text("%.4g m/s", fine.middle[k]),
        validation_text("%.2f %%", 100.0 * error), "1 %", validation_text("%d particles across", FINE), cpu / TIMES});
  }
  validation_write(&(ValidationRow){"F2", validation_text("%s, whole profile at all times, over V0", flow->name),
                                    "series", "", validation_text("%.2f %%", 100.0 * fine.profile), "1 %",
                                    validation_text("%d particles across, %ld steps; %d: %.2f %%, order %.1f", FINE,
                                                    fine.steps, COARSE, 100.0 * coarse.profile, order),
                                    cpu});
  assert_true(worst < 0.01); // the target of the reference problem
  assert_true(fine.profile < 0.01);
  assert_true(order > 1.0);
}

static void couette_flow_starts_as_the_series_says(void **unused)
{
  (void)unused;
  check_flow(&(Flow){"Couette", true, couette});
}

static void poiseuille_flow_starts_as_the_series_says(void **unused)
{
  (void)unused;
  check_flow(&(Flow){"Poiseuille", false, poiseuille});
}

int main(void)
{
  validation_begin("F2");
  const struct CMUnitTest tests[] = {cmocka_unit_test(couette_flow_starts_as_the_series_says),
                                     cmocka_unit_test(poiseuille_flow_starts_as_the_series_says)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
