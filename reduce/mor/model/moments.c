#include "reduce/mor/model/moments.h"

#include <math.h>

#include "reduce/linear/dense_block.h"
#include "reduce/petsc/petsc_compat.h"

PetscErrorCode moments_create(PetscInt n_inputs, PetscInt p, Moments **moments)
{
  PetscFunctionBeginUser;
  PetscCall(PetscNew(moments));
  (*moments)->n_inputs = n_inputs;
  (*moments)->p = p;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode moments_append(Moments *moments, PetscReal shift, PetscInt power, const PetscReal *value)
{
  const size_t size = (size_t)moments->n_inputs * (size_t)moments->p;

  PetscFunctionBeginUser;
  if (moments->n == moments->capacity) {
    moments->capacity = 2 * moments->capacity + 16;
    PetscCall(PetscRealloc((size_t)moments->capacity * sizeof(PetscReal), &moments->shift));
    PetscCall(PetscRealloc((size_t)moments->capacity * sizeof(PetscInt), &moments->power));
    PetscCall(PetscRealloc((size_t)moments->capacity * size * sizeof(PetscReal), &moments->value));
  }
  moments->shift[moments->n] = shift;
  moments->power[moments->n] = power;
  PetscCall(PetscArraycpy(moments->value + (size_t)moments->n * size, value, size));
  moments->n++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode moments_compute(Moments *moments, const ThermalSystem *system, ShiftedSolver *solver, Mat ports, Mat F,
                               PetscInt q)
{
  Mat X, EX;
  PetscReal *value;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)moments->n_inputs * (size_t)moments->p, &value));
  PetscCall(dense_block_create(system->E, moments->n_inputs, &X));
  PetscCall(dense_block_create(system->E, moments->n_inputs, &EX));
  for (PetscInt k = 0; k < q; k++) {
    PetscCall(shifted_solver_solve(solver, k == 0 ? F : EX, X));
    PetscCall(dense_block_multiply(system->E, X, EX));
    PetscCall(dense_block_inner(ports, X, value));
    PetscCall(moments_append(moments, shifted_solver_get_shift(solver), k, value));
  }
  PetscCall(MatDestroy(&X));
  PetscCall(MatDestroy(&EX));
  PetscCall(PetscFree(value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode moments_compare(const Moments *moments, const ModalModel *model, const PetscReal *u, PetscReal *error)
{
  const PetscInt p = moments->p;
  PetscReal *reduced;

  PetscFunctionBeginUser;
  *error = moments->n > 0 ? 0.0 : (PetscReal)NAN;
  PetscCall(PetscMalloc1((size_t)p, &reduced));
  for (PetscInt a = 0; a < moments->n; a++)
    for (PetscInt j = 0; j < moments->n_inputs; j++) {
      const PetscReal *full = moments->value + ((size_t)a * (size_t)moments->n_inputs + (size_t)j) * (size_t)p;
      PetscReal difference = 0.0, size = 0.0;
      modal_model_moment(model, moments->shift[a], moments->power[a], u + (size_t)j * (size_t)p, reduced);
      for (PetscInt i = 0; i < p; i++) {
        difference += (reduced[i] - full[i]) * (reduced[i] - full[i]);
        size += full[i] * full[i];
      }
      if (size > 0.0) *error = PetscMax(*error, sqrt(difference / size));
    }
  PetscCall(PetscFree(reduced));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode moments_destroy(Moments **moments)
{
  PetscFunctionBeginUser;
  if (!*moments) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*moments)->shift));
  PetscCall(PetscFree((*moments)->power));
  PetscCall(PetscFree((*moments)->value));
  PetscCall(PetscFree(*moments));
  PetscFunctionReturn(PETSC_SUCCESS);
}
