/* neighbours_private.h - what the files of the neighbour lists share.
 * neighbours.c  life, making of lists     neighbours_due.c  skins, and how long lists last with them */
#ifndef CAST_PARTICLES_NEIGHBOURS_PRIVATE_H
#define CAST_PARTICLES_NEIGHBOURS_PRIVATE_H

#include "cast/particles/approach.h"
#include "cast/particles/cells.h"
#include "cast/particles/pair_list.h"
#include "cast/particles/vicinity.h"

/* How much nearer particles may come, m: fluid to fluid, and to a wall, which stands still. */
typedef struct Skins {
  double fluid, wall;
} Skins;

struct Neighbours {
  double reach, most_skin; // m
  double spacing, step;    // m, s; step 0: skins stay as they are
  Skins listed;            // of the lists when they were made
  Skins wanted;            // of the rows' near parts, if there is time for it
  Skins near;              // of the near parts when they were told apart
  Skins used;              // since the lists were made particles may have come nearer by so much
  const Surface *surface;
  double period[3];
  Cells fluid_cells, wall_cells;
  double *sorted_wall[3]; // [n_wall] positions in the order of wall_cells
  ptrdiff_t n_wall;       // -1: walls not sorted yet
  float *built_at[3];     // [n_fluid] positions when the near parts were told apart
  double rounding;        // m, at most so far are these from the positions
  uint8_t *thin;          // [n_fluid] a thin mould wall is near
  ptrdiff_t n_fluid, capacity;
  PairList fluid_fluid, fluid_wall, wall_fluid;
  RowBuffers buffers;
  Approach approach;
  long builds;
};

typedef enum Due { NOTHING_DUE, ROWS_DUE, LISTS_DUE } Due;

/* Takes the ways since the near parts were told apart into nb->used where rows or lists are due. Errors:
 * CAST_ERR_MEMORY. */
CastStatus neighbours_find_due(Neighbours *neighbours, const Particles *particles, Due *due, CastError *err);
/* Skins of the lists and of the near parts, from the melt's speed now; as given without neighbours_suit_skin. */
void neighbours_choose_skins(Neighbours *neighbours, const Particles *particles);
/* From here on ways are counted for neighbours_find_due. */
void neighbours_remember_positions(Neighbours *neighbours, const Particles *particles);

#endif
