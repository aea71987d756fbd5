/* vicinity.h - sorted points near a place, looked for in the cells around it.
 * The places of one cell share these cells: they are found once and looked through for each place. */
#ifndef CAST_PARTICLES_VICINITY_H
#define CAST_PARTICLES_VICINITY_H

#include "cast/particles/cells.h"

/* Points sorted into cells: sorted[d][k] is the position of sorted point k, whose number is base + k, or with an order
 * base + order[k]. */
typedef struct SortedPoints {
  const Cells *cells;
  double *const *sorted; // [3][n] m
  const int32_t *order;  // [n] or NULL
  int32_t base;
} SortedPoints;

typedef struct Vicinity {
  bool known;      // of `cell`
  int32_t cell[3]; // the cell in the middle
  int n_runs;
  CellRun run[CELLS_RUNS];
  ptrdiff_t room; // entries that vicinity_select may write, hits or not
} Vicinity;

/* Make v the vicinity of x's cell. v->known must be false where it was that of other points. */
void vicinity_move_to(Vicinity *v, const SortedPoints *points, const double x[3]);
/* Numbers of the points with |x_point - x|^2 < reach2 to index, in the order of the cells; returns how many. The plain
 * one does the same without vectors. */
ptrdiff_t vicinity_select(const Vicinity *v, const SortedPoints *points, const double x[3], double reach2,
                          int32_t *index);
ptrdiff_t vicinity_select_plain(const Vicinity *v, const SortedPoints *points, const double x[3], double reach2,
                                int32_t *index);

#endif
