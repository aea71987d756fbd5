/* sweep.h - sums over pairs of particles: packed records in, rates out. Internal to physics/. */
#ifndef CAST_PHYSICS_SWEEP_H
#define CAST_PHYSICS_SWEEP_H

#include "cast/physics/sph.h"

/* A particle's record: what a neighbour needs to know of it, side by side, so that one or two cache lines hold it.
 * A wall's record differs in the last four places. */
enum {
  REC_X,
  REC_Y,
  REC_Z,
  REC_VOLUME,
  REC_VX, // wall: the velocity extrapolated for no slip
  REC_VY,
  REC_VZ,
  REC_P,   // p/rho^2
  REC_ETA, // diffused_density
  REC_MU,
  REC_KAPPA,
  REC_T,
  REC_WALL_VX = REC_ETA, // wall: its own velocity
  REC_WALL_VY = REC_MU,
  REC_WALL_VZ = REC_KAPPA,
  REC_WALL_MASS = REC_T // kg, of the extrapolated density
};

typedef struct SweepScales {
  double slope, value; // norm/h^5 and norm/h^3
  double per_h;        // 1/m
  double diffusion;    // 2 delta h c0, m2/s
  double artificial;   // alpha c0 h/rho0
  double soften;       // 0.01 h^2, m2: keeps the artificial viscosity finite
  double body[3];      // m/s2, gravity + extra
  double held[3];      // m/s2, the part of it that pressure can balance: none along an axis that repeats
  double period[3], per_period[3];
} SweepScales;

typedef struct Sweep {
  const SphParameters *sph;
  Particles *p;
  const PairList *fluid_fluid, *fluid_wall, *wall_fluid;
  SweepScales scale;
  bool periodic;
} Sweep;

typedef struct SweepTasks {
  bool flow, heat; // drho and a; heat
} SweepTasks;

Sweep sweep_begin(const SphParameters *sph, Particles *particles, const Neighbours *neighbours);
/* Pressure and volume from density, then the fluid's records. */
void sweep_pack_fluid(const Sweep *sweep);
void sweep_sum_density(const Sweep *sweep); // rho by summation, from packed positions
void sweep_walls(const Sweep *sweep);       // p, v, rho and records of the walls that fluid is near to
void sweep_fluid(const Sweep *sweep, SweepTasks tasks);

#endif
