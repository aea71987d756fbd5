/* walls.h - wall particles made from the ROM's geometry at the run's own spacing.
 * Lattice cells of size `spacing` that the mould fills in whole or in part, out to the kernel's reach from the CAVITY
 * wall (and round the rim of its openings): each becomes a particle at the centroid of its part inside the mould with
 * that part's volume, so that sums over wall particles see the true wall, at any orientation, not a staircase.
 *
 * Where the mould's wall is thinner than the reach, each side gets wall particles of its own as deep as the reach.
 * Those of a side that lie where the mould belongs to the other side, or where there is no mould any more, are its
 * echoes: they stand for what a wall without other side would have there. Wall particles may then overlap in space, but
 * a place is either in sight of a fluid particle (and holds fluid, or a wall particle that is no echo) or hidden from
 * it (and then its echo counts): walls_seen tells, and of those seen none overlap. Where no wall is thin there are no
 * echoes and everything is seen. */
#ifndef CAST_GEOMETRY_WALLS_H
#define CAST_GEOMETRY_WALLS_H

#include <stddef.h>
#include "cast/geometry/surface.h"

typedef struct WallSet {
  ptrdiff_t n;
  double *x[3];      // m
  double *volume;    // m3, about spacing^3 at most (slivers below 5 % of a cell are merged into a neighbour)
  double *foot[3];   // m, nearest point of the surface this particle stands for
  double *normal[3]; // unit, into the melt, at the foot
  double *depth;     // m, > 0: distance from the foot
  int32_t *patch;    // ROM patch of the foot
  uint8_t *echo;     // 1: an echo, see above
} WallSet;

/*  origin  m: a corner of the lattice (fluid particles sit at origin + (i + 1/2) spacing)
 *  reach   m: the kernel's support radius
 * Errors: CAST_ERR_MEMORY; CAST_ERR_INPUT where spacing cannot resolve the cavity at all. */
CastStatus walls_generate(const Surface *surface, double spacing, double reach, const double origin[3], WallSet *walls,
                          CastError *err);
void walls_destroy(WallSet *walls);

/* Does a fluid particle at x feel the wall particle at `place` with this foot, normal and echo?
 * x within surface_reach of the place. Quick where no wall is thin near x (surface_thin_near). */
bool walls_seen(const Surface *surface, const double x[3], const double place[3], const double foot[3],
                const double normal[3], bool echo);

#endif
