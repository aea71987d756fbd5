/* Neighbour lists: grid of cells, particles sorted by cell, then for each particle the points of the cells around it
 * tested against its distance (Verlet lists with a skin).
 * Lists are built by rows that threads take in contiguous shares, so a list does not depend on their number; the walls'
 * is the transpose of the fluid's. How long lists last: neighbours_due.c. */
#include "cast/particles/neighbours.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cast/particles/hiding.h"
#include "cast/particles/neighbours_private.h"
#include "cast/particles/pair_prune.h"

double neighbours_skin(double spacing)
{
  return 0.25 * spacing;
}

/* Melt moves faster past a wall than past melt nearby: walls have twice the skin. */
double neighbours_range(double reach, double skin)
{
  return reach + 2.0 * skin;
}

static CastStatus create(double reach, double skin, const Surface *surface, const double period[3], Neighbours **out,
                         CastError *err)
{
  *out = NULL;
  CAST_CHECK(reach > 0.0 && skin >= 0.0 && isfinite(reach + skin), err, CAST_ERR_ARGUMENT,
             "neighbours: reach %g m and skin %g m must be positive", reach, skin);
  const double range = neighbours_range(reach, skin);
  for (int d = 0; d < 3; d++)
    CAST_CHECK(period[d] == 0.0 || period[d] >= 2.5 * range, err, CAST_ERR_ARGUMENT,
               "neighbours: period %g m along axis %d is below 2.5 times the reach with skin, %g m", period[d], d,
               range);
  Neighbours *nb = calloc(1, sizeof *nb);
  CAST_CHECK(nb, err, CAST_ERR_MEMORY, "neighbours: no memory");
  nb->reach = reach;
  nb->most_skin = skin;
  nb->listed = nb->wanted = (Skins){skin, range - reach};
  nb->surface = surface;
  nb->n_wall = -1;
  memcpy(nb->period, period, sizeof nb->period);
  *out = nb;
  return CAST_OK;
}

CastStatus neighbours_create(double reach, double skin, const Surface *surface, Neighbours **neighbours, CastError *err)
{
  return create(reach, skin, surface, (const double[3]){0.0, 0.0, 0.0}, neighbours, err);
}

CastStatus neighbours_create_periodic(double reach, double skin, const double period[3], Neighbours **neighbours,
                                      CastError *err)
{
  return create(reach, skin, NULL, period, neighbours, err);
}

void neighbours_suit_skin(Neighbours *nb, double spacing, double step)
{
  nb->spacing = spacing;
  nb->step = step;
}

void neighbours_destroy(Neighbours **neighbours)
{
  if (!neighbours || !*neighbours) return;
  Neighbours *nb = *neighbours;
  cells_free(&nb->fluid_cells);
  cells_free(&nb->wall_cells);
  for (int d = 0; d < 3; d++) {
    free(nb->sorted_wall[d]);
    free(nb->built_at[d]);
  }
  free(nb->thin);
  pair_list_free(&nb->fluid_fluid);
  pair_list_free(&nb->fluid_wall);
  pair_list_free(&nb->wall_fluid);
  row_buffers_free(&nb->buffers);
  approach_free(&nb->approach);
  free(nb);
  *neighbours = NULL;
}

/* ---- sorting ---- */

static CastStatus check_positions(const Particles *p, CastError *err)
{
  ptrdiff_t bad = p->n_fluid;
#pragma omp parallel for simd reduction(min : bad)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const ptrdiff_t found = isfinite(p->x[0][i] + p->x[1][i] + p->x[2][i]) ? p->n_fluid : i;
    bad = found < bad ? found : bad;
  }
  CAST_CHECK(bad == p->n_fluid, err, CAST_ERR_NUMERIC, "particle %d: its position (%g, %g, %g) m is not finite",
             p->id[bad], p->x[0][bad], p->x[1][bad], p->x[2][bad]);
  return CAST_OK;
}

static CastStatus reserve_fluid(Neighbours *nb, ptrdiff_t n, CastError *err)
{
  nb->n_fluid = n;
  if (n <= nb->capacity) return CAST_OK;
  const size_t bytes = (size_t)n * sizeof(float);
  float **const room[] = {&nb->built_at[0], &nb->built_at[1], &nb->built_at[2]};
  bool ok = true;
  for (size_t r = 0; r < sizeof room / sizeof *room; r++) {
    free(*room[r]);
    *room[r] = malloc(bytes);
    ok = ok && *room[r];
  }
  free(nb->thin);
  nb->thin = malloc((size_t)n);
  nb->capacity = ok && nb->thin ? n : 0;
  CAST_CHECK(nb->capacity == n, err, CAST_ERR_MEMORY, "neighbours: no memory for %td particles", n);
  return CAST_OK;
}

static void wrap_positions(const Neighbours *nb, Particles *p)
{
  for (int d = 0; d < 3; d++) {
    const double period = nb->period[d];
    if (period <= 0.0) continue;
    for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
      p->x[d][i] -= period * floor(p->x[d][i] / period);
      if (p->x[d][i] >= period) p->x[d][i] = 0.0; // a tiny negative number rounds up to the period
    }
  }
}

/* Bring all fields of the fluid into the order of its cells. */
static void sort_fluid(Neighbours *nb, Particles *p)
{
  ParticleField field[PARTICLE_FIELDS];
  particles_fields(p, field);
  const ptrdiff_t n = p->n_fluid;
  const int32_t *order = nb->fluid_cells.order;
  // records are made anew before each sweep: until then there is room in them
  double *swap = (double *)(void *)p->record;
  int32_t *swap_id = (int32_t *)(void *)p->record;
#pragma omp parallel
  {
    for (int f = 0; f < PARTICLE_FIELDS; f++) {
      double *data = field[f].data;
#pragma omp for
      for (ptrdiff_t i = 0; i < n; i++) swap[i] = data[order[i]];
#pragma omp for
      for (ptrdiff_t i = 0; i < n; i++) data[i] = swap[i];
    }
#pragma omp for
    for (ptrdiff_t i = 0; i < n; i++) swap_id[i] = p->id[order[i]];
#pragma omp for
    for (ptrdiff_t i = 0; i < n; i++) p->id[i] = swap_id[i];
  }
}

static CastStatus sort_walls(Neighbours *nb, const Particles *p, CastError *err)
{
  const ptrdiff_t n = p->n - p->n_fluid;
  if (nb->n_wall == n) return CAST_OK; // walls never move
  double *const x[3] = {p->x[0] + p->n_fluid, p->x[1] + p->n_fluid, p->x[2] + p->n_fluid};
  CAST_CALL(cells_sort(&nb->wall_cells, n, x, neighbours_range(nb->reach, nb->most_skin), nb->period, err));
  for (int d = 0; d < 3; d++) {
    free(nb->sorted_wall[d]);
    nb->sorted_wall[d] = malloc((size_t)(n > 0 ? n : 1) * sizeof(double));
    CAST_CHECK(nb->sorted_wall[d], err, CAST_ERR_MEMORY, "neighbours: no memory for %td wall particles", n);
    for (ptrdiff_t k = 0; k < n; k++) nb->sorted_wall[d][k] = x[d][nb->wall_cells.order[k]];
  }
  nb->n_wall = n;
  return CAST_OK;
}

/* ---- rows ---- */

static void find_thin(Neighbours *nb, const Particles *p)
{
  memset(nb->thin, 0, (size_t)nb->n_fluid);
  if (!nb->surface) return;
#pragma omp parallel for
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const double x[3] = {p->x[0][i], p->x[1][i], p->x[2][i]};
    nb->thin[i] = surface_thin_near(nb->surface, x);
  }
}

typedef enum RowKind { FLUID_FLUID, FLUID_WALL } RowKind;

typedef struct RowContext {
  const Neighbours *nb;
  const Particles *p;
  RowKind kind;
  SortedPoints points; // to look among
} RowContext;

/* Drop the particle itself from its row; returns the new length. */
static ptrdiff_t drop_self(ptrdiff_t row, ptrdiff_t n, int32_t *index)
{
  ptrdiff_t at = 0;
  while (at < n && index[at] != row) at++;
  if (at == n) return n; // its cell has moved on by rounding: it was not among the candidates
  memmove(index + at, index + at + 1, (size_t)(n - at - 1) * sizeof *index);
  return n - 1;
}

static bool fill_row(const void *context, ptrdiff_t row, RowBuffer *buffer)
{
  const RowContext *c = context;
  const Neighbours *nb = c->nb;
  const double x[3] = {c->p->x[0][row], c->p->x[1][row], c->p->x[2][row]};
  const double reach = nb->reach + (c->kind == FLUID_FLUID ? nb->listed.fluid : nb->listed.wall);
  vicinity_move_to(&buffer->vicinity, &c->points, x);
  if (!row_buffer_reserve(buffer, buffer->vicinity.room)) return false;
  int32_t *index = buffer->index + buffer->n;
  ptrdiff_t n = vicinity_select(&buffer->vicinity, &c->points, x, reach * reach, index);
  if (c->kind == FLUID_FLUID) n = drop_self(row, n, index);
  if (nb->surface && nb->thin[row]) {
    const Hiding hiding = {nb->surface, nb->thin, c->p, nb->reach + nb->listed.wall};
    n = c->kind == FLUID_FLUID ? hiding_drop_fluid(&hiding, row, n, index) : hiding_drop_walls(&hiding, row, n, index);
  }
  buffer->n += n;
  return true;
}

/* Tell apart in all rows what may lie within reach soon from what may later. */
static CastStatus split_rows(Neighbours *nb, Particles *p, CastError *err)
{
  neighbours_remember_positions(nb, p);
  nb->near = (Skins){fmin(nb->wanted.fluid, nb->listed.fluid - nb->used.fluid),
                     fmin(nb->wanted.wall, nb->listed.wall - nb->used.wall)};
  if (!(nb->near.fluid < nb->listed.fluid || nb->near.wall < nb->listed.wall)) return CAST_OK;
  // records are made anew before each sweep: until then there is room in them
  const PrunePlaces places = prune_places(p, nb->reach, nb->period, (PrunePlace *)(void *)p->record);
  const double fluid = nb->reach * (1.0 + 1e-6) + nb->near.fluid, wall = nb->reach * (1.0 + 1e-6) + nb->near.wall;
  CAST_CALL(pair_list_prune(&nb->fluid_fluid, &places, 0, fluid, &nb->buffers, err));
  CAST_CALL(pair_list_prune(&nb->fluid_wall, &places, 0, wall, &nb->buffers, err));
  return pair_list_prune(&nb->wall_fluid, &places, p->n_fluid, wall, &nb->buffers, err);
}

static CastStatus build(Neighbours *nb, Particles *p, CastError *err)
{
  CAST_CALL(check_positions(p, err));
  CAST_CALL(reserve_fluid(nb, p->n_fluid, err));
  CAST_CALL(sort_walls(nb, p, err));
  neighbours_choose_skins(nb, p);
  wrap_positions(nb, p);
  CAST_CALL(cells_sort(&nb->fluid_cells, p->n_fluid, p->x, nb->reach + nb->listed.fluid, nb->period, err));
  sort_fluid(nb, p);
  find_thin(nb, p);
  const RowContext melt = {nb, p, FLUID_FLUID, {&nb->fluid_cells, p->x, NULL, 0}};
  const RowContext wall = {
      nb, p, FLUID_WALL, {&nb->wall_cells, nb->sorted_wall, nb->wall_cells.order, (int32_t)p->n_fluid}};
  CAST_CALL(pair_list_build(&nb->fluid_fluid, p->n_fluid, fill_row, &melt, &nb->buffers, err));
  CAST_CALL(pair_list_build(&nb->fluid_wall, p->n_fluid, fill_row, &wall, &nb->buffers, err));
  CAST_CALL(pair_list_transpose(&nb->fluid_wall, (int32_t)p->n_fluid, p->n - p->n_fluid, &nb->wall_fluid, err));
  nb->used = (Skins){0.0, 0.0};
  nb->builds++;
  return split_rows(nb, p, err);
}

CastStatus neighbours_update(Neighbours *nb, Particles *particles, bool force, bool *rebuilt, CastError *err)
{
  Due due;
  CAST_CALL(neighbours_find_due(nb, particles, &due, err));
  if (force) due = LISTS_DUE;
  if (rebuilt) *rebuilt = due == LISTS_DUE;
  if (due == ROWS_DUE) return split_rows(nb, particles, err);
  return due == LISTS_DUE ? build(nb, particles, err) : CAST_OK;
}

const PairList *neighbours_fluid_fluid(const Neighbours *nb)
{
  return &nb->fluid_fluid;
}

const PairList *neighbours_fluid_wall(const Neighbours *nb)
{
  return &nb->fluid_wall;
}

const PairList *neighbours_wall_fluid(const Neighbours *nb)
{
  return &nb->wall_fluid;
}

const double *neighbours_period(const Neighbours *nb)
{
  return nb->period;
}

long neighbours_builds(const Neighbours *nb)
{
  return nb->builds;
}
