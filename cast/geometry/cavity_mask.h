/* cavity_mask.h - which lattice cells belong to the cavity; for placement.c and cavity_cells.c. */
#ifndef CAST_GEOMETRY_CAVITY_MASK_H
#define CAST_GEOMETRY_CAVITY_MASK_H

#include "cast/geometry/cut.h"

/* A cell that the surface cuts. */
typedef struct MaskCell {
  int32_t cell;
  CutPart part; // the void's
} MaskCell;

/* Cells over the box round the cavity wall; cells that stick out of it are cut to it. */
typedef struct CavityMask {
  const Surface *surface;
  double spacing, origin[3]; // m
  int32_t first[3], n[3];    // the lattice cell of the first, and how many
  uint8_t *is_cavity;        // [n0*n1*n2], x fastest
  ptrdiff_t n_near;
  MaskCell *near; // [n_near] in the order of their cells; some turn out not to be the cavity's
} CavityMask;

/* Errors: CAST_ERR_INPUT (no cavity, too many cells), CAST_ERR_MEMORY. */
CastStatus cavity_mask_create(const Surface *surface, double spacing, const double origin[3], CavityMask *mask,
                              CastError *err);
void cavity_mask_destroy(CavityMask *mask);
ptrdiff_t cavity_mask_size(const CavityMask *mask);
/* The first of mask->near whose cell is not below `cell`, or n_near. */
ptrdiff_t cavity_mask_find(const CavityMask *mask, ptrdiff_t cell);
/* All of a cell, cut to the box; zero volume where nothing of it is left. The void part of cells not in mask->near. */
void cavity_mask_whole(const CavityMask *mask, ptrdiff_t cell, CutPart *part);

#endif
