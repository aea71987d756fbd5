/* modes.c
 * Method: Krylov-Schur on (shift E + K)^-1 E in the E inner product, with the reduction's own solver inside.
 * Reference: Stewart 2001, SIAM J. Matrix Anal. Appl. 23, 601. */
#include "reduce/mor/modes.h"

#include <slepceps.h>

#include "reduce/linear/dense_block.h"
#include "reduce/petsc/petsc_compat.h"

enum { WIDTH = 32 };                                // modes handed over at a time
static const PetscReal EIGENVALUE_TOLERANCE = 1e-8; // of lambda: far below what the truncation loses

typedef struct Inverse { // as a preconditioner, for SLEPc
  ShiftedSolver *solver; // borrowed
  Mat in, out;           // [n x 1]
} Inverse;

static PetscErrorCode apply_inverse(PC pc, Vec x, Vec y)
{
  Inverse *inverse;
  Vec column;

  PetscFunctionBeginUser;
  PetscCall(PCShellGetContext(pc, &inverse));
  PetscCall(MatDenseGetColumnVecWrite(inverse->in, 0, &column));
  PetscCall(VecCopy(x, column));
  PetscCall(MatDenseRestoreColumnVecWrite(inverse->in, 0, &column));
  PetscCall(shifted_solver_solve(inverse->solver, inverse->in, inverse->out));
  PetscCall(MatDenseGetColumnVecRead(inverse->out, 0, &column));
  PetscCall(VecCopy(column, y));
  PetscCall(MatDenseRestoreColumnVecRead(inverse->out, 0, &column));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode set_transformation(EPS eps, PetscReal shift, Inverse *inverse)
{
  ST st;
  KSP ksp;
  PC pc;

  PetscFunctionBeginUser;
  PetscCall(EPSGetST(eps, &st));
  PetscCall(STSetType(st, STSINVERT));
  PetscCall(STSetShift(st, -shift));
  PetscCall(STGetKSP(st, &ksp));
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCSHELL));
  PetscCall(PCShellSetContext(pc, inverse));
  PetscCall(PCShellSetApply(pc, apply_inverse));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode solve(EPS eps, const ThermalSystem *system, PetscReal shift, PetscInt k, Inverse *inverse)
{
  PetscInt found;

  PetscFunctionBeginUser;
  PetscCall(EPSSetOptionsPrefix(eps, "mor_"));
  PetscCall(EPSSetOperators(eps, system->K, system->E));
  PetscCall(EPSSetProblemType(eps, EPS_GHEP));
  PetscCall(EPSSetType(eps, EPSKRYLOVSCHUR));
  PetscCall(EPSSetDimensions(eps, k, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(EPSSetTolerances(eps, EIGENVALUE_TOLERANCE, PETSC_DEFAULT));
  PetscCall(EPSSetWhichEigenpairs(eps, EPS_TARGET_MAGNITUDE));
  PetscCall(EPSSetTarget(eps, -shift));
  PetscCall(set_transformation(eps, shift, inverse));
  PetscCall(EPSSetFromOptions(eps));
  PetscCall(EPSSolve(eps));
  PetscCall(EPSGetConverged(eps, &found));
  PetscCheck(found >= k, PetscObjectComm((PetscObject)eps), PETSC_ERR_NOT_CONVERGED,
             "method modal: only %d of the %d slowest modes converged", (int)found, (int)k);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode hand_over(EPS eps, PetscInt k, KrylovBasis *basis)
{
  PetscFunctionBeginUser;
  for (PetscInt first = 0; first < k; first += PetscMin(WIDTH, basis->width)) {
    const PetscInt width = PetscMin(PetscMin(WIDTH, basis->width), k - first);
    PetscInt kept;
    Mat X;
    PetscCall(krylov_basis_get_block(basis, width, &X));
    for (PetscInt c = 0; c < width; c++) {
      Vec column;
      PetscCall(MatDenseGetColumnVecWrite(X, c, &column));
      PetscCall(EPSGetEigenvector(eps, first + c, column, NULL));
      PetscCall(MatDenseRestoreColumnVecWrite(X, c, &column));
    }
    PetscCall(krylov_basis_add(basis, &X, &kept));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode modes_add(KrylovBasis *basis, ShiftedSolver *solver, PetscReal shift, PetscInt k)
{
  const ThermalSystem *system = basis->system;
  Inverse inverse = {.solver = solver};
  EPS eps;

  PetscFunctionBeginUser;
  PetscCheck(k < system->n, PetscObjectComm((PetscObject)system->E), PETSC_ERR_USER,
             "reduction.modes: %d; the mould has %d unknowns", (int)k, (int)system->n);
  PetscCall(shifted_solver_set_shift(solver, shift, 4 * k));
  PetscCall(dense_block_create(system->E, 1, &inverse.in));
  PetscCall(dense_block_create(system->E, 1, &inverse.out));
  PetscCall(EPSCreate(PetscObjectComm((PetscObject)system->E), &eps));
  PetscCall(solve(eps, system, shift, k, &inverse));
  PetscCall(hand_over(eps, k, basis));
  PetscCall(EPSDestroy(&eps));
  PetscCall(MatDestroy(&inverse.in));
  PetscCall(MatDestroy(&inverse.out));
  PetscFunctionReturn(PETSC_SUCCESS);
}
