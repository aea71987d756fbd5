/* F1: a tank of melt at rest under gravity with a free surface, for 10 s: pressure, drift, loss of particles.
 * Pressures are those of every single particle at 200 instants from 1 s on, when the sound of the start has died away.
 */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "cast/kernel/pair.h"
#include "tests/support/lattice_tank.h"
#include "tests/support/validation.h"

static const double depth = 0.1, gravity = 9.81, rho0 = 1000.0;
enum { ACROSS = 6, FINE = 16, COARSE = 8 };

typedef struct Rest {
  double pressure;  // largest |p - rho g (H - z)| of a particle from 1 s to 10 s, over rho g H
  double sinking;   // of the centre of mass from 1 s to 10 s, over H
  double speed;     // root mean square at 10 s, over sqrt(g H)
  long lost, steps; // particles outside the tank; steps taken
} Rest;

static double pressure_error(const LatticeTank *tank)
{
  const Particles *p = &tank->particles;
  double worst = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++)
    worst = fmax(worst, fabs(p->p[i] / (rho0 * gravity) - (depth - p->x[2][i])) / depth);
  return worst;
}

static double mean_height(const Particles *p)
{
  double sum = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) sum += p->x[2][i];
  return sum / (double)p->n_fluid;
}

static long count_lost(const LatticeTank *tank)
{
  const Particles *p = &tank->particles;
  long lost = 0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    bool inside = true;
    for (int d = 0; d < 3; d++) inside = inside && p->x[d][i] > 0.0 && p->x[d][i] < tank->box[d] * tank->sph.spacing;
    lost += !inside;
  }
  return lost;
}

static LatticeTank make_tank(int high)
{
  const double dx = depth / high;
  LatticeTank tank = {.fluid = {ACROSS, ACROSS, high},
                      .box = {ACROSS, ACROSS, high + 4},
                      .layers = 3,
                      .low = {true, true, true},
                      .high = {true, true, false},
                      .sph = {.kernel = KERNEL_WENDLAND_C2,
                              .h = 1.5 * dx,
                              .spacing = dx,
                              .rho0 = rho0,
                              .c0 = 10.0 * sqrt(gravity * depth),
                              .gamma = 7.0,
                              .delta = 0.1,
                              .alpha = 0.05,
                              .gravity = {0.0, 0.0, -gravity}}};
  lattice_tank_create(&tank);
  Particles *p = &tank.particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++)
    p->rho[i] = tait_density(rho0 * gravity * (depth - p->x[2][i]), rho0, tank.sph.c0, tank.sph.gamma);
  return tank;
}

static Rest rest_for_ten_seconds(int high)
{
  LatticeTank tank = make_tank(high);
  Rest rest = {0};
  double early = 0.0, next = 1.0;
  while (tank.time < 10.0) {
    lattice_tank_step(&tank, 0.0);
    if (tank.time < next) continue;
    if (next == 1.0) early = mean_height(&tank.particles);
    next += 0.045;
    rest.pressure = fmax(rest.pressure, pressure_error(&tank));
  }
  const Particles *p = &tank.particles;
  rest.sinking = (early - mean_height(p)) / depth;
  rest.speed = sqrt(2.0 * sph_kinetic_energy(p) / ((double)p->n_fluid * p->mass[0] * gravity * depth));
  rest.lost = count_lost(&tank);
  rest.steps = tank.steps;
  lattice_tank_destroy(&tank);
  return rest;
}

static void write_row(const char *quantity, const char *ours, const char *error, const char *target, const Rest *rest,
                      double cpu)
{
  validation_write(&(ValidationRow){"F1", quantity, "at rest", ours, error, target,
                                    validation_text("%d particles deep, %ld steps", FINE, rest->steps), cpu});
}

static void a_tank_stays_at_rest_for_ten_seconds(void **unused)
{
  (void)unused;
  omp_set_num_threads(1); // a few hundred particles are too few to share
  const Rest coarse = rest_for_ten_seconds(COARSE);
  const double start = validation_cpu_time();
  const Rest fine = rest_for_ten_seconds(FINE);
  const double cpu = validation_cpu_time() - start;
  validation_begin("F1");
  validation_write(&(ValidationRow){"F1", "pressure of any particle, 1 s to 10 s, over rho g H", "rho g (H - z)", "",
                                    validation_text("%.2f %%", 100.0 * fine.pressure), "2 %",
                                    validation_text("%d particles deep, %ld steps; %d deep: %.2f %%", FINE, fine.steps,
                                                    COARSE, 100.0 * coarse.pressure),
                                    cpu});
  write_row("sinking of the centre of mass from 1 s to 10 s, over H", "",
            validation_text("%.3f %%", 100.0 * fine.sinking), "no drift", &fine, cpu);
  write_row("root mean square speed at 10 s, over sqrt(g H)", "", validation_text("%.1e", fine.speed), "-", &fine, cpu);
  write_row("particles outside the tank", validation_text("%ld", fine.lost), validation_text("%ld", fine.lost), "0",
            &fine, cpu);
  assert_int_equal(fine.lost + coarse.lost, 0);
  assert_true(fine.pressure < 0.02); // the target of the reference problem
  assert_true(fine.pressure < coarse.pressure);
  assert_true(fabs(fine.sinking) < 1e-3); // a sixtieth of a particle spacing in 10 s
  assert_true(fine.speed < 1e-2);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_tank_stays_at_rest_for_ten_seconds)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
