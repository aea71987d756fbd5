/* modes.h - the mould's slowest thermal modes, K v = lambda E v, as a reduction space. For comparison: they know
 * nothing of where heat enters, and hundreds are needed before a millisecond shows. */
#ifndef REDUCE_MOR_MODES_H
#define REDUCE_MOR_MODES_H

#include "reduce/linear/shifted_solver.h"
#include "reduce/mor/krylov/krylov_basis.h"

/* Add the k slowest modes to the basis, by shift-and-invert Lanczos (SLEPc) about -shift, where shift E + K is positive
 * definite; the solver takes that shift. PETSc options with the prefix -mor_ (-mor_eps_ncv and so on) overrule.
 * Errors: PETSC_ERR_NOT_CONVERGED with how many were found. */
PetscErrorCode modes_add(KrylovBasis *basis, ShiftedSolver *solver, PetscReal shift, PetscInt k);

#endif
