/* The mould's modal state and its step.
 *
 * Method  Each mode k sees the input u_k = (B q)_k + ambient_k (T_ambient - T_preheat), constant over the step. With
 *         the gain phi_k and the lag dt - phi_k of its scheme
 *           exponential     phi = (1 - exp(-lambda dt))/lambda        exact
 *           backward Euler  phi = dt/(1 + lambda dt)
 *         both schemes read
 *           z' = z + phi (u - lambda z),       integral of lambda z over the step = lambda phi z + (dt - phi) u,
 *         the integral being that of the exact z(t), or of the new z for backward Euler. So lambda -> 0 needs no case
 *         of its own, and the losses, constant^T (integral of lambda z - ambient dt (T_ambient - T_preheat)), come
 *         from the modes and not from what heat is missing.
 *         z and the losses are summed with compensation: a step may change them by less than their last digit.
 * Cost    B is read once (rom_rows.h): row k gives u_k, and while it is in cache adds z_k to the patch temperatures.
 *         Rows are taken in chunks of fixed size, whose sums are added in order: same bits at any thread count.
 * References  docs/theory, eq. 7, 8, 11, 12 */
#include "cast/mould/rom_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cast/kernel/dispatch.h"
#include "cast/mould/dense.h"
#include "cast/mould/rom_rows.h"
#include "cast/mould/rom_state_private.h"

enum { CHUNK_ROWS = 32 };
static const double PARALLEL_SIZE = 65536.0; // r m from which threads pay: below it a step takes a few tens of us

typedef struct Compensated { // value + low is the sum; low is what value cannot hold (Kahan 1965, Neumaier 1974)
  double value, low;
} Compensated;

struct RomState {
  const RomData *rom;
  RomRows rows;   // of B
  double missing; // W, of the step's flows (rom_rows.h)
  RomScheme scheme;
  double preheat, ambient; // K
  double time;             // s
  Compensated lost;        // J
  double *z, *z_low;       // [r] sqrt(J K); the state is z + z_low
  double *temperature;     // [m] K
  double dt;               // s, of the coefficients below
  double *phi, *lag;       // [r] s
  size_t n_chunks;
  double *partial;          // [n_chunks*m] K, each chunk's part of the patch temperatures
  double *chunk_loss;       // [n_chunks] J
  double *further;          // [n_chunks*m] K, the same one step ahead; NULL until asked for
  bool look_further;        // in this step
  OuterWalls *walls;        // borrowed; NULL: the ROM's own conditions hold
  double *wall_heat;        // [walls] J since last taken
  double *wall_flow, *flow; // [walls], [m] W, of a step
  double *T_free;           // [walls] K, at its end without these
};

static void compensated_add(Compensated *sum, double term)
{
  const double total = sum->value + term;
  sum->low += fabs(sum->value) >= fabs(term) ? (sum->value - total) + term : (term - total) + sum->value;
  sum->value = total;
}

/* ---- life ---- */

static bool allocate(RomState *state)
{
  const size_t r = state->rom->r, m = state->rom->m;
  double **const modal[] = {&state->z, &state->z_low, &state->phi, &state->lag};
  bool ok = true;
  for (size_t f = 0; f < sizeof modal / sizeof *modal; f++) {
    *modal[f] = calloc(r, sizeof(double));
    ok = ok && *modal[f];
  }
  state->n_chunks = (r + CHUNK_ROWS - 1) / CHUNK_ROWS;
  state->temperature = calloc(m, sizeof(double));
  state->partial = calloc(state->n_chunks * m, sizeof(double));
  state->chunk_loss = calloc(state->n_chunks, sizeof(double));
  return ok && state->temperature && state->partial && state->chunk_loss;
}

CastStatus rom_state_create(const RomData *rom, RomScheme scheme, double preheat, double ambient, RomState **out,
                            CastError *err)
{
  *out = NULL;
  CAST_CHECK(rom->r > 0 && rom->m > 0, err, CAST_ERR_ARGUMENT, "mould: a model of %zu states and %zu patches", rom->r,
             rom->m);
  CAST_CHECK(isfinite(preheat) && isfinite(ambient), err, CAST_ERR_ARGUMENT,
             "mould: preheat %g K and ambient %g K must be finite", preheat, ambient);
  RomState *state = calloc(1, sizeof *state);
  CAST_CHECK(state, err, CAST_ERR_MEMORY, "mould: no memory");
  state->rom = rom;
  state->scheme = scheme;
  state->preheat = preheat;
  state->ambient = ambient;
  state->dt = -1.0;
  if (!allocate(state)) {
    rom_state_destroy(&state);
    return cast_error_set(err, CAST_ERR_MEMORY, "mould: no memory for %zu states and %zu patches", rom->r, rom->m);
  }
  const CastStatus status = rom_rows_create(rom, &state->rows, err);
  if (status != CAST_OK) {
    rom_state_destroy(&state);
    return status;
  }
  for (size_t l = 0; l < rom->m; l++) state->temperature[l] = preheat;
  *out = state;
  return CAST_OK;
}

void rom_state_destroy(RomState **state)
{
  if (!state || !*state) return;
  RomState *s = *state;
  free(s->z);
  free(s->z_low);
  free(s->phi);
  free(s->lag);
  free(s->temperature);
  free(s->partial);
  free(s->chunk_loss);
  free(s->further);
  rom_rows_free(&s->rows);
  free(s->wall_heat);
  free(s->wall_flow);
  free(s->T_free);
  free(s->flow);
  free(s);
  *state = NULL;
}

CastStatus rom_state_set_walls(RomState *s, OuterWalls *walls, CastError *err)
{
  const size_t n = outer_walls_n(walls);
  s->wall_heat = calloc(n + 1, sizeof(double));
  s->wall_flow = calloc(n + 1, sizeof(double));
  s->T_free = calloc(n + 1, sizeof(double));
  s->flow = calloc(s->rom->m, sizeof(double));
  CAST_CHECK(s->wall_heat && s->wall_flow && s->T_free && s->flow, err, CAST_ERR_MEMORY,
             "mould: no memory for %zu outer walls", n);
  s->walls = walls;
  return CAST_OK;
}

static size_t n_walls(const RomState *s)
{
  return s->walls ? outer_walls_n(s->walls) : 0;
}

void rom_state_take_wall_heat(RomState *s, double *heat)
{
  for (size_t i = 0; i < n_walls(s); i++) {
    heat[outer_walls_patch(s->walls, i)] += s->wall_heat[i];
    s->wall_heat[i] = 0.0;
  }
}

/* ---- the step ---- */

/* 1 - (1 - exp(-x))/x, x >= 0: by its series where the quotient is near one. */
static double lag_fraction(double x)
{
  if (x > 0.5) return 1.0 + expm1(-x) / x;
  double term = 0.5 * x, sum = 0.0;
  for (int n = 3; fabs(term) > 1e-17 * fabs(sum) && n < 32; n++) {
    sum += term;
    term *= -x / n;
  }
  return sum;
}

double rom_state_gain(RomScheme scheme, double lambda, double dt)
{
  const double x = lambda * dt;
  if (scheme == ROM_BACKWARD_EULER) return dt / (1.0 + x);
  return x > 0.0 ? -expm1(-x) / lambda : dt;
}

static void set_step(RomState *s, double dt)
{
  if (dt == s->dt) return;
  for (size_t k = 0; k < s->rom->r; k++) {
    const double lambda = s->rom->lambda[k];
    s->phi[k] = rom_state_gain(s->scheme, lambda, dt);
    s->lag[k] = s->scheme == ROM_EXPONENTIAL ? dt * lag_fraction(lambda * dt) : lambda * dt * s->phi[k];
  }
  s->dt = dt;
}

/* z_k += phi (u - lambda z); returns the mode's loss in the step, J. */
static double step_mode(RomState *s, size_t k, double u)
{
  const RomData *rom = s->rom;
  const double z = s->z[k] + s->z_low[k], drive = rom->ambient[k] * (s->ambient - s->preheat), all = u + drive;
  const double decay = rom->lambda[k] * s->phi[k] * z;
  Compensated sum = {s->z[k], s->z_low[k]};
  compensated_add(&sum, s->phi[k] * all - decay);
  s->z[k] = sum.value + sum.low;
  s->z_low[k] = (sum.value - s->z[k]) + sum.low;
  return rom->constant[k] * (decay + s->lag[k] * all - s->dt * drive);
}

/* z_k after one more step with the same u. */
static double one_further(const RomState *s, size_t k, double u)
{
  const double all = u + s->rom->ambient[k] * (s->ambient - s->preheat);
  return s->z[k] + s->phi[k] * (all - s->rom->lambda[k] * s->z[k]);
}

static void step_chunk(RomState *s, size_t chunk, const double *q)
{
  const size_t m = s->rom->m, first = chunk * CHUNK_ROWS, r = s->rom->r;
  const size_t end = first + CHUNK_ROWS < r ? first + CHUNK_ROWS : r;
  double *partial = s->partial + chunk * m, *further = s->look_further ? s->further + chunk * m : NULL, loss = 0.0;
  memset(partial, 0, m * sizeof *partial);
  if (further) memset(further, 0, m * sizeof *further);
  for (size_t k = first; k < end; k += ROM_ROWS_AT_ONCE) {
    const size_t n = end - k < ROM_ROWS_AT_ONCE ? end - k : ROM_ROWS_AT_ONCE;
    double u[ROM_ROWS_AT_ONCE], after[ROM_ROWS_AT_ONCE];
    rom_rows_dot(&s->rows, k, n, q, u);
    for (size_t i = 0; i < n; i++) {
      if (s->rows.narrow) u[i] += s->rows.share[k + i] * s->missing;
      loss += step_mode(s, k + i, u[i]);
      after[i] = one_further(s, k + i, u[i]);
    }
    rom_rows_add(&s->rows, k, n, s->z + k, partial, after, further);
  }
  s->chunk_loss[chunk] = loss;
}

/* Temperatures of the walls' patches after the step with the flows q alone. */
static void look_ahead(RomState *s, const double *q)
{
  const RomData *rom = s->rom;
  const size_t n = outer_walls_n(s->walls);
  for (size_t i = 0; i < n; i++) s->T_free[i] = s->preheat;
  for (size_t k = 0; k < rom->r; k++) {
    const double *row = rom->B + k * rom->m, z = s->z[k] + s->z_low[k];
    const double all = dense_dot(row, q, rom->m) + rom->ambient[k] * (s->ambient - s->preheat);
    const double after = z + s->phi[k] * (all - rom->lambda[k] * z);
    for (size_t i = 0; i < n; i++) s->T_free[i] += row[outer_walls_patch(s->walls, i)] * after;
  }
}

/* The melt's flows and the walls', which leave the books as a loss of the other sign. */
static const double *add_walls(RomState *s, const double *q, double dt)
{
  look_ahead(s, q);
  const OuterStep step = {dt, s->phi, s->temperature, s->T_free};
  outer_walls_flows(s->walls, &step, s->wall_flow);
  memcpy(s->flow, q, s->rom->m * sizeof *s->flow);
  for (size_t i = 0; i < outer_walls_n(s->walls); i++) {
    s->flow[outer_walls_patch(s->walls, i)] += s->wall_flow[i];
    s->wall_heat[i] += s->wall_flow[i] * dt;
    compensated_add(&s->lost, -s->wall_flow[i] * dt);
  }
  return s->flow;
}

void rom_state_step(RomState *s, const double *q, double dt)
{
  const size_t m = s->rom->m;
  const bool threads = (double)s->rom->r * (double)m > PARALLEL_SIZE;
  set_step(s, dt);
  if (s->walls) q = add_walls(s, q, dt);
  s->missing = rom_rows_missing(&s->rows, q);
#pragma omp parallel for schedule(static) if (threads)
  for (size_t chunk = 0; chunk < s->n_chunks; chunk++) step_chunk(s, chunk, q);
  for (size_t l = 0; l < m; l++) s->temperature[l] = s->preheat;
  for (size_t chunk = 0; chunk < s->n_chunks; chunk++) {
    dense_add(1.0, s->partial + chunk * m, s->temperature, m);
    compensated_add(&s->lost, s->chunk_loss[chunk]);
  }
  s->time += dt;
}

void rom_state_step_ahead(RomState *s, const double *q, double dt, double *ahead)
{
  const size_t m = s->rom->m;
  if (!s->further) s->further = malloc(s->n_chunks * m * sizeof *s->further);
  s->look_further = s->further != NULL;
  rom_state_step(s, q, dt);
  for (size_t l = 0; l < m; l++) ahead[l] = s->look_further ? s->preheat : s->temperature[l]; // no memory: as it is
  for (size_t chunk = 0; chunk < s->n_chunks && s->look_further; chunk++)
    dense_add(1.0, s->further + chunk * m, ahead, m);
  s->look_further = false;
}

double rom_state_flops(const RomState *s)
{
  return (double)s->rom->r * (4.0 * (double)s->rom->m + 20.0);
}

/* ---- what it tells ---- */

double rom_state_time(const RomState *s)
{
  return s->time;
}

size_t rom_state_n_patches(const RomState *s)
{
  return s->rom->m;
}

const double *rom_state_patch_temperature(const RomState *s)
{
  return s->temperature;
}

const double *rom_state_z(const RomState *s)
{
  return s->z;
}

const RomData *rom_state_model(const RomState *s)
{
  return s->rom;
}

RomScheme rom_state_scheme(const RomState *s)
{
  return s->scheme;
}

double rom_state_preheat(const RomState *s)
{
  return s->preheat;
}

double rom_state_heat(const RomState *s)
{
  Compensated heat = {0.0, 0.0}, low = {0.0, 0.0};
  for (size_t k = 0; k < s->rom->r; k++) {
    compensated_add(&heat, s->rom->constant[k] * s->z[k]);
    compensated_add(&low, s->rom->constant[k] * s->z_low[k]);
  }
  return heat.value + (heat.low + low.value);
}

double rom_state_lost(const RomState *s)
{
  return s->lost.value + s->lost.low;
}

SIMD_CLONES static double point_rise(const float *row, const double *z, size_t r)
{
  double sum = 0.0;
#pragma omp simd reduction(+ : sum)
  for (size_t k = 0; k < r; k++) sum += (double)row[k] * z[k];
  return sum;
}

void rom_state_point_temperature(const RomState *s, double *temperature)
{
  const size_t r = s->rom->r, n = s->rom->n_points;
#pragma omp parallel for schedule(static)
  for (size_t p = 0; p < n; p++) temperature[p] = s->preheat + point_rise(s->rom->basis + p * r, s->z, r);
}

/* ---- checkpoints ---- */

size_t rom_state_size(const RomState *s)
{
  return 3 + 2 * s->rom->r + s->rom->m + n_walls(s);
}

void rom_state_save(const RomState *s, double *buffer)
{
  const size_t r = s->rom->r, m = s->rom->m;
  buffer[0] = s->time;
  buffer[1] = s->lost.value;
  buffer[2] = s->lost.low;
  memcpy(buffer + 3, s->z, r * sizeof *buffer);
  memcpy(buffer + 3 + r, s->z_low, r * sizeof *buffer);
  memcpy(buffer + 3 + 2 * r, s->temperature, m * sizeof *buffer);
  if (s->walls) memcpy(buffer + 3 + 2 * r + m, s->wall_heat, n_walls(s) * sizeof *buffer);
}

void rom_state_restore(RomState *s, const double *buffer)
{
  const size_t r = s->rom->r, m = s->rom->m;
  s->time = buffer[0];
  s->lost = (Compensated){buffer[1], buffer[2]};
  memcpy(s->z, buffer + 3, r * sizeof *buffer);
  memcpy(s->z_low, buffer + 3 + r, r * sizeof *buffer);
  memcpy(s->temperature, buffer + 3 + 2 * r, m * sizeof *buffer);
  if (s->walls) memcpy(s->wall_heat, buffer + 3 + 2 * r + m, n_walls(s) * sizeof *buffer);
}
