#include "cast/pour/gas.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cast/kernel/pair.h"
#include "common/vector.h"

static const double COVER = 1.1; // spacings round a particle that are melt
static const double MOST_CELLS = 2e8;

enum {
  CELL_VOID = 1,
  CELL_SEED = 2,
  CELL_MELT = 4,
  CELL_GAS = 8,
  CELL_NEAR = 16,
  CELL_LINK = 32
}; // LINK << axis: open

struct Gas {
  double low[3], cell; // m
  ptrdiff_t n[3], stride[3], cells;
  uint8_t *state;   // [cells]
  ptrdiff_t *stack; // [cells]
  int32_t *near;    // particles that feel it
  ptrdiff_t n_near, capacity;
};

/* ---- making ---- */

static void middle(const Gas *g, ptrdiff_t c, double x[3])
{
  const ptrdiff_t at[3] = {c % g->n[0], c / g->n[0] % g->n[1], c / g->n[0] / g->n[1]};
  for (int d = 0; d < 3; d++) x[d] = g->low[d] + ((double)at[d] + 0.5) * g->cell;
}

static ptrdiff_t classify(Gas *g, const GasConfig *config, const Surface *surface)
{
  ptrdiff_t seeds = 0;
#pragma omp parallel for schedule(dynamic, 1024) reduction(+ : seeds)
  for (ptrdiff_t c = 0; c < g->cells; c++) {
    double x[3];
    middle(g, c, x);
    if (surface && surface_inside_mould(surface, x)) continue;
    const bool seed = vec_in_box(config->corner, config->size, x);
    g->state[c] = (uint8_t)(CELL_VOID | (seed ? CELL_SEED : 0));
    seeds += seed;
  }
  return seeds;
}

/* Void cells with a common face, unless a wall thinner than a cell stands between their middles. */
static void link_cells(Gas *g, const Surface *surface)
{
#pragma omp parallel for schedule(dynamic, 1024)
  for (ptrdiff_t c = 0; c < g->cells; c++) {
    if (!(g->state[c] & CELL_VOID)) continue;
    double x[3], y[3];
    middle(g, c, x);
    const bool thin = surface && surface_thin_near(surface, x);
    for (int d = 0; d < 3; d++) {
      if (c / g->stride[d] % g->n[d] == g->n[d] - 1) continue;
      const ptrdiff_t other = c + g->stride[d];
      if (!(g->state[other] & CELL_VOID)) continue;
      middle(g, other, y);
      if (thin && surface_separates(surface, x, y)) continue;
      g->state[c] = (uint8_t)(g->state[c] | CELL_LINK << d);
    }
  }
}

CastStatus gas_create(const GasConfig *config, const Surface *surface, double spacing, const double low[3],
                      const double high[3], Gas **gas, CastError *err)
{
  Gas *g = *gas = calloc(1, sizeof *g);
  CAST_CHECK(g, err, CAST_ERR_MEMORY, "no memory for the gas");
  double cells = 1.0;
  g->cell = spacing;
  for (int d = 0; d < 3; d++) {
    g->low[d] = low[d];
    cells *= fmax(ceil((high[d] - low[d]) / spacing - 1e-6), 1.0);
    g->n[d] = cells < MOST_CELLS ? (ptrdiff_t)fmax(ceil((high[d] - low[d]) / spacing - 1e-6), 1.0) : 0;
    g->stride[d] = d == 0 ? 1 : g->stride[d - 1] * g->n[d - 1];
  }
  g->cells = g->stride[2] * g->n[2];
  CastStatus status = CAST_OK;
  if (cells >= MOST_CELLS)
    status =
        cast_error_set(err, CAST_ERR_INPUT, "forces.gas: cavity and box together are %g cells of the spacing", cells);
  g->state = status == CAST_OK ? calloc((size_t)g->cells, 1) : NULL;
  g->stack = status == CAST_OK ? malloc((size_t)g->cells * sizeof *g->stack) : NULL;
  if (status == CAST_OK && (!g->state || !g->stack))
    status = cast_error_set(err, CAST_ERR_MEMORY, "no memory for gas in %td cells", g->cells);
  if (status == CAST_OK && classify(g, config, surface) == 0)
    status = cast_error_set(err, CAST_ERR_INPUT, "forces.gas.from: there is nothing but mould in it");
  if (status == CAST_OK) link_cells(g, surface);
  if (status != CAST_OK) gas_destroy(gas);
  return status;
}

void gas_destroy(Gas **gas)
{
  if (!gas || !*gas) return;
  free((*gas)->state);
  free((*gas)->stack);
  free((*gas)->near);
  free(*gas);
  *gas = NULL;
}

/* ---- where it is ---- */

static void cover(Gas *g, const double x[3])
{
  ptrdiff_t first[3], last[3];
  for (int d = 0; d < 3; d++) {
    const double at = (x[d] - g->low[d]) / g->cell;
    first[d] = (ptrdiff_t)fmax(floor(at - 0.5 - COVER) + 1.0, 0.0);
    last[d] = (ptrdiff_t)fmin(floor(at - 0.5 + COVER), (double)g->n[d] - 1.0);
  }
  for (ptrdiff_t k = first[2]; k <= last[2]; k++)
    for (ptrdiff_t j = first[1]; j <= last[1]; j++)
      for (ptrdiff_t i = first[0]; i <= last[0]; i++) {
        const ptrdiff_t c = i + j * g->stride[1] + k * g->stride[2];
        double y[3], r2 = 0.0;
        middle(g, c, y);
        for (int d = 0; d < 3; d++) r2 += (x[d] - y[d]) * (x[d] - y[d]);
        if (r2 > COVER * COVER * g->cell * g->cell) continue;
#pragma omp atomic
        g->state[c] |= CELL_MELT;
      }
}

/* Cells reached through open faces from c, of those that lack the mark and none of `barred`; they get the mark and go
 * on the stack. */
static void spread(Gas *g, ptrdiff_t c, int mark, int barred, ptrdiff_t *top)
{
  for (int d = 0; d < 3; d++)
    for (int sign = -1; sign <= 1; sign += 2) {
      const ptrdiff_t at = c / g->stride[d] % g->n[d] + sign;
      if (at < 0 || at >= g->n[d]) continue;
      const ptrdiff_t other = c + sign * g->stride[d], lower = sign > 0 ? c : other;
      if (!(g->state[lower] & CELL_LINK << d) || g->state[other] & (mark | barred)) continue;
      g->state[other] = (uint8_t)(g->state[other] | mark);
      g->stack[(*top)++] = other;
    }
}

static void flood(Gas *g)
{
  ptrdiff_t top = 0;
  for (ptrdiff_t c = 0; c < g->cells; c++)
    if (g->state[c] & CELL_SEED && !(g->state[c] & CELL_MELT)) {
      g->state[c] |= CELL_GAS | CELL_NEAR;
      g->stack[top++] = c;
    }
  for (ptrdiff_t done = 0; done < top; done++) spread(g, g->stack[done], CELL_GAS | CELL_NEAR, CELL_MELT, &top);
  ptrdiff_t begun = 0; // then into the melt, one layer of cells after the other
  for (int round = 0; round < GAS_REACH; round++) {
    const ptrdiff_t end = top;
    for (; begun < end; begun++) spread(g, g->stack[begun], CELL_NEAR, 0, &top);
  }
}

static ptrdiff_t cell_of(const Gas *g, const double x[3])
{
  ptrdiff_t c = 0;
  for (int d = 0; d < 3; d++) {
    const double at = floor((x[d] - g->low[d]) / g->cell);
    if (!(at >= 0.0 && at < (double)g->n[d])) return -1;
    c += (ptrdiff_t)at * g->stride[d];
  }
  return c;
}

CastStatus gas_rebuild(Gas *g, const Particles *p, CastError *err)
{
  if (p->n_fluid > g->capacity) {
    free(g->near);
    g->capacity = p->n_fluid + p->n_fluid / 4;
    g->near = malloc((size_t)g->capacity * sizeof *g->near);
    if (!g->near) g->capacity = 0;
    CAST_CHECK(g->near, err, CAST_ERR_MEMORY, "no memory for gas on %td particles", p->n_fluid);
  }
#pragma omp parallel for
  for (ptrdiff_t c = 0; c < g->cells; c++) g->state[c] = (uint8_t)(g->state[c] & ~(CELL_MELT | CELL_GAS | CELL_NEAR));
#pragma omp parallel for
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) cover(g, (const double[3]){p->x[0][i], p->x[1][i], p->x[2][i]});
  flood(g);
  g->n_near = 0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const ptrdiff_t c = cell_of(g, (const double[3]){p->x[0][i], p->x[1][i], p->x[2][i]});
    if (c >= 0 && g->state[c] & CELL_NEAR) g->near[g->n_near++] = (int32_t)i;
  }
  return CAST_OK;
}

bool gas_is_at(const Gas *g, const double x[3])
{
  const ptrdiff_t c = cell_of(g, x);
  return c >= 0 && g->state[c] & CELL_GAS;
}

/* ---- what it does ---- */

/* sum_j V_j grad W_ij of one list. */
static void add_gradient(const SphParameters *sph, const Particles *p, const PairList *list, const double period[3],
                         ptrdiff_t i, double sum[3])
{
  const double scale = shape_norm(sph->kernel) / pow(sph->h, 5.0);
  for (ptrdiff_t k = list->start[i]; k < pair_list_end(list, i); k++) {
    const ptrdiff_t j = list->index[k];
    double way[3];
    const double r2 = particles_offset(p, i, j, period, way);
    const double F = scale * shape_slope(sph->kernel, sqrt(r2) / sph->h);
    for (int d = 0; d < 3; d++) sum[d] -= p->volume[j] * F * way[d];
  }
}

void gas_push(const Gas *g, const SphParameters *sph, const Neighbours *neighbours, double pressure, Particles *p)
{
  if (pressure == 0.0) return;
  const PairList *fluid = neighbours_fluid_fluid(neighbours), *wall = neighbours_fluid_wall(neighbours);
#pragma omp parallel for schedule(dynamic, 128)
  for (ptrdiff_t k = 0; k < g->n_near; k++) {
    const ptrdiff_t i = g->near[k];
    double sum[3] = {0.0, 0.0, 0.0};
    add_gradient(sph, p, fluid, neighbours_period(neighbours), i, sum);
    add_gradient(sph, p, wall, neighbours_period(neighbours), i, sum);
    for (int d = 0; d < 3; d++) p->a[d][i] += 2.0 * pressure / p->rho[i] * sum[d];
  }
}
