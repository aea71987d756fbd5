#include "cast/results/freezing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cast/physics/gradient.h"

static const double NIYAMA_AT = 0.1, WINDOW = 0.2; // of the freezing range above the solidus

const FreezingText freezing_texts[FREEZING_FIELDS] = {
    {"liquidus_time", "s", "when it last fell below the liquidus; NaN: has not"},
    {"solidus_time", "s", "when it last fell below the solidus; NaN: has not"},
    {"solidification_time", "s", "local: from liquidus to solidus"},
    {"cooling_rate", "K/s", "mean over the freezing range"},
    {"final_cooling_rate", "K/s", "mean over the last fifth of the freezing range"},
    {"gradient", "K/m", "|grad T| a tenth of the freezing range above the solidus"},
    {"niyama", "K^0.5 s^0.5/m", "gradient/sqrt(final cooling rate)"},
    {"arm_spacing", "m", "secondary dendrite arms, estimate from the solidification time"},
    {"remelted", "1", "how often it was solid and became mushy again"},
};

enum { LAST, AT_LIQUIDUS, AT_WINDOW, AT_SOLIDUS, GRADIENT, REMELTED, KEPT };

struct Freezing {
  double liquidus, solidus, window, niyama; // K; NAN: nothing freezes
  double arm, exponent;                     // m after 1 s, 1; NAN: not known
  ptrdiff_t n;
  double time;              // s, of the last update; NAN: none yet
  double *kept[KEPT];       // [n] by id: K, s, s, s, K/m, 1
  double *before;           // [n] K, by the particles' places: temperatures of the last update
  const SphParameters *sph; // NULL: no gradients
  const Neighbours *neighbours;
};

CastStatus freezing_create(const Material *melt, ptrdiff_t n_ids, Freezing **freezing, CastError *err)
{
  Freezing *f = *freezing = calloc(1, sizeof *f);
  CAST_CHECK(f, err, CAST_ERR_MEMORY, "no memory");
  const bool freezes = melt->solid_fraction.n > 0;
  const double range = melt->liquidus - melt->solidus;
  f->liquidus = freezes ? melt->liquidus : (double)NAN;
  f->solidus = freezes ? melt->solidus : (double)NAN;
  f->window = f->solidus + WINDOW * range;
  f->niyama = f->solidus + NIYAMA_AT * range;
  f->arm = melt->arm_spacing_at_1s;
  f->exponent = melt->arm_spacing_exponent;
  f->n = n_ids;
  f->time = (double)NAN;
  double *room = malloc(((KEPT + 1) * (size_t)n_ids + 1) * sizeof *room);
  if (!room) {
    freezing_destroy(freezing);
    return cast_error_set(err, CAST_ERR_MEMORY, "no memory for when %td particles freeze", n_ids);
  }
  for (int k = 0; k < KEPT; k++) f->kept[k] = room + k * n_ids;
  f->before = room + KEPT * n_ids;
  for (ptrdiff_t k = 0; k < KEPT * n_ids; k++) room[k] = (double)NAN;
  memset(f->kept[REMELTED], 0, (size_t)n_ids * sizeof(double));
  return CAST_OK;
}

void freezing_destroy(Freezing **freezing)
{
  if (!freezing || !*freezing) return;
  free((*freezing)->kept[0]);
  free(*freezing);
  *freezing = NULL;
}

void freezing_watch_gradient(Freezing *freezing, const SphParameters *sph, const Neighbours *neighbours)
{
  freezing->sph = sph;
  freezing->neighbours = neighbours;
}

/* The time at which the temperature went from `before` to below `mark`, or what was known where it did not. */
static double crossing(double mark, double before, double now, double start, double end, double known)
{
  if (now >= mark) return (double)NAN;
  if (!(before >= mark)) return known;
  return start + (end - start) * (before - mark) / (before - now);
}

/* |grad T| in the field half-way between before and now at which particle i is at T_N; or what was known. */
static double gradient_when_crossing(const Freezing *f, const Particles *p, ptrdiff_t i, double known)
{
  const double before = f->before[i], now = p->T[i];
  if (now >= f->niyama) return (double)NAN;
  if (!(before >= f->niyama) || !f->sph) return known;
  const double *const fields[2] = {f->before, p->T}, share = (before - f->niyama) / (before - now);
  double both[2][3], sum2 = 0.0;
  gradient_at(f->sph, p, f->neighbours, i, 2, fields, both);
  for (int d = 0; d < 3; d++) {
    const double along = (1.0 - share) * both[0][d] + share * both[1][d];
    sum2 += along * along;
  }
  return sqrt(sum2);
}

void freezing_update(Freezing *f, const Particles *p, double time)
{
  if (isnan(f->liquidus)) return;
#pragma omp parallel for schedule(static)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) f->before[i] = f->kept[LAST][p->id[i]];
#pragma omp parallel for schedule(dynamic, 256)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const int32_t id = p->id[i];
    const double before = f->before[i], now = p->T[i];
    if (now >= f->solidus && before < f->solidus) f->kept[REMELTED][id]++;
    f->kept[AT_SOLIDUS][id] = crossing(f->solidus, before, now, f->time, time, f->kept[AT_SOLIDUS][id]);
    f->kept[AT_WINDOW][id] = crossing(f->window, before, now, f->time, time, f->kept[AT_WINDOW][id]);
    f->kept[AT_LIQUIDUS][id] = crossing(f->liquidus, before, now, f->time, time, f->kept[AT_LIQUIDUS][id]);
    f->kept[GRADIENT][id] = gradient_when_crossing(f, p, i, f->kept[GRADIENT][id]);
    f->kept[LAST][id] = now;
  }
  f->time = time;
}

double freezing_value(const Freezing *f, FreezingField field, ptrdiff_t id)
{
  const double local = f->kept[AT_SOLIDUS][id] - f->kept[AT_LIQUIDUS][id];
  const double rate = (f->window - f->solidus) / (f->kept[AT_SOLIDUS][id] - f->kept[AT_WINDOW][id]);
  switch (field) {
  case FREEZING_LIQUIDUS_TIME:
    return f->kept[AT_LIQUIDUS][id];
  case FREEZING_SOLIDUS_TIME:
    return f->kept[AT_SOLIDUS][id];
  case FREEZING_SOLIDIFICATION_TIME:
    return local;
  case FREEZING_COOLING_RATE:
    return (f->liquidus - f->solidus) / local;
  case FREEZING_FINAL_RATE:
    return rate;
  case FREEZING_GRADIENT:
    return f->kept[GRADIENT][id];
  case FREEZING_NIYAMA:
    return f->kept[GRADIENT][id] / sqrt(rate);
  case FREEZING_ARM_SPACING:
    return isnan(local) ? local : f->arm * pow(local, f->exponent);
  default:
    return isnan(f->liquidus) ? f->liquidus : f->kept[REMELTED][id];
  }
}

size_t freezing_size(const Freezing *f)
{
  return 1 + KEPT * (size_t)f->n;
}

void freezing_save(const Freezing *f, double *buffer)
{
  buffer[0] = f->time;
  memcpy(buffer + 1, f->kept[0], KEPT * (size_t)f->n * sizeof *buffer);
}

void freezing_restore(Freezing *f, const double *buffer)
{
  f->time = buffer[0];
  memcpy(f->kept[0], buffer + 1, KEPT * (size_t)f->n * sizeof *buffer);
}
