#include "tests/support/gas_column.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>

#include "tests/support/assert_ok.h"

GasColumn gas_column_create(int length, double dx, double rho0, double c0, double gravity, bool above)
{
  CastError err;
  GasColumn column = {.tank = {.fluid = {COLUMN_ACROSS, COLUMN_ACROSS, length},
                               .box = {COLUMN_ACROSS, COLUMN_ACROSS, length},
                               .layers = 3,
                               .low = {false, false, true}, // else it would repeat along its length
                               .sph = {.kernel = KERNEL_WENDLAND_C2,
                                       .h = 1.5 * dx,
                                       .spacing = dx,
                                       .rho0 = rho0,
                                       .c0 = c0,
                                       .gamma = 7.0,
                                       .delta = 0.1,
                                       .alpha = 0.1,
                                       .gravity = {0.0, 0.0, -gravity}}},
                      .length = length,
                      .spacing = dx};
  lattice_tank_create(&column.tank);
  Particles *p = &column.tank.particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) p->x[2][i] += COLUMN_ROOM * dx; // out of reach of that floor
  const double low[3] = {0.0, 0.0, 0.0};
  const double high[3] = {COLUMN_ACROSS * dx, COLUMN_ACROSS * dx, (length + 2 * COLUMN_ROOM) * dx};
  GasConfig config = {.size = {high[0], high[1], above ? high[2] : dx}};
  ok(gas_create(&config, NULL, dx, low, high, &column.gas, &err), &err);
  sph_initialise(&column.tank.sph, p);
  return column;
}

void gas_column_destroy(GasColumn *column)
{
  gas_destroy(&column->gas);
  lattice_tank_destroy(&column->tank);
}

void gas_column_rates(GasColumn *column, double pressure)
{
  CastError err;
  LatticeTank *tank = &column->tank;
  bool rebuilt = false;
  ok(neighbours_update(tank->neighbours, &tank->particles, false, &rebuilt, &err), &err);
  if (rebuilt) ok(gas_rebuild(column->gas, &tank->particles, &err), &err);
  sph_rates(&tank->sph, &tank->particles, tank->neighbours);
  gas_push(column->gas, &tank->sph, tank->neighbours, pressure, &tank->particles);
}

void gas_column_step(GasColumn *column, double dt, double pressure)
{
  CastError err;
  LatticeTank *tank = &column->tank;
  if (tank->steps == 0) gas_column_rates(column, pressure);
  ok(sph_drift(&tank->sph, &tank->particles, NULL, dt, NULL, &err), &err);
  gas_column_rates(column, pressure);
  ok(sph_finish(&tank->sph, &tank->particles, dt, &err), &err);
  tank->time += dt;
  tank->steps++;
}
