/* Gas on a free surface: the traction of columns, where it reaches and where it is shut out. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "cast/kernel/pair.h"
#include "cast/pour/gas.h"
#include "cast/sim/sim.h"
#include "tests/support/assert_close.h"
#include "tests/support/assert_ok.h"
#include "tests/support/cast_case.h"
#include "tests/support/gas_column.h"

enum { LENGTH = 24 }; // particles
static const double dx = 1e-3, rho0 = 1000.0, pressure = 1000.0;

static GasColumn make_column(bool above)
{
  return gas_column_create(LENGTH, dx, rho0, 20.0, 0.0, above);
}

static double mean(const double *value, ptrdiff_t n)
{
  double sum = 0.0;
  for (ptrdiff_t i = 0; i < n; i++) sum += value[i];
  return sum / (double)n;
}

/* The sum over the layers is a sum for the integral of a kernel over a half-space, at a sixth of its reach a step. */
static void gas_below_pushes_a_column_by_its_pressure_times_its_area(void **state)
{
  (void)state;
  GasColumn column = make_column(false);
  gas_column_rates(&column, pressure);
  const Particles *p = &column.tank.particles;
  assert_close(mean(p->a[2], p->n_fluid) / (pressure / (rho0 * LENGTH * dx)), 1.0, 2e-3);
  assert_close(mean(p->a[0], p->n_fluid), 0.0, 1e-12);
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) // only what is near the gas
    if (p->x[2][i] > (COLUMN_ROOM + GAS_REACH) * dx) assert_close(p->a[2][i], 0.0, 1e-9 * pressure / (rho0 * dx));
  gas_column_destroy(&column);
}

static void gas_all_round_pushes_nowhere(void **state)
{
  (void)state;
  GasColumn column = make_column(true);
  gas_column_rates(&column, pressure);
  const Particles *p = &column.tank.particles;
  assert_close(mean(p->a[2], p->n_fluid) / (pressure / (rho0 * LENGTH * dx)), 0.0, 1e-10);
  assert_true(gas_is_at(column.gas, (const double[3]){0.5 * dx, 0.5 * dx, (LENGTH + 2 * COLUMN_ROOM - 0.5) * dx}));
  gas_column_destroy(&column);
}

static void melt_that_fills_a_section_shuts_gas_out_and_a_hole_lets_it_in(void **state)
{
  (void)state;
  CastError err;
  GasColumn column = make_column(false);
  const double above[3] = {0.5 * dx, 0.5 * dx, (LENGTH + 2 * COLUMN_ROOM - 0.5) * dx},
               below[3] = {0.5 * dx, 0.5 * dx, 0.5 * dx};
  Particles *p = &column.tank.particles;
  ok(gas_rebuild(column.gas, p, &err), &err);
  assert_true(gas_is_at(column.gas, below));
  assert_false(gas_is_at(column.gas, above));
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) // a hole of 4 by 4 particles
    if (p->x[0][i] < 4.0 * dx && p->x[1][i] < 4.0 * dx) p->x[2][i] = 0.5 * COLUMN_ROOM * dx;
  ok(gas_rebuild(column.gas, p, &err), &err);
  assert_true(gas_is_at(column.gas, above));
  gas_column_destroy(&column);
}

/* ---- in a mould ---- */

/* The cup full of melt above the empty pin, without gravity; how full is the pin, and does the ledger close? */
static double pressed_into_the_pin(const char *name, const char *gas)
{
  CastError err = {0};
  char path[128], forces[512];
  snprintf(forces, sizeof forces, "{ gravity: 0 0 -1 m/s^2%s }", gas);
  const CastCaseInput input = {.melt = "  material: cual10\n  temperature: 1150 degC\n"
                                       "  blocks: [{ corner: [-2 mm, -2 mm, -4 mm], size: [4 mm, 4 mm, 2.4 mm] }]\n",
                               .forces = forces,
                               .sph = "{ spacing: 0.4 mm, sound_speed: 30 m/s }",
                               .time = "{ end: 3.5 ms }"};
  CastConfig *config = NULL;
  Sim *sim = NULL;
  SimEnd end;
  ok(cast_case_input(&casting, name, &input, path, &err), &err);
  ok(cast_config_read(path, NULL, &config, &err), &err);
  ok(sim_create(config, NULL, &sim, &err), &err);
  ok(sim_run(sim, NULL, &end, &err), &err);
  const EnergyLedger e = sim_ledger(sim);
  assert_close(e.residual, 0.0, 1e-9 * e.exchanged);
  const Particles *p = sim_particles(sim);
  double in_pin = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) in_pin += p->x[2][i] < -4e-3;
  sim_destroy(&sim);
  cast_config_destroy(&config);
  return in_pin / (4.0 * 4.0 * 5.0); // particles of a pin of 1.6 mm by 1.6 mm by 2 mm
}

static void gas_over_the_cup_presses_melt_into_a_pin(void **state)
{
  (void)state;
  const double without = pressed_into_the_pin("alone", "");
  const double with = pressed_into_the_pin(
      "pressed",
      ", gas: { pressure: [[0 s, 0 kPa], [0.2 ms, 20 kPa]], from: { corner: -2 -2 -0.4 mm, size: 4 4 2 mm } }");
  assert_true(without < 0.1);
  assert_true(with > 0.6); // melt that comes at 2.4 m/s bounces at the end
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(gas_below_pushes_a_column_by_its_pressure_times_its_area),
      cmocka_unit_test(gas_all_round_pushes_nowhere),
      cmocka_unit_test(melt_that_fills_a_section_shuts_gas_out_and_a_hole_lets_it_in),
      cmocka_unit_test(gas_over_the_cup_presses_melt_into_a_pin),
  };
  return cmocka_run_group_tests(tests, cast_case_set_up, cast_case_clean_up);
}
