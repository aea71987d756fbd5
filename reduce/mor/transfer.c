/* transfer.c - H(s) at a real s, of the reduced and of the full model. */
#include "reduce/linear/dense_block.h"
#include "reduce/linear/shifted_solver.h"
#include "reduce/mor/reduced_model.h"
#include "reduce/petsc/petsc_compat.h"

PetscErrorCode reduced_model_transfer(const ReducedModel *model, PetscReal s, PetscReal *H)
{
  const size_t m = (size_t)model->m;

  PetscFunctionBeginUser;
  PetscCheck(s > 0.0 || model->lambda[0] > 0.0, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
             "H(s) at s = %g 1/s: the mould keeps its heat (lambda = 0), so s > 0 is expected", (double)s);
  PetscCall(PetscArrayzero(H, m * m));
  for (size_t k = 0; k < (size_t)model->r; k++) {
    const PetscReal *row = model->B + k * m, weight = 1.0 / (s + model->lambda[k]);
    for (size_t i = 0; i < m; i++)
      for (size_t j = 0; j < m; j++) H[i * m + j] += row[i] * weight * row[j];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode thermal_system_transfer(const ThermalSystem *system, PetscReal s, PetscReal rtol, PetscReal *H)
{
  ShiftedSolver *solver = NULL;
  Mat X;

  PetscFunctionBeginUser;
  PetscCall(shifted_solver_create(system, rtol, PETSC_FALSE, &solver));
  PetscCall(shifted_solver_set_shift(solver, s, system->m));
  PetscCall(dense_block_create(system->E, system->m, &X));
  PetscCall(shifted_solver_solve(solver, system->B, X));
  PetscCall(dense_block_inner(system->B, X, H)); // symmetric: row-major and column-major are the same
  PetscCall(MatDestroy(&X));
  PetscCall(shifted_solver_destroy(&solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}
