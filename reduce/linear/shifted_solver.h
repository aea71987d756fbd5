/* shifted_solver.h - solve (s E + K) X = B for blocks of right-hand sides at one real shift s after another.
 *
 * The matrix is symmetric positive definite for s > 0, and for s = 0 where K is regular. Each solve ends with the
 * residual computed and held against the tolerance, whatever the preconditioner: block conjugate gradients, column by
 * column in arithmetic and block by block in memory traffic, preconditioned by
 *   MUMPS Cholesky, block low-rank where the tolerance allows (default up to a few hundred thousand unknowns),
 *   incomplete Cholesky in single precision, 16 columns at a time, where that costs less (panel_cg.h),
 *   BoomerAMG (larger, or forced).
 * PETSc options with the prefix -mor_ (-mor_pc_type and so on) overrule the choice. */
#ifndef REDUCE_LINEAR_SHIFTED_SOLVER_H
#define REDUCE_LINEAR_SHIFTED_SOLVER_H

#include "reduce/config/config.h"
#include "reduce/fem/thermal_system.h"

typedef struct ShiftedSolver ShiftedSolver;

typedef struct ShiftedSolverCount {     // what was done so far
  PetscInt setups, columns, iterations; // iterations: applications of a preconditioner to one column
} ShiftedSolverCount;

/* `system` borrowed: must outlive the solver. rtol: of the residual of each column, over the norm of its right-hand
 * side. iterative: never factorise. Collective. */
PetscErrorCode shifted_solver_create(const ThermalSystem *system, PetscReal rtol, PetscBool iterative,
                                     ShiftedSolver **solver);
/* Take shift s, 1/s, and build the preconditioner that is cheapest for about so many `columns` to be solved with it.
 * Errors: s < 0, or s = 0 where K is singular. */
PetscErrorCode shifted_solver_set_shift(ShiftedSolver *solver, PetscReal s, PetscInt columns);
/* Change the tolerance for the solves that follow; the preconditioner stays. */
void shifted_solver_set_tolerance(ShiftedSolver *solver, PetscReal rtol);
/* Errors: PETSC_ERR_NOT_CONVERGED with the residual reached. B and X must differ. */
PetscErrorCode shifted_solver_solve(ShiftedSolver *solver, Mat B, Mat X);
PetscReal shifted_solver_get_shift(const ShiftedSolver *solver);
ShiftedSolverCount shifted_solver_get_count(const ShiftedSolver *solver);
/* "MUMPS Cholesky", for the log. */
const char *shifted_solver_get_name(const ShiftedSolver *solver);
PetscErrorCode shifted_solver_destroy(ShiftedSolver **solver);

#endif
