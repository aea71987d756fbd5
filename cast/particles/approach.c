/* Method  cells are put together to blocks two reaches wide; the ways of each block's particles lie in a box, and the
 *         boxes of a block and its neighbours bound the differences. */
#include "cast/particles/approach.h"

#include <math.h>
#include <stdlib.h>

enum { BLOCK = 2 * CELLS_SPAN }; // cells, at least

struct BlockWays {
  double low[3], high[3]; // m; low > high: no particle
};

typedef struct BlockGrid {
  const Cells *cells;
  int32_t count[3];
} BlockGrid;

static ptrdiff_t block_at(const BlockGrid *grid, const int32_t at[3])
{
  return ((ptrdiff_t)at[2] * grid->count[1] + at[1]) * grid->count[0] + at[0];
}

/* First cell of block `at` along an axis; that of the next is its end. */
static int32_t first_cell(const BlockGrid *grid, int axis, int32_t at)
{
  return (int32_t)((int64_t)at * grid->cells->count[axis] / grid->count[axis]);
}

static void add_run(BlockWays *ways, double *const x[3], float *const before[3], ptrdiff_t first, ptrdiff_t end)
{
  for (int d = 0; d < 3; d++) {
    double low = ways->low[d], high = ways->high[d];
#pragma omp simd reduction(min : low) reduction(max : high)
    for (ptrdiff_t i = first; i < end; i++) {
      const double way = x[d][i] - (double)before[d][i];
      low = way < low ? way : low;
      high = way > high ? way : high;
    }
    ways->low[d] = low;
    ways->high[d] = high;
  }
}

static BlockWays block_ways(const BlockGrid *grid, const int32_t at[3], double *const x[3], float *const before[3])
{
  const Cells *c = grid->cells;
  BlockWays ways = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  int32_t first[3], end[3];
  for (int d = 0; d < 3; d++) {
    first[d] = first_cell(grid, d, at[d]);
    end[d] = first_cell(grid, d, at[d] + 1);
  }
  for (int32_t z = first[2]; z < end[2]; z++)
    for (int32_t y = first[1]; y < end[1]; y++) {
      const ptrdiff_t row = ((ptrdiff_t)z * c->count[1] + y) * c->count[0];
      add_run(&ways, x, before, c->start[row + first[0]], c->start[row + end[0]]);
    }
  return ways;
}

/* Largest square of the difference of a way in one block and one in the other. */
static double largest_difference2(const BlockWays *a, const BlockWays *b)
{
  double sum = 0.0;
  for (int d = 0; d < 3; d++) {
    const double up = a->high[d] - b->low[d], down = b->high[d] - a->low[d], most = up > down ? up : down;
    sum += most * most;
  }
  return a->low[0] <= a->high[0] && b->low[0] <= b->high[0] ? sum : 0.0;
}

/* Over the block itself and the half of its 26 neighbours that follow it: the others look at this one. */
static double difference2_around(const BlockGrid *grid, const BlockWays *block, const int32_t at[3])
{
  const BlockWays *own = &block[block_at(grid, at)];
  double most = largest_difference2(own, own);
  for (int k = 14; k < 27; k++) {
    int32_t next[3] = {at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1};
    bool there = true;
    for (int d = 0; d < 3; d++) {
      if (grid->cells->periodic[d]) next[d] = (next[d] + grid->count[d]) % grid->count[d];
      there = there && next[d] >= 0 && next[d] < grid->count[d];
    }
    if (there) most = fmax(most, largest_difference2(own, &block[block_at(grid, next)]));
  }
  return most;
}

static void place_of(const BlockGrid *grid, ptrdiff_t b, int32_t at[3])
{
  at[0] = (int32_t)(b % grid->count[0]);
  at[1] = (int32_t)(b / grid->count[0] % grid->count[1]);
  at[2] = (int32_t)(b / grid->count[0] / grid->count[1]);
}

CastStatus approach_bound(Approach *approach, const Cells *cells, double *const x[3], float *const before[3],
                          double *bound, CastError *err)
{
  BlockGrid grid = {.cells = cells};
  for (int d = 0; d < 3; d++) grid.count[d] = cells->count[d] > BLOCK ? cells->count[d] / BLOCK : 1;
  const ptrdiff_t n = (ptrdiff_t)grid.count[0] * grid.count[1] * grid.count[2];
  if (n > approach->capacity) {
    free(approach->block);
    approach->block = malloc((size_t)n * sizeof *approach->block);
    approach->capacity = approach->block ? n : 0;
    CAST_CHECK(approach->block, err, CAST_ERR_MEMORY, "neighbours: no memory for %td blocks", n);
  }
  double most = 0.0;
#pragma omp parallel
  {
    int32_t at[3];
#pragma omp for schedule(dynamic, 8)
    for (ptrdiff_t b = 0; b < n; b++) {
      place_of(&grid, b, at);
      approach->block[b] = block_ways(&grid, at, x, before);
    }
#pragma omp for reduction(max : most)
    for (ptrdiff_t b = 0; b < n; b++) {
      place_of(&grid, b, at);
      most = fmax(most, difference2_around(&grid, approach->block, at));
    }
  }
  *bound = sqrt(most);
  return CAST_OK;
}

void approach_free(Approach *approach)
{
  free(approach->block);
  *approach = (Approach){0};
}
