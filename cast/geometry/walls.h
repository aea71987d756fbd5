/* walls.h - wall particles made from the ROM's geometry at the run's own spacing.
 * Lattice cells of size `spacing` that the mould fills in whole or in part, out to the kernel's reach from the CAVITY
 * wall (and round the rim of its openings): each becomes a particle at the centroid of its part inside the mould with
 * that part's volume, so that sums over wall particles see the true wall, at any orientation, not a staircase.
 * Where the mould's wall is thinner than the reach, each side gets wall particles of its own (they may overlap in
 * space); a fluid particle interacts only with those whose foot it sees (surface_separates). */
#ifndef CAST_GEOMETRY_WALLS_H
#define CAST_GEOMETRY_WALLS_H

#include <stddef.h>
#include "cast/geometry/surface.h"

typedef struct WallSet {
  ptrdiff_t n;
  double *x[3];      // m
  double *volume;    // m3, at most spacing^3
  double *foot[3];   // m, nearest point of the surface this particle stands for
  double *normal[3]; // unit, into the melt, at the foot
  double *depth;     // m, > 0: distance from the foot
  int32_t *patch;    // ROM patch of the foot
} WallSet;

/*  origin  m: a corner of the lattice (fluid particles sit at origin + (i + 1/2) spacing)
 *  reach   m: the kernel's support radius
 * Errors: CAST_ERR_MEMORY; CAST_ERR_INPUT where spacing cannot resolve the cavity at all. */
CastStatus walls_generate(const Surface *surface, double spacing, double reach, const double origin[3], WallSet *walls,
                          CastError *err);
void walls_destroy(WallSet *walls);

#endif
