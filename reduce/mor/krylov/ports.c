#include "reduce/mor/krylov/ports.h"

#include "reduce/linear/dense_block.h"
#include "reduce/petsc/petsc_compat.h"

PetscErrorCode ports_create(const ThermalSystem *system, Mat *ports, PetscReal *sum)
{
  Vec column;

  PetscFunctionBeginUser;
  PetscCall(VecSum(system->ambient, sum));
  if (*sum <= 0.0) {
    *sum = 0.0;
    PetscCall(PetscObjectReference((PetscObject)system->B));
    *ports = system->B;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(dense_block_create(system->E, system->m + 1, ports));
  PetscCall(dense_block_copy(*ports, 0, system->B, NULL, system->m));
  PetscCall(MatDenseGetColumnVecWrite(*ports, system->m, &column));
  PetscCall(VecCopy(system->ambient, column));
  PetscCall(VecScale(column, 1.0 / *sum));
  PetscCall(MatDenseRestoreColumnVecWrite(*ports, system->m, &column));
  PetscFunctionReturn(PETSC_SUCCESS);
}
