/* residual_directions.c - which directions of the inputs the basis lacks at a real rate. */
#include "reduce/linear/dense_block.h"
#include "reduce/linear/small_dense.h"
#include "reduce/mor/certificate/residual.h"
#include "reduce/petsc/petsc_compat.h"

/* Phi(s) D at a real s, [p x p] */
static PetscErrorCode real_factor(const Residual *residual, const ModalModel *model, PetscReal s,
                                  const PetscReal *weight, PetscReal *Phi)
{
  const PetscInt p = residual->p;
  PetscReal *x;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)model->r * (size_t)p, &x));
  for (PetscInt k = 0; k < model->r; k++)
    for (PetscInt l = 0; l < p; l++) x[k * p + l] = model->B[k * p + l] / (s + model->lambda[k]);
  PetscCall(small_multiply('N', 'T', p, p, model->r, -1.0, residual->c, x, 0.0, Phi));
  for (PetscInt l = 0; l < p; l++) {
    Phi[l + l * p] += 1.0;
    for (PetscInt k = 0; k < p; k++) Phi[k + l * p] *= weight[l];
  }
  PetscCall(PetscFree(x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode residual_directions(const Residual *residual, const ModalModel *model, ShiftedSolver *solver,
                                   PetscReal s, const PetscReal *weight, PetscReal least, Mat *X, PetscReal *largest)
{
  const PetscInt p = residual->p;
  PetscReal *Phi, *G, *error, *product, *value;
  PetscInt k = 0;
  Mat Z;

  PetscFunctionBeginUser;
  *X = NULL;
  const size_t square = (size_t)p * (size_t)p;
  PetscCall(PetscMalloc5(square, &Phi, square, &G, square, &error, square, &product, (size_t)p, &value));
  PetscCall(shifted_solver_set_shift(solver, s, p));
  PetscCall(dense_block_create(residual->system->E, p, &Z));
  PetscCall(shifted_solver_solve(solver, residual->R0, Z));
  PetscCall(dense_block_inner(residual->R0, Z, G));
  PetscCall(real_factor(residual, model, s, weight, Phi));
  PetscCall(small_multiply('N', 'N', p, p, p, 1.0, G, Phi, 0.0, product));
  PetscCall(small_multiply('T', 'N', p, p, p, 1.0, Phi, product, 0.0, error));
  PetscCall(small_eigen(model->comm, p, error, value));
  *largest = value[p - 1];
  while (k < p && value[p - 1 - k] > least) k++;
  if (k > 0) { // the eigenvectors stand in the last k columns
    PetscCall(small_multiply('N', 'N', p, k, p, 1.0, Phi, error + (size_t)(p - k) * (size_t)p, 0.0, product));
    PetscCall(dense_block_create(residual->system->E, k, X));
    PetscCall(dense_block_combine(*X, 0.0, 1.0, Z, product, p));
  }
  PetscCall(MatDestroy(&Z));
  PetscCall(PetscFree5(Phi, G, error, product, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}
