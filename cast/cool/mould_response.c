#include "cast/cool/mould_response.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

CastStatus mould_response_create(size_t m, const RomState *state, MouldResponse *r, CastError *err)
{
  *r = (MouldResponse){.m = m};
  r->patch = calloc(m + 1, sizeof *r->patch);
  r->root = calloc(m + 1, sizeof *r->root);
  r->T0 = calloc(m + 1, sizeof *r->T0);
  r->T = calloc(m + 1, sizeof *r->T);
  r->work = calloc(m + 1, sizeof *r->work);
  r->scaled = calloc(m + 1, sizeof *r->scaled);
  r->state = calloc(rom_state_size(state), sizeof *r->state);
  if (r->patch && r->root && r->T0 && r->T && r->work && r->scaled && r->state) return CAST_OK;
  mould_response_destroy(r);
  return cast_error_set(err, CAST_ERR_MEMORY, "cooling: no memory for %zu patches", m);
}

void mould_response_destroy(MouldResponse *r)
{
  free(r->patch);
  free(r->root);
  free(r->factor);
  free(r->T0);
  free(r->T);
  free(r->work);
  free(r->scaled);
  free(r->state);
  *r = (MouldResponse){0};
}

/* ---- Cholesky, row by row ---- */

static double row_dot(const double *a, const double *b, size_t n)
{
  double sum = 0.0;
#pragma omp simd reduction(+ : sum)
  for (size_t k = 0; k < n; k++) sum += a[k] * b[k];
  return sum;
}

/* Column by column, so that the rows of a column are independent. */
static bool factorise(double *A, size_t n)
{
  for (size_t j = 0; j < n; j++) {
    const double pivot = A[j * n + j] - row_dot(A + j * n, A + j * n, j);
    if (!(pivot > 0.0)) return false;
    A[j * n + j] = sqrt(pivot);
#pragma omp parallel for schedule(static) if (n - j > 64)
    for (size_t i = j + 1; i < n; i++) A[i * n + j] = (A[i * n + j] - row_dot(A + i * n, A + j * n, j)) / A[j * n + j];
  }
  return true;
}

/* x = (L L^T)^-1 x */
static void solve(const double *L, size_t n, double *x)
{
  for (size_t i = 0; i < n; i++) x[i] = (x[i] - row_dot(L + i * n, x, i)) / L[i * n + i];
  for (size_t i = n; i-- > 0;) {
    x[i] /= L[i * n + i];
    const double value = x[i];
#pragma omp simd
    for (size_t k = 0; k < i; k++) x[k] -= L[i * n + k] * value;
  }
}

/* ---- before a step ---- */

static void find_touched(MouldResponse *r, const CouplingContacts *contacts)
{
  r->n = 0;
  for (size_t l = 0; l < r->m; l++) {
    double sum = 0.0;
    for (ptrdiff_t k = contacts->of_patch_start[l]; k < contacts->of_patch_start[l + 1]; k++)
      sum += contacts->conductance[contacts->of_patch[k]];
    if (sum <= 0.0) continue;
    r->patch[r->n] = (int32_t)l;
    r->root[r->n++] = sqrt(sum);
  }
}

/* Where the mould's temperatures would go by themselves. */
static void look_ahead(MouldResponse *r, RomState *state, double dt)
{
  rom_state_save(state, r->state);
  memset(r->T0, 0, r->m * sizeof *r->T0); // flows of zero
  rom_state_step(state, r->T0, dt);
  memcpy(r->T0, rom_state_patch_temperature(state), r->m * sizeof *r->T0);
  rom_state_restore(state, r->state);
}

static CastStatus build_factor(MouldResponse *r, const RomState *state, double dt, CastError *err)
{
  const size_t n = r->n;
  if (n * n > r->room || !r->factor) {
    free(r->factor);
    r->room = n * n;
    r->factor = malloc((n * n + 1) * sizeof *r->factor);
    CAST_CHECK(r->factor, err, CAST_ERR_MEMORY, "cooling: no memory for a matrix of %zu patches", n);
  }
  CAST_CALL(rom_state_step_matrix(state, dt, n, r->patch, r->factor, err));
  for (size_t a = 0; a < n; a++)
    for (size_t b = 0; b < n; b++) r->factor[a * n + b] = r->root[a] * r->factor[a * n + b] * r->root[b] + (a == b);
  CAST_CHECK(factorise(r->factor, n), err, CAST_ERR_NUMERIC,
             "cooling: the mould's response over %g s is not positive: the ROM is not passive", dt);
  return CAST_OK;
}

CastStatus mould_response_prepare(MouldResponse *r, const CouplingContacts *contacts, RomState *state, bool frozen,
                                  double dt, CastError *err)
{
  find_touched(r, contacts);
  if (!frozen) {
    look_ahead(r, state, dt);
    return build_factor(r, state, dt, err);
  }
  memcpy(r->T0, rom_state_patch_temperature(state), r->m * sizeof *r->T0);
  free(r->factor);
  r->factor = NULL;
  return CAST_OK;
}

/* ---- during it ---- */

void mould_response_apply(MouldResponse *r, const double *x, double *y)
{
  for (size_t a = 0; a < r->n; a++) r->work[a] = r->scaled[a] = x[r->patch[a]] / r->root[a];
  memset(y, 0, r->m * sizeof *y); // may be x
  if (!r->factor) return;
  solve(r->factor, r->n, r->work);
  for (size_t a = 0; a < r->n; a++) y[r->patch[a]] = (r->scaled[a] - r->work[a]) / r->root[a];
}

/* Patches that no melt touches get heat from the others, but nothing here asks for their temperature. */
void mould_response_temperatures(MouldResponse *r, const double *S)
{
  double *excess = r->T; // S - D T0
  memset(excess, 0, r->m * sizeof *excess);
  for (size_t a = 0; a < r->n; a++) {
    const int32_t l = r->patch[a];
    excess[l] = S[l] - r->root[a] * r->root[a] * r->T0[l];
  }
  mould_response_apply(r, excess, r->T);
  for (size_t l = 0; l < r->m; l++) r->T[l] += r->T0[l];
}
