/* GAS: a column of melt of length L in a duct, gas of pressure p on one end. Alone it is accelerated by p/(rho L), and
 * its pressure falls from p to none along it; against gravity gas of p = rho g L below holds it. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "tests/support/gas_column.h"
#include "tests/support/validation.h"

static const double rho0 = 1000.0, length = 0.024, pressure = 1000.0; // kg/m3, m, Pa
static const double c0 = 30.0; // m/s, of which sqrt(2 p/rho), the speed of a jet, is a twentieth
enum { FINE = 24, COARSE = 12 };

typedef struct Motion {
  double acceleration; // of the centre of mass, from its way, over p/(rho L)
  double profile;      // root mean square of p - p (1 - s/L) over p, at the end, in the middle half of the column
  double way;          // of the centre of mass, over L
  long steps;
} Motion;

static double centre(const Particles *p)
{
  double sum = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) sum += p->x[2][i];
  return sum / (double)p->n_fluid;
}

static double profile_error(const GasColumn *column, double middle)
{
  const Particles *p = &column->tank.particles;
  double sum = 0.0;
  int n = 0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const double s = (p->x[2][i] - middle) / length + 0.5; // from the gas
    if (fabs(s - 0.5) > 0.25) continue;
    const double off = p->p[i] / pressure - (1.0 - s);
    sum += off * off;
    n++;
  }
  return sqrt(sum / n);
}

/* The pressure rises within ten passes of sound through the column, so that it does not ring. */
static Motion push(int particles, double gravity, double end)
{
  const double dx = length / particles, rise = 10.0 * length / c0;
  GasColumn column = gas_column_create(particles, dx, rho0, c0, gravity, false);
  const Particles *p = &column.tank.particles;
  const double begun = centre(p), dt = 0.25 * 1.5 * dx / c0;
  double exact = 0.0, speed = 0.0; // of the centre of mass
  Motion motion = {.steps = 0};
  for (; column.tank.time < end; motion.steps++) {
    const double now = fmin((column.tank.time + dt) / rise, 1.0);
    column.tank.sph.gravity[2] = -gravity * now; // both rise together
    const double a = pressure * now / (rho0 * length) - gravity * now;
    gas_column_step(&column, dt, pressure * now);
    speed += a * dt;
    exact += speed * dt;
  }
  const double way = centre(p) - begun;
  motion.way = way / length;
  motion.acceleration = way / exact;
  motion.profile = profile_error(&column, centre(p));
  gas_column_destroy(&column);
  return motion;
}

static void gas_accelerates_a_column_by_its_pressure_over_its_mass(void **unused)
{
  (void)unused;
  omp_set_num_threads(1);
  const double end = 20e-3; // by then at 0.6 m/s
  const Motion coarse = push(COARSE, 0.0, end);
  const double start = validation_cpu_time();
  const Motion fine = push(FINE, 0.0, end), held = push(FINE, pressure / (rho0 * length), end);
  const double cpu = validation_cpu_time() - start;
  const char *resolution = validation_text("%d particles long, %ld steps; %d long: %.2f %%", FINE, fine.steps, COARSE,
                                           100.0 * fabs(coarse.acceleration - 1.0));
  validation_begin("GAS");
  validation_write(&(ValidationRow){"GAS", "column pushed by gas on one end, acceleration", "p/(rho L)", "",
                                    validation_text("%.2f %%", 100.0 * fabs(fine.acceleration - 1.0)), "1 %",
                                    resolution, cpu});
  validation_write(&(ValidationRow){
      "GAS", "the same, pressure in its middle half, root mean square, over p", "p (1 - s/L)", "",
      validation_text("%.2f %%", 100.0 * fine.profile), "2 %",
      validation_text("%d particles long; %d long: %.2f %%", FINE, COARSE, 100.0 * coarse.profile), cpu});
  validation_write(&(ValidationRow){
      "GAS", "column of p/(rho g) held by gas below, way in 20 ms, over its free fall", "stands still", "",
      validation_text("%.2f %%", 100.0 * fabs(held.way) * length / (0.5 * pressure / (rho0 * length) * end * end)),
      "1 %", validation_text("%d particles long", FINE), cpu});
  assert_true(fabs(fine.acceleration - 1.0) < 0.01);
  assert_true(fine.profile < 0.02);
  assert_true(fabs(held.way) * length < 0.01 * 0.5 * pressure / (rho0 * length) * end * end);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(gas_accelerates_a_column_by_its_pressure_over_its_mass)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
