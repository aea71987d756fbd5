/* certificate.c
 * Galerkin's residual R(iw) = B - (iw E + K) V x(iw), x = (iw + Lambda)^-1 B_r, has V^T R = 0, and C = B^T, so
 *   H - H_r = R^T (iw E + K)^-1 R.
 * In the generalised eigenbasis of (K, E), |lambda + iw| >= (lambda + w)/sqrt(2), hence
 *   ||H(iw) - H_r(iw)||_2 <= sqrt(2) lambda_max(R^H (w E + K)^-1 R). */
#include "reduce/mor/certificate.h"

#include <math.h>

#include "reduce/mor/dense_block.h"
#include "reduce/mor/small_dense.h"
#include "reduce/petsc_compat.h"

/* The solves for the bound are exact to their tolerance, far below this. */
static const PetscReal SOLVER_SLACK = 1.01;

/* Re and Im of R: with x = xr + i xi,  Re R = B - K V xr + w E V xi,  Im R = -K V xi - w E V xr. */
static PetscErrorCode residual(const ThermalSystem *system, BV V, const ModalModel *model, PetscReal w, Mat R[2])
{
  const PetscInt r = model->r, m = system->m, p = model->p;
  Mat basis, Vx, product;
  PetscReal *x, *ones;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc2((size_t)r * (size_t)m, &x, (size_t)m, &ones));
  PetscCall(dense_block_create(system->E, m, &Vx));
  PetscCall(dense_block_create(system->E, m, &product));
  PetscCall(BVSetActiveColumns(V, 0, r));
  PetscCall(BVGetMat(V, &basis));
  PetscCall(MatCopy(system->B, R[0], SAME_NONZERO_PATTERN));
  PetscCall(MatZeroEntries(R[1]));
  for (int part = 0; part < 2; part++) {
    for (PetscInt k = 0; k < r; k++) {
      const PetscReal lambda = model->lambda[k], size = lambda * lambda + w * w;
      for (PetscInt l = 0; l < m; l++) x[k + l * r] = (part == 0 ? lambda : -w) / size * model->B[k * p + l];
    }
    PetscCall(dense_block_combine(Vx, 0.0, 1.0, basis, x, r));
    PetscCall(dense_block_multiply(system->K, Vx, product));
    for (PetscInt l = 0; l < m; l++) ones[l] = -1.0;
    PetscCall(dense_block_axpby(R[part], 1.0, ones, product));
    PetscCall(dense_block_multiply(system->E, Vx, product));
    for (PetscInt l = 0; l < m; l++) ones[l] = part == 0 ? -w : w;
    PetscCall(dense_block_axpby(R[1 - part], 1.0, ones, product));
  }
  PetscCall(BVRestoreMat(V, &basis));
  PetscCall(MatDestroy(&Vx));
  PetscCall(MatDestroy(&product));
  PetscCall(PetscFree2(x, ones));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* P + iS = D R^H (w E + K)^-1 R D, Hermitian. */
static PetscErrorCode error_energy(const ThermalSystem *system, ShiftedSolver *solver, Mat R[2], PetscReal *P,
                                   PetscReal *S)
{
  const size_t m = (size_t)system->m;
  Mat Z;
  PetscReal *G;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1(m * m, &G));
  PetscCall(dense_block_create(system->E, system->m, &Z));
  PetscCall(shifted_solver_solve(solver, R[0], Z));
  PetscCall(dense_block_inner(R[0], Z, P));
  PetscCall(dense_block_inner(R[1], Z, G)); // R_i^T M^-1 R_r
  for (size_t j = 0; j < m; j++)
    for (size_t i = 0; i < m; i++) S[i + j * m] = G[j + i * m] - G[i + j * m];
  PetscCall(shifted_solver_solve(solver, R[1], Z));
  PetscCall(dense_block_inner(R[1], Z, G));
  for (size_t j = 0; j < m; j++)
    for (size_t i = 0; i < m; i++) {
      const PetscReal weight = sqrt(system->area[i] * system->area[j]);
      P[i + j * m] = weight * (P[i + j * m] + G[i + j * m]);
      S[i + j * m] *= weight;
    }
  PetscCall(MatDestroy(&Z));
  PetscCall(PetscFree(G));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ||H_r(iw)||_2 by the Hermitian H^H H, H = P + iS with P and S symmetric. */
static PetscErrorCode transfer_norm(const ThermalSystem *system, const ModalModel *model, PetscReal w, PetscReal *norm)
{
  const size_t m = (size_t)system->m, r = (size_t)model->r, columns = (size_t)model->p;
  PetscReal *P, *S, *scaled, *real, *imaginary, largest;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc5(m * m, &P, m * m, &S, r * columns, &scaled, m * m, &real, m * m, &imaginary));
  for (int part = 0; part < 2; part++) {
    PetscReal *H = part == 0 ? P : S, *full;
    for (size_t k = 0; k < r; k++) {
      const PetscReal lambda = model->lambda[k];
      const PetscReal factor = (part == 0 ? lambda : -w) / (lambda * lambda + w * w);
      for (size_t l = 0; l < columns; l++) scaled[l + k * columns] = factor * model->B[k * columns + l];
    }
    PetscCall(PetscMalloc1(columns * columns, &full));
    PetscCall(small_multiply('N', 'T', model->p, model->p, model->r, 1.0, model->B, scaled, 0.0, full));
    for (size_t j = 0; j < m; j++)
      for (size_t i = 0; i < m; i++) H[i + j * m] = full[i + j * columns] * sqrt(system->area[i] * system->area[j]);
    PetscCall(PetscFree(full));
  }
  /* (P - iS)(P + iS) = (P^2 + S^2) + i(PS - SP) */
  PetscCall(small_multiply('N', 'N', system->m, system->m, system->m, 1.0, P, P, 0.0, real));
  PetscCall(small_multiply('N', 'N', system->m, system->m, system->m, 1.0, S, S, 1.0, real));
  PetscCall(small_multiply('N', 'N', system->m, system->m, system->m, 1.0, P, S, 0.0, imaginary));
  PetscCall(small_multiply('N', 'N', system->m, system->m, system->m, -1.0, S, P, 1.0, imaginary));
  PetscCall(small_hermitian_largest(model->comm, system->m, real, imaginary, &largest));
  *norm = sqrt(PetscMax(largest, 0.0));
  PetscCall(PetscFree5(P, S, scaled, real, imaginary));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode certificate_transfer_bound(const ThermalSystem *system, BV V, const ModalModel *model,
                                          ShiftedSolver *solver, PetscReal w, PetscReal *bound)
{
  const size_t m = (size_t)system->m;
  Mat R[2];
  PetscReal *P, *S, largest = 0.0, norm = 0.0;

  PetscFunctionBeginUser;
  PetscCall(shifted_solver_set_shift(solver, w, 2 * system->m));
  PetscCall(PetscMalloc2(m * m, &P, m * m, &S));
  PetscCall(dense_block_create(system->E, system->m, &R[0]));
  PetscCall(dense_block_create(system->E, system->m, &R[1]));
  PetscCall(residual(system, V, model, w, R));
  PetscCall(error_energy(system, solver, R, P, S));
  PetscCall(small_hermitian_largest(model->comm, system->m, P, S, &largest));
  PetscCall(transfer_norm(system, model, w, &norm));
  *bound = SOLVER_SLACK * PETSC_SQRT2 * largest / norm;
  PetscCall(MatDestroy(&R[0]));
  PetscCall(MatDestroy(&R[1]));
  PetscCall(PetscFree2(P, S));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode certificate_orthogonality(const ThermalSystem *system, BV V, PetscReal *defect)
{
  enum { WIDTH = 64 };
  PetscInt r;
  Mat X, EX;
  PetscReal *G;

  PetscFunctionBeginUser;
  *defect = 0.0;
  PetscCall(BVGetActiveColumns(V, NULL, &r));
  PetscCall(PetscMalloc1((size_t)r * WIDTH, &G));
  PetscCall(dense_block_create(system->E, WIDTH, &X));
  PetscCall(dense_block_create(system->E, WIDTH, &EX));
  for (PetscInt first = 0; first < r; first += WIDTH) {
    const PetscInt k = PetscMin(WIDTH, r - first);
    Mat basis;
    PetscInt column[WIDTH];
    for (PetscInt c = 0; c < k; c++) column[c] = first + c;
    PetscCall(BVGetMat(V, &basis));
    PetscCall(dense_block_copy(X, 0, basis, column, k));
    PetscCall(dense_block_multiply(system->E, X, EX));
    PetscCall(dense_block_inner(basis, EX, G));
    PetscCall(BVRestoreMat(V, &basis));
    for (PetscInt c = 0; c < k; c++)
      for (PetscInt i = 0; i < r; i++)
        *defect = PetscMax(*defect, PetscAbsReal(G[i + c * r] - (i == first + c ? 1.0 : 0.0)));
  }
  PetscCall(MatDestroy(&X));
  PetscCall(MatDestroy(&EX));
  PetscCall(PetscFree(G));
  PetscFunctionReturn(PETSC_SUCCESS);
}
