/* pair_prune.h - rows of a list put in order of use: first the entries that are near, then those that may come near
 * before the list is made anew. */
#ifndef CAST_PARTICLES_PAIR_PRUNE_H
#define CAST_PARTICLES_PAIR_PRUNE_H

#include "cast/particles/pair_list.h"

/* Places as integers that wrap round at 2^32: differences are exact, and along an axis that repeats the nearest
 * image's. Four numbers, so that one load brings a place. */
typedef struct PrunePlace {
  _Alignas(16) uint32_t at[4]; // the last is not used
} PrunePlace;

typedef struct PrunePlaces {
  const PrunePlace *place; // [all particles], borrowed
  float step[3];           // m, of the integers
} PrunePlaces;

/* The places of all particles in units of 2^-24 `reach` (m), or of 2^-32 of the period. room: [p->n] */
PrunePlaces prune_places(const Particles *p, double reach, const double period[3], PrunePlace *room);
/* Sets list->near: the entries of row r that are nearer than `reach` m to particle base + r come first. Either part
 * keeps its order. Errors: CAST_ERR_MEMORY. */
CastStatus pair_list_prune(PairList *list, const PrunePlaces *places, ptrdiff_t base, double reach, RowBuffers *buffers,
                           CastError *err);
/* One row of n entries; far: room for n + PRUNE_LANES. Returns how many are near. The plain one does the same without
 * vectors. */
enum { PRUNE_LANES = 16 };
ptrdiff_t prune_row(const PrunePlaces *places, const PrunePlace *me, float reach2, int32_t *row, ptrdiff_t n,
                    int32_t *far);
ptrdiff_t prune_row_plain(const PrunePlaces *places, const PrunePlace *me, float reach2, int32_t *row, ptrdiff_t n,
                          int32_t *far);

#endif
