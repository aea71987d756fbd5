#include "reduce/mor/certificate/error_model.h"

#include <math.h>

#include "reduce/linear/small_dense.h"
#include "reduce/mor/certificate/laplace_contour.h"
#include "reduce/petsc/petsc_compat.h"

/* Eigenvalues of the vectors' Gram matrix, of lengths 1, below this are what inexact solves leave over. */
static const PetscReal DEPENDENT = 1e-3;
static const PetscReal WINDOW = 60.0; // ratio of the times that one contour serves

typedef struct RawNodes { // in the vectors [Z_1, Z_2, ..]
  PetscInt n, p;
  PetscReal *E, *K; // [n x n]
  PetscReal *B;     // [n x p] column-major
} RawNodes;

/* Blocks of E and K between the nodes i and j, whose vectors begin at row and column. */
static void fill_pair(const ErrorNodes *nodes, PetscInt i, PetscInt j, PetscInt row, PetscInt column, RawNodes *raw)
{
  const size_t p = (size_t)raw->p, n = (size_t)raw->n;
  const PetscReal *Gi = nodes->G + (size_t)i * p * p, *Gj = nodes->G + (size_t)j * p * p;
  const PetscReal *heat = nodes->heat + (size_t)i * p * p, u = nodes->rate[i], v = nodes->rate[j];
  for (size_t l = 0; l < p; l++)
    for (size_t k = 0; k < p; k++) {
      const size_t e = k + l * p;
      const PetscReal of_E = i == j ? heat[e] : (Gi[e] - Gj[e]) / (v - u);
      const PetscReal of_K = Gj[e] - u * of_E; // u < v: the difference that loses least
      raw->E[(size_t)row + k + ((size_t)column + l) * n] = raw->E[(size_t)column + l + ((size_t)row + k) * n] = of_E;
      raw->K[(size_t)row + k + ((size_t)column + l) * n] = raw->K[(size_t)column + l + ((size_t)row + k) * n] = of_K;
    }
}

static PetscErrorCode fill(const ErrorNodes *nodes, PetscInt first, PetscInt stride, RawNodes *raw)
{
  const PetscInt p = nodes->p;

  PetscFunctionBeginUser;
  raw->p = p;
  raw->n = ((nodes->n - first + stride - 1) / stride) * p;
  const size_t n = (size_t)raw->n;
  PetscCall(PetscMalloc3(n * n, &raw->E, n * n, &raw->K, n * (size_t)p, &raw->B));
  for (PetscInt i = first, row = 0; i < nodes->n; i += stride, row += p) {
    for (PetscInt j = i, column = row; j < nodes->n; j += stride, column += p) fill_pair(nodes, i, j, row, column, raw);
    for (size_t l = 0; l < (size_t)p; l++)
      PetscCall(
          PetscArraycpy(raw->B + (size_t)row + l * n, nodes->G + ((size_t)i * (size_t)p + l) * (size_t)p, (size_t)p));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* T [n x kept]: the vectors' combinations that are orthonormal; E is used up. */
static PetscErrorCode orthonormalise(MPI_Comm comm, RawNodes *raw, PetscReal **T, PetscInt *kept)
{
  const size_t n = (size_t)raw->n;
  PetscReal *scale, *w;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc2(n, &scale, n, &w));
  for (size_t i = 0; i < n; i++) scale[i] = raw->E[i + i * n] > 0.0 ? 1.0 / sqrt(raw->E[i + i * n]) : 0.0;
  for (size_t j = 0; j < n; j++)
    for (size_t i = 0; i < n; i++) raw->E[i + j * n] *= scale[i] * scale[j];
  PetscCall(small_eigen(comm, raw->n, raw->E, w));
  *kept = 0;
  while (*kept < raw->n && w[raw->n - 1 - *kept] > DEPENDENT) (*kept)++;
  PetscCall(PetscMalloc1(n * (size_t)PetscMax(*kept, 1), T));
  for (size_t c = 0; c < (size_t)*kept; c++) {
    const size_t from = n - (size_t)*kept + c;
    for (size_t i = 0; i < n; i++) (*T)[i + c * n] = scale[i] * raw->E[i + from * n] / sqrt(w[from]);
  }
  PetscCall(PetscFree2(scale, w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode error_model_create(MPI_Comm comm, const ErrorNodes *nodes, PetscInt first, PetscInt stride,
                                  ErrorModel **out)
{
  ErrorModel *error;
  RawNodes raw;
  PetscReal *T, *KT, *small, *B;
  PetscInt kept = 0;

  PetscFunctionBeginUser;
  PetscCall(PetscNew(&error));
  *out = error;
  error->comm = comm;
  error->p = nodes->p;
  PetscCall(fill(nodes, first, stride, &raw));
  PetscCall(orthonormalise(comm, &raw, &T, &kept));
  const size_t size = (size_t)kept, p = (size_t)nodes->p;
  error->n = kept;
  PetscCall(PetscMalloc1(PetscMax(size, 1), &error->lambda));
  PetscCall(PetscMalloc1(PetscMax(size * p, 1), &error->b));
  PetscCall(PetscMalloc3((size_t)raw.n * size, &KT, size * size, &small, size * p, &B));
  PetscCall(small_multiply('N', 'N', raw.n, kept, raw.n, 1.0, raw.K, T, 0.0, KT));
  PetscCall(small_multiply('T', 'N', kept, kept, raw.n, 1.0, T, KT, 0.0, small));
  PetscCall(small_eigen(comm, kept, small, error->lambda));
  for (PetscInt k = 0; k < kept; k++) error->lambda[k] = PetscMax(error->lambda[k], 0.0);
  PetscCall(small_multiply('T', 'N', nodes->p, kept, raw.n, 1.0, raw.B, T, 0.0, B));
  PetscCall(small_multiply('N', 'N', nodes->p, kept, kept, 1.0, B, small, 0.0, error->b)); // [p x n] is row-major
  PetscCall(PetscFree3(KT, small, B));
  PetscCall(PetscFree(T));
  PetscCall(PetscFree3(raw.E, raw.K, raw.B));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode error_model_energy(const ErrorModel *error, PetscReal w, PetscReal *G)
{
  const size_t n = (size_t)error->n, p = (size_t)error->p;
  PetscReal *scaled;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1(n * p, &scaled));
  for (size_t k = 0; k < n; k++)
    for (size_t l = 0; l < p; l++) scaled[l + k * p] = error->b[l + k * p] / (w + error->lambda[k]);
  PetscCall(PetscArrayzero(G, p * p));
  PetscCall(small_multiply('N', 'T', error->p, error->p, error->n, 1.0, error->b, scaled, 0.0, G));
  PetscCall(PetscFree(scaled));
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct Work { // columns: real parts of all inputs, then the imaginary ones
  PetscInt k;         // inputs
  PetscReal *driven;  // [r x k] B u
  PetscReal *x;       // [max(r, n) x 2k]
  PetscReal *phi, *g; // [p x 2k]
} Work;

/* X(i, :) /= s + lambda_i */
static void divide(PetscInt n, const PetscReal *lambda, double complex s, PetscInt k, PetscReal *X)
{
  const size_t rows = (size_t)n, imaginary = (size_t)n * (size_t)k;
  for (size_t i = 0; i < rows; i++) {
    const double complex factor = 1.0 / (s + lambda[i]);
    for (size_t e = i; e < imaginary; e += rows) {
      const PetscReal re = X[e], im = X[e + imaginary];
      X[e] = creal(factor) * re - cimag(factor) * im;
      X[e + imaginary] = creal(factor) * im + cimag(factor) * re;
    }
  }
}

/* g = Phi^T G Phi u at s, from phi = u on */
static PetscErrorCode transform_at(const ErrorModel *error, const Residual *residual, const ModalModel *model,
                                   const PetscReal *u, double complex s, Work *work)
{
  const PetscInt p = error->p, r = model->r, k = work->k;
  const size_t real = (size_t)r * (size_t)k, inputs = (size_t)p * (size_t)k;

  PetscFunctionBeginUser;
  PetscCall(PetscArraycpy(work->x, work->driven, real));
  PetscCall(PetscArrayzero(work->x + real, real));
  divide(r, model->lambda, s, k, work->x);
  PetscCall(PetscArraycpy(work->phi, u, inputs));
  PetscCall(PetscArrayzero(work->phi + inputs, inputs));
  PetscCall(small_multiply('N', 'N', p, 2 * k, r, -1.0, residual->c, work->x, 1.0, work->phi));
  PetscCall(small_multiply('T', 'N', error->n, 2 * k, p, 1.0, error->b, work->phi, 0.0, work->x));
  divide(error->n, error->lambda, s, k, work->x);
  PetscCall(small_multiply('N', 'N', p, 2 * k, error->n, 1.0, error->b, work->x, 0.0, work->g));
  PetscCall(small_multiply('T', 'N', r, 2 * k, p, 1.0, residual->c, work->g, 0.0, work->x));
  divide(r, model->lambda, s, k, work->x);
  PetscCall(small_multiply('N', 'N', p, 2 * k, r, -1.0, model->B, work->x, 1.0, work->g));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Times [first, last) by one contour. */
static PetscErrorCode window(const ErrorModel *error, const Residual *residual, const ModalModel *model,
                             const ErrorSteps *steps, PetscInt first, PetscInt last, Work *work, PetscReal *temperature)
{
  const size_t size = (size_t)error->p * (size_t)work->k;
  LaplaceContour contour;

  PetscFunctionBeginUser;
  laplace_contour_set(steps->time[first], steps->time[last - 1], &contour);
  for (int point = 0; point < CONTOUR_POINTS; point++) {
    const double complex s = contour.s[point];
    PetscCall(transform_at(error, residual, model, steps->u, s, work));
    for (PetscInt t = first; t < last; t++) {
      const double complex factor = cexp(s * steps->time[t]) * contour.weight[point] / s;
      PetscReal *at = temperature + (size_t)t * size;
      for (size_t e = 0; e < size; e++) at[e] += cimag(factor) * work->g[e] + creal(factor) * work->g[e + size];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode error_model_steps(const ErrorModel *error, const Residual *residual, const ModalModel *model,
                                 const ErrorSteps *steps, PetscReal *temperature)
{
  const PetscInt p = error->p, r = model->r, k = steps->n_inputs, n = PetscMax(r, error->n);
  const size_t inputs = (size_t)p * (size_t)k;
  Work work = {.k = k};

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc4((size_t)r * (size_t)k, &work.driven, 2 * (size_t)n * (size_t)k, &work.x, 2 * inputs, &work.phi,
                         2 * inputs, &work.g));
  PetscCall(PetscArrayzero(temperature, (size_t)steps->n_times * inputs));
  PetscCall(small_multiply('T', 'N', r, k, p, 1.0, model->B, steps->u, 0.0, work.driven));
  for (PetscInt first = 0, last; first < steps->n_times; first = last) {
    for (last = first + 1; last < steps->n_times && steps->time[last] <= WINDOW * steps->time[first];) last++;
    PetscCall(window(error, residual, model, steps, first, last, &work, temperature));
  }
  PetscCall(PetscFree4(work.driven, work.x, work.phi, work.g));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode error_model_destroy(ErrorModel **error)
{
  PetscFunctionBeginUser;
  if (!*error) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*error)->lambda));
  PetscCall(PetscFree((*error)->b));
  PetscCall(PetscFree(*error));
  PetscFunctionReturn(PETSC_SUCCESS);
}
