/* sim_drive.c - the forces of the moment, and how fast they may make the melt. */
#include <math.h>

#include "cast/sim/sim_private.h"

void sim_set_forces(Sim *sim, double time)
{
  drive_at(&sim->config->drive, time, &sim->sph);
}

/* ---- gas ---- */

/* The cavity, the melt at the start and the input's box, and two cells around them. */
CastStatus sim_gas_create(Sim *sim, CastError *err)
{
  const GasConfig *gas = &sim->config->gas;
  const Particles *p = &sim->particles;
  if (gas->pressure.n == 0) return CAST_OK;
  double low[3], high[3];
  for (int d = 0; d < 3; d++) {
    low[d] = gas->corner[d];
    high[d] = gas->corner[d] + gas->size[d];
    for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
      low[d] = fmin(low[d], p->x[d][i]);
      high[d] = fmax(high[d], p->x[d][i]);
    }
    for (size_t t = 0; t < sim->rom->n_triangles; t++) {
      if (sim->rom->patch[sim->rom->triangle_patch[t]].outer) continue;
      for (int k = 0; k < 3; k++) {
        const double x = sim->rom->points[3 * sim->rom->triangles[3 * t + (size_t)k] + d];
        low[d] = fmin(low[d], x);
        high[d] = fmax(high[d], x);
      }
    }
    low[d] -= 2.0 * sim->config->spacing;
    high[d] += 2.0 * sim->config->spacing;
  }
  return gas_create(gas, sim->surface, sim->config->spacing, low, high, &sim->gas, err);
}

void sim_gas_push(Sim *sim, double time)
{
  const double pressure = table_evaluate(&sim->config->gas.pressure, time);
  gas_push(sim->gas, &sim->sph, sim->neighbours, pressure, &sim->particles);
}

/* ---- how fast ---- */

typedef struct Extent {
  double least, most; // m2/s2
} Extent;

static void widen(Extent *extent, double value)
{
  extent->least = fmin(extent->least, value);
  extent->most = fmax(extent->most, value);
}

/* Potentials of the melt at the start (corners of blocks, cavity below the level) and of the cavity's wall. */
static void measure_potential(const Sim *sim, const SphParameters *sph, Extent *melt, Extent *wall)
{
  const CastConfig *c = sim->config;
  for (size_t b = 0; b < c->n_blocks; b++)
    for (int corner = 0; corner < 8; corner++) {
      double x[3];
      for (int d = 0; d < 3; d++) x[d] = c->block[b].corner[d] + ((corner >> d) & 1 ? c->block[b].size[d] : 0.0);
      widen(melt, drive_potential(sph, x));
    }
  for (size_t k = 0; k < c->n_inlets; k++) widen(melt, drive_potential(sph, c->inlet[k].centre));
  for (size_t t = 0; t < sim->rom->n_triangles; t++) {
    if (sim->rom->patch[sim->rom->triangle_patch[t]].outer) continue;
    for (int k = 0; k < 3; k++) {
      const double *x = &sim->rom->points[3 * sim->rom->triangles[3 * t + (size_t)k]];
      const double value = drive_potential(sph, x);
      widen(wall, value);
      if (c->has_level && x[2] <= c->level) widen(melt, value);
    }
  }
}

/* Euler's acceleration has no potential: its size at the farthest point of the cavity over the cavity's extent. */
static double spin_up_gain(const Sim *sim, const SphParameters *sph)
{
  double low[3], high[3], farthest2 = 0.0, extent2 = 0.0;
  surface_bounds(sim->surface, low, high);
  for (int d = 0; d < 3; d++) {
    const double far = fmax(fabs(low[d] - sph->spin.point[d]), fabs(high[d] - sph->spin.point[d]));
    farthest2 += far * far;
    extent2 += (high[d] - low[d]) * (high[d] - low[d]);
  }
  const double *e = sph->spin.spin_up;
  return sqrt((e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) * farthest2 * extent2);
}

static double gain_at(const Sim *sim, double time)
{
  SphParameters sph = sim->sph;
  drive_at(&sim->config->drive, time, &sph);
  Extent melt = {INFINITY, -INFINITY}, wall = {INFINITY, -INFINITY};
  measure_potential(sim, &sph, &melt, &wall);
  return fmax(wall.most - melt.least, 0.0) + spin_up_gain(sim, &sph);
}

double sim_drive_gain(const Sim *sim)
{
  enum { SAMPLES = 32 };
  const Drive *drive = &sim->config->drive;
  const double end = sim->config->end;
  const Table *gas = &sim->config->gas.pressure;
  double most = gain_at(sim, 0.0), pressed = 0.0;
  for (size_t k = 0; k < gas->n; k++) pressed = fmax(pressed, gas->y[k] / sim->sph.rho0);
  if (drive_is_steady(drive)) return most + pressed;
  for (int k = 1; k <= SAMPLES; k++) most = fmax(most, gain_at(sim, end * k / SAMPLES));
  for (size_t k = 0; isfinite(drive_kink(drive, k)); k++) {
    const double time = drive_kink(drive, k);
    if (time > 0.0 && time < end) most = fmax(most, gain_at(sim, time));
  }
  return most + pressed;
}
