/* residual_truncated.c
 * A second stage keeps the states z = W x of the projected model, W^T W = I. Its residual is Galerkin's too, and with
 *   (iw E + K) V = E V (iw + Lambda) + R_0 c^T,   B = R_0 + E V B_r,   E V = (M V - R_0 c^T)(w + Lambda)^-1,
 * M = w E + K, it is
 *   R = R_0 Psi + M V g,   g = (w + Lambda)^-1 (B_r - (iw + Lambda) z),   Psi = 1 - c^T (z + g),
 * so that, as V^T R_0 = 0 and V^T M V = w + Lambda,
 *   R^H M^-1 R = Psi^H G Psi + g^H (w + Lambda) g. */
#include "reduce/mor/residual.h"
#include "reduce/mor/small_dense.h"
#include "reduce/petsc_compat.h"

/* z of W x, real or imaginary part, [r x p] */
static PetscErrorCode kept_state(const ModalModel *last, const PetscReal *W, PetscInt r, PetscReal w, int part,
                                 PetscReal *z)
{
  const PetscInt p = last->p;
  PetscReal *x;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)last->r * (size_t)p, &x));
  for (PetscInt k = 0; k < last->r; k++) {
    const PetscReal lambda = last->lambda[k], size = lambda * lambda + w * w;
    for (PetscInt l = 0; l < p; l++) x[l + k * p] = (part == 0 ? lambda : -w) / size * last->B[k * p + l];
  }
  PetscCall(small_multiply('N', 'T', r, p, last->r, 1.0, W, x, 0.0, z));
  PetscCall(PetscFree(x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* P + iS = g^H (w + Lambda) g, [p x p], its columns scaled by weight; g [r x p] of each part is scaled on the way. */
static PetscErrorCode kept_energy(const ModalModel *model, const PetscReal *weight, PetscReal w, PetscReal *const g[2],
                                  PetscReal *P, PetscReal *S)
{
  const PetscInt r = model->r, p = model->p;

  PetscFunctionBeginUser;
  for (int part = 0; part < 2; part++)
    for (PetscInt l = 0; l < p; l++)
      for (PetscInt k = 0; k < r; k++) g[part][k + l * r] *= weight[l] * PetscSqrtReal(w + model->lambda[k]);
  PetscCall(small_multiply('T', 'N', p, p, r, 1.0, g[0], g[0], 0.0, P));
  PetscCall(small_multiply('T', 'N', p, p, r, 1.0, g[1], g[1], 1.0, P));
  PetscCall(small_multiply('T', 'N', p, p, r, 1.0, g[0], g[1], 0.0, S));
  PetscCall(small_multiply('T', 'N', p, p, r, -1.0, g[1], g[0], 1.0, S));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode residual_truncated(const Residual *residual, const ModalModel *model, const TruncatedModel *cut,
                                  PetscReal w, const PetscReal *weight, PetscReal *const Psi[2], PetscReal *P,
                                  PetscReal *S)
{
  const PetscInt r = model->r, p = model->p;
  const size_t size = (size_t)r * (size_t)p;
  PetscReal *z[2], *g[2];

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc4(size, &z[0], size, &z[1], size, &g[0], size, &g[1]));
  for (int part = 0; part < 2; part++) PetscCall(kept_state(cut->last, cut->W, r, w, part, z[part]));
  for (PetscInt l = 0; l < p; l++)
    for (PetscInt k = 0; k < r; k++) {
      const PetscReal lambda = model->lambda[k], re = z[0][k + l * r], im = z[1][k + l * r];
      g[0][k + l * r] = (model->B[k * p + l] - lambda * re + w * im) / (w + lambda);
      g[1][k + l * r] = (-lambda * im - w * re) / (w + lambda);
    }
  for (int part = 0; part < 2; part++) {
    for (size_t e = 0; e < size; e++) z[part][e] += g[part][e];
    PetscCall(small_multiply('N', 'N', p, p, r, -1.0, residual->c, z[part], 0.0, Psi[part]));
    for (PetscInt l = 0; l < p; l++) {
      if (part == 0) Psi[0][l + l * p] += 1.0;
      for (PetscInt k = 0; k < p; k++) Psi[part][k + l * p] *= weight[l];
    }
  }
  PetscCall(kept_energy(model, weight, w, g, P, S));
  PetscCall(PetscFree4(z[0], z[1], g[0], g[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
