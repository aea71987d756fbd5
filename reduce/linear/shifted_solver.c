#include "reduce/linear/shifted_solver.h"

#include <petscksp.h>

#include "reduce/linear/dense_block.h"
#include "reduce/linear/panel_cg.h"
#include "reduce/petsc/petsc_compat.h"

enum {
  BATCH = 64,           // columns solved at a time: bounds the memory, and MUMPS gains little from more
  DIRECT_LIMIT = 300000 // unknowns: above, AMG needs less memory and soon less time than a factor
};

static const PetscReal LOW_RANK_RTOL = 1e-9; // tighter tolerances get the full-rank factor

struct ShiftedSolver {
  const ThermalSystem *system; // borrowed
  Mat A;                       // s E + K, on the union of both patterns
  PC factor;                   // the preconditioner where sweeps do not pay; owned
  PanelCg *panels;             // the solver where they do; owned
  PetscBool sweeping;          // panels are in use, not the factor
  const char *name;
  PetscReal shift, rtol;
  PetscBool direct, low_rank, chosen_by_user;
  PetscInt limit; // of iterations with sweeps: more would cost more than the factor
  ShiftedSolverCount count;
  PetscInt width; // columns of the work blocks; 0: none yet
  Mat R, Z, P, Q; // [n x width]
};

static PetscErrorCode set_default_option(const char *name, const char *value)
{
  PetscBool given;

  PetscFunctionBeginUser;
  PetscCall(PetscOptionsHasName(NULL, NULL, name, &given));
  if (!given) PetscCall(PetscOptionsSetValue(NULL, name, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* HMIS with extended+i interpolation stays robust on meshes graded over two decades. */
static PetscErrorCode prepare_amg(PC pc)
{
  PetscFunctionBeginUser;
  PetscCall(PCSetType(pc, PCHYPRE));
  PetscCall(PCHYPRESetType(pc, "boomeramg"));
  PetscCall(set_default_option("-mor_pc_hypre_boomeramg_coarsen_type", "HMIS"));
  PetscCall(set_default_option("-mor_pc_hypre_boomeramg_interp_type", "ext+i"));
  PetscCall(set_default_option("-mor_pc_hypre_boomeramg_P_max", "4"));
  PetscCall(set_default_option("-mor_pc_hypre_boomeramg_strong_threshold", "0.5"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Any block low-rank error is mended by the conjugate gradients around it. */
static PetscErrorCode prepare_cholesky(PC pc, PetscBool low_rank)
{
  Mat factor;

  PetscFunctionBeginUser;
  PetscCall(PCSetType(pc, PCCHOLESKY));
  PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  PetscCall(PCFactorSetUpMatSolverType(pc));
  PetscCall(PCFactorGetMatrix(pc, &factor));
  if (low_rank) {
    PetscCall(MatMumpsSetIcntl(factor, 35, 2));
    PetscCall(MatMumpsSetCntl(factor, 7, 1e-8));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode create_preconditioners(ShiftedSolver *solver)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)solver->A);

  PetscFunctionBeginUser;
  PetscCall(PCCreate(comm, &solver->factor));
  PetscCall(PCSetOptionsPrefix(solver->factor, "mor_"));
  PetscCall(PCSetOperators(solver->factor, solver->A, solver->A));
  PetscCall(PetscOptionsHasName(NULL, "mor_", "-pc_type", &solver->chosen_by_user));
  if (!solver->chosen_by_user) {
    if (solver->direct)
      PetscCall(prepare_cholesky(solver->factor, solver->low_rank));
    else
      PetscCall(prepare_amg(solver->factor));
  }
  PetscCall(PCSetFromOptions(solver->factor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode shifted_solver_create(const ThermalSystem *system, PetscReal rtol, PetscBool iterative,
                                     ShiftedSolver **out)
{
  ShiftedSolver *solver;

  PetscFunctionBeginUser;
  PetscCall(PetscNew(&solver));
  *out = solver;
  solver->system = system;
  solver->rtol = rtol;
  solver->direct = (PetscBool)(!iterative && system->n <= DIRECT_LIMIT);
  solver->low_rank = (PetscBool)(rtol > LOW_RANK_RTOL);
  solver->shift = -1.0;
  PetscCall(MatDuplicate(system->K, MAT_COPY_VALUES, &solver->A));
  PetscCall(MatAXPY(solver->A, 1.0, system->E, UNKNOWN_NONZERO_PATTERN));
  PetscCall(MatSetOption(solver->A, MAT_NEW_NONZERO_LOCATION_ERR, PETSC_TRUE));
  PetscCall(MatSetOption(solver->A, MAT_SPD, PETSC_TRUE));
  PetscCall(create_preconditioners(solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Iterations that sweeps need. P1 elements: D^-1 E has its spectrum in [1/2, 5/2] and D^-1 K in [0, 4] on any
 * mesh (Wathen 1987, IMA J. Numer. Anal. 7, 449), so the condition grows at most like x = 1 + max K_ii/(s E_ii). On
 * graded meshes the smallest elements are few, and a power of x fits what was measured for 1 < x < 3e5, with symmetric
 * Gauss-Seidel. Between rows of conduction it is up to three times less; the choice stays with the more, as what a
 * factor leaves over is less by far, and the certificate has to add it. */
static PetscErrorCode expect_iterations(ShiftedSolver *solver, PetscReal s, PetscReal *iterations)
{
  Vec e, k;
  PetscReal ratio;

  PetscFunctionBeginUser;
  PetscCall(MatCreateVecs(solver->A, &e, &k));
  PetscCall(MatGetDiagonal(solver->system->E, e));
  PetscCall(MatGetDiagonal(solver->system->K, k));
  PetscCall(VecPointwiseDivide(k, k, e));
  PetscCall(VecMax(k, NULL, &ratio));
  *iterations = 0.33 * PetscPowReal(1.0 + ratio / s, 0.28) * PetscLogReal(2.0 / solver->rtol);
  PetscCall(VecDestroy(&e));
  PetscCall(VecDestroy(&k));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Costs in units of a column's iteration with sweeps, measured from 1e4 to 1e5 unknowns: a factor 70 n^0.42, a
 * solve with it 50 per column; setting up AMG 500, a solve with it 1000 per column. */
static PetscErrorCode prefer_sweeps(ShiftedSolver *solver, PetscReal s, PetscInt columns, PetscBool *prefer)
{
  const PetscReal n = (PetscReal)solver->system->n, k = (PetscReal)PetscMax(columns, 1);
  PetscReal iterations = 0.0, other;

  PetscFunctionBeginUser;
  *prefer = PETSC_FALSE;
  if (solver->chosen_by_user || s <= 0.0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(expect_iterations(solver, s, &iterations));
  other = solver->direct ? 70.0 * PetscPowReal(n, 0.42) + 50.0 * k : 500.0 + 1000.0 * k;
  solver->limit = 20 + 2 * (PetscInt)(other / k);
  *prefer = (PetscBool)(iterations * k < other);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sweeps, or the general preconditioner. */
static PetscErrorCode set_preconditioner(ShiftedSolver *solver, PetscBool sweeping)
{
  PetscFunctionBeginUser;
  solver->sweeping = sweeping;
  solver->name = sweeping                 ? "CG with incomplete Cholesky"
                 : solver->chosen_by_user ? "CG with the preconditioner of the PETSc options"
                 : solver->direct         ? "MUMPS Cholesky"
                                          : "CG with BoomerAMG";
  if (sweeping) {
    if (!solver->panels) PetscCall(panel_cg_create(solver->A, &solver->panels));
    PetscCall(panel_cg_take_values(solver->panels));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  solver->count.setups++;
  PetscCall(PCSetUp(solver->factor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode shifted_solver_set_shift(ShiftedSolver *solver, PetscReal s, PetscInt columns)
{
  const ThermalSystem *system = solver->system;
  PetscBool sweeping;

  PetscFunctionBeginUser;
  if (s == solver->shift) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(s >= 0.0, PetscObjectComm((PetscObject)solver->A), PETSC_ERR_ARG_OUTOFRANGE,
             "expansion point %g 1/s: a real shift of 0 or more is expected", (double)s);
  PetscCheck(s > 0.0 || !system->singular, PetscObjectComm((PetscObject)solver->A), PETSC_ERR_USER,
             "expansion point 0 (reduction.s0): nothing fixes the mould's temperature (all walls are insulated), so K "
             "is singular and "
             "has no moments there; give a shift above 0, about 1/t_end");
  PetscCall(MatZeroEntries(solver->A));
  PetscCall(MatAXPY(solver->A, 1.0, system->K, SUBSET_NONZERO_PATTERN));
  PetscCall(MatAXPY(solver->A, s, system->E, SUBSET_NONZERO_PATTERN));
  PetscCall(prefer_sweeps(solver, s, columns, &sweeping));
  PetscCall(set_preconditioner(solver, sweeping));
  solver->shift = s;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode take_work_blocks(ShiftedSolver *solver, PetscInt width)
{
  PetscFunctionBeginUser;
  if (width == solver->width) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatDestroy(&solver->R));
  PetscCall(MatDestroy(&solver->Z));
  PetscCall(MatDestroy(&solver->P));
  PetscCall(MatDestroy(&solver->Q));
  solver->width = width;
  if (width == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(dense_block_create(solver->A, width, &solver->R));
  PetscCall(dense_block_create(solver->A, width, &solver->Z));
  PetscCall(dense_block_create(solver->A, width, &solver->P));
  PetscCall(dense_block_create(solver->A, width, &solver->Q));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool factorised(const ShiftedSolver *solver)
{
  return (PetscBool)(!solver->sweeping && solver->direct && !solver->chosen_by_user);
}

static PetscInt iteration_limit(const ShiftedSolver *solver)
{
  return !factorised(solver) ? 1000 : solver->low_rank ? 8 : 2;
}

static PetscErrorCode precondition(ShiftedSolver *solver, Mat R, Mat Z)
{
  PetscFunctionBeginUser;
  PetscCall(PCMatApply(solver->factor, R, Z));
  solver->count.iterations += solver->width;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Largest ||r_c||/||b_c||; columns of zeros count as solved. */
static PetscErrorCode worst_residual(Mat R, const PetscReal *b_squared, PetscReal *r_squared, PetscReal *worst)
{
  PetscInt k;

  PetscFunctionBeginUser;
  PetscCall(MatGetSize(R, NULL, &k));
  PetscCall(dense_block_dots(R, R, r_squared));
  *worst = 0.0;
  for (PetscInt c = 0; c < k; c++) {
    const PetscReal ratio = b_squared[c] > 0.0 ? PetscSqrtReal(r_squared[c] / b_squared[c]) : 0.0;
    if (!(ratio <= *worst)) *worst = ratio; // a NaN becomes the worst
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Conjugate gradients on each column, from X as it is with residual R. */
static PetscErrorCode iterate(ShiftedSolver *solver, Mat X, const PetscReal *b_squared, PetscReal *worst)
{
  const PetscInt k = solver->width, limit = iteration_limit(solver);
  PetscReal *rz, *pq, *alpha, *next, *r_squared;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc5((size_t)k, &rz, (size_t)k, &pq, (size_t)k, &alpha, (size_t)k, &next, (size_t)k, &r_squared));
  PetscCall(worst_residual(solver->R, b_squared, r_squared, worst));
  for (PetscInt iteration = 0; *worst > solver->rtol && iteration < limit; iteration++) {
    PetscCall(precondition(solver, solver->R, solver->Z));
    PetscCall(dense_block_dots(solver->R, solver->Z, next));
    for (PetscInt c = 0; c < k; c++) alpha[c] = iteration > 0 && rz[c] > 0.0 ? next[c] / rz[c] : 0.0;
    PetscCall(dense_block_aypx(solver->P, alpha, solver->Z));
    PetscCall(PetscArraycpy(rz, next, (size_t)k));
    PetscCall(dense_block_multiply(solver->A, solver->P, solver->Q));
    PetscCall(dense_block_dots(solver->P, solver->Q, pq));
    for (PetscInt c = 0; c < k; c++) // columns that have converged stay as they are
      alpha[c] = pq[c] > 0.0 && r_squared[c] > 0.01 * solver->rtol * solver->rtol * b_squared[c] ? rz[c] / pq[c] : 0.0;
    PetscCall(dense_block_axpby(X, 1.0, alpha, solver->P));
    for (PetscInt c = 0; c < k; c++) alpha[c] = -alpha[c];
    PetscCall(dense_block_axpby(solver->R, 1.0, alpha, solver->Q));
    PetscCall(worst_residual(solver->R, b_squared, r_squared, worst));
    if (PetscIsNanReal(*worst)) break;
  }
  PetscCall(PetscFree5(rz, pq, alpha, next, r_squared));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* R = B - A X */
static PetscErrorCode measure(ShiftedSolver *solver, Mat B, Mat X, const PetscReal *b_squared, PetscReal *worst)
{
  PetscReal *r_squared;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)solver->width, &r_squared));
  PetscCall(dense_block_multiply(solver->A, X, solver->R));
  PetscCall(MatAYPX(solver->R, -1.0, B, SAME_NONZERO_PATTERN));
  PetscCall(worst_residual(solver->R, b_squared, r_squared, worst));
  PetscCall(PetscFree(r_squared));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In single precision, then again for what is left over, as long as that helps. */
static PetscErrorCode sweep(ShiftedSolver *solver, Mat B, Mat X, const PetscReal *b_squared, PetscReal *worst)
{
  enum { MOST_ROUNDS = 8 };
  const PetscInt k = solver->width;
  PetscInt iterations = 0;
  PetscReal *length, before = PETSC_MAX_REAL;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)k, &length));
  for (PetscInt c = 0; c < k; c++) length[c] = 0.8 * solver->rtol * PetscSqrtReal(b_squared[c]);
  PetscCall(MatZeroEntries(X));
  PetscCall(MatCopy(B, solver->R, SAME_NONZERO_PATTERN));
  *worst = 1.0;
  for (int round = 0; round<MOST_ROUNDS && * worst> solver->rtol && *worst < 0.3 * before; round++) {
    before = *worst;
    PetscCall(panel_cg_solve(solver->panels, solver->R, X, length, solver->limit, &iterations));
    solver->count.iterations += k * iterations;
    PetscCall(measure(solver, B, X, b_squared, worst));
    if (iterations == solver->limit) break;
  }
  PetscCall(PetscFree(length));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* X = M^-1 B first: with a factor this is the answer, and the residual only confirms it. */
static PetscErrorCode attempt(ShiftedSolver *solver, Mat B, Mat X, const PetscReal *b_squared, PetscReal *worst)
{
  PetscFunctionBeginUser;
  PetscCall(precondition(solver, B, X));
  PetscCall(measure(solver, B, X, b_squared, worst));
  PetscCall(MatZeroEntries(solver->P));
  PetscCall(iterate(solver, X, b_squared, worst));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode solve_batch(ShiftedSolver *solver, Mat B, Mat X)
{
  const PetscInt k = solver->width;
  PetscReal *b_squared, worst, accepted = solver->rtol;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)k, &b_squared));
  PetscCall(dense_block_dots(B, B, b_squared));
  if (solver->sweeping) {
    PetscCall(sweep(solver, B, X, b_squared, &worst));
    if (!(worst <= accepted)) PetscCall(set_preconditioner(solver, PETSC_FALSE)); // too hard for them on this mesh
  }
  if (!solver->sweeping) PetscCall(attempt(solver, B, X, b_squared, &worst));
  /* Rounding limits the residual to about eps ||A|| ||x||, which a factor reaches and nothing betters. */
  if (factorised(solver)) accepted = PetscMax(accepted, 1e-9);
  PetscCheck(worst <= accepted, PetscObjectComm((PetscObject)solver->A), PETSC_ERR_NOT_CONVERGED,
             "(s E + K) X = B at s = %g 1/s by %s: relative residual %.2e, %.2e asked for", (double)solver->shift,
             solver->name, (double)worst, (double)accepted);
  PetscCall(PetscFree(b_squared));
  solver->count.columns += k;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode shifted_solver_solve(ShiftedSolver *solver, Mat B, Mat X)
{
  PetscInt k;

  PetscFunctionBeginUser;
  PetscCall(MatGetSize(B, NULL, &k));
  for (PetscInt first = 0; first < k; first += BATCH) {
    const PetscInt last = PetscMin(first + BATCH, k);
    Mat of_B, of_X;
    PetscCall(take_work_blocks(solver, last - first));
    PetscCall(MatDenseGetSubMatrix(B, PETSC_DECIDE, PETSC_DECIDE, first, last, &of_B));
    PetscCall(MatDenseGetSubMatrix(X, PETSC_DECIDE, PETSC_DECIDE, first, last, &of_X));
    PetscCall(solve_batch(solver, of_B, of_X));
    PetscCall(MatDenseRestoreSubMatrix(X, &of_X));
    PetscCall(MatDenseRestoreSubMatrix(B, &of_B));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

void shifted_solver_set_tolerance(ShiftedSolver *solver, PetscReal rtol)
{
  solver->rtol = rtol;
}

PetscReal shifted_solver_get_shift(const ShiftedSolver *solver)
{
  return solver->shift;
}

ShiftedSolverCount shifted_solver_get_count(const ShiftedSolver *solver)
{
  return solver->count;
}

const char *shifted_solver_get_name(const ShiftedSolver *solver)
{
  return solver->name;
}

PetscErrorCode shifted_solver_destroy(ShiftedSolver **solver)
{
  PetscFunctionBeginUser;
  if (!*solver) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(take_work_blocks(*solver, 0));
  PetscCall(PCDestroy(&(*solver)->factor));
  PetscCall(panel_cg_destroy(&(*solver)->panels));
  PetscCall(MatDestroy(&(*solver)->A));
  PetscCall(PetscFree(*solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}
