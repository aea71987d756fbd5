/* sph.h - the melt's step: weakly compressible SPH (docs/theory, The melt).
 * One step of velocity Verlet reads, in sim.c:
 *   sph_drift          v += a dt/2, x += v dt, density predicted     (wall guard: nothing enters the mould)
 *   neighbours_update
 *   sph_rates          wall pressure and velocity by extrapolation; then in one pass over all pairs drho, a (pressure,
 *                      viscosity, body forces) and heat between fluid particles
 *   coupling_exchange, rom_state_step
 *   sph_finish         v += a dt/2, rho += drho dt, E += heat dt/mass, T = T(E), kappa(T), mu(T)
 *
 * Density and velocity. One pass over pairs must give both drho, which needs the new velocity, and a, which needs the
 * new density. Forces are taken at a predicted density rho + dt (2 drho - drho_last), and the density then goes on from
 * where it was with the drho just found, at the new place with the half-step velocity: symplectic Euler for the density
 * itself. A sound wave of frequency w is then damped by (w dt)^4/2 a step and never grows for w dt < 0.7 (the sound
 * limit of sph_time_step keeps it below about 0.4); with the plain prediction rho + dt drho it would grow at that rate.
 */
#ifndef CAST_PHYSICS_SPH_H
#define CAST_PHYSICS_SPH_H

#include <stdbool.h>
#include "cast/geometry/surface.h"
#include "cast/kernel/kernel.h"
#include "cast/particles/neighbours.h"
#include "cast/particles/particles.h"
#include "cast/physics/spin.h"
#include "common/material/material.h"

typedef enum SphDensity { SPH_CONTINUITY, SPH_SUMMATION } SphDensity;

typedef struct SphParameters {
  KernelKind kernel;
  double h;       // m smoothing length (support radius = kernel_support(kernel) h)
  double spacing; // m
  double rho0;    // kg/m3
  double c0;      // m/s numerical sound speed
  double gamma;   // exponent of Tait's equation, 7
  SphDensity density;
  double delta;                // density diffusion (delta-SPH), 0.1; 0: none
  double alpha;                // artificial viscosity, 0: none
  bool cut_tension;            // no pressure below zero (else until the melt is torn, from 2 to 5 % of stretching)
  double wall_pull;            // Pa, with which walls pull at most (tension_wall_pull); 0: they push only
  double gravity[3], extra[3]; // m/s2, now
  Spin spin;                   // of the mould, now
  const Material *melt;        // borrowed: T(E), kappa(T), mu(T); NULL: T, kappa, mu stay as they are set
  bool frozen_flow;            // particles stay where they are (heat only: H1, H2, H4)
} SphParameters;

typedef struct SphLimits {                    // the time step and what sets it
  double sound, force, viscosity, conduction; // s each, safety factors included; INFINITY where there is none
  double step;                                // the least
  const char *which;                          // "sound", "force", "viscosity" or "conduction"
} SphLimits;

/* Once, before the first step: p and volume from rho (a hydrostatic start is the caller's), T, kappa and mu from E. */
void sph_initialise(const SphParameters *sph, Particles *particles);
double sph_sound_step(const SphParameters *sph, double speed); // s, the limit that sound sets while melt moves so fast
SphLimits sph_time_step(const SphParameters *sph, const Particles *particles);
/* Advance positions; a fluid particle close to the wall loses speed into it, and one that would enter the mould by more
 * than a tenth of the spacing is set back (wall_guard.h). guarded: how many were. Errors: CAST_ERR_NUMERIC, naming the
 * particle, place. */
CastStatus sph_drift(const SphParameters *sph, Particles *particles, const Surface *surface, double dt, long *guarded,
                     CastError *err);
/* sph_forces and sph_conduction in one pass over the pairs: what a run calls. Sets drho, p, a, heat of the fluid (heat:
 * of fluid pairs alone), p, v, rho of the wall. With frozen_flow: sph_conduction alone. */
void sph_rates(const SphParameters *sph, Particles *particles, const Neighbours *neighbours);
void sph_forces(const SphParameters *sph, Particles *particles, const Neighbours *neighbours);     // all but heat
void sph_conduction(const SphParameters *sph, Particles *particles, const Neighbours *neighbours); // heat alone
/* Errors: CAST_ERR_NUMERIC (NaN, density <= 0, speed beyond c0), naming the particle, its place and the value. */
CastStatus sph_finish(const SphParameters *sph, Particles *particles, double dt, CastError *err);

double sph_kinetic_energy(const Particles *particles); // J, summed in a fixed order
double sph_enthalpy(const Particles *particles);       // J, summed in a fixed order

#endif
