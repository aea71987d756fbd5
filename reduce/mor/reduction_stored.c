/* reduction_stored.c
 * Method: rational Krylov without an orthonormal basis in memory. Each shift gives its vectors, which go to disk as
 * they are, and a few matrices of moments [p x p], from which the reduced model follows (loewner.h). So nothing is
 * orthogonalised, memory holds four blocks [n x p] whatever the order, and a run that was interrupted goes on after the
 * last shift that was complete. What needs the vectors later (residual, near-wall basis) reads them through once. */
#include <math.h>

#include "reduce/linear/dense_block.h"
#include "reduce/mor/reduction.h"
#include "reduce/petsc/petsc_compat.h"

static const PetscReal MOST_MEMORY = 4e9;      // bytes of vectors, above which they go to disk
static const PetscReal DEFLATION_SHARE = 0.03; // of the tolerance: shorter directions are dropped
static const PetscReal LEAST_DEFLATION = 1e-5; // below, moments of 12 digits say nothing

PetscBool reduction_is_stored(const Reduction *reduction)
{
  const ReductionConfig *config = reduction->config;
  ShiftPlan plan;
  PetscReal bytes = (PetscReal)sizeof(PetscScalar) * (PetscReal)reduction->system->n * (PetscReal)reduction->p;

  if (config->method != REDUCTION_RATIONAL || config->basis == BASIS_MEMORY) return PETSC_FALSE;
  if (config->basis == BASIS_DISK) return PETSC_TRUE;
  if (reduction_plan_shifts(reduction, &plan)) return PETSC_FALSE;
  PetscInt vectors = 0;
  for (PetscInt i = 0; i < plan.n; i++) vectors += plan.moments[i];
  bytes *= (PetscReal)vectors;
  return (PetscBool)(shifts_plan_destroy(&plan) == 0 && bytes > MOST_MEMORY);
}

/* Norm, and the diagonal weighted by the place in the numbering: another numbering gives another sum. */
static PetscErrorCode fingerprint(Mat A, PetscReal *norm, PetscReal *ordered)
{
  Vec diagonal;
  const PetscScalar *value;
  PetscInt first, last;

  PetscFunctionBeginUser;
  PetscCall(MatNorm(A, NORM_FROBENIUS, norm));
  PetscCall(MatCreateVecs(A, NULL, &diagonal));
  PetscCall(MatGetDiagonal(A, diagonal));
  PetscCall(VecGetOwnershipRange(diagonal, &first, &last));
  PetscCall(VecGetArrayRead(diagonal, &value));
  *ordered = 0.0;
  for (PetscInt i = first; i < last; i++) *ordered += (2.0 + cos((double)i)) * PetscAbsScalar(value[i - first]);
  PetscCall(VecRestoreArrayRead(diagonal, &value));
  PetscCall(VecDestroy(&diagonal));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, ordered, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)A)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a folder must have been made with to be of use: the problem, its numbering, and the rows of each rank. */
static PetscErrorCode problem_signature(const Reduction *reduction, char text[512])
{
  const ReductionConfig *config = reduction->config;
  const ThermalSystem *system = reduction->system;
  const MPI_Comm comm = PetscObjectComm((PetscObject)system->E);
  PetscReal of_E, of_K, of_ports, order_E, order_K;
  PetscMPIInt ranks, rank;
  PetscInt first, layout;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(MatGetOwnershipRange(system->E, &first, NULL));
  layout = first * (rank + 1);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &layout, 1, MPIU_INT, MPI_SUM, comm));
  PetscCall(fingerprint(system->E, &of_E, &order_E));
  PetscCall(fingerprint(system->K, &of_K, &order_K));
  PetscCall(MatNorm(reduction->ports, NORM_FROBENIUS, &of_ports));
  snprintf(
      text, 512,
      "castreduce shifts 2: n %d p %d ranks %d rows %d times %.17g %.17g rtol %.17g | %.17g %.17g %.17g %.17g %.17g",
      (int)system->n, (int)reduction->p, (int)ranks, (int)layout, config->t_start, config->t_end,
      (double)reduction->rtol, (double)of_E, (double)order_E, (double)of_K, (double)order_K, (double)of_ports);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* mu = X^T Y, which is symmetric but for rounding, [p x p] */
static PetscErrorCode moment(Mat X, Mat Y, PetscInt p, PetscReal *mu)
{
  PetscFunctionBeginUser;
  PetscCall(dense_block_inner(X, Y, mu));
  for (PetscInt j = 0; j < p; j++)
    for (PetscInt i = 0; i < j; i++) mu[i + j * p] = mu[j + i * p] = 0.5 * (mu[i + j * p] + mu[j + i * p]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* 1^T E x and 1^T K x of each column, [p] */
static PetscErrorCode heat_of(const KrylovBasis *basis, Mat X, PetscReal *heat, PetscReal *losses)
{
  PetscFunctionBeginUser;
  for (PetscInt l = 0; l < basis->p; l++) {
    Vec column;
    PetscCall(MatDenseGetColumnVecRead(X, l, &column));
    PetscCall(VecDot(column, basis->E_one, &heat[l]));
    PetscCall(VecDot(column, basis->K_one, &losses[l]));
    PetscCall(MatDenseRestoreColumnVecRead(X, l, &column));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* X_1 .. X_q at the solver's shift, each to the store; moments as in shift_blocks.h. */
static PetscErrorCode solve_blocks(Reduction *reduction, ShiftMoments *shift)
{
  const PetscInt p = reduction->p;
  const size_t square = (size_t)p * (size_t)p;
  Mat X, EX, right = reduction->ports, swap;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1(2 * (size_t)shift->q * square, &shift->mu));
  PetscCall(PetscMalloc1(2 * (size_t)shift->q * (size_t)p, &shift->heat));
  PetscCall(dense_block_create(reduction->system->E, p, &X));
  PetscCall(dense_block_create(reduction->system->E, p, &EX));
  for (PetscInt k = 0; k < shift->q; k++) {
    PetscCall(shifted_solver_solve(reduction->solver, right, X));
    if (k == 0) PetscCall(reduction_keep_moments(reduction, X));
    PetscCall(shift_blocks_add(reduction->basis->blocks, X));
    PetscCall(moment(right, X, p, shift->mu + 2 * (size_t)k * square));
    PetscCall(dense_block_multiply(reduction->system->E, X, EX));
    PetscCall(moment(X, EX, p, shift->mu + (2 * (size_t)k + 1) * square));
    PetscCall(heat_of(reduction->basis, X, shift->heat + k * p, shift->heat + (shift->q + k) * p));
    swap = k == 0 ? NULL : right;
    right = EX;
    EX = swap;
    if (!EX && k + 1 < shift->q) PetscCall(dense_block_create(reduction->system->E, p, &EX));
  }
  if (right != reduction->ports) PetscCall(MatDestroy(&right));
  PetscCall(MatDestroy(&EX));
  PetscCall(MatDestroy(&X));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode take_stored_shift(Reduction *reduction, PetscReal s, PetscInt q)
{
  const double start = log_wall_time();
  ShiftMoments shift = {.s = s, .q = q};

  PetscFunctionBeginUser;
  PetscCall(shifted_solver_set_shift(reduction->solver, s, reduction_columns(reduction, q)));
  PetscCall(reduction_record_shift(reduction, s));
  PetscCall(solve_blocks(reduction, &shift));
  PetscCall(shift_blocks_complete(reduction->basis->blocks, &shift));
  log_info(reduction->log, "shift %.3g 1/s: %d vectors stored; %.1f s (%s)", (double)s, (int)(q * reduction->p),
           log_wall_time() - start, shifted_solver_get_name(reduction->solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode project(Reduction *reduction, PetscReal *error)
{
  const double start = log_wall_time();

  PetscFunctionBeginUser;
  PetscCall(krylov_basis_project_stored(reduction->basis));
  PetscCall(reduction_judge(reduction, error));
  log_info(reduction->log, "projection: %d of %d vectors kept (%.1f s)", (int)reduction->basis->r,
           (int)reduction->basis->raw->n_raw, log_wall_time() - start);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode add_stored_shifts(Reduction *reduction)
{
  const StepReference *reference = reduction->reference;
  const PetscReal target = reduction_first_stage_target(reduction->config);
  PetscReal *error, s;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)reference->n_times, &error));
  PetscCall(project(reduction, error));
  for (PetscInt added = 0; reduction->step_error > target; added++) {
    if (reduction->config->n_shifts > 0 || added == REDUCTION_MOST_ADDED_SHIFTS) break;
    PetscCall(shifts_suggest(reduction->n_shifts, reduction->shifts, reference->n_times, reference->time, error, &s));
    log_info(reduction->log, "step responses: error %.2e of the rise, %.2e is needed: one more shift at %.3g 1/s",
             (double)reduction->step_error, (double)target, (double)s);
    PetscCall(take_stored_shift(reduction, s, 1));
    PetscCall(project(reduction, error));
  }
  PetscCall(PetscFree(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode reduction_run_stored(Reduction *reduction)
{
  const ReductionConfig *config = reduction->config;
  const PetscReal deflation =
      PetscMax(PetscMax(config->deflation, LEAST_DEFLATION), DEFLATION_SHARE * config->tolerance);
  char signature[512];
  ShiftPlan plan;
  PetscInt done;

  PetscFunctionBeginUser;
  PetscCall(reduction_plan_shifts(reduction, &plan));
  reduction->moments_per_shift = plan.moments[0];
  log_info(
      reduction->log, "reduction: %d unknowns, %d patches; %d real shifts from %.3g to %.3g 1/s, vectors kept %s%s",
      (int)reduction->system->n, (int)reduction->system->m, (int)plan.n, (double)plan.shift[0],
      (double)plan.shift[plan.n - 1], config->scratch ? "in " : "in memory", config->scratch ? config->scratch : "");
  PetscCall(moments_create(reduction->reference->n_patches, reduction->p, &reduction->moments));
  PetscCall(problem_signature(reduction, signature));
  PetscCall(krylov_basis_create_stored(reduction->system, reduction->ports, config->scratch, signature, deflation,
                                       &reduction->basis));
  done = reduction->basis->blocks->n_shifts;
  for (PetscInt i = 0; i < done; i++) {
    PetscCall(reduction_record_shift(reduction, reduction->basis->blocks->shift[i].s));
    log_info(reduction->log, "shift %.3g 1/s: taken over from an earlier run", (double)reduction->shifts[i]);
  }
  for (PetscInt i = done; i < plan.n; i++) {
    PetscCall(take_stored_shift(reduction, plan.shift[i], plan.moments[i]));
    PetscCall(reduction_solve_windows(reduction, PETSC_FALSE));
  }
  PetscCall(shifts_plan_destroy(&plan));
  if (!reduction_knows_missing(reduction)) PetscCall(reduction_solve_windows(reduction, PETSC_TRUE));
  PetscCall(add_stored_shifts(reduction));
  PetscFunctionReturn(PETSC_SUCCESS);
}
