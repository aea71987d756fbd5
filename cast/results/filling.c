#include "cast/results/filling.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const double filling_levels[FILLING_LEVELS] = {0.5, 0.9, 0.99};

static const double COVER = 0.9;         // of a cell's edge
static const double MOST_CELLS = 32.0e6; // of the box that holds the cavity; beyond it cells are made larger

struct Filling {
  CavityCells cells;
  double low[3], cell; // m
  ptrdiff_t count[3];
  int32_t *at;     // [count] cavity cell there; -1: none
  uint8_t *filled; // [cells.n]
  size_t n_boxes;
  FeatureBox *box;                   // [n_boxes]
  uint8_t *in_box;                   // [n_boxes][cells.n]
  uint8_t *in_part;                  // [cells.n]
  bool has_part;                     // it is not the whole cavity
  double *volume, *fraction;         // [n_features + 1], the last for the part
  double (*reached)[FILLING_LEVELS]; // [n_features + 1] s
};

static void measure_grid(Filling *f, const double origin[3])
{
  for (int d = 0; d < 3; d++) {
    double low = INFINITY, high = -INFINITY;
    for (ptrdiff_t i = 0; i < f->cells.n; i++) {
      low = fmin(low, f->cells.x[d][i]);
      high = fmax(high, f->cells.x[d][i]);
    }
    const double first = floor((low - origin[d]) / f->cell), last = floor((high - origin[d]) / f->cell);
    f->low[d] = origin[d] + first * f->cell;
    f->count[d] = (ptrdiff_t)(last - first) + 1;
  }
}

static ptrdiff_t index_along(const Filling *f, int d, double x)
{
  return (ptrdiff_t)floor((x - f->low[d]) / f->cell);
}

static ptrdiff_t place_of(const Filling *f, const ptrdiff_t k[3])
{
  return (k[2] * f->count[1] + k[1]) * f->count[0] + k[0];
}

static void locate(const Filling *f, ptrdiff_t cell, ptrdiff_t k[3])
{
  for (int d = 0; d < 3; d++) {
    const ptrdiff_t at = index_along(f, d, f->cells.x[d][cell]);
    k[d] = at < 0 ? 0 : at >= f->count[d] ? f->count[d] - 1 : at;
  }
}

static CastStatus sort_cells(Filling *f, CastError *err)
{
  const size_t n = (size_t)(f->count[0] * f->count[1] * f->count[2]);
  f->at = malloc(n * sizeof *f->at + 1);
  f->filled = calloc((size_t)f->cells.n + 1, 1);
  f->in_part = malloc((size_t)f->cells.n + 1);
  CAST_CHECK(f->at && f->filled && f->in_part, err, CAST_ERR_MEMORY, "no memory for the cavity's %td cells",
             f->cells.n);
  for (size_t k = 0; k < n; k++) f->at[k] = -1;
  memset(f->in_part, 1, (size_t)f->cells.n + 1);
  for (ptrdiff_t i = 0; i < f->cells.n; i++) {
    ptrdiff_t k[3];
    locate(f, i, k);
    f->at[place_of(f, k)] = (int32_t)i;
  }
  return CAST_OK;
}

/* Room for the numbers of each feature and the part; volumes from the cells. */
static CastStatus measure_features(Filling *f, CastError *err)
{
  const size_t features = filling_n_features(f) + 1;
  free(f->volume);
  free(f->fraction);
  free(f->reached);
  f->volume = calloc(features, sizeof *f->volume);
  f->fraction = calloc(features, sizeof *f->fraction);
  f->reached = calloc(features, sizeof *f->reached);
  CAST_CHECK(f->volume && f->fraction && f->reached, err, CAST_ERR_MEMORY, "no memory for %zu features", features);
  for (ptrdiff_t i = 0; i < f->cells.n; i++)
    for (size_t s = 0; s < features; s++)
      if (filling_cell_is_in(f, i, s)) f->volume[s] += f->cells.volume[i];
  for (size_t s = 0; s < features; s++)
    for (int l = 0; l < FILLING_LEVELS; l++) f->reached[s][l] = NAN;
  return CAST_OK;
}

CastStatus filling_create(const Surface *surface, const RomData *rom, double spacing, const double origin[3],
                          Filling **filling, CastError *err)
{
  Filling *made = *filling = calloc(1, sizeof *made);
  CAST_CHECK(made, err, CAST_ERR_MEMORY, "no memory for the filling");
  double low[3], high[3];
  surface_bounds(surface, low, high);
  const double box = (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
  made->cell = fmax(spacing, cbrt(box / MOST_CELLS));
  CastStatus status = cavity_cells_create(surface, rom, made->cell, origin, &made->cells, err);
  if (status == CAST_OK && made->cells.n > 0) measure_grid(made, origin);
  if (status == CAST_OK) status = sort_cells(made, err);
  if (status == CAST_OK) status = measure_features(made, err);
  if (status != CAST_OK) filling_destroy(filling);
  return status;
}

void filling_destroy(Filling **filling)
{
  if (!filling || !*filling) return;
  Filling *f = *filling;
  cavity_cells_destroy(&f->cells);
  free(f->at);
  free(f->filled);
  free(f->volume);
  free(f->fraction);
  free(f->reached);
  free(f->in_part);
  free(f->in_box);
  free(f->box);
  free(f);
  *filling = NULL;
}

static size_t find_feature(const Filling *f, const char *name)
{
  size_t s = 0;
  while (s < filling_n_features(f) && strcmp(filling_name(f, s), name) != 0) s++;
  return s;
}

static CastStatus fill_box(Filling *f, size_t b, CastError *err)
{
  const FeatureBox *box = &f->box[b];
  uint8_t *inside = f->in_box + b * (size_t)f->cells.n;
  ptrdiff_t found = 0;
  for (ptrdiff_t i = 0; i < f->cells.n; i++) {
    inside[i] = 1;
    for (int d = 0; d < 3; d++)
      if (f->cells.x[d][i] < box->low[d] || f->cells.x[d][i] > box->high[d]) inside[i] = 0;
    found += inside[i];
  }
  CAST_CHECK(found > 0, err, CAST_ERR_INPUT, "features: '%s' holds nothing of the mould's cavity", box->name);
  return CAST_OK;
}

CastStatus filling_add_boxes(Filling *f, size_t n, const FeatureBox *box, CastError *err)
{
  if (n == 0) return CAST_OK;
  for (size_t b = 0; b < n; b++)
    CAST_CHECK(find_feature(f, box[b].name) == filling_n_features(f), err, CAST_ERR_INPUT,
               "features: '%s' is a surface of the mould's cavity; take another name", box[b].name);
  f->box = malloc(n * sizeof *f->box);
  f->in_box = malloc(n * (size_t)f->cells.n + 1);
  CAST_CHECK(f->box && f->in_box, err, CAST_ERR_MEMORY, "no memory for %zu features", n);
  memcpy(f->box, box, n * sizeof *box);
  f->n_boxes = n;
  for (size_t b = 0; b < n; b++) CAST_CALL(fill_box(f, b, err));
  return measure_features(f, err);
}

CastStatus filling_set_part(Filling *f, size_t n, char (*names)[ROM_NAME_LENGTH], CastError *err)
{
  if (n == 0) return CAST_OK;
  const size_t features = filling_n_features(f);
  memset(f->in_part, 0, (size_t)f->cells.n + 1);
  f->has_part = true;
  for (size_t i = 0; i < n; i++) {
    const size_t s = find_feature(f, names[i]);
    char known[256] = "";
    for (size_t k = 0, used = 0; k < features && used < sizeof known; k++)
      used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", k ? ", " : "", filling_name(f, k));
    CAST_CHECK(s < features, err, CAST_ERR_INPUT, "part: the mould's cavity has no surface '%s'; it has %s", names[i],
               known);
    for (ptrdiff_t c = 0; c < f->cells.n; c++) f->in_part[c] |= filling_cell_is_in(f, c, s);
  }
  return measure_features(f, err);
}

/* Mark the cells around a particle that it covers. Threads may write the same byte: it is the same value. */
static void cover(Filling *f, const double x[3])
{
  ptrdiff_t first[3], last[3];
  for (int d = 0; d < 3; d++) {
    const ptrdiff_t k = index_along(f, d, x[d]);
    first[d] = k - 1 < 0 ? 0 : k - 1;
    last[d] = k + 1 >= f->count[d] ? f->count[d] - 1 : k + 1;
  }
  const double reach2 = COVER * COVER * f->cell * f->cell;
  for (ptrdiff_t c = first[2]; c <= last[2]; c++)
    for (ptrdiff_t b = first[1]; b <= last[1]; b++)
      for (ptrdiff_t a = first[0]; a <= last[0]; a++) {
        const int32_t i = f->at[(c * f->count[1] + b) * f->count[0] + a];
        if (i < 0) continue;
        const double dx = f->cells.x[0][i] - x[0], dy = f->cells.x[1][i] - x[1], dz = f->cells.x[2][i] - x[2];
        if (dx * dx + dy * dy + dz * dz > reach2) continue;
#pragma omp atomic write
        f->filled[i] = 1;
      }
}

void filling_update(Filling *f, const Particles *p, double time)
{
  if (f->cells.n == 0) return;
  memset(f->filled, 0, (size_t)f->cells.n);
#pragma omp parallel for
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) cover(f, (const double[3]){p->x[0][i], p->x[1][i], p->x[2][i]});
  const size_t features = filling_n_features(f) + 1;
  for (size_t s = 0; s < features; s++) f->fraction[s] = 0.0;
  for (ptrdiff_t i = 0; i < f->cells.n; i++) {
    if (!f->filled[i]) continue;
    f->fraction[f->cells.surface[i]] += f->cells.volume[i];
    for (size_t s = f->cells.n_surfaces; s < features; s++)
      if (filling_cell_is_in(f, i, s)) f->fraction[s] += f->cells.volume[i];
  }
  for (size_t s = 0; s < features; s++) {
    f->fraction[s] = f->volume[s] > 0.0 ? f->fraction[s] / f->volume[s] : 0.0;
    for (int l = 0; l < FILLING_LEVELS; l++)
      if (isnan(f->reached[s][l]) && f->fraction[s] >= filling_levels[l]) f->reached[s][l] = time;
  }
}

size_t filling_n_features(const Filling *filling)
{
  return filling->cells.n_surfaces + filling->n_boxes;
}

size_t filling_n_surfaces(const Filling *filling)
{
  return filling->cells.n_surfaces;
}

const char *filling_name(const Filling *filling, size_t feature)
{
  const size_t surfaces = filling->cells.n_surfaces;
  if (feature < surfaces) return filling->cells.names[feature];
  if (feature < surfaces + filling->n_boxes) return filling->box[feature - surfaces].name;
  return filling->has_part ? "part" : "whole cavity";
}

const CavityCells *filling_cells(const Filling *filling)
{
  return &filling->cells;
}

bool filling_cell_is_filled(const Filling *filling, ptrdiff_t cell)
{
  return filling->filled[cell];
}

bool filling_cell_is_in(const Filling *f, ptrdiff_t cell, size_t feature)
{
  const size_t surfaces = f->cells.n_surfaces;
  if (feature < surfaces) return f->cells.surface[cell] == (int32_t)feature;
  if (feature < surfaces + f->n_boxes) return f->in_box[(feature - surfaces) * (size_t)f->cells.n + (size_t)cell];
  return f->in_part[cell];
}

ptrdiff_t filling_cell_of(const Filling *f, const double x[3])
{
  ptrdiff_t k[3];
  for (int d = 0; d < 3; d++) {
    if (f->cells.n == 0 || !isfinite(x[d]) || fabs(x[d] - f->low[d]) > 1e6 * f->cell) return -1;
    k[d] = index_along(f, d, x[d]);
    if (k[d] < 0 || k[d] >= f->count[d]) return -1;
  }
  return f->at[place_of(f, k)];
}

ptrdiff_t filling_neighbour(const Filling *f, ptrdiff_t cell, const int step[3])
{
  ptrdiff_t k[3];
  locate(f, cell, k);
  for (int d = 0; d < 3; d++) {
    k[d] += step[d];
    if (k[d] < 0 || k[d] >= f->count[d]) return -1;
  }
  return f->at[place_of(f, k)];
}

double filling_volume(const Filling *filling, size_t feature)
{
  return filling->volume[feature];
}

double filling_fraction(const Filling *filling, size_t feature)
{
  return filling->fraction[feature];
}

double filling_time(const Filling *filling, size_t feature, int level)
{
  return filling->reached[feature][level];
}

size_t filling_state_size(const Filling *filling)
{
  return (filling_n_features(filling) + 1) * FILLING_LEVELS;
}

void filling_save(const Filling *filling, double *state)
{
  memcpy(state, filling->reached, filling_state_size(filling) * sizeof *state);
}

void filling_restore(Filling *filling, const double *state)
{
  memcpy(filling->reached, state, filling_state_size(filling) * sizeof *state);
}
