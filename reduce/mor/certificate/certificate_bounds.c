/* certificate_bounds.c */
#include <math.h>

#include "reduce/linear/small_dense.h"
#include "reduce/mor/certificate/certificate_private.h"
#include "reduce/petsc/petsc_compat.h"

enum { EVALUATIONS_PER_DECADE = 2 }; // of the bound, and as many again halfway between

static const PetscReal ROUNDING = 1e-12; // of the arithmetic, relative to ||H||

typedef struct Energy { // of the residual R D at a rate, in the norm of (w E + K)^-1, squared
  PetscReal exact;      // of R_0 Phi D, from above
  PetscReal all;        // with what R_0 Phi leaves out
} Energy;

/* By the nodes around w; the matrix itself is left in part[0].
 */
static PetscErrorCode largest_energy(const Certificate *band, PetscReal w, Energy *largest)
{
  const size_t square = (size_t)band->p * (size_t)band->p;
  PetscReal *const *below = band->part[0], *const *above = band->part[1], size;
  PetscInt k = 0;

  PetscFunctionBeginUser;
  while (k < band->n_nodes - 2 && band->node[k + 1] <= w) k++;
  const PetscReal U = band->node[k] + w, W = 2.0 * w, V = band->node[k + 1] + w; // lambda_0 = w
  const PetscReal a = (U / W) * (U / W) * (V - W) / (V - U), b = (V / W) * (V / W) * (W - U) / (V - U);
  PetscCall(certificate_energy(band, band->G + (size_t)k * square, below[0], below[1]));
  PetscCall(certificate_energy(band, band->G + (size_t)(k + 1) * square, above[0], above[1]));
  for (int i = 0; i < 2; i++)
    for (size_t e = 0; e < square; e++) below[i][e] = a * below[i][e] + b * above[i][e];
  PetscCall(small_hermitian_largest(band->model->comm, band->p, below[0], below[1], &largest->exact));
  largest->exact = PetscMax(largest->exact, 0.0);
  PetscCall(residual_defect_by_sums(band->residual, band->model, w, band->weight, &size));
  size *= PetscMax(band->solved[k], band->solved[k + 1]);
  largest->all = pow(sqrt(largest->exact) + size, 2.0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ||P + iS||_2, both symmetric, by the Hermitian (P - iS)(P + iS) = (P^2 + S^2) + i(PS - SP). */
static PetscErrorCode symmetric_norm(const Certificate *band, const PetscReal *P, const PetscReal *S, PetscReal *norm)
{
  const PetscInt p = band->p;
  PetscReal *real = band->part[1][0], *imaginary = band->part[1][1];

  PetscFunctionBeginUser;
  PetscCall(small_multiply('N', 'N', p, p, p, 1.0, P, P, 0.0, real));
  PetscCall(small_multiply('N', 'N', p, p, p, 1.0, S, S, 1.0, real));
  PetscCall(small_multiply('N', 'N', p, p, p, 1.0, P, S, 0.0, imaginary));
  PetscCall(small_multiply('N', 'N', p, p, p, -1.0, S, P, 1.0, imaginary));
  PetscCall(small_hermitian_largest(band->model->comm, p, real, imaginary, norm));
  *norm = sqrt(PetscMax(*norm, 0.0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* D (H - H_other) D of two models, other NULL: of one, and its norm; P, S [p x p] its parts. */
static PetscErrorCode transfer(const Certificate *band, const ModalModel *model, const ModalModel *other, PetscReal w,
                               PetscReal *P, PetscReal *S, PetscReal *norm)
{
  const PetscInt p = band->p;

  PetscFunctionBeginUser;
  PetscCall(modal_model_transfer(model, other, w, P, S));
  for (PetscInt j = 0; j < p; j++)
    for (PetscInt i = 0; i < p; i++) {
      P[i + j * p] *= band->weight[i] * band->weight[j];
      S[i + j * p] *= band->weight[i] * band->weight[j];
    }
  PetscCall(symmetric_norm(band, P, S, norm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* P + iS += (1 - i)/2 Phi^T G Phi, of what certificate_energy has left in product */
static PetscErrorCode add_centre(const Certificate *band, PetscReal *P, PetscReal *S)
{
  const PetscInt p = band->p;
  const PetscReal half[2][2][2] = {{{0.5, -0.5}, {0.5, 0.5}}, {{0.5, 0.5}, {-0.5, 0.5}}}; // [Phi][product][P or S]

  PetscFunctionBeginUser;
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      const PetscReal *factor = half[i][j];
      PetscCall(small_multiply('T', 'N', p, p, p, factor[0], band->Phi[i], band->product[j], 1.0, P));
      PetscCall(small_multiply('T', 'N', p, p, p, factor[1], band->Phi[i], band->product[j], 1.0, S));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By the disc around what is known of H - H_last; part[0] is the energy from above.
 *   T [P, S] D (H_r - H_last) D, used up */
static PetscErrorCode disc_bound(const Certificate *band, PetscReal w, const Energy *largest, PetscReal *const T[2],
                                 PetscReal *bound)
{
  const size_t square = (size_t)band->p * (size_t)band->p;
  PetscReal *G, *const *above = band->part[0], *const *below = band->part[1], gap, centre;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1(square, &G));
  PetscCall(error_model_energy(band->error, w, G));
  PetscCall(certificate_energy(band, G, below[0], below[1]));
  for (int i = 0; i < 2; i++)
    for (size_t e = 0; e < square; e++) below[i][e] = above[i][e] - below[i][e];
  PetscCall(small_hermitian_largest(band->model->comm, band->p, below[0], below[1], &gap));
  gap = PetscMax(gap, 0.0) + 2.0 * band->mismatch * largest->exact;
  PetscCall(add_centre(band, T[0], T[1]));
  PetscCall(symmetric_norm(band, T[0], T[1], &centre));
  *bound =
      centre + PETSC_SQRT2 / 2.0 * (largest->exact + gap) + PETSC_SQRT2 * (largest->all - largest->exact) + band->slip;
  PetscCall(PetscFree(G));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode bound_at(const Certificate *band, const ModalModel *last, PetscReal w, PetscReal *bound)
{
  const size_t square = (size_t)band->p * (size_t)band->p;
  PetscReal *T[2], truncated = 0.0, norm, other = PETSC_MAX_REAL;
  Energy largest;

  PetscFunctionBeginUser;
  PetscCall(PetscCalloc2(square, &T[0], square, &T[1]));
  PetscCall(transfer(band, last, NULL, w, T[0], T[1], &norm));
  if (last != band->model)
    PetscCall(transfer(band, band->model, last, w, T[0], T[1], &truncated));
  else
    for (int i = 0; i < 2; i++) PetscCall(PetscArrayzero(T[i], square));
  PetscCall(certificate_take_factor(band, w));
  PetscCall(largest_energy(band, w, &largest));
  *bound = PETSC_SQRT2 * largest.all + band->slip + truncated;
  if (band->error) PetscCall(disc_bound(band, w, &largest, T, &other));
  *bound = PetscMin(*bound, other);
  *bound = *bound / norm + ROUNDING;
  PetscCall(PetscFree2(T[0], T[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where the bound bends downwards, by half of what a straight line through both neighbours misses: on either side the
 * line is between points half as far apart, so that a quarter would do. */
static PetscErrorCode raise_between(PetscInt n, PetscReal *bound)
{
  PetscReal *factor;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)n, &factor));
  for (PetscInt i = 0; i < n; i++) factor[i] = 1.0;
  for (PetscInt i = 1; i + 1 < n; i++) {
    const PetscReal missed = bound[i] / sqrt(bound[i - 1] * bound[i + 1]) - 1.0;
    for (PetscInt k = i - 1; k <= i + 1; k++) factor[k] = PetscMax(factor[k], 1.0 + 0.5 * missed);
  }
  for (PetscInt i = 0; i < n; i++) bound[i] *= factor[i];
  PetscCall(PetscFree(factor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode certificate_transfer_bounds(const Certificate *band, const ModalModel *last, PetscInt *n,
                                           PetscReal **frequency, PetscReal **bound)
{
  const PetscReal ratio = band->w_last / band->w_first;
  const PetscInt gaps = PetscMax(1, (PetscInt)ceil(EVALUATIONS_PER_DECADE * log10(ratio) - 1e-9));
  PetscReal *w, *at;

  PetscFunctionBeginUser;
  *n = 2 * gaps + 1;
  PetscCall(PetscMalloc2((size_t)*n, &w, (size_t)*n, &at));
  for (PetscInt i = 0; i < *n; i++) {
    w[i] = i == *n - 1 ? band->w_last : band->w_first * pow(ratio, (double)i / (double)(*n - 1));
    PetscCall(bound_at(band, last, w[i], &at[i]));
  }
  PetscCall(raise_between(*n, at));
  *frequency = w;
  *bound = at;
  PetscFunctionReturn(PETSC_SUCCESS);
}
