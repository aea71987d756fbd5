/* surface_grid.c - the uniform grid through which the surface is searched.
 * Cells are about as large as the cavity's triangles, but no finer than a quarter of the reach and never more than a
 * few million. Cells without triangles know whether they are mould or void, and how far the nearest triangle is at
 * least. */
#include "cast/geometry/surface_internal.h"

#include <stdlib.h>

enum { MAX_CELLS = 4000000, MAX_STEPS = 255 };
static const int32_t FACE_STEP[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};

static double mean_cavity_edge(const Surface *s)
{
  double sum = 0.0;
  ptrdiff_t count = 0;
  for (ptrdiff_t t = 0; t < s->n_triangles; t++)
    for (int k = 0; k < 3 && !s->outer[t]; k++, count++)
      sum += sqrt(vec_distance2(s->facet[t].corner[k], s->facet[t].corner[(k + 1) % 3]));
  return count ? sum / (double)count : (double)INFINITY;
}

/* A margin of one reach and one cell: every point that may have a hit lies in the grid, and its border is open air. */
static void size_grid(Surface *s)
{
  SearchGrid *grid = &s->grid;
  const double edge = mean_cavity_edge(s);
  grid->cell = fmin(fmax(edge, 0.25 * s->reach), s->reach);
  for (;; grid->cell *= 1.1) {
    double cells = 1.0;
    for (int k = 0; k < 3; k++) cells *= ceil((s->high[k] - s->low[k] + 2.0 * s->reach) / grid->cell) + 2.0;
    if (cells <= MAX_CELLS) break;
  }
  grid->per_cell = 1.0 / grid->cell;
  for (int k = 0; k < 3; k++) {
    grid->low[k] = s->low[k] - s->reach - grid->cell;
    grid->n[k] = (int32_t)(ceil((s->high[k] - s->low[k] + 2.0 * s->reach) / grid->cell) + 2.0);
  }
}

/* Does the facet's plane pass through the cell? The box of the facet is tested by the caller's loop. */
static bool plane_meets_cell(const SearchGrid *grid, const Facet *facet, const int32_t at[3])
{
  double to[3], radius = 0.0;
  for (int k = 0; k < 3; k++) {
    to[k] = grid->low[k] + (at[k] + 0.5) * grid->cell - facet->corner[0][k];
    radius += fabs(facet->normal[k]);
  }
  return fabs(vec_dot(to, facet->normal)) <= 0.5 * grid->cell * radius * (1.0 + 1.0e-6);
}

/* Cells that a facet may touch: counted in start (item == NULL) or listed. A margin of 1e-6 cells makes the lists safe
 * against rounding in whoever walks through the grid. */
static void register_facet(Surface *s, int32_t t, int32_t *item)
{
  SearchGrid *grid = &s->grid;
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (int k = 0; k < 3; k++)
    for (int axis = 0; axis < 3; axis++) {
      low[axis] = fmin(low[axis], s->facet[t].corner[k][axis] - 1.0e-6 * grid->cell);
      high[axis] = fmax(high[axis], s->facet[t].corner[k][axis] + 1.0e-6 * grid->cell);
    }
  int32_t first[3], last[3], at[3];
  if (!grid_range(grid, low, high, first, last)) return;
  for (at[2] = first[2]; at[2] <= last[2]; at[2]++)
    for (at[1] = first[1]; at[1] <= last[1]; at[1]++)
      for (at[0] = first[0]; at[0] <= last[0]; at[0]++) {
        if (!plane_meets_cell(grid, &s->facet[t], at)) continue;
        const ptrdiff_t cell = grid_index(grid, at);
        if (item)
          item[grid->start[cell]++] = t;
        else
          grid->start[cell + 1]++;
      }
}

static CastStatus fill_grid(Surface *s, CastError *err)
{
  SearchGrid *grid = &s->grid;
  const ptrdiff_t cells = grid_cells(grid);
  for (int32_t t = 0; t < s->n_triangles; t++) register_facet(s, t, NULL);
  ptrdiff_t total = 0;
  for (ptrdiff_t c = 0; c < cells; c++) {
    total += grid->start[c + 1];
    CAST_CHECK(total < INT32_MAX, err, CAST_ERR_MEMORY, "the mould's boundary is too fine for its search grid");
    grid->start[c + 1] = (int32_t)total;
  }
  grid->item = malloc((size_t)(total ? total : 1) * sizeof *grid->item);
  CAST_CHECK(grid->item, err, CAST_ERR_MEMORY, "no memory for a search grid of %td entries", total);
  for (int32_t t = 0; t < s->n_triangles; t++) register_facet(s, t, grid->item);
  for (ptrdiff_t c = cells; c > 0; c--) grid->start[c] = grid->start[c - 1];
  grid->start[0] = 0;
  return CAST_OK;
}

/* to[x] = the lesser of to[x] and one more than the least of from[x - 1], from[x] and from[x + 1]. */
static void step_from_row(const uint8_t *restrict from, int32_t n, uint8_t *restrict to)
{
  for (int32_t x = 0; x < n; x++) {
    const uint8_t left = from[x > 0 ? x - 1 : 0], right = from[x + 1 < n ? x + 1 : x];
    uint8_t least = from[x] < left ? from[x] : left;
    least = least < right ? least : right;
    least = (uint8_t)(least + (least < MAX_STEPS));
    to[x] = least < to[x] ? least : to[x];
  }
}

static void step_along_row(uint8_t *row, int32_t n, bool forward)
{
  for (int32_t k = 1; k < n; k++) {
    uint8_t *here = forward ? row + k : row + (n - 1 - k);
    const int next = (forward ? here[-1] : here[1]) + 1;
    if (next < *here) *here = (uint8_t)next;
  }
}

/* King's-move distance to the nearest occupied cell: a forward and a backward sweep over the 13 neighbours met before,
 * nine of them in the plane before, in parallel. Exact for this metric (A. Rosenfeld, J. L. Pfaltz, J. ACM 13 (1966)
 * 471). */
static void sweep_steps(SearchGrid *grid, bool forward)
{
  const int32_t *n = grid->n, back = forward ? -1 : 1;
#pragma omp parallel
  for (int32_t plane = 0; plane < n[2]; plane++) {
    const int32_t z = forward ? plane : n[2] - 1 - plane;
    uint8_t *const here = grid->steps + (ptrdiff_t)z * n[0] * n[1];
    if (plane > 0) {
      const uint8_t *const before = here + back * (ptrdiff_t)n[0] * n[1];
#pragma omp for schedule(static)
      for (int32_t y = 0; y < n[1]; y++)
        for (int32_t from = y > 0 ? y - 1 : 0; from <= y + 1 && from < n[1]; from++)
          step_from_row(before + (ptrdiff_t)from * n[0], n[0], here + (ptrdiff_t)y * n[0]);
    }
#pragma omp single
    for (int32_t line = 0; line < n[1]; line++) {
      uint8_t *const row = here + (ptrdiff_t)(forward ? line : n[1] - 1 - line) * n[0];
      if (line > 0) step_from_row(row + back * n[0], n[0], row);
      step_along_row(row, n[0], forward);
    }
  }
}

CastStatus surface_grid_create(Surface *s, CastError *err)
{
  size_grid(s);
  SearchGrid *grid = &s->grid;
  const ptrdiff_t cells = grid_cells(grid);
  grid->start = calloc((size_t)cells + 1, sizeof *grid->start);
  grid->flags = calloc((size_t)cells, 1);
  grid->steps = malloc((size_t)cells);
  CAST_CHECK(grid->start && grid->flags && grid->steps, err, CAST_ERR_MEMORY,
             "no memory for a search grid of %td cells", cells);
  CAST_CALL(fill_grid(s, err));
  for (ptrdiff_t c = 0; c < cells; c++) grid->steps[c] = grid->start[c + 1] > grid->start[c] ? 0 : MAX_STEPS;
  sweep_steps(grid, true);
  sweep_steps(grid, false);
  return CAST_OK;
}

static void flood(SearchGrid *grid, ptrdiff_t seed, uint8_t flag, int32_t *stack)
{
  ptrdiff_t height = 0;
  stack[height++] = (int32_t)seed;
  grid->flags[seed] = flag;
  while (height > 0) {
    const ptrdiff_t cell = stack[--height];
    const int32_t at[3] = {(int32_t)(cell % grid->n[0]), (int32_t)(cell / grid->n[0] % grid->n[1]),
                           (int32_t)(cell / grid->n[0] / grid->n[1])};
    for (int k = 0; k < 6; k++) {
      const int32_t to[3] = {at[0] + FACE_STEP[k][0], at[1] + FACE_STEP[k][1], at[2] + FACE_STEP[k][2]};
      if (!grid_holds(grid, to)) continue;
      const ptrdiff_t next = grid_index(grid, to);
      if (grid->steps[next] == 0 || grid->flags[next]) continue;
      grid->flags[next] = flag;
      stack[height++] = (int32_t)next;
    }
  }
}

/* No triangle stands between two neighbouring cells that hold none: one question settles each connected lot of them. */
CastStatus surface_grid_classify(Surface *s, CastError *err)
{
  SearchGrid *grid = &s->grid;
  const ptrdiff_t cells = grid_cells(grid);
  int32_t *stack = malloc((size_t)cells * sizeof *stack);
  CAST_CHECK(stack, err, CAST_ERR_MEMORY, "no memory to classify a search grid of %td cells", cells);
  for (ptrdiff_t c = 0; c < cells; c++) {
    if (grid->steps[c] == 0 || grid->flags[c]) continue;
    const int32_t at[3] = {(int32_t)(c % grid->n[0]), (int32_t)(c / grid->n[0] % grid->n[1]),
                           (int32_t)(c / grid->n[0] / grid->n[1])};
    double centre[3];
    for (int k = 0; k < 3; k++) centre[k] = grid->low[k] + (at[k] + 0.5) * grid->cell;
    SurfaceHit hit;
    const NearestQuery query = {.reach = INFINITY, .guess = -1};
    const bool found = surface_nearest_query(s, centre, &query, &hit);
    flood(grid, c, found && hit.distance < 0.0 ? CELL_INSIDE : CELL_OPEN, stack);
  }
  free(stack);
  return CAST_OK;
}
