/* study_plan.c - which runs there are. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/study/study.h"

void study_range_value(const StudyKey *key, double fraction, char text[64])
{
  const double value = key->from + fraction * (key->to - key->from);
  snprintf(text, 64, "%.10g%s%s", value, key->unit[0] ? " " : "", key->unit);
}

static void grid_point(const StudyConfig *config, size_t number, StudyPoint *point)
{
  for (size_t k = config->n_keys; k-- > 0;) {
    const StudyKey *key = &config->key[k];
    const size_t n = key->n ? key->n : (size_t)key->steps, at = number % n;
    number /= n;
    if (key->n)
      memcpy(point->value[k], key->value[at], sizeof point->value[k]);
    else
      study_range_value(key, (double)at / (double)(n - 1), point->value[k]);
  }
}

/* splitmix64 (Steele, Lea & Flood 2014): 64 bits that are the same everywhere. */
static uint64_t next_random(uint64_t *state)
{
  uint64_t z = *state += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

static double random_fraction(uint64_t *state) // in [0, 1)
{
  return (double)(next_random(state) >> 11) * 0x1.0p-53;
}

static CastStatus latin_hypercube(const StudyConfig *config, size_t n, StudyPoint *points, CastError *err)
{
  size_t *stratum = malloc(n * sizeof *stratum);
  CAST_CHECK(stratum, err, CAST_ERR_MEMORY, "no memory for %zu samples", n);
  uint64_t state = (uint64_t)config->seed;
  for (size_t k = 0; k < config->n_keys; k++) {
    for (size_t i = 0; i < n; i++) stratum[i] = i;
    for (size_t i = n; i-- > 1;) { // Fisher and Yates
      const size_t j = (size_t)(random_fraction(&state) * (double)(i + 1)), keep = stratum[i];
      stratum[i] = stratum[j];
      stratum[j] = keep;
    }
    for (size_t i = 0; i < n; i++)
      study_range_value(&config->key[k], ((double)stratum[i] + random_fraction(&state)) / (double)n,
                        points[i].value[k]);
  }
  free(stratum);
  return CAST_OK;
}

CastStatus study_plan_points(const StudyConfig *config, size_t *n, StudyPoint **points, CastError *err)
{
  *n = 1;
  for (size_t k = 0; k < config->n_keys; k++) *n *= config->key[k].n ? config->key[k].n : (size_t)config->key[k].steps;
  if (config->plan == STUDY_LATIN_HYPERCUBE) *n = (size_t)config->samples;
  *points = calloc(*n, sizeof **points);
  CAST_CHECK(*points, err, CAST_ERR_MEMORY, "no memory for %zu runs", *n);
  if (config->plan == STUDY_LATIN_HYPERCUBE) {
    const CastStatus status = latin_hypercube(config, *n, *points, err);
    if (status != CAST_OK) {
      free(*points);
      *points = NULL;
    }
    return status;
  }
  for (size_t i = 0; i < *n; i++) grid_point(config, i, &(*points)[i]);
  return CAST_OK;
}
