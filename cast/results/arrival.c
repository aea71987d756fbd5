/* Method  Places not yet reached wait in the buckets of a grid, as wide as twice the farthest reach: a particle looks
 *         into eight. Most of them are empty, for the melt behind the front has reached all there is: only particles
 *         near a waiting place go on to distances. The particle nearest to a place wins, equal ones by their number, so
 *         that the order in which particles are kept does not matter. */
#include "cast/results/arrival.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/vector.h"

static const double CELL_REACH = 0.9;                       // of a cell's edge, as filling.c
static const double HIGH = 1.25, BESIDE = 0.87, SUNK = 0.2; // spacings, before a triangle
static const double MOST_BUCKETS = 4e6;

typedef struct TrianglePlace {
  double x[3], normal[3]; // m; into the cavity
} TrianglePlace;

struct Arrival {
  const CavityCells *cells; // borrowed
  ptrdiff_t n_cells, n;     // places: cells, then triangles
  size_t n_triangles;
  int32_t *triangle;    // [n_triangles]
  TrianglePlace *place; // [n_triangles]
  double cell_reach2, high, beside2, sunk;
  double *time, *temperature; // [n] s, K; NAN: not reached
  double low[3], bucket;      // m
  ptrdiff_t count[3];
  ptrdiff_t *start; // [buckets + 1] into waiting
  int32_t *left;    // [buckets] how many still wait, at the start of the bucket's share
  int32_t *waiting; // [n]
  uint8_t *near;    // [n_fluid] is a waiting place near?
  double *best;     // [n] m2, distance of the nearest particle of this look; HUGE_VAL: none
  int32_t *nearest; // [n] its index
  int32_t *touched; // [n] places that a particle of this look reaches
};

/* ---- places ---- */

static void locate_place(const Arrival *a, ptrdiff_t i, double x[3])
{
  for (int d = 0; d < 3; d++) x[d] = i < a->n_cells ? a->cells->x[d][i] : a->place[i - a->n_cells].x[d];
}

/* Triangles wind so that their normal points out of the mould: into the cavity. */
static void set_triangles(Arrival *a, const RomData *rom)
{
  TrianglePlace *place = a->place;
  for (size_t t = 0; t < rom->n_triangles; t++) {
    if (rom->patch[rom->triangle_patch[t]].outer) continue;
    const double *corner[3];
    double side[2][3];
    for (size_t k = 0; k < 3; k++) corner[k] = &rom->points[3 * rom->triangles[3 * t + k]];
    for (int d = 0; d < 3; d++) place->x[d] = (corner[0][d] + corner[1][d] + corner[2][d]) / 3.0;
    vec_between(corner[0], corner[1], side[0]);
    vec_between(corner[0], corner[2], side[1]);
    vec_cross(side[0], side[1], place->normal);
    vec_normalise(place->normal);
    a->triangle[a->n_triangles++] = (int32_t)t;
    place++;
  }
}

/* ---- buckets ---- */

static ptrdiff_t bucket_of(const Arrival *a, const ptrdiff_t k[3])
{
  return (k[2] * a->count[1] + k[1]) * a->count[0] + k[0];
}

/* The bucket of place i. */
static ptrdiff_t bucket_at(const Arrival *a, ptrdiff_t i)
{
  double x[3];
  ptrdiff_t k[3];
  locate_place(a, i, x);
  for (int d = 0; d < 3; d++) {
    k[d] = (ptrdiff_t)((x[d] - a->low[d]) / a->bucket);
    k[d] = k[d] < 0 ? 0 : k[d] >= a->count[d] ? a->count[d] - 1 : k[d];
  }
  return bucket_of(a, k);
}

static void measure_grid(Arrival *a, double reach)
{
  double high[3], volume = 1.0;
  for (int d = 0; d < 3; d++) {
    a->low[d] = HUGE_VAL;
    high[d] = -HUGE_VAL;
    for (ptrdiff_t i = 0; i < a->n; i++) {
      double x[3];
      locate_place(a, i, x);
      a->low[d] = x[d] < a->low[d] ? x[d] : a->low[d];
      high[d] = x[d] > high[d] ? x[d] : high[d];
    }
    if (a->n == 0) a->low[d] = high[d] = 0.0;
    volume *= high[d] - a->low[d] + reach;
  }
  a->bucket = fmax(2.0 * reach, cbrt(volume / MOST_BUCKETS));
  for (int d = 0; d < 3; d++) a->count[d] = (ptrdiff_t)((high[d] - a->low[d]) / a->bucket) + 1;
}

/* All places that have no time yet wait. */
static void fill_buckets(Arrival *a)
{
  const ptrdiff_t buckets = a->count[0] * a->count[1] * a->count[2];
  memset(a->start, 0, (size_t)(buckets + 1) * sizeof *a->start);
  memset(a->left, 0, (size_t)buckets * sizeof *a->left);
  for (ptrdiff_t i = 0; i < a->n; i++) a->start[bucket_at(a, i) + 1]++;
  for (ptrdiff_t b = 0; b < buckets; b++) a->start[b + 1] += a->start[b];
  for (ptrdiff_t i = 0; i < a->n; i++) {
    if (!isnan(a->time[i])) continue;
    const ptrdiff_t b = bucket_at(a, i);
    a->waiting[a->start[b] + a->left[b]++] = (int32_t)i;
  }
}

/* ---- life ---- */

static CastStatus allocate(Arrival *a, const CavityCells *cells, const RomData *rom, CastError *err)
{
  const size_t most = (size_t)cells->n + rom->n_triangles + 1;
  a->place = malloc((rom->n_triangles + 1) * sizeof *a->place);
  a->triangle = malloc((rom->n_triangles + 1) * sizeof *a->triangle);
  a->time = malloc(2 * most * sizeof *a->time);
  a->best = malloc(most * sizeof *a->best);
  a->waiting = malloc(most * sizeof *a->waiting);
  a->nearest = malloc(most * sizeof *a->nearest);
  a->touched = malloc(most * sizeof *a->touched);
  CAST_CHECK(a->place && a->triangle && a->time && a->best && a->waiting && a->nearest && a->touched, err,
             CAST_ERR_MEMORY, "no memory for %zu places of the cavity", most);
  return CAST_OK;
}

static CastStatus build(Arrival *a, const CavityCells *cells, const RomData *rom, double spacing, ptrdiff_t n_fluid,
                        CastError *err)
{
  CAST_CALL(allocate(a, cells, rom, err));
  a->cells = cells;
  a->n_cells = cells->n;
  set_triangles(a, rom);
  a->n = a->n_cells + (ptrdiff_t)a->n_triangles;
  a->temperature = a->time + a->n;
  for (ptrdiff_t i = 0; i < a->n; i++) {
    a->time[i] = a->temperature[i] = (double)NAN;
    a->best[i] = HUGE_VAL;
  }
  const double cell = CELL_REACH * cells->cell;
  a->cell_reach2 = cell * cell;
  a->high = HIGH * spacing;
  a->beside2 = BESIDE * BESIDE * spacing * spacing;
  a->sunk = -SUNK * spacing;
  measure_grid(a, fmax(cell, sqrt(a->high * a->high + a->beside2)));
  const size_t buckets = (size_t)(a->count[0] * a->count[1] * a->count[2]);
  a->start = malloc((buckets + 1) * sizeof *a->start);
  a->left = malloc(buckets * sizeof *a->left);
  a->near = malloc((size_t)n_fluid + 1);
  CAST_CHECK(a->start && a->left && a->near, err, CAST_ERR_MEMORY, "no memory to watch %td places", a->n);
  fill_buckets(a);
  return CAST_OK;
}

CastStatus arrival_create(const CavityCells *cells, const RomData *rom, double spacing, ptrdiff_t n_fluid,
                          Arrival **arrival, CastError *err)
{
  Arrival *made = *arrival = calloc(1, sizeof *made);
  CAST_CHECK(made, err, CAST_ERR_MEMORY, "no memory");
  const CastStatus status = build(made, cells, rom, spacing, n_fluid, err);
  if (status != CAST_OK) arrival_destroy(arrival);
  return status;
}

void arrival_destroy(Arrival **arrival)
{
  if (!arrival || !*arrival) return;
  Arrival *a = *arrival;
  void *const all[] = {a->place,   a->triangle, a->time, a->start,   a->left,
                       a->waiting, a->near,     a->best, a->nearest, a->touched};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) free(all[k]);
  free(a);
  *arrival = NULL;
}

/* ---- looking ---- */

/* The buckets that hold all within reach of x; returns how many. */
static int buckets_around(const Arrival *a, const double x[3], ptrdiff_t bucket[8])
{
  ptrdiff_t first[3], last[3];
  for (int d = 0; d < 3; d++) {
    const double at = (x[d] - a->low[d]) / a->bucket - 0.5;
    if (!(at > -2.0 && at < (double)a->count[d] + 1.0)) return 0;
    first[d] = (ptrdiff_t)floor(at) < 0 ? 0 : (ptrdiff_t)floor(at);
    last[d] = (ptrdiff_t)floor(at) + 1 >= a->count[d] ? a->count[d] - 1 : (ptrdiff_t)floor(at) + 1;
  }
  int n = 0;
  for (ptrdiff_t c = first[2]; c <= last[2]; c++)
    for (ptrdiff_t b = first[1]; b <= last[1]; b++)
      for (ptrdiff_t k = first[0]; k <= last[0]; k++) bucket[n++] = bucket_of(a, (const ptrdiff_t[3]){k, b, c});
  return n;
}

/* Squared distance from place i to x, m2; HUGE_VAL: x does not reach it. */
static double distance2(const Arrival *a, ptrdiff_t i, const double x[3])
{
  double at[3], way[3];
  locate_place(a, i, at);
  vec_between(at, x, way);
  const double r2 = vec_dot(way, way);
  if (i < a->n_cells) return r2 <= a->cell_reach2 ? r2 : HUGE_VAL;
  const double height = vec_dot(way, a->place[i - a->n_cells].normal);
  return height > a->sunk && height < a->high && r2 - height * height < a->beside2 ? r2 : HUGE_VAL;
}

/* Particle k comes to the places around it; returns how many are touched now. */
static ptrdiff_t come(Arrival *a, const Particles *p, ptrdiff_t k, ptrdiff_t n_touched)
{
  const double x[3] = {p->x[0][k], p->x[1][k], p->x[2][k]};
  ptrdiff_t bucket[8];
  const int n = buckets_around(a, x, bucket);
  for (int b = 0; b < n; b++)
    for (int32_t w = 0; w < a->left[bucket[b]]; w++) {
      const int32_t i = a->waiting[a->start[bucket[b]] + w];
      const double r2 = distance2(a, i, x);
      if (r2 == HUGE_VAL) continue;
      if (a->best[i] == HUGE_VAL) a->touched[n_touched++] = i;
      if (r2 > a->best[i] || (r2 == a->best[i] && p->id[k] > p->id[a->nearest[i]])) continue;
      a->best[i] = r2;
      a->nearest[i] = (int32_t)k;
    }
  return n_touched;
}

/* Take the places that are reached now out of their bucket, the others keep their order. */
static void take_out(Arrival *a, ptrdiff_t b)
{
  int32_t *waiting = a->waiting + a->start[b], kept = 0;
  for (int32_t w = 0; w < a->left[b]; w++)
    if (isnan(a->time[waiting[w]])) waiting[kept++] = waiting[w];
  a->left[b] = kept;
}

void arrival_update(Arrival *a, const Particles *p, double time)
{
#pragma omp parallel for schedule(static)
  for (ptrdiff_t k = 0; k < p->n_fluid; k++) {
    ptrdiff_t bucket[8];
    const int n = buckets_around(a, (const double[3]){p->x[0][k], p->x[1][k], p->x[2][k]}, bucket);
    int32_t left = 0;
    for (int b = 0; b < n; b++) left |= a->left[bucket[b]];
    a->near[k] = left != 0;
  }
  ptrdiff_t n_touched = 0;
  for (ptrdiff_t k = 0; k < p->n_fluid; k++)
    if (a->near[k]) n_touched = come(a, p, k, n_touched);
  for (ptrdiff_t t = 0; t < n_touched; t++) {
    const int32_t i = a->touched[t];
    a->time[i] = time;
    a->temperature[i] = p->T[a->nearest[i]];
    a->best[i] = HUGE_VAL;
  }
  for (ptrdiff_t t = 0; t < n_touched; t++) take_out(a, bucket_at(a, a->touched[t]));
}

/* ---- what is known ---- */

size_t arrival_n_triangles(const Arrival *arrival)
{
  return arrival->n_triangles;
}

const int32_t *arrival_triangles(const Arrival *arrival)
{
  return arrival->triangle;
}

double arrival_cell_time(const Arrival *arrival, ptrdiff_t cell)
{
  return arrival->time[cell];
}

double arrival_cell_temperature(const Arrival *arrival, ptrdiff_t cell)
{
  return arrival->temperature[cell];
}

double arrival_triangle_time(const Arrival *arrival, ptrdiff_t i)
{
  return arrival->time[arrival->n_cells + i];
}

double arrival_triangle_temperature(const Arrival *arrival, ptrdiff_t i)
{
  return arrival->temperature[arrival->n_cells + i];
}

const double *arrival_triangle_place(const Arrival *arrival, ptrdiff_t i)
{
  return arrival->place[i].x;
}

const double *arrival_triangle_normal(const Arrival *arrival, ptrdiff_t i)
{
  return arrival->place[i].normal;
}

size_t arrival_size(const Arrival *arrival)
{
  return 2 * (size_t)arrival->n;
}

void arrival_save(const Arrival *arrival, double *buffer)
{
  memcpy(buffer, arrival->time, arrival_size(arrival) * sizeof *buffer);
}

void arrival_restore(Arrival *arrival, const double *buffer)
{
  memcpy(arrival->time, buffer, arrival_size(arrival) * sizeof *buffer);
  fill_buckets(arrival);
}
