#include "cast/physics/sph.h"

#include <math.h>

#include "cast/kernel/pair.h"
#include "cast/physics/properties.h"
#include "cast/physics/sweep.h"

void sph_initialise(const SphParameters *sph, Particles *p)
{
  properties_update(sph->melt, p);
#pragma omp parallel for
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    p->p[i] = melt_pressure(p->rho[i], sph->rho0, sph->c0, sph->gamma, sph->cut_tension);
    p->volume[i] = p->mass[i] / whole_density(p->rho[i], sph->rho0);
    p->rho_start[i] = p->rho[i];
    p->drho_last[i] = (double)NAN;
  }
}

static void run_tasks(const SphParameters *sph, Particles *p, const Neighbours *neighbours, SweepTasks tasks)
{
  if (sph->frozen_flow) tasks.flow = false;
  if (p->n_fluid == 0 || (!tasks.flow && !tasks.heat)) return;
  Sweep sweep = sweep_begin(sph, p, neighbours);
  sweep_pack_fluid(&sweep);
  if (tasks.flow && sph->density == SPH_SUMMATION) {
    sweep_sum_density(&sweep);
    sweep_pack_fluid(&sweep);
  }
  if (tasks.flow) sweep_walls(&sweep);
  if (tasks.flow && tasks.heat)
    sweep_fluid(&sweep);
  else
    sweep_fluid_plain(&sweep, tasks);
}

void sph_rates(const SphParameters *sph, Particles *particles, const Neighbours *neighbours)
{
  run_tasks(sph, particles, neighbours, (SweepTasks){.flow = true, .heat = true});
}

void sph_forces(const SphParameters *sph, Particles *particles, const Neighbours *neighbours)
{
  run_tasks(sph, particles, neighbours, (SweepTasks){.flow = true});
}

void sph_conduction(const SphParameters *sph, Particles *particles, const Neighbours *neighbours)
{
  run_tasks(sph, particles, neighbours, (SweepTasks){.heat = true});
}

/* ---- time step ---- */

typedef struct Extremes {
  double speed, acceleration, viscosity, conductivity; // m/s, m/s2, m2/s, W/(m K) per kg/m3
} Extremes;

static Extremes find_extremes(const Particles *p)
{
  double v2 = 0.0, a2 = 0.0, nu = 0.0, conductivity = 0.0;
#pragma omp parallel for simd reduction(max : v2, a2, nu, conductivity)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) { // not fmax: it cares for NaN and is a call
    const double v2_i = p->v[0][i] * p->v[0][i] + p->v[1][i] * p->v[1][i] + p->v[2][i] * p->v[2][i];
    const double a2_i = p->a[0][i] * p->a[0][i] + p->a[1][i] * p->a[1][i] + p->a[2][i] * p->a[2][i];
    const double nu_i = p->mu[i] / p->rho[i], conductivity_i = p->kappa[i] / p->rho[i];
    v2 = v2_i > v2 ? v2_i : v2;
    a2 = a2_i > a2 ? a2_i : a2;
    nu = nu_i > nu ? nu_i : nu;
    conductivity = conductivity_i > conductivity ? conductivity_i : conductivity;
  }
  return (Extremes){sqrt(v2), sqrt(a2), nu, conductivity};
}

double sph_sound_step(const SphParameters *sph, double speed)
{
  return 0.3 * (0.5 * kernel_support(sph->kernel) * sph->h) / (sph->c0 + speed);
}

/* Limits for a length l of half the kernel's support (h of a Wendland kernel):
 *   sound 0.3 l/(c0 + v), force 0.25 sqrt(l/a), viscosity 0.1 l^2/nu, conduction 0.1 rho c l^2/kappa.
 * Diffusion in explicit steps is stable up to 0.22 l^2/nu: sum V F = 3.5/l^2 for Wendland's kernel, the largest
 * eigenvalue of the Laplacian about 9/l^2. */
SphLimits sph_time_step(const SphParameters *sph, const Particles *p)
{
  const double l = 0.5 * kernel_support(sph->kernel) * sph->h, never = (double)INFINITY;
  const Extremes most = find_extremes(p);
  const double acceleration = most.acceleration + 2.0 * sqrt(spin_rate2(&sph->spin)) * most.speed; // Coriolis'
  const double heat = sph->melt ? most.conductivity / material_specific_heat_min(sph->melt) : 0.0;
  SphLimits limits = {.sound = sph_sound_step(sph, most.speed),
                      .force = acceleration > 0.0 ? 0.25 * sqrt(l / acceleration) : never,
                      .viscosity = most.viscosity > 0.0 ? 0.1 * l * l / most.viscosity : never,
                      .conduction = heat > 0.0 ? 0.1 * l * l / heat : never};
  if (sph->frozen_flow) limits.sound = limits.force = limits.viscosity = never;
  const struct {
    double step;
    const char *name;
  } all[] = {{limits.sound, "sound"},
             {limits.force, "force"},
             {limits.viscosity, "viscosity"},
             {limits.conduction, "conduction"}};
  limits.step = never;
  limits.which = "none";
  for (int k = 0; k < 4; k++)
    if (all[k].step < limits.step) {
      limits.step = all[k].step;
      limits.which = all[k].name;
    }
  return limits;
}

/* ---- books ---- */

enum { SUM_CHUNK = 4096 };

/* Sum of weight_i value_i in chunks of a fixed size, so that the order of additions does not depend on threads. */
static double ordered_sum(const Particles *p, double (*value)(const Particles *p, ptrdiff_t i))
{
  double total = 0.0;
  for (ptrdiff_t first = 0; first < p->n_fluid; first += SUM_CHUNK) {
    const ptrdiff_t end = first + SUM_CHUNK < p->n_fluid ? first + SUM_CHUNK : p->n_fluid;
    double part = 0.0;
    for (ptrdiff_t i = first; i < end; i++) part += value(p, i);
    total += part;
  }
  return total;
}

static double kinetic_energy(const Particles *p, ptrdiff_t i)
{
  return 0.5 * p->mass[i] * (p->v[0][i] * p->v[0][i] + p->v[1][i] * p->v[1][i] + p->v[2][i] * p->v[2][i]);
}

static double enthalpy(const Particles *p, ptrdiff_t i)
{
  return p->mass[i] * p->E[i];
}

double sph_kinetic_energy(const Particles *particles)
{
  return ordered_sum(particles, kinetic_energy);
}

double sph_enthalpy(const Particles *particles)
{
  return ordered_sum(particles, enthalpy);
}
