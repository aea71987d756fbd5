/* walls_cells.h - the wall particles of one lattice cell; for walls.c. */
#ifndef CAST_GEOMETRY_WALLS_CELLS_H
#define CAST_GEOMETRY_WALLS_CELLS_H

#include "cast/geometry/surface_internal.h"

typedef struct WallParticle {
  double x[3], volume;              // m, m3
  double foot[3], normal[3], depth; // m
  int32_t patch, cell[3];
  bool echo;
} WallParticle;

typedef struct WallBuffer {
  ptrdiff_t n, capacity;
  WallParticle *particle;
  bool failed; // no memory
} WallBuffer;

typedef struct WallLattice {
  const Surface *surface;
  double spacing, reach, origin[3]; // m
} WallLattice;

/* Append the particles of a cell. `near`: the guess and candidates of a search from anywhere in the cell. */
void wall_cell_fill(const WallLattice *lattice, const int32_t cell[3], const NearestQuery *near, WallBuffer *out);

#endif
