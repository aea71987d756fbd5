/* wall_guard.h - nothing enters the mould: what holds melt off the true wall, particle by particle. Internal to
 * physics/. Wall particles push with the pressure of the melt beside them, and where that is stretched (round a convex
 * lip) they do not push at all. Then two things are left: a film      a particle nearer to the wall than `film`
 * spacings that still approaches it is slowed by what is squeezed out between: dv_n/dt = -(c0/film) (1 - distance/film)
 * v_n, the pressure rho0 c0 v_n of sudden impact ("water hammer") where it touches. It takes speed into the wall alone,
 * and only where melt under pressure never comes: settled layers stand half a spacing off. the guard   a particle
 * deeper in the mould than `guard_depth` spacings is set back on the wall and loses its speed into it. */
#ifndef CAST_PHYSICS_WALL_GUARD_H
#define CAST_PHYSICS_WALL_GUARD_H

#include "cast/physics/sph.h"

typedef struct WallGuard {
  const SphParameters *sph;
  const Surface *surface;
  double dt; // s
} WallGuard;

/* Fluid particles [first, end) after they have moved; their clearance must be no more than it is. Returns how many were
 * set back. */
long wall_guard_rows(const WallGuard *guard, Particles *particles, ptrdiff_t first, ptrdiff_t end);

#endif
