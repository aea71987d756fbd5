/* approach.h - by how much particles near each other may have come nearer since they were sorted into cells.
 * Two of them came nearer by the difference of their ways at most: melt that falls as one, and drops that fly apart far
 * from each other, come no nearer. */
#ifndef CAST_PARTICLES_APPROACH_H
#define CAST_PARTICLES_APPROACH_H

#include "cast/particles/cells.h"

typedef struct BlockWays BlockWays; // the ways of a block of cells, as a box
typedef struct Approach {
  BlockWays *block;
  ptrdiff_t capacity;
} Approach;

/* A bound on |w_i - w_j|, m, over all pairs nearer than two reaches when the points were sorted; w = x - before [3][n],
 * both in the order of the cells. Errors: CAST_ERR_MEMORY. */
CastStatus approach_bound(Approach *approach, const Cells *cells, double *const x[3], float *const before[3],
                          double *bound, CastError *err);
void approach_free(Approach *approach);

#endif
