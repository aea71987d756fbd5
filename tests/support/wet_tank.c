#include "tests/support/wet_tank.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "cast/kernel/pair.h"
#include "tests/support/assert_ok.h"

static void find_rates(WetTank *wet, bool first)
{
  CastError err = {0};
  ok(neighbours_update(wet->tank.neighbours, &wet->tank.particles, first, NULL, &err), &err);
  sph_rates(&wet->tank.sph, &wet->tank.particles, wet->tank.neighbours);
  ok(tension_push(wet->tension, &wet->tank.particles, wet->tank.neighbours, &err), &err);
}

void wet_tank_begin(WetTank *wet, double mu, double theta)
{
  const double at = 0.0, one = 1.0;
  CastError err = {0};
  lattice_tank_create(&wet->tank);
  for (ptrdiff_t i = 0; i < wet->tank.particles.n_fluid; i++) wet->tank.particles.mu[i] = mu;
  ok(table_create(1, &at, &one, &wet->sigma, &err), &err);
  ok(tension_create(wet->tank.sph.kernel, wet->tank.sph.h, wet->tank.sph.spacing, &wet->sigma, theta * pair_pi / 180.0,
                    &wet->tension, &err),
     &err);
  wet->tank.sph.wall_pull = tension_wall_pull(wet->tension);
  sph_initialise(&wet->tank.sph, &wet->tank.particles);
  find_rates(wet, true);
}

void wet_tank_step(WetTank *wet)
{
  CastError err = {0};
  LatticeTank *tank = &wet->tank;
  const double dt = fmin(sph_time_step(&tank->sph, &tank->particles).step, tension_step(wet->tension, 1.0));
  ok(sph_drift(&tank->sph, &tank->particles, NULL, dt, NULL, &err), &err);
  find_rates(wet, false);
  ok(sph_finish(&tank->sph, &tank->particles, dt, &err), &err);
  tank->time += dt;
}

void wet_tank_end(WetTank *wet)
{
  tension_destroy(&wet->tension);
  table_destroy(&wet->sigma);
  lattice_tank_destroy(&wet->tank);
}

SphParameters wet_parameters(double dx, double c0)
{
  return (SphParameters){.kernel = KERNEL_WENDLAND_C2,
                         .h = 1.5 * dx,
                         .spacing = dx,
                         .rho0 = 1.0,
                         .c0 = c0,
                         .gamma = 7.0,
                         .delta = 0.1,
                         .alpha = 0.02};
}
