/* cells.h - points sorted into a grid of cubic cells, so that those near a place are a few runs of a sorted array.
 * Cells are numbered with x fastest; a run of cells along x is a run of points. */
#ifndef CAST_PARTICLES_CELLS_H
#define CAST_PARTICLES_CELLS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "common/error.h"

enum { CELLS_SPAN = 2 }; // cells to look at on each side: a cell is at least reach/2 wide

typedef struct Cells {
  double low[3];    // m, corner of the grid
  double size[3];   // m, of a cell
  int32_t count[3]; // cells along each axis
  bool periodic[3];
  ptrdiff_t *start; // [cells + 1] first sorted point of each cell
  ptrdiff_t capacity_start;
  ptrdiff_t n;    // points
  int32_t *order; // [n] sorted place -> point; equal cells keep the points' order
  int32_t *cell;  // [n] cell of each point; scratch
  ptrdiff_t capacity_points;
} Cells;

/* Sort the points x [3][n] into cells for searches up to `reach` (m). Points are finite; along a periodic axis they lie
 * in [0, period). The grid covers the points; it is coarsened where that would take more than a few cells a point.
 * Errors: CAST_ERR_MEMORY. */
CastStatus cells_sort(Cells *cells, ptrdiff_t n, double *const x[3], double reach, const double period[3],
                      CastError *err);
void cells_free(Cells *cells);

/* The cell of a place, as numbers along each axis; beyond the grid by more than the span: some cell out there. */
void cells_locate(const Cells *cells, const double x[3], int32_t cell[3]);

/* Runs of sorted points in the cells around a place. `shift` is to be added to the points' positions (periodic images).
 */
typedef struct CellRun {
  ptrdiff_t first, end;
  double shift[3];
} CellRun;
enum { CELLS_RUNS = 2 * (2 * CELLS_SPAN + 1) * (2 * CELLS_SPAN + 1) };
/* Returns how many runs, in ascending order of cells but for images. */
int cells_runs(const Cells *cells, const double x[3], CellRun run[CELLS_RUNS]);

#endif
