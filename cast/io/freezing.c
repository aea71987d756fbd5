#include "cast/io/freezing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct Freezing {
  double liquidus, solidus; // K; NAN: nothing freezes
  ptrdiff_t n;
  double time;                             // s, of the last update; NAN: none yet
  double *last, *at_liquidus, *at_solidus; // [n] K, s, s; by id
};

CastStatus freezing_create(const Material *melt, ptrdiff_t n_ids, Freezing **freezing, CastError *err)
{
  Freezing *f = *freezing = calloc(1, sizeof *f);
  CAST_CHECK(f, err, CAST_ERR_MEMORY, "no memory");
  const bool freezes = melt->solid_fraction.n > 0;
  f->liquidus = freezes ? melt->liquidus : (double)NAN;
  f->solidus = freezes ? melt->solidus : (double)NAN;
  f->n = n_ids;
  f->time = (double)NAN;
  f->last = malloc((size_t)(3 * n_ids + 1) * sizeof *f->last);
  if (!f->last) {
    freezing_destroy(freezing);
    return cast_error_set(err, CAST_ERR_MEMORY, "no memory for when %td particles freeze", n_ids);
  }
  f->at_liquidus = f->last + n_ids;
  f->at_solidus = f->at_liquidus + n_ids;
  for (ptrdiff_t k = 0; k < 3 * n_ids; k++) f->last[k] = (double)NAN;
  return CAST_OK;
}

void freezing_destroy(Freezing **freezing)
{
  if (!freezing || !*freezing) return;
  free((*freezing)->last);
  free(*freezing);
  *freezing = NULL;
}

/* The time at which the temperature went from `before` to below `mark`, or what was known where it did not. */
static double crossing(double mark, double before, double now, double start, double end, double known)
{
  if (now >= mark) return (double)NAN;
  if (!(before >= mark)) return known;
  return start + (end - start) * (before - mark) / (before - now);
}

void freezing_update(Freezing *f, const Particles *p, double time)
{
  if (isnan(f->liquidus)) return;
#pragma omp parallel for schedule(static)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const int32_t id = p->id[i];
    const double before = f->last[id], now = p->T[i];
    f->at_solidus[id] = crossing(f->solidus, before, now, f->time, time, f->at_solidus[id]);
    f->at_liquidus[id] = crossing(f->liquidus, before, now, f->time, time, f->at_liquidus[id]);
    f->last[id] = now;
  }
  f->time = time;
}

double freezing_value(const Freezing *f, FreezingField field, ptrdiff_t id)
{
  const double local = f->at_solidus[id] - f->at_liquidus[id];
  switch (field) {
  case FREEZING_LIQUIDUS_TIME:
    return f->at_liquidus[id];
  case FREEZING_SOLIDUS_TIME:
    return f->at_solidus[id];
  case FREEZING_SOLIDIFICATION_TIME:
    return local;
  default:
    return (f->liquidus - f->solidus) / local;
  }
}

size_t freezing_size(const Freezing *f)
{
  return 1 + 3 * (size_t)f->n;
}

void freezing_save(const Freezing *f, double *buffer)
{
  buffer[0] = f->time;
  memcpy(buffer + 1, f->last, 3 * (size_t)f->n * sizeof *buffer);
}

void freezing_restore(Freezing *f, const double *buffer)
{
  f->time = buffer[0];
  memcpy(f->last, buffer + 1, 3 * (size_t)f->n * sizeof *buffer);
}
