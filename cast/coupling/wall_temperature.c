/* Temperatures of wall particles from the reduced basis.
 *
 * The basis is linear in each tetrahedron, so a wall particle's temperature is that of four points of the mesh. Either
 * those points' temperatures are computed and interpolated, or the basis is interpolated once, one row for each wall
 * particle: whichever are fewer. A step then costs 2 r operations for each row that melt is near to; rows are stored
 * as in the file, in float: a rise of 300 K is then known to 2e-5 K, and no heat is counted with it. */
#include "cast/coupling/wall_temperature.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cast/kernel/dispatch.h"
#include "cast/mould/band.h"

enum { WALK = 8 };

typedef struct Blend { // temperature = sum weight T[row]
  int32_t row[4];
  double weight[4];
} Blend;

struct WallTemperature {
  size_t r;
  ptrdiff_t n_wall, n_rows;
  Blend *blend;         // [n_wall]
  float *basis;         // [n_rows*r] K/sqrt(J K)
  double *row_rise;     // [n_rows] K above preheat
  double *temperature;  // [n_wall] K
  double *depth;        // [n_wall] m
  uint8_t *row_in_use;  // [n_rows]
  uint8_t *wall_in_use; // [n_wall]
  int32_t *instead;     // [n_wall] the patch whose temperature is taken, -1: none
};

/* ---- where ---- */

/* A wall particle's own place or, where the band does not reach that far (an echo, whose place is not in the mould; a
 * coarse spacing), the deepest of WALK steps back to its foot. The pair formula takes the true depth. */
static bool locate(const Band *band, const Particles *p, ptrdiff_t k, double spacing, BandPlace *place, double *depth)
{
  const ptrdiff_t j = p->n_fluid + k;
  const double start = p->echo[k] ? fmin(1.0, 0.5 * spacing / fmax(p->depth[k], 1e-300)) : 1.0;
  for (int step = 0; step <= WALK; step++) {
    // at the foot itself rounding may put the point outside: a millionth of the spacing inwards will do
    const double share = fmax(start * (double)(WALK - step) / WALK, 1e-6 * spacing / fmax(p->depth[k], spacing));
    double x[3];
    for (int d = 0; d < 3; d++) x[d] = p->foot[d][k] + share * (p->x[d][j] - p->foot[d][k]);
    if (!band_locate(band, x, place)) continue;
    *depth = share * p->depth[k];
    return true;
  }
  return false;
}

static CastStatus locate_all(WallTemperature *w, const RomData *rom, const Particles *p, double spacing,
                             BandPlace *places, CastError *err)
{
  Band *band;
  CAST_CALL(band_create(rom, &band, err));
  ptrdiff_t lost = w->n_wall;
#pragma omp parallel for schedule(dynamic, 64) reduction(min : lost)
  for (ptrdiff_t k = 0; k < w->n_wall; k++) {
    w->instead[k] = -1;
    if (locate(band, p, k, spacing, &places[k], &w->depth[k])) continue;
    // the rim may lie beyond the band, which follows the cavity: it has its patch's temperature, at its surface
    if (rom->patch[p->patch[k]].outer)
      w->instead[k] = p->patch[k];
    else
      lost = k < lost ? k : lost;
    places[k] = (BandPlace){.weight = {1.0}};
    w->depth[k] = 0.0;
  }
  band_destroy(&band);
  if (lost == w->n_wall) return CAST_OK;
  return cast_error_set(err, CAST_ERR_INPUT,
                        "wall particle at (%g, %g, %g) m: neither it nor its foot on the wall (%g, %g, %g) m lies in "
                        "the band of tetrahedra that the ROM holds (%g m deep)",
                        p->x[0][p->n_fluid + lost], p->x[1][p->n_fluid + lost], p->x[2][p->n_fluid + lost],
                        p->foot[0][lost], p->foot[1][lost], p->foot[2][lost], rom->band);
}

/* ---- rows ---- */

static CastStatus rows_of_points(WallTemperature *w, const RomData *rom, const BandPlace *places,
                                 const int32_t *row_of_point, CastError *err)
{
  w->basis = malloc((size_t)w->n_rows * w->r * sizeof *w->basis);
  CAST_CHECK(w->basis, err, CAST_ERR_MEMORY, "coupling: no memory for the basis at %td points", w->n_rows);
  for (size_t point = 0; point < rom->n_points; point++)
    if (row_of_point[point] >= 0)
      memcpy(w->basis + (size_t)row_of_point[point] * w->r, rom->basis + point * w->r, w->r * sizeof *w->basis);
  for (ptrdiff_t k = 0; k < w->n_wall; k++)
    for (int c = 0; c < 4; c++) {
      w->blend[k].row[c] = row_of_point[places[k].point[c]];
      w->blend[k].weight[c] = places[k].weight[c];
    }
  return CAST_OK;
}

static CastStatus rows_of_walls(WallTemperature *w, const RomData *rom, const BandPlace *places, CastError *err)
{
  w->n_rows = w->n_wall;
  w->basis = malloc((size_t)w->n_rows * w->r * sizeof *w->basis);
  CAST_CHECK(w->basis, err, CAST_ERR_MEMORY, "coupling: no memory for the basis at %td wall particles", w->n_rows);
#pragma omp parallel for schedule(static)
  for (ptrdiff_t k = 0; k < w->n_wall; k++) {
    const BandPlace *at = &places[k];
    for (size_t s = 0; s < w->r; s++) {
      double sum = 0.0;
      for (int c = 0; c < 4; c++) sum += at->weight[c] * (double)rom->basis[(size_t)at->point[c] * w->r + s];
      w->basis[(size_t)k * w->r + s] = (float)sum;
    }
    w->blend[k] = (Blend){.row = {(int32_t)k, (int32_t)k, (int32_t)k, (int32_t)k}, .weight = {1.0, 0.0, 0.0, 0.0}};
  }
  return CAST_OK;
}

static CastStatus make_rows(WallTemperature *w, const RomData *rom, const BandPlace *places, CastError *err)
{
  int32_t *row_of_point = malloc((rom->n_points + 1) * sizeof *row_of_point);
  CAST_CHECK(row_of_point, err, CAST_ERR_MEMORY, "coupling: no memory");
  for (size_t point = 0; point < rom->n_points; point++) row_of_point[point] = -1;
  for (ptrdiff_t k = 0; k < w->n_wall; k++)
    for (int c = 0; c < 4; c++) row_of_point[places[k].point[c]] = 0;
  w->n_rows = 0;
  for (size_t point = 0; point < rom->n_points; point++)
    if (row_of_point[point] == 0) row_of_point[point] = (int32_t)w->n_rows++;
  const CastStatus status =
      w->n_rows < w->n_wall ? rows_of_points(w, rom, places, row_of_point, err) : rows_of_walls(w, rom, places, err);
  free(row_of_point);
  return status;
}

/* ---- life ---- */

static CastStatus build(WallTemperature *w, const RomData *rom, const Particles *p, double spacing, CastError *err)
{
  const size_t n = (size_t)w->n_wall + 1;
  w->blend = calloc(n, sizeof *w->blend);
  w->temperature = calloc(n, sizeof *w->temperature);
  w->depth = calloc(n, sizeof *w->depth);
  w->wall_in_use = calloc(n, 1);
  w->instead = calloc(n, sizeof *w->instead);
  BandPlace *places = malloc(n * sizeof *places);
  CastStatus status = CAST_OK;
  if (!w->blend || !w->temperature || !w->depth || !w->wall_in_use || !w->instead || !places)
    status = cast_error_set(err, CAST_ERR_MEMORY, "coupling: no memory for %td wall particles", w->n_wall);
  if (status == CAST_OK) status = locate_all(w, rom, p, spacing, places, err);
  if (status == CAST_OK) status = make_rows(w, rom, places, err);
  free(places);
  CAST_CALL(status);
  w->row_rise = calloc((size_t)w->n_rows + 1, sizeof *w->row_rise);
  w->row_in_use = calloc((size_t)w->n_rows + 1, 1);
  CAST_CHECK(w->row_rise && w->row_in_use, err, CAST_ERR_MEMORY, "coupling: no memory for %td points", w->n_rows);
  return CAST_OK;
}

CastStatus wall_temperature_create(const RomData *rom, const Particles *particles, double spacing,
                                   WallTemperature **out, CastError *err)
{
  *out = NULL;
  WallTemperature *w = calloc(1, sizeof *w);
  CAST_CHECK(w, err, CAST_ERR_MEMORY, "coupling: no memory");
  w->r = rom->r;
  w->n_wall = particles->n - particles->n_fluid;
  const CastStatus status = build(w, rom, particles, spacing, err);
  if (status != CAST_OK) wall_temperature_destroy(&w);
  *out = w;
  return status;
}

void wall_temperature_destroy(WallTemperature **walls)
{
  if (!walls || !*walls) return;
  WallTemperature *w = *walls;
  free(w->blend);
  free(w->basis);
  free(w->row_rise);
  free(w->temperature);
  free(w->depth);
  free(w->row_in_use);
  free(w->wall_in_use);
  free(w->instead);
  free(w);
  *walls = NULL;
}

/* ---- during a run ---- */

void wall_temperature_select(WallTemperature *w, const Neighbours *neighbours)
{
  const PairList *list = neighbours_wall_fluid(neighbours);
  memset(w->row_in_use, 0, (size_t)w->n_rows);
  for (ptrdiff_t k = 0; k < w->n_wall; k++) {
    w->wall_in_use[k] = list->start[k + 1] > list->start[k];
    if (!w->wall_in_use[k]) continue;
    for (int c = 0; c < 4; c++) w->row_in_use[w->blend[k].row[c]] = 1;
  }
}

SIMD_CLONES static double rise(const float *row, const double *z, size_t r)
{
  double sum = 0.0;
#pragma omp simd reduction(+ : sum)
  for (size_t k = 0; k < r; k++) sum += (double)row[k] * z[k];
  return sum;
}

void wall_temperature_update(WallTemperature *w, const RomState *state)
{
  const double *z = rom_state_z(state), preheat = rom_state_preheat(state);
#pragma omp parallel for schedule(dynamic, 64)
  for (ptrdiff_t row = 0; row < w->n_rows; row++)
    if (w->row_in_use[row]) w->row_rise[row] = rise(w->basis + (size_t)row * w->r, z, w->r);
#pragma omp parallel for schedule(static)
  for (ptrdiff_t k = 0; k < w->n_wall; k++) {
    if (!w->wall_in_use[k]) continue;
    double sum = 0.0;
    for (int c = 0; c < 4; c++) sum += w->blend[k].weight[c] * w->row_rise[w->blend[k].row[c]];
    w->temperature[k] = w->instead[k] < 0 ? preheat + sum : rom_state_patch_temperature(state)[w->instead[k]];
  }
}

const double *wall_temperature(const WallTemperature *w)
{
  return w->temperature;
}

const double *wall_temperature_depth(const WallTemperature *w)
{
  return w->depth;
}

bool wall_temperature_in_use(const WallTemperature *w, ptrdiff_t wall)
{
  return w->wall_in_use[wall] != 0;
}
