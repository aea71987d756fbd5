/* mould_pace.c
 * Method  Between its steps the mould is known by what it would do if the mean flows q0 of its last step went on: each
 *         patch then follows a smooth course, taken as straight. What the flows q really are differs from q0, and that
 *         acts through the patch's own response,
 *           T_l(tau) = T_l(0) + slope_l tau + integral_0^tau g'_l(tau - s) (q_l(s) - q0_l) ds,
 *           g'_l(tau) = sum_k B_kl^2 exp(-lambda_k tau).
 *         So a patch that melt has just reached warms at once, as it does when the mould is stepped with the melt; what
 *         it does to its neighbours within the interval waits for the end of it. Then the mould takes one step with the
 *         mean flows: the heat is the heat gathered, to rounding.
 *         g'_l is summed over rates a factor 2^(1/2) apart instead of the lambda_k: each B_kl^2 is shared between the
 * two rates around lambda_k, which errs by less than 0.4 % of the mode's part, as exp(-x) has a curvature of at most
 *         0.23 over log x. Rates above the fastest are quasi-steady, those below the slowest constant.
 * Cost    2 (rates + 3) m multiplications a step of the melt, with about 20 rates; the full step has 2 r m.
 * References  docs/theory, 12a to 12c */
#include "cast/mould/mould_pace.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RATES_PER_OCTAVE = 2, MOST_RATES = 40 };
static const double FASTEST = 4e6; // 1/s: settled within any step

struct MouldPace {
  size_t m, n_rates;
  double rate[MOST_RATES]; // 1/s, descending, the last one 0
  double *weight;          // [n_rates*m] of g'_l at each rate, K/J
  double *course;          // [n_rates*m] what q - q0 has made of each, K
  double elapsed;          // s
  double *heat;            // [m] J gathered
  double *slope;           // [m] K/s
  double *flow;            // [m] W, q0
  double *temperature;     // [m] K, predicted
};

/* Rates that span those of the model; slower ones hardly move within an interval. */
static size_t choose_rates(const RomData *rom, double rate[MOST_RATES])
{
  double fastest = 1.0;
  for (size_t k = 0; k < rom->r; k++) fastest = fmax(fastest, rom->lambda[k]);
  fastest = fmin(fastest, FASTEST);
  for (int j = 0; j < MOST_RATES - 1; j++) rate[j] = fastest * exp2(-(double)j / RATES_PER_OCTAVE);
  rate[MOST_RATES - 1] = 0.0;
  return MOST_RATES;
}

/* B_kl^2 to the rates around lambda_k. */
static void share_mode(MouldPace *p, const double *row, double lambda)
{
  size_t j = 0;
  while (j < p->n_rates - 2 && p->rate[j + 1] > lambda) j++;
  double first = 1.0;
  if (lambda >= p->rate[0])
    first = p->rate[0] / lambda; // the same steady part
  else
    first =
        p->rate[j + 1] > 0.0 ? log(lambda / p->rate[j + 1]) / log(p->rate[j] / p->rate[j + 1]) : lambda / p->rate[j];
  const double second = lambda >= p->rate[0] ? 0.0 : 1.0 - first;
  double *above = p->weight + j * p->m, *below = above + p->m;
  for (size_t l = 0; l < p->m; l++) {
    const double square = row[l] * row[l];
    above[l] += first * square;
    below[l] += second * square;
  }
}

CastStatus mould_pace_create(const RomData *rom, MouldPace **out, CastError *err)
{
  *out = NULL;
  MouldPace *p = calloc(1, sizeof *p);
  CAST_CHECK(p, err, CAST_ERR_MEMORY, "mould: no memory");
  const size_t m = p->m = rom->m;
  p->n_rates = choose_rates(rom, p->rate);
  double **const arrays[] = {&p->heat, &p->slope, &p->flow, &p->temperature, &p->weight, &p->course};
  bool ok = true;
  for (size_t a = 0; a < sizeof arrays / sizeof *arrays; a++)
    ok = (*arrays[a] = calloc(a < 4 ? m : m * p->n_rates, sizeof(double))) && ok;
  if (!ok) {
    mould_pace_destroy(&p);
    return cast_error_set(err, CAST_ERR_MEMORY, "mould: no memory for %zu patches", m);
  }
  for (size_t k = 0; k < rom->r; k++) share_mode(p, rom->B + k * m, rom->lambda[k]);
  *out = p;
  return CAST_OK;
}

void mould_pace_destroy(MouldPace **pace)
{
  if (!pace || !*pace) return;
  MouldPace *p = *pace;
  free(p->weight);
  free(p->course);
  free(p->heat);
  free(p->slope);
  free(p->flow);
  free(p->temperature);
  free(p);
  *pace = NULL;
}

/* ---- prediction ---- */

/* course' = course exp(-rate dt) + weight (q - q0) (1 - exp(-rate dt))/rate; their sum to the temperatures. */
static void advance_rate(MouldPace *p, size_t j, const double *q, double dt)
{
  const double rate = p->rate[j], keep = exp(-rate * dt), gain = rate > 0.0 ? -expm1(-rate * dt) / rate : dt;
  double *course = p->course + j * p->m;
  const double *weight = p->weight + j * p->m;
  for (size_t l = 0; l < p->m; l++) {
    course[l] = keep * course[l] + gain * weight[l] * (q[l] - p->flow[l]);
    p->temperature[l] += course[l];
  }
}

static void start_prediction(MouldPace *p, const RomState *state)
{
  const double *T = rom_state_patch_temperature(state);
  for (size_t l = 0; l < p->m; l++) p->temperature[l] = T[l] + p->slope[l] * p->elapsed;
}

const double *mould_pace_temperature(const MouldPace *p, const RomState *state)
{
  return p->elapsed > 0.0 ? p->temperature : rom_state_patch_temperature(state);
}

/* ---- heat ---- */

void mould_pace_gather(MouldPace *p, const RomState *state, const double *q, double dt)
{
  p->elapsed += dt;
  for (size_t l = 0; l < p->m; l++) p->heat[l] += q[l] * dt;
  start_prediction(p, state);
  for (size_t j = 0; j < p->n_rates; j++) advance_rate(p, j, q, dt);
}

double mould_pace_elapsed(const MouldPace *p)
{
  return p->elapsed;
}

double mould_pace_heat(const MouldPace *p)
{
  double sum = 0.0;
  for (size_t l = 0; l < p->m; l++) sum += p->heat[l];
  return sum;
}

void mould_pace_step(MouldPace *p, RomState *state)
{
  const double dt = p->elapsed;
  if (dt == 0.0) return;
  for (size_t l = 0; l < p->m; l++) {
    p->flow[l] = p->heat[l] / dt;
    p->heat[l] = 0.0;
  }
  rom_state_step_ahead(state, p->flow, dt, p->temperature);
  const double *T = rom_state_patch_temperature(state);
  for (size_t l = 0; l < p->m; l++) p->slope[l] = (p->temperature[l] - T[l]) / dt;
  memset(p->course, 0, p->n_rates * p->m * sizeof *p->course);
  p->elapsed = 0.0;
}

void mould_pace_forget(MouldPace *p)
{
  memset(p->slope, 0, p->m * sizeof *p->slope);
  memset(p->flow, 0, p->m * sizeof *p->flow);
}

/* ---- checkpoints ---- */

size_t mould_pace_size(const MouldPace *p)
{
  return 1 + (3 + p->n_rates) * p->m;
}

void mould_pace_save(const MouldPace *p, double *buffer)
{
  const size_t m = p->m;
  buffer[0] = p->elapsed;
  memcpy(buffer + 1, p->heat, m * sizeof *buffer);
  memcpy(buffer + 1 + m, p->slope, m * sizeof *buffer);
  memcpy(buffer + 1 + 2 * m, p->flow, m * sizeof *buffer);
  memcpy(buffer + 1 + 3 * m, p->course, p->n_rates * m * sizeof *buffer);
}

void mould_pace_restore(MouldPace *p, const RomState *state, const double *buffer)
{
  const size_t m = p->m;
  p->elapsed = buffer[0];
  memcpy(p->heat, buffer + 1, m * sizeof *buffer);
  memcpy(p->slope, buffer + 1 + m, m * sizeof *buffer);
  memcpy(p->flow, buffer + 1 + 2 * m, m * sizeof *buffer);
  memcpy(p->course, buffer + 1 + 3 * m, p->n_rates * m * sizeof *buffer);
  start_prediction(p, state);
  for (size_t j = 0; j < p->n_rates; j++)
    for (size_t l = 0; l < m; l++) p->temperature[l] += p->course[j * m + l];
}
