#include "cast/results/melt_results.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/io/xmf.h"

static const VtkField STATE[] = {
    // the fields of freezing_texts follow
    {"id", "1", "a particle's number, kept for its whole life", 1, true},
    {"temperature", "K", "temperature", 1, false},
    {"enthalpy", "J/kg", "enthalpy", 1, false},
    {"solid_fraction", "1", "solid fraction at that temperature", 1, false},
    {"velocity", "m/s", "velocity", 3, false},
    {"pressure", "Pa", "pressure", 1, false},
    {"density", "kg/m3", "density", 1, false},
    {"fill_time", "s", "when melt first came to the place where it stands", 1, false},
    {"front_temperature", "K", "of the melt that came there first", 1, false},
};
enum { N_STATE = sizeof STATE / sizeof STATE[0], N_FIELDS = N_STATE + FREEZING_FIELDS, XMF_EACH = 128 };

struct MeltResults {
  VtkSeries *series;
  VtkField field[N_FIELDS];
  char path[4096], xmf_path[4096];
  const Material *melt;
  const Freezing *freezing; // NULL: not followed
  const Filling *filling;   // NULL: not followed
  const Arrival *arrival;
  ptrdiff_t n_ids;
  int32_t *order; // [n_ids] particle with that id; -1: gone
  float *buffer;  // [n_ids*3] points, then fields one after the other
  int32_t *id;
};

static CastStatus allocate(const char *folder, const Material *melt, ptrdiff_t n_ids, MeltResults **results,
                           CastError *err)
{
  MeltResults *made = *results = calloc(1, sizeof *made);
  CAST_CHECK(made, err, CAST_ERR_MEMORY, "no memory for the results");
  made->melt = melt;
  made->n_ids = n_ids;
  memcpy(made->field, STATE, sizeof STATE);
  for (int f = 0; f < FREEZING_FIELDS; f++) {
    const FreezingText *text = &freezing_texts[f];
    made->field[N_STATE + f] = (VtkField){text->name, text->units, text->description, 1, false};
  }
  snprintf(made->path, sizeof made->path, "%.4000s/results.vtkhdf", folder);
  snprintf(made->xmf_path, sizeof made->xmf_path, "%.4000s/results.xmf", folder);
  const size_t n = (size_t)n_ids + 1;
  made->order = malloc(n * sizeof *made->order);
  made->buffer = malloc(n * (13 + FREEZING_FIELDS) * sizeof *made->buffer);
  made->id = malloc(n * sizeof *made->id);
  CAST_CHECK(made->order && made->buffer && made->id, err, CAST_ERR_MEMORY, "no memory to write %td particles", n_ids);
  return CAST_OK;
}

CastStatus melt_results_open(const char *folder, const Material *melt, ptrdiff_t n_ids, size_t n_steps,
                             MeltResults **results, CastError *err)
{
  CastStatus status = allocate(folder, melt, n_ids, results, err);
  MeltResults *made = *results;
  if (status == CAST_OK)
    status = n_steps == 0
                 ? vtk_series_create(made->path, N_FIELDS, made->field, NULL, (size_t)n_ids, &made->series, err)
                 : vtk_series_reopen(made->path, N_FIELDS, made->field, n_steps, &made->series, err);
  if (status != CAST_OK) melt_results_close(results);
  return status;
}

void melt_results_close(MeltResults **results)
{
  if (!results || !*results) return;
  vtk_series_destroy(&(*results)->series);
  free((*results)->order);
  free((*results)->buffer);
  free((*results)->id);
  free(*results);
  *results = NULL;
}

static float *gather_scalar(const MeltResults *r, const double *from, ptrdiff_t n, float *to)
{
  for (ptrdiff_t i = 0; i < n; i++) to[i] = (float)from[r->order[i]];
  return to;
}

static float *gather_vector(const MeltResults *r, double *const from[3], ptrdiff_t n, float *to)
{
  for (ptrdiff_t i = 0; i < n; i++)
    for (int d = 0; d < 3; d++) to[3 * i + d] = (float)from[d][r->order[i]];
  return to;
}

static float *gather_freezing(const MeltResults *r, FreezingField field, ptrdiff_t n, float *to)
{
  for (ptrdiff_t i = 0; i < n; i++) to[i] = r->freezing ? (float)freezing_value(r->freezing, field, r->id[i]) : NAN;
  return to;
}

void melt_results_follow(MeltResults *results, const Freezing *freezing, const Filling *filling, const Arrival *arrival)
{
  results->freezing = freezing;
  results->filling = filling;
  results->arrival = arrival;
}

/* Of the places where the n particles stand, to time [n] and temperature [n]. */
static void gather_arrival(const MeltResults *r, const Particles *p, ptrdiff_t n, float *time, float *temperature)
{
  for (ptrdiff_t k = 0; k < n; k++) {
    const int32_t i = r->order[k];
    const double x[3] = {p->x[0][i], p->x[1][i], p->x[2][i]};
    const ptrdiff_t cell = r->filling ? filling_cell_of(r->filling, x) : -1;
    time[k] = cell < 0 ? NAN : (float)arrival_cell_time(r->arrival, cell);
    temperature[k] = cell < 0 ? NAN : (float)arrival_cell_temperature(r->arrival, cell);
  }
}

/* Fill order with the particles there are, by ascending id; returns how many. */
static ptrdiff_t order_by_id(MeltResults *r, const Particles *p)
{
  for (ptrdiff_t k = 0; k < r->n_ids; k++) r->order[k] = -1;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) r->order[p->id[i]] = (int32_t)i;
  ptrdiff_t n = 0;
  for (ptrdiff_t k = 0; k < r->n_ids; k++)
    if (r->order[k] >= 0) {
      r->id[n] = (int32_t)k;
      r->order[n++] = r->order[k];
    }
  return n;
}

CastStatus melt_results_append(MeltResults *r, double time, const Particles *p, CastError *err)
{
  const ptrdiff_t n = order_by_id(r, p);
  float *next = r->buffer;
  const float *points = gather_vector(r, p->x, n, next);
  const float *temperature = gather_scalar(r, p->T, n, next += 3 * n);
  const float *enthalpy = gather_scalar(r, p->E, n, next += n);
  float *solid = next += n;
  const bool melts = r->melt->solid_fraction.n > 0;
  for (ptrdiff_t i = 0; i < n; i++)
    solid[i] = melts ? (float)table_evaluate(&r->melt->solid_fraction, p->T[r->order[i]]) : 0.0f;
  const float *velocity = gather_vector(r, p->v, n, next += n);
  const float *pressure = gather_scalar(r, p->p, n, next += 3 * n);
  const float *density = gather_scalar(r, p->rho, n, next += n);
  float *fill_time = next += n, *front = next += n;
  gather_arrival(r, p, n, fill_time, front);
  const void *values[N_FIELDS] = {r->id, temperature, enthalpy, solid, velocity, pressure, density, fill_time, front};
  for (int f = 0; f < FREEZING_FIELDS; f++) values[N_STATE + f] = gather_freezing(r, (FreezingField)f, n, next += n);
  CAST_CALL(vtk_series_append(r->series, time, (size_t)n, points, values, err));
  const size_t steps = vtk_series_n_steps(r->series);
  return steps <= XMF_EACH || steps % XMF_EACH == 0 ? melt_results_finish(r, err) : CAST_OK;
}

CastStatus melt_results_finish(MeltResults *results, CastError *err)
{
  return xmf_write(results->xmf_path, results->series, 0, NULL, err);
}

size_t melt_results_n_steps(const MeltResults *results)
{
  return vtk_series_n_steps(results->series);
}

const char *melt_results_path(const MeltResults *results)
{
  return results->path;
}
