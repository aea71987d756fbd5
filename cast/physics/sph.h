/* sph.h - the melt's step: weakly compressible SPH (DESIGN: docs/theory, melt).
 * One step of velocity Verlet reads, in sim.c:
 *   sph_drift        v += a dt/2, x += v dt, rho += drho dt      (wall guard: nothing enters the mould)
 *   neighbours_update
 *   sph_forces       wall pressure and velocity by extrapolation, drho, p, a (pressure, viscosity, body forces)
 *   sph_conduction   heat between fluid particles (sets particles->heat)
 *   coupling_exchange, rom_state_step
 *   sph_finish       v += a dt/2, E += heat dt/mass, T = T(E), kappa(T), mu(T) */
#ifndef CAST_PHYSICS_SPH_H
#define CAST_PHYSICS_SPH_H

#include <stdbool.h>
#include "cast/geometry/surface.h"
#include "cast/kernel/kernel.h"
#include "cast/particles/neighbours.h"
#include "cast/particles/particles.h"
#include "common/material.h"

typedef enum SphDensity { SPH_CONTINUITY, SPH_SUMMATION } SphDensity;

typedef struct SphParameters {
  KernelKind kernel;
  double h;            // m smoothing length (support radius = kernel_support(kernel) h)
  double spacing;      // m
  double rho0;         // kg/m3
  double c0;           // m/s numerical sound speed
  double gamma;        // exponent of Tait's equation, 7
  SphDensity density;
  double delta;        // density diffusion (delta-SPH), 0.1; 0: none
  double alpha;        // artificial viscosity, 0: none
  bool cut_tension;    // pressures below zero are set to zero
  double gravity[3], extra[3]; // m/s2, constant
  const Material *melt; // borrowed: T(E), kappa(T), mu(T)
  bool frozen_flow;    // particles stay where they are (heat only: H1, H2, H4)
} SphParameters;

typedef struct SphLimits { // the time step and what sets it
  double sound, force, viscosity, conduction; // s each
  double step;                                // the least, times its safety factor
  const char *which;
} SphLimits;

/* Set rho, p (hydrostatic start is the caller's), T, kappa and mu from E. */
void sph_initialise(const SphParameters *sph, Particles *particles);
SphLimits sph_time_step(const SphParameters *sph, const Particles *particles);
/* Advance positions; a fluid particle that would enter the mould by more than a tenth of the spacing is set back to the
 * wall and loses its velocity into it. guarded: how many were. Errors: CAST_ERR_NUMERIC, naming the particle, place. */
CastStatus sph_drift(const SphParameters *sph, Particles *particles, const Surface *surface, double dt, long *guarded,
                     CastError *err);
void sph_forces(const SphParameters *sph, Particles *particles, const Neighbours *neighbours);
void sph_conduction(const SphParameters *sph, Particles *particles, const Neighbours *neighbours);
/* Errors: CAST_ERR_NUMERIC (NaN, density <= 0, speed beyond c0), naming the particle, its place and the value. */
CastStatus sph_finish(const SphParameters *sph, Particles *particles, double dt, CastError *err);

double sph_kinetic_energy(const Particles *particles); // J, summed in a fixed order
double sph_enthalpy(const Particles *particles);       // J, summed in a fixed order

#endif
