#include "reduce/mor/krylov/loewner.h"

#include <petscblaslapack.h>

#include "reduce/linear/small_dense.h"
#include "reduce/petsc/petsc_compat.h"

#define LAPACKpstrf_ PETSCBLAS(pstrf, PSTRF)
BLAS_EXTERN void LAPACKpstrf_(const char *, PetscBLASInt *, PetscReal *, PetscBLASInt *, PetscBLASInt *, PetscBLASInt *,
                              PetscReal *, PetscReal *, PetscBLASInt *);

typedef struct Raw { // in the vectors 1, X_1, X_2, .. as they are
  PetscInt n, p;
  PetscReal *E, *K; // [n x n]
  PetscReal *B;     // [n x p] row-major
  PetscReal *heat;  // [n] V^T E 1
} Raw;

/* f [(qa + 1) x (qb + 1)] blocks [p x p], f(a, b) at f + (a + b (qa + 1)) p p; f(0, 0) is not used. */
static void divided_differences(const ShiftMoments *s, const ShiftMoments *t, PetscInt p, PetscReal *f)
{
  const size_t square = (size_t)p * (size_t)p, rows = (size_t)s->q + 1;
  for (size_t a = 1; a <= (size_t)s->q; a++)
    for (size_t e = 0; e < square; e++) f[a * square + e] = s->mu[(a - 1) * square + e];
  for (size_t b = 1; b <= (size_t)t->q; b++)
    for (size_t e = 0; e < square; e++) f[b * rows * square + e] = t->mu[(b - 1) * square + e];
  for (size_t b = 1; b <= (size_t)t->q; b++)
    for (size_t a = 1; a <= (size_t)s->q; a++) {
      PetscReal *at = f + (a + b * rows) * square;
      const PetscReal *left = f + (a + (b - 1) * rows) * square, *right = f + (a - 1 + b * rows) * square;
      if (s == t)
        for (size_t e = 0; e < square; e++) at[e] = s->mu[(a + b - 1) * square + e];
      else
        for (size_t e = 0; e < square; e++) at[e] = (left[e] - right[e]) / (t->s - s->s);
    }
}

/* Blocks of E and K between the shifts s and t, whose vectors begin at row i and column j. */
static PetscErrorCode fill_pair(Raw *raw, const ShiftMoments *s, const ShiftMoments *t, PetscInt i, PetscInt j)
{
  const PetscInt p = raw->p;
  const size_t square = (size_t)p * (size_t)p, rows = (size_t)s->q + 1, n = (size_t)raw->n;
  PetscReal *f;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1(rows * (size_t)(t->q + 1) * square, &f));
  divided_differences(s, t, p, f);
  for (PetscInt b = 1; b <= t->q; b++)
    for (PetscInt a = 1; a <= s->q; a++) {
      const PetscReal *of_E = f + ((size_t)a + (size_t)b * rows) * square;
      /* K Y_b = E Y_(b-1) - t E Y_b, or the same of X_a: by the smaller shift, which magnifies rounding less */
      const PetscBool by_s = (PetscBool)(s->s < t->s);
      const PetscReal shift = by_s ? s->s : t->s;
      const PetscReal *before =
          f + (by_s ? (size_t)(a - 1) + (size_t)b * rows : (size_t)a + (size_t)(b - 1) * rows) * square;
      for (PetscInt l = 0; l < p; l++)
        for (PetscInt k = 0; k < p; k++) {
          const size_t row = (size_t)(i + (a - 1) * p + k), column = (size_t)(j + (b - 1) * p + l);
          const size_t e = (size_t)k + (size_t)l * (size_t)p;
          raw->E[row + column * n] = raw->E[column + row * n] = of_E[e];
          raw->K[row + column * n] = raw->K[column + row * n] = before[e] - shift * of_E[e];
        }
    }
  PetscCall(PetscFree(f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The constant 1 comes first. */
static void fill_constant(Raw *raw, const ShiftBlocks *blocks, PetscReal capacity, PetscReal losses)
{
  const size_t n = (size_t)raw->n, p = (size_t)raw->p;
  raw->E[0] = raw->heat[0] = capacity;
  raw->K[0] = losses;
  for (size_t l = 0; l < p; l++) raw->B[l] = 1.0;
  size_t row = 1;
  for (PetscInt i = 0; i < blocks->n_shifts; i++) {
    const ShiftMoments *s = &blocks->shift[i];
    for (size_t a = 0; a < (size_t)s->q; a++)
      for (size_t k = 0; k < p; k++, row++) {
        for (size_t l = 0; l < p; l++) raw->B[row * p + l] = s->mu[a * p * p + k * p + l];
        raw->heat[row] = s->heat[a * p + k];
        raw->E[row] = raw->E[row * n] = raw->heat[row];
        raw->K[row] = raw->K[row * n] = s->heat[((size_t)s->q + a) * p + k];
      }
  }
}

static PetscErrorCode fill(const ShiftBlocks *blocks, PetscReal capacity, PetscReal losses, Raw *raw)
{
  PetscInt i = 1, j;

  PetscFunctionBeginUser;
  fill_constant(raw, blocks, capacity, losses);
  for (PetscInt s = 0; s < blocks->n_shifts; i += blocks->shift[s++].q * raw->p) {
    j = i;
    for (PetscInt t = s; t < blocks->n_shifts; j += blocks->shift[t++].q * raw->p)
      PetscCall(fill_pair(raw, &blocks->shift[s], &blocks->shift[t], i, j));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Pivoted Cholesky, P^T D E D P = U^T U, D to unit lengths: the largest remaining direction comes first, as in
 * Gram-Schmidt with pivoting, and the constant before all. V = X D P U^-1.
 *   scale [n] D;  pivot [n] out, from 1;  E becomes U */
static PetscErrorCode factorise(Raw *raw, PetscReal deflation, PetscReal *scale, PetscBLASInt *pivot, PetscInt *rank)
{
  const size_t n = (size_t)raw->n;
  PetscBLASInt size, found, info;
  PetscReal tolerance = deflation * deflation, *work;

  PetscFunctionBeginUser;
  for (size_t k = 0; k < n; k++)
    scale[k] = raw->E[k + k * n] > 0.0 ? (k == 0 ? 2.0 : 1.0) / PetscSqrtReal(raw->E[k + k * n]) : 0.0;
  for (size_t j = 0; j < n; j++)
    for (size_t i = 0; i < n; i++) raw->E[i + j * n] *= scale[i] * scale[j];
  PetscCall(PetscBLASIntCast(raw->n, &size));
  PetscCall(PetscMalloc1(2 * n, &work));
  PetscCallBLAS("LAPACKpstrf", LAPACKpstrf_("U", &size, raw->E, &size, pivot, &found, &tolerance, work, &info));
  PetscCheck(info >= 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK pstrf: info = %d", (int)info);
  PetscCheck(pivot[0] == 1, PETSC_COMM_SELF, PETSC_ERR_PLIB, "the constant temperature did not come first");
  *rank = (PetscInt)found;
  PetscCall(PetscFree(work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A [n x n] in the raw vectors becomes U^-T (P^T D A D P) U^-1, [r x r]. */
static PetscErrorCode transform(const Raw *raw, const PetscReal *scale, const PetscBLASInt *pivot, PetscInt r,
                                const PetscReal *A, PetscReal *of)
{
  const size_t n = (size_t)raw->n, rank = (size_t)r;
  PetscBLASInt size, ld;
  const PetscReal one = 1.0;

  PetscFunctionBeginUser;
  for (size_t j = 0; j < rank; j++)
    for (size_t i = 0; i < rank; i++) {
      const size_t row = (size_t)pivot[i] - 1, column = (size_t)pivot[j] - 1;
      of[i + j * rank] = scale[row] * scale[column] * A[row + column * n];
    }
  PetscCall(PetscBLASIntCast(r, &size));
  PetscCall(PetscBLASIntCast(raw->n, &ld));
  PetscCallBLAS("BLAStrsm", BLAStrsm_("L", "U", "T", "N", &size, &size, &one, raw->E, &ld, of, &size));
  PetscCallBLAS("BLAStrsm", BLAStrsm_("R", "U", "N", "N", &size, &size, &one, raw->E, &ld, of, &size));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* T = D P U^-1, inputs = U^-T P^T D B, constant likewise */
static PetscErrorCode set_coordinates(const Raw *raw, const PetscReal *scale, const PetscBLASInt *pivot,
                                      LoewnerModel *model)
{
  const size_t n = (size_t)raw->n, r = (size_t)model->r, p = (size_t)raw->p;
  PetscBLASInt size, ld, columns, unit = 1, rows;
  const PetscReal one = 1.0;
  PetscReal *identity;

  PetscFunctionBeginUser;
  PetscCall(PetscBLASIntCast(model->r, &size));
  PetscCall(PetscBLASIntCast(raw->n, &ld));
  PetscCall(PetscBLASIntCast(raw->p, &columns));
  rows = columns;
  for (size_t k = 0; k < r; k++) {
    const size_t from = (size_t)pivot[k] - 1;
    for (size_t l = 0; l < p; l++) model->inputs[k * p + l] = scale[from] * raw->B[from * p + l];
    model->constant[k] = scale[from] * raw->heat[from];
  }
  /* row-major [r x p] is [p x r]: inputs^T U^-1 */
  PetscCallBLAS("BLAStrsm", BLAStrsm_("R", "U", "N", "N", &rows, &size, &one, raw->E, &ld, model->inputs, &columns));
  PetscCallBLAS("BLAStrsm", BLAStrsm_("L", "U", "T", "N", &size, &unit, &one, raw->E, &ld, model->constant, &size));
  PetscCall(PetscCalloc1(r * r, &identity));
  for (size_t k = 0; k < r; k++) identity[k + k * r] = 1.0;
  PetscCallBLAS("BLAStrsm", BLAStrsm_("L", "U", "N", "N", &size, &size, &one, raw->E, &ld, identity, &size));
  for (size_t j = 0; j < r; j++)
    for (size_t k = 0; k < r; k++) {
      const size_t to = (size_t)pivot[k] - 1;
      model->T[to + j * n] = scale[to] * identity[k + j * r];
    }
  PetscCall(PetscFree(identity));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode loewner_project(const ShiftBlocks *blocks, PetscReal capacity, PetscReal losses, PetscReal deflation,
                               LoewnerModel **out)
{
  Raw raw = {.p = blocks->p, .n = 1 + blocks->n * blocks->p};
  const size_t n = (size_t)raw.n, p = (size_t)raw.p;
  LoewnerModel *model;
  PetscReal *scale;
  PetscBLASInt *pivot;

  PetscFunctionBeginUser;
  PetscCall(PetscNew(&model));
  *out = model;
  PetscCall(PetscMalloc4(n * n, &raw.E, n * n, &raw.K, n * p, &raw.B, n, &raw.heat));
  PetscCall(PetscMalloc2(n, &scale, n, &pivot));
  PetscCall(fill(blocks, capacity, losses, &raw));
  PetscCall(factorise(&raw, deflation, scale, pivot, &model->r));
  const size_t r = (size_t)model->r;
  model->n_raw = raw.n;
  model->p = raw.p;
  PetscCall(PetscMalloc1(r * r, &model->K));
  PetscCall(PetscMalloc1(r * p, &model->inputs));
  PetscCall(PetscMalloc1(r, &model->constant));
  PetscCall(PetscCalloc1(n * r, &model->T));
  PetscCall(transform(&raw, scale, pivot, model->r, raw.K, model->K));
  PetscCall(set_coordinates(&raw, scale, pivot, model));
  PetscCall(PetscFree4(raw.E, raw.K, raw.B, raw.heat));
  PetscCall(PetscFree2(scale, pivot));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode loewner_destroy(LoewnerModel **model)
{
  PetscFunctionBeginUser;
  if (!*model) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*model)->T));
  PetscCall(PetscFree((*model)->K));
  PetscCall(PetscFree((*model)->inputs));
  PetscCall(PetscFree((*model)->constant));
  PetscCall(PetscFree(*model));
  PetscFunctionReturn(PETSC_SUCCESS);
}
