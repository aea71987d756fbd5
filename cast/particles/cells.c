#include "cast/particles/cells.h"

#include <math.h>
#include <stdlib.h>

static CastStatus reserve(ptrdiff_t count, size_t size, ptrdiff_t *capacity, void **room, CastError *err)
{
  if (count <= *capacity) return CAST_OK;
  const ptrdiff_t wanted = count + count / 4;
  free(*room);
  *room = malloc((size_t)wanted * size);
  *capacity = *room ? wanted : 0;
  CAST_CHECK(*room, err, CAST_ERR_MEMORY, "neighbour search: no memory for %td entries", wanted);
  return CAST_OK;
}

static void bounds(ptrdiff_t n, const double *x, double *low, double *high)
{
  double least = n > 0 ? x[0] : 0.0, most = least;
#pragma omp parallel for simd reduction(min : least) reduction(max : most)
  for (ptrdiff_t i = 0; i < n; i++) { // not fmin, fmax: these care for NaN and are calls
    least = x[i] < least ? x[i] : least;
    most = x[i] > most ? x[i] : most;
  }
  *low = least;
  *high = most;
}

/* Choose cells of at least reach/CELLS_SPAN that cover the points; a lone particle far away makes them coarser. Cells
 * begin at multiples of their size: grids over different points for the same reach have cells in common. */
static void lay_grid(Cells *c, double *const x[3], double reach, const double period[3])
{
  double high[3];
  for (int d = 0; d < 3; d++) {
    c->periodic[d] = period[d] > 0.0;
    if (c->periodic[d]) {
      c->low[d] = 0.0;
      high[d] = period[d];
    } else {
      bounds(c->n, x[d], &c->low[d], &high[d]);
    }
  }
  const double most = 4.0 * (double)c->n + 4096.0, bottom[3] = {c->low[0], c->low[1], c->low[2]};
  for (double least = reach / CELLS_SPAN, cells = 2.0 * most; cells > most; least *= 1.3) {
    cells = 1.0;
    for (int d = 0; d < 3; d++) {
      c->low[d] = c->periodic[d] ? 0.0 : least * floor(bottom[d] / least);
      cells *= floor((high[d] - c->low[d]) / least) + 1.0;
    }
    for (int d = 0; d < 3 && cells <= most; d++) {
      const double length = high[d] - c->low[d];
      const int32_t fit = (int32_t)floor(length / least);
      c->count[d] = c->periodic[d] ? fit : fit + 1;
      c->size[d] = c->periodic[d] ? length / fit : least;
    }
  }
}

static int32_t clamp(double cell, int32_t count)
{
  return cell < 0.0 ? 0 : cell >= count ? count - 1 : (int32_t)cell;
}

static void assign_cells(Cells *c, double *const x[3])
{
#pragma omp parallel for
  for (ptrdiff_t i = 0; i < c->n; i++) {
    int32_t at[3];
    for (int d = 0; d < 3; d++) at[d] = clamp(floor((x[d][i] - c->low[d]) / c->size[d]), c->count[d]);
    c->cell[i] = (at[2] * c->count[1] + at[1]) * c->count[0] + at[0];
  }
}

CastStatus cells_sort(Cells *c, ptrdiff_t n, double *const x[3], double reach, const double period[3], CastError *err)
{
  c->n = n;
  lay_grid(c, x, reach, period);
  const ptrdiff_t cells = (ptrdiff_t)c->count[0] * c->count[1] * c->count[2];
  ptrdiff_t capacity = c->capacity_points;
  CAST_CALL(reserve(n, sizeof *c->order, &capacity, (void **)&c->order, err));
  CAST_CALL(reserve(n, sizeof *c->cell, &c->capacity_points, (void **)&c->cell, err));
  CAST_CALL(reserve(cells + 1, sizeof *c->start, &c->capacity_start, (void **)&c->start, err));
  assign_cells(c, x);
  for (ptrdiff_t k = 0; k <= cells; k++) c->start[k] = 0;
  for (ptrdiff_t i = 0; i < n; i++) c->start[c->cell[i] + 1]++;
  for (ptrdiff_t k = 0; k < cells; k++) c->start[k + 1] += c->start[k];
  for (ptrdiff_t i = 0; i < n; i++) c->order[c->start[c->cell[i]]++] = (int32_t)i;
  for (ptrdiff_t k = cells; k > 0; k--) c->start[k] = c->start[k - 1]; // the fill moved each start to its end
  c->start[0] = 0;
  return CAST_OK;
}

void cells_free(Cells *c)
{
  free(c->start);
  free(c->order);
  free(c->cell);
  *c = (Cells){0};
}

/* The cells at -span..span around `at` along axis d as one or two ranges with the shift that brings them here. */
typedef struct Range {
  int32_t first, end;
  double shift;
} Range;

static int axis_ranges(const Cells *c, int d, int32_t at, Range range[2])
{
  const int32_t first = at - CELLS_SPAN, end = at + CELLS_SPAN + 1, count = c->count[d];
  const double period = c->size[d] * count;
  int n = 0;
  if (c->periodic[d] && first < 0) range[n++] = (Range){first + count, count, -period};
  const int32_t a = first < 0 ? 0 : first, b = end > count ? count : end;
  if (a < b) range[n++] = (Range){a, b, 0.0};
  if (c->periodic[d] && end > count) range[n++] = (Range){0, end - count, period};
  return n; // at most two: a periodic axis has more than 2 span cells
}

void cells_locate(const Cells *c, const double x[3], int32_t cell[3])
{
  for (int d = 0; d < 3; d++) {
    // beyond the grid by more than the span no cell is near; the clamp keeps the conversion to int32 defined
    const double at = floor((x[d] - c->low[d]) / c->size[d]);
    const double least = -CELLS_SPAN - 1, most = c->count[d] + CELLS_SPAN + 1;
    cell[d] = (int32_t)(at < least ? least : at > most ? most : at);
  }
}

int cells_runs(const Cells *c, const double x[3], CellRun run[CELLS_RUNS])
{
  Range range[3][2];
  int n_range[3];
  int32_t cell[3];
  cells_locate(c, x, cell);
  for (int d = 0; d < 3; d++) n_range[d] = axis_ranges(c, d, cell[d], range[d]);
  int n = 0;
  for (int rz = 0; rz < n_range[2]; rz++)
    for (int32_t z = range[2][rz].first; z < range[2][rz].end; z++)
      for (int ry = 0; ry < n_range[1]; ry++)
        for (int32_t y = range[1][ry].first; y < range[1][ry].end; y++)
          for (int rx = 0; rx < n_range[0]; rx++) {
            const ptrdiff_t row = ((ptrdiff_t)z * c->count[1] + y) * c->count[0];
            const ptrdiff_t first = c->start[row + range[0][rx].first], end = c->start[row + range[0][rx].end];
            if (first < end)
              run[n++] = (CellRun){first, end, {range[0][rx].shift, range[1][ry].shift, range[2][rz].shift}};
          }
  return n;
}
