/* Neighbour lists: grid of cells, particles sorted by cell, then for each particle the points of the cells around it
 * tested against its distance (Verlet lists with a skin).
 * Lists are built by rows that threads take in contiguous shares, so a list does not depend on their number; the walls'
 * is the transpose of the fluid's. */
#include "cast/particles/neighbours.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cast/geometry/sight.h"
#include "cast/particles/approach.h"
#include "cast/particles/cells.h"
#include "cast/particles/pair_list.h"
#include "cast/particles/vicinity.h"

struct Neighbours {
  double reach, skin, wall_skin; // m; skin: between fluid particles
  double most_skin;              // m
  double spacing, step;          // m, s; step 0: the skin stays as it is
  const Surface *surface;
  double period[3];
  Cells fluid_cells, wall_cells;
  double *sorted_wall[3]; // [n_wall] positions in the order of wall_cells
  ptrdiff_t n_wall;       // -1: walls not sorted yet
  float *built_at[3];     // [n_fluid] positions when the lists were built
  double rounding;        // m, at most so far are these from the positions
  uint8_t *thin;          // [n_fluid] a thin mould wall is near
  ptrdiff_t n_fluid, capacity;
  PairList fluid_fluid, fluid_wall, wall_fluid;
  RowBuffers buffers;
  Approach approach;
  long builds;
};

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
  nb->skin = skin;
  nb->wall_skin = range - reach;
  nb->most_skin = skin;
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

/* ---- is a rebuild due? ---- */

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

static double longest_way(const Neighbours *nb, const Particles *p)
{
  double longest2 = 0.0;
#pragma omp parallel for simd reduction(max : longest2)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const double dx = p->x[0][i] - (double)nb->built_at[0][i], dy = p->x[1][i] - (double)nb->built_at[1][i],
                 dz = p->x[2][i] - (double)nb->built_at[2][i], way2 = dx * dx + dy * dy + dz * dz;
    longest2 = way2 > longest2 ? way2 : longest2;
  }
  return sqrt(longest2);
}

/* Lists hold while no pair that they lack can have come within reach. Walls stand still. */
static CastStatus find_due(Neighbours *nb, const Particles *p, bool *due, CastError *err)
{
  *due = nb->builds == 0 || nb->n_fluid != p->n_fluid;
  if (*due) return CAST_OK;
  const double longest = longest_way(nb, p) + nb->rounding;
  *due = !(longest <= nb->wall_skin && longest <= 0.5 * nb->reach); // beyond: particles of distant blocks might meet
  if (*due || longest <= 0.5 * nb->skin) return CAST_OK;
  double nearer;
  CAST_CALL(approach_bound(&nb->approach, &nb->fluid_cells, p->x, nb->built_at, &nearer, err));
  *due = nearer + 2.0 * nb->rounding > nb->skin;
  return CAST_OK;
}

/* ---- the skin ---- */

/* Sums over pairs cost about A (1 + skin/reach)^3 a step, lists B for each build, that is B way/skin a step where
 * particles move by `way`: least for skin^2 near B reach/(3 A (1 + skin/reach)^2) way. Measured, B/A is 2 to 3 and
 * neighbours come nearer by 0.7 of the fastest particle's way (docs/performance). */
static void choose_skin(Neighbours *nb, const Particles *p)
{
  if (!(nb->step > 0.0)) return;
  double v2 = 0.0;
#pragma omp parallel for simd reduction(max : v2)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const double v2_i = p->v[0][i] * p->v[0][i] + p->v[1][i] * p->v[1][i] + p->v[2][i] * p->v[2][i];
    v2 = v2_i > v2 ? v2_i : v2;
  }
  const double way = sqrt(v2) * nb->step / nb->spacing, best = 1.2 * sqrt(way), least = 0.08;
  nb->skin = fmin((best > least ? best : least) * nb->spacing, nb->most_skin);
  nb->wall_skin = neighbours_range(nb->reach, nb->skin) - nb->reach;
}

/* ---- sorting ---- */

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

/* ---- pairs that the mould keeps apart ---- */

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

/* A particle that is known to be clear of the mould: quick answers hold for it. */
static bool is_clear(const Particles *p, ptrdiff_t i)
{
  return p->clearance[i] > 0.0;
}

/* sight (may be NULL): from particle i. Always asked with the lower index first, so that both particles of a pair hear
 * the same. */
static bool fluid_separated(const Neighbours *nb, const Particles *p, const Sight *sight, ptrdiff_t i, ptrdiff_t j)
{
  if (!nb->thin[i] || !nb->thin[j]) return false;
  const double y[3] = {p->x[0][j], p->x[1][j], p->x[2][j]};
  if (sight && is_clear(p, j) && sight_is_free(sight, y)) return false;
  const ptrdiff_t a = i < j ? i : j, b = i < j ? j : i;
  const double xa[3] = {p->x[0][a], p->x[1][a], p->x[2][a]}, xb[3] = {p->x[0][b], p->x[1][b], p->x[2][b]};
  return surface_separates(nb->surface, xa, xb);
}

static bool wall_separated(const Neighbours *nb, const Particles *p, const Sight *sight, ptrdiff_t i, ptrdiff_t j)
{
  if (!nb->thin[i]) return false;
  const ptrdiff_t k = j - p->n_fluid;
  const double x[3] = {p->x[0][i], p->x[1][i], p->x[2][i]}, place[3] = {p->x[0][j], p->x[1][j], p->x[2][j]};
  const double foot[3] = {p->foot[0][k], p->foot[1][k], p->foot[2][k]};
  const double normal[3] = {p->normal[0][k], p->normal[1][k], p->normal[2][k]};
  if (sight && p->echo[k] && sight_enters_nothing(sight, place)) return true;
  if (sight && !p->echo[k] && sight_meets_wall(sight, place, normal)) return false;
  return !walls_seen(nb->surface, x, place, foot, normal, p->echo[k]);
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

/* Drop from a row what the mould hides from the particle; returns the new length. */
static ptrdiff_t drop_hidden(const RowContext *c, ptrdiff_t row, ptrdiff_t n, int32_t *index)
{
  const double x[3] = {c->p->x[0][row], c->p->x[1][row], c->p->x[2][row]};
  Sight around, *sight = n > 0 && is_clear(c->p, row) ? &around : NULL;
  if (sight) sight_from(c->nb->surface, x, c->nb->reach + c->nb->wall_skin, sight);
  ptrdiff_t kept = 0;
  for (ptrdiff_t k = 0; k < n; k++) {
    const int32_t j = index[k];
    const bool hidden = c->kind == FLUID_FLUID ? fluid_separated(c->nb, c->p, sight, row, j)
                                               : wall_separated(c->nb, c->p, sight, row, j);
    index[kept] = j;
    kept += !hidden;
  }
  return kept;
}

static bool fill_row(const void *context, ptrdiff_t row, RowBuffer *buffer)
{
  const RowContext *c = context;
  const Neighbours *nb = c->nb;
  const double x[3] = {c->p->x[0][row], c->p->x[1][row], c->p->x[2][row]};
  const double reach = nb->reach + (c->kind == FLUID_FLUID ? nb->skin : nb->wall_skin);
  vicinity_move_to(&buffer->vicinity, &c->points, x);
  if (!row_buffer_reserve(buffer, buffer->vicinity.room)) return false;
  int32_t *index = buffer->index + buffer->n;
  ptrdiff_t n = vicinity_select(&buffer->vicinity, &c->points, x, reach * reach, index);
  if (c->kind == FLUID_FLUID) n = drop_self(row, n, index);
  if (nb->surface && nb->thin[row]) n = drop_hidden(c, row, n, index);
  buffer->n += n;
  return true;
}

/* In single precision: whether lists hold is a question of a tenth of a spacing. */
static void remember_positions(Neighbours *nb, const Particles *p)
{
  const Cells *c = &nb->fluid_cells;
  double far = 0.0;
  for (int d = 0; d < 3; d++) {
    far = fmax(far, fmax(fabs(c->low[d]), fabs(c->low[d] + c->size[d] * c->count[d])));
#pragma omp parallel for simd
    for (ptrdiff_t i = 0; i < p->n_fluid; i++) nb->built_at[d][i] = (float)p->x[d][i];
  }
  nb->rounding = sqrt(3.0) * 0.5 * (double)FLT_EPSILON * far;
}

static CastStatus build(Neighbours *nb, Particles *p, CastError *err)
{
  CAST_CALL(check_positions(p, err));
  CAST_CALL(reserve_fluid(nb, p->n_fluid, err));
  CAST_CALL(sort_walls(nb, p, err));
  choose_skin(nb, p);
  wrap_positions(nb, p);
  CAST_CALL(cells_sort(&nb->fluid_cells, p->n_fluid, p->x, nb->reach + nb->skin, nb->period, err));
  sort_fluid(nb, p);
  find_thin(nb, p);
  const RowContext melt = {nb, p, FLUID_FLUID, {&nb->fluid_cells, p->x, NULL, 0}};
  const RowContext wall = {
      nb, p, FLUID_WALL, {&nb->wall_cells, nb->sorted_wall, nb->wall_cells.order, (int32_t)p->n_fluid}};
  CAST_CALL(pair_list_build(&nb->fluid_fluid, p->n_fluid, fill_row, &melt, &nb->buffers, err));
  CAST_CALL(pair_list_build(&nb->fluid_wall, p->n_fluid, fill_row, &wall, &nb->buffers, err));
  CAST_CALL(pair_list_transpose(&nb->fluid_wall, (int32_t)p->n_fluid, p->n - p->n_fluid, &nb->wall_fluid, err));
  remember_positions(nb, p);
  nb->builds++;
  return CAST_OK;
}

CastStatus neighbours_update(Neighbours *nb, Particles *particles, bool force, bool *rebuilt, CastError *err)
{
  bool due;
  CAST_CALL(find_due(nb, particles, &due, err));
  due = due || force;
  if (rebuilt) *rebuilt = due;
  return due ? build(nb, particles, err) : CAST_OK;
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
