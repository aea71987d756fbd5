/* neighbours.h - who is within the kernel's support of whom. Cell lists and Verlet lists with a skin.
 * Lists are full: each fluid particle has all its neighbours, so iteration i writes only its own particle and results
 * have the same bits at any thread count. Entries of a row stand in an order that does not depend on threads: first
 * what may lie within reach now, then what may later (pair_list_end). */
#ifndef CAST_PARTICLES_NEIGHBOURS_H
#define CAST_PARTICLES_NEIGHBOURS_H

#include <stdbool.h>
#include "cast/geometry/surface.h"
#include "cast/particles/particles.h"

typedef struct PairList {
  ptrdiff_t n;      // rows
  ptrdiff_t *start; // [n + 1]
  int32_t *index;   // [start[n]]
  int32_t *near;    // [n] so many entries of a row come first that may lie within reach now
  ptrdiff_t capacity;
} PairList;

/* The end of row i for sums over pairs at the present places. Entries from there to start[i + 1] are beyond reach now
 * and may come within it before lists are made anew. */
static inline ptrdiff_t pair_list_end(const PairList *list, ptrdiff_t i)
{
  return list->start[i] + list->near[i];
}

typedef struct Neighbours Neighbours;

/* The skin, m, to create lists with for particles of this spacing; neighbours_suit_skin takes up to twice as much for
 * all pairs (docs/performance). */
double neighbours_skin(double spacing);
double neighbours_range(double reach, double skin); // m, no pair in the lists was farther apart when they were built
/*  reach    m: the kernel's support radius
 *  skin     m: added to it (twice for pairs with walls), so lists last until particles may have come nearer to each
 *           other by so much
 *  surface  borrowed; pairs that the mould separates are left out (NULL: no such test) */
CastStatus neighbours_create(double reach, double skin, const Surface *surface, Neighbours **neighbours,
                             CastError *err);
/* The same in a domain that repeats: period[d] m along axis d, 0: it does not. Fluid particles are brought back into
 * [0, period) when lists are rebuilt, walls must lie there. For channels; no surface.
 * Errors also: CAST_ERR_ARGUMENT for a period below 2.5 times the range, where a pair would meet its own image. */
CastStatus neighbours_create_periodic(double reach, double skin, const double period[3], Neighbours **neighbours,
                                      CastError *err);
/* From now on take the skin, up to twice that given, that suits the speed of the melt at each build, and keep apart
 * within each row, by a shorter skin, what may lie within reach soon (pair_list_end): that is told anew several times
 * before the lists are. Skins depend on the particles alone, so a resumed run has the same lists.
 *   spacing  m
 *   step     s, about as long as time steps will be */
void neighbours_suit_skin(Neighbours *neighbours, double spacing, double step);
const double *neighbours_period(const Neighbours *neighbours); // [3] m, 0 where the domain does not repeat
void neighbours_destroy(Neighbours **neighbours);
/* Rebuild if a pair that is not listed may have come within reach since the last build, or `force`; sooner than that
 * the near parts of the rows are told anew, for which p->record is scratch. A rebuild re-sorts the fluid particles in
 * space (all their fields). `rebuilt` tells whether indices changed. Errors: CAST_ERR_MEMORY; CAST_ERR_NUMERIC for a
 * position that is not finite, naming the particle. */
CastStatus neighbours_update(Neighbours *neighbours, Particles *particles, bool force, bool *rebuilt, CastError *err);
/* Fluid i -> fluid j; fluid i -> wall j (j is a particle index >= n_fluid); wall k -> fluid j (row k = wall index).
 * Entries may lie beyond reach: kernels vanish there. */
const PairList *neighbours_fluid_fluid(const Neighbours *neighbours);
const PairList *neighbours_fluid_wall(const Neighbours *neighbours);
const PairList *neighbours_wall_fluid(const Neighbours *neighbours);
long neighbours_builds(const Neighbours *neighbours);

#endif
