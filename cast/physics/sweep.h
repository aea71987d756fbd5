/* sweep.h - one pass over all pairs of a neighbour list: records in, rates out. Internal to physics/.
 * The fast form (pack.c, sweep.c, walls.c) computes pairs in single precision: positions as integers whose differences
 * are exact, lengths in h, volumes in h^3; sums between fluid particles are integers, all that is kept is double. The
 * plain form (sweep_plain.c) computes the same formulas in double from the particles' fields. */
#ifndef CAST_PHYSICS_SWEEP_H
#define CAST_PHYSICS_SWEEP_H

#include "cast/physics/sph.h"

/* A particle's record: what a neighbour needs to know of it, side by side, so that one or two cache lines hold it.
 * A wall's record differs in the last four places. */
enum {
  REC_X,      // place: x in units of 2^-24 h, or of 2^-32 of the period, wrapping round at 2^32. The difference of two
  REC_Y,      // is exact, has single precision's digits at a length of h, and is the nearest image's along an axis that
  REC_Z,      // repeats
  REC_VOLUME, // h^3
  REC_VX,     // m/s; wall: the velocity extrapolated for no slip
  REC_VY,
  REC_VZ,
  REC_P,                 // p/rho^2
  REC_ETA,               // diffused_density
  REC_MU,                // viscosity, mu h^5/m^2: so scaled, pressure and viscous forces add up
  REC_KAPPA,             // W/(m K)
  REC_T,                 // K above that of the fluid's first particle
  REC_WALL_VX = REC_ETA, // wall: its own velocity
  REC_WALL_VY = REC_MU,
  REC_WALL_VZ = REC_KAPPA,
  REC_WALL_MASS = REC_T // of the extrapolated density, in masses of a fluid particle
};

enum { SWEEP_GRAIN_BITS = 27 }; // no term of a pair has more than 2^27 grains

typedef struct SweepScales {
  double slope, value; // norm/h^5, 1/m5, and norm/h^3, 1/m3
  double per_h;        // 1/m
  double mass;         // kg, of a fluid particle
  double diffusion;    // 2 delta h c0, m2/s
  double artificial;   // alpha c0 h/rho0
  double soften;       // 0.01 h^2, m2: keeps the artificial viscosity finite
  double apart;        // strength of pair_apart, as p/rho^2
  double per_q_apart;  // 1/h, it begins at q = 1/per_q_apart
  double wall_least;   // of P_i + P_wall, p/rho^2: walls pull no more
  double body[3];      // m/s2, gravity + extra
  double held[3];      // m/s2, the part of it that pressure can balance: none along an axis that repeats
  double period[3], per_period[3];
  double per_unit[3]; // 1/m, the inverse of a record's unit of place
  float step[3];      // h, the unit
  double T0;          // K, what the records' temperatures count from
  struct {            // see pack.c; in the fast form's units
    double drho, a, heat;
  } grain;
  struct { // from the fast form's sums (lengths in h, F in norm/h^5, volumes in h^3, masses in m) to SI
    double drho, a, heat, away;
  } si;
} SweepScales;

typedef struct Sweep {
  const SphParameters *sph;
  Particles *p;
  const PairList *fluid_fluid, *fluid_wall, *wall_fluid;
  SweepScales scale;
  bool spins;
} Sweep;

typedef struct SweepTasks {
  bool flow, heat; // drho and a; heat
} SweepTasks;

/* Added to viscosities and conductivities, whose sums are divided by: 0/0 must give 0. */
#define SWEEP_TINY 1e-17

/* Sums over one particle's pairs, in SI. */
typedef struct Rates {
  double drho;    // kg/(m3 s)
  double a[3];    // m/s2
  double heat;    // W
  double away[3]; // 1/m, sum over walls of V_j F_ij d: points out of the wall
} Rates;

Sweep sweep_begin(const SphParameters *sph, Particles *particles, const Neighbours *neighbours);
/* Pressure and volume from density, then the fluid's records and the grains that suit them. */
void sweep_pack_fluid(Sweep *sweep);
RecordField sweep_place(const SweepScales *scale, int axis, double x);
void sweep_sum_density(const Sweep *sweep); // rho by summation
void sweep_walls(const Sweep *sweep);       // p, v, rho and records of the walls that fluid is near to
void sweep_fluid(const Sweep *sweep);       // flow and heat, fast
void sweep_fluid_plain(const Sweep *sweep, SweepTasks tasks);

#endif
