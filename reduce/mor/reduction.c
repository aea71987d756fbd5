/* reduction.c
 * Method: block rational Krylov with real shifts, Galerkin projection in the E inner product. Each shift's
 * preconditioner serves the block of all inputs and, where it falls on one of the reference's poles, the full model's
 * step responses; the tolerance is judged against those alone (reduction_judge.c).
 * References: Ruhe 1984, Linear Algebra Appl. 58, 391; Odabasioglu, Celik & Pileggi 1998, IEEE Trans. CAD 17, 645
 * (block Arnoldi, passivity by congruence). */
#include "reduce/mor/reduction.h"

#include <math.h>

#include "reduce/linear/dense_block.h"
#include "reduce/mor/modes.h"
#include "reduce/petsc/petsc_compat.h"

static const PetscReal MODES_RTOL = 1e-11;  // what shift-and-invert Lanczos needs inside
static const PetscReal STORED_RTOL = 1e-12; // moments build on one another
/* Of what is allowed: smaller errors bring no vector. A second stage makes its own choice, and needs the rest small:
 * its error comes on top, and the certificate cannot know that the two cancel. */
static const PetscReal DIRECTION_SHARE = 0.25, DIRECTION_SHARE_BEFORE_SECOND = 0.03;
static const PetscReal WORTHWHILE = 0.7; // an added shift's directions bring the error down at least to this share
static const PetscReal AMBIENT_H = 20.0; // W/(m2 K): gives the ambient port an area among the patches'

PetscErrorCode reduction_create(const ThermalSystem *system, const ReductionConfig *config, Log *log, Reduction **out)
{
  Reduction *reduction;

  PetscFunctionBeginUser;
  PetscCall(PetscNew(&reduction));
  *out = reduction;
  reduction->system = system;
  reduction->config = config;
  reduction->log = log;
  PetscCall(ports_create(system, &reduction->ports, &reduction->ambient_sum));
  PetscCall(MatGetSize(reduction->ports, NULL, &reduction->p));
  reduction->rtol = reduction_is_stored(reduction) ? PetscMin(config->solver_rtol, STORED_RTOL) : config->solver_rtol;
  PetscCall(shifted_solver_create(system, reduction->rtol, (PetscBool)config->iterative, &reduction->solver));
  PetscCall(step_reference_create(system, reduction->ports, config->t_start, config->t_end, &reduction->reference));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode reduction_record_shift(Reduction *reduction, PetscReal s)
{
  PetscFunctionBeginUser;
  PetscCall(PetscRealloc((size_t)(reduction->n_shifts + 1) * sizeof(PetscReal), &reduction->shifts));
  reduction->shifts[reduction->n_shifts++] = s;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* H(s) of the sampled patches, from the solves of the reduction itself. */
PetscErrorCode reduction_keep_moments(Reduction *reduction, Mat X)
{
  const StepReference *reference = reduction->reference;
  Mat sampled;
  PetscReal *value;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)reference->n_patches * (size_t)reduction->p, &value));
  PetscCall(dense_block_create(reduction->system->E, reference->n_patches, &sampled));
  PetscCall(dense_block_copy(sampled, 0, X, reference->patch, reference->n_patches));
  PetscCall(dense_block_inner(reduction->ports, sampled, value));
  PetscCall(moments_append(reduction->moments, shifted_solver_get_shift(reduction->solver), 0, value));
  PetscCall(MatDestroy(&sampled));
  PetscCall(PetscFree(value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* X = (s E + K)^-1 E V_last, V_last the vectors that the step before has added */
static PetscErrorCode next_krylov_block(Reduction *reduction, PetscInt last, Mat X)
{
  KrylovBasis *basis = reduction->basis;
  Mat V, block, product;
  PetscInt *column;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)last, &column));
  for (PetscInt c = 0; c < last; c++) column[c] = basis->r - last + c;
  PetscCall(dense_block_create(reduction->system->E, last, &block));
  PetscCall(dense_block_create(reduction->system->E, last, &product));
  PetscCall(BVSetActiveColumns(basis->V, 0, basis->r));
  PetscCall(BVGetMat(basis->V, &V));
  PetscCall(dense_block_copy(block, 0, V, column, last));
  PetscCall(BVRestoreMat(basis->V, &V));
  PetscCall(dense_block_multiply(reduction->system->E, block, product));
  PetscCall(shifted_solver_solve(reduction->solver, product, X));
  PetscCall(MatDestroy(&block));
  PetscCall(MatDestroy(&product));
  PetscCall(PetscFree(column));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* X = (s E + K)^-1 [ports]. At s = 0 the heat E 1 is one input more: the constant, K^-1 ambient, stands in the basis
 * already, and what follows from it, K^-1 E 1, has to be in the recursion too. (At s > 0 it is, since
 * (s E + K)^-1 E 1 = (1 - (s E + K)^-1 ambient)/s.) */
static PetscErrorCode first_krylov_block(Reduction *reduction, Mat X)
{
  Mat part, heat, answer;
  Vec column;
  PetscInt k;

  PetscFunctionBeginUser;
  PetscCall(MatGetSize(X, NULL, &k));
  PetscCall(MatDenseGetSubMatrix(X, PETSC_DECIDE, PETSC_DECIDE, 0, reduction->p, &part));
  PetscCall(shifted_solver_solve(reduction->solver, reduction->ports, part));
  PetscCall(MatDenseRestoreSubMatrix(X, &part));
  if (k == reduction->p) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(dense_block_create(reduction->system->E, 1, &heat));
  PetscCall(dense_block_create(reduction->system->E, 1, &answer));
  PetscCall(MatDenseGetColumnVecWrite(heat, 0, &column));
  PetscCall(VecCopy(reduction->basis->E_one, column));
  PetscCall(MatDenseRestoreColumnVecWrite(heat, 0, &column));
  PetscCall(shifted_solver_solve(reduction->solver, heat, answer));
  PetscCall(dense_block_copy(X, reduction->p, answer, NULL, 1));
  PetscCall(MatDestroy(&heat));
  PetscCall(MatDestroy(&answer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `moments` vectors an input at shift s: X_1 = (s E + K)^-1 ports, X_k+1 = (s E + K)^-1 E (what X_k has added). */
static PetscErrorCode take_shift(Reduction *reduction, PetscReal s, PetscInt moments)
{
  KrylovBasis *basis = reduction->basis;
  const PetscInt before = basis->r;
  const double start = log_wall_time();
  PetscInt kept = reduction->p + (s == 0.0 ? 1 : 0);
  double solving = 0.0;
  Mat X;

  PetscFunctionBeginUser;
  PetscCall(shifted_solver_set_shift(reduction->solver, s, reduction_columns(reduction, moments)));
  PetscCall(reduction_record_shift(reduction, s));
  for (PetscInt k = 0; k < moments && kept > 0; k++) {
    const double begin = log_wall_time();
    PetscCall(krylov_basis_get_block(basis, kept, &X));
    if (k == 0)
      PetscCall(first_krylov_block(reduction, X));
    else
      PetscCall(next_krylov_block(reduction, kept, X));
    if (k == 0 && reduction->config->method == REDUCTION_RATIONAL) PetscCall(reduction_keep_moments(reduction, X));
    solving += log_wall_time() - begin;
    PetscCall(krylov_basis_add(basis, &X, &kept));
  }
  log_info(reduction->log, "shift %.3g 1/s: %d of %d directions kept, %d in all; %.1f s, %.1f of it solving (%s)",
           (double)s, (int)(basis->r - before), (int)(moments * reduction->p), (int)basis->r, log_wall_time() - start,
           solving, shifted_solver_get_name(reduction->solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest error of H at the real rate s that the tolerance allows, in the weighted 2-norm. */
static PetscReal allowed_at(const Reduction *reduction, PetscReal s, const PetscReal *weight)
{
  const ModalModel *modal = reduction->modal;
  PetscReal largest = 0.0; // diagonal entry of D H_r D: a lower bound of its norm
  for (PetscInt l = 0; l < modal->p; l++) {
    PetscReal entry = 0.0;
    for (PetscInt k = 0; k < modal->r; k++)
      entry += modal->B[k * modal->p + l] * modal->B[k * modal->p + l] / (s + modal->lambda[k]);
    largest = PetscMax(largest, weight[l] * weight[l] * entry);
  }
  return reduction_first_stage_target(reduction->config) * largest;
}

/* One vector more at shift s for each direction of the inputs whose error there is above a share of what is allowed.
 *   taken  out: vectors that were added */
static PetscErrorCode take_directions(Reduction *reduction, PetscReal s, PetscInt *taken)
{
  KrylovBasis *basis = reduction->basis;
  const double start = log_wall_time();
  Residual *fresh = NULL;
  PetscReal *weight, largest;
  PetscInt k = 0, kept = 0;
  Mat X, block;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)reduction->p, &weight));
  for (PetscInt l = 0; l < reduction->p; l++)
    weight[l] = l < reduction->system->m ? sqrt(reduction->system->area[l]) : 0.0;
  if (reduction->p > reduction->system->m) // the ambient acts on the outer walls: no area of its own
    weight[reduction->p - 1] = sqrt(reduction->ambient_sum / AMBIENT_H);
  if (!reduction->certificate) PetscCall(residual_create(basis, reduction->modal, &fresh));
  const Residual *residual = fresh ? fresh : certificate_get_residual(reduction->certificate);
  const PetscReal allowed = allowed_at(reduction, s, weight);
  const PetscReal share = reduction->config->second_stage ? DIRECTION_SHARE_BEFORE_SECOND : DIRECTION_SHARE;
  PetscCall(
      residual_directions(residual, reduction->modal, reduction->solver, s, weight, share * allowed, &X, &largest));
  if (X) {
    PetscCall(MatGetSize(X, NULL, &k));
    PetscCall(krylov_basis_get_block(basis, k, &block));
    PetscCall(dense_block_copy(block, 0, X, NULL, k));
    PetscCall(krylov_basis_add(basis, &block, &kept));
    PetscCall(MatDestroy(&X));
  }
  if (kept > 0) PetscCall(reduction_record_shift(reduction, s));
  *taken = kept;
  log_info(
      reduction->log,
      "shift %.3g 1/s: the error of H is %.2g of what is allowed, in %d of %d directions it matters: %d kept, %d in "
      "all; %.1f s (%s)",
      (double)s, (double)(largest / allowed), (int)k, (int)reduction->p, (int)kept, (int)basis->r,
      log_wall_time() - start, shifted_solver_get_name(reduction->solver));
  PetscCall(residual_destroy(&fresh));
  PetscCall(PetscFree(weight));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* More shifts where the step responses are worst, with the directions that the residual asks for there. Errors on the
 * real axis can be far smaller than those of the responses: where the residual asks for nothing, or what it asks for
 * hardly helps, the whole block is taken. */
static PetscErrorCode add_shifts(Reduction *reduction)
{
  const StepReference *reference = reduction->reference;
  const PetscReal target = reduction_first_stage_target(reduction->config);
  PetscReal *error, s, before = 0.0;
  PetscBool helps = PETSC_TRUE;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)reference->n_times, &error));
  PetscCall(reduction_judge(reduction, error));
  for (PetscInt added = 0; reduction->step_error > target; added++) {
    if (reduction->config->n_shifts > 0) break; // the user's own shifts stand as they are
    if (added == REDUCTION_MOST_ADDED_SHIFTS) break;
    PetscCall(shifts_suggest(reduction->n_shifts, reduction->shifts, reference->n_times, reference->time, error, &s));
    log_info(reduction->log, "step responses: error %.2e of the rise, %.2e is needed: one more shift at %.3g 1/s",
             (double)reduction->step_error, (double)target, (double)s);
    PetscInt taken = 0;
    before = reduction->step_error;
    if (helps) PetscCall(take_directions(reduction, s, &taken));
    if (taken == 0) PetscCall(take_shift(reduction, s, 1));
    PetscCall(reduction_judge(reduction, error));
    helps = (PetscBool)(taken == 0 || reduction->step_error < WORTHWHILE * before);
  }
  PetscCall(PetscFree(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode reduction_plan_shifts(const Reduction *reduction, ShiftPlan *plan)
{
  const ReductionConfig *config = reduction->config;

  PetscFunctionBeginUser;
  if (config->n_shifts > 0)
    PetscCall(shifts_plan_given((PetscInt)config->n_shifts, config->shifts, plan));
  else
    PetscCall(shifts_plan(config->t_start, config->t_end, reduction_first_stage_target(config), plan));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode reduction_run_rational(Reduction *reduction)
{
  const ReductionConfig *config = reduction->config;
  const PetscInt spare = config->n_shifts > 0 ? 0 : 1; // room for one shift more: growing copies the basis
  PetscInt vectors = 0;
  ShiftPlan plan;

  PetscFunctionBeginUser;
  if (reduction_is_stored(reduction)) {
    PetscCall(reduction_run_stored(reduction));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(reduction_plan_shifts(reduction, &plan));
  for (PetscInt i = 0; i < plan.n; i++) vectors += plan.moments[i];
  reduction->moments_per_shift = plan.moments[0];
  log_info(reduction->log,
           "reduction: %d unknowns, %d patches; %d vectors an input at %d real shifts from %.3g to %.3g 1/s",
           (int)reduction->system->n, (int)reduction->system->m, (int)vectors, (int)plan.n, (double)plan.shift[0],
           (double)plan.shift[plan.n - 1]);
  PetscCall(moments_create(reduction->reference->n_patches, reduction->p, &reduction->moments));
  PetscCall(krylov_basis_create(reduction->system, reduction->ports, 1 + (vectors + spare) * reduction->p, reduction->p,
                                config->deflation, &reduction->basis));
  for (PetscInt i = 0; i < plan.n; i++) {
    PetscCall(take_shift(reduction, plan.shift[i], plan.moments[i]));
    PetscCall(reduction_solve_windows(reduction, PETSC_FALSE));
  }
  PetscCall(shifts_plan_destroy(&plan));
  if (!reduction_knows_missing(reduction)) PetscCall(reduction_solve_windows(reduction, PETSC_TRUE));
  PetscCall(add_shifts(reduction));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode reduction_run_arnoldi(Reduction *reduction)
{
  const ReductionConfig *config = reduction->config;
  const PetscInt q = (PetscInt)config->moments, width = reduction->p + (config->s0 == 0.0 ? 1 : 0);

  PetscFunctionBeginUser;
  log_info(reduction->log, "reduction: %d unknowns, %d patches; %d moments at %.3g 1/s", (int)reduction->system->n,
           (int)reduction->system->m, (int)q, config->s0);
  reduction->moments_per_shift = q;
  PetscCall(krylov_basis_create(reduction->system, reduction->ports, 1 + q * width, width, config->deflation,
                                &reduction->basis));
  PetscCall(take_shift(reduction, config->s0, q));
  PetscCall(moments_create(reduction->reference->n_inputs, reduction->p, &reduction->moments));
  PetscCall(moments_compute(reduction->moments, reduction->system, reduction->solver, reduction->ports,
                            reduction->reference->F, q));
  PetscCall(reduction_solve_windows(reduction, PETSC_TRUE));
  PetscCall(reduction_judge(reduction, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode reduction_run_modal(Reduction *reduction)
{
  const ReductionConfig *config = reduction->config;
  const PetscInt k = config->modes > 0 ? (PetscInt)config->modes : PetscMin(5 * reduction->p, reduction->system->n / 4);
  const double start = log_wall_time();

  PetscFunctionBeginUser;
  log_info(reduction->log, "reduction: %d unknowns, %d patches; the %d slowest modes", (int)reduction->system->n,
           (int)reduction->system->m, (int)k);
  PetscCall(krylov_basis_create(reduction->system, reduction->ports, 1 + k, PetscMax(reduction->p, 1),
                                config->deflation, &reduction->basis));
  shifted_solver_set_tolerance(reduction->solver, MODES_RTOL);
  PetscCall(modes_add(reduction->basis, reduction->solver, 1.0 / config->t_end, k));
  shifted_solver_set_tolerance(reduction->solver, reduction->rtol);
  log_info(reduction->log, "%d modes and the constant; %.1f s (%s)", (int)k, log_wall_time() - start,
           shifted_solver_get_name(reduction->solver));
  PetscCall(moments_create(reduction->reference->n_inputs, reduction->p, &reduction->moments)); // none are matched
  PetscCall(reduction_solve_windows(reduction, PETSC_TRUE));
  PetscCall(reduction_judge(reduction, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode reduction_destroy(Reduction **reduction)
{
  PetscFunctionBeginUser;
  if (!*reduction) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatDestroy(&(*reduction)->ports));
  PetscCall(shifted_solver_destroy(&(*reduction)->solver));
  PetscCall(krylov_basis_destroy(&(*reduction)->basis));
  PetscCall(step_reference_destroy(&(*reduction)->reference));
  PetscCall(moments_destroy(&(*reduction)->moments));
  PetscCall(modal_model_destroy(&(*reduction)->modal));
  PetscCall(modal_model_destroy(&(*reduction)->projected));
  PetscCall(certificate_destroy(&(*reduction)->certificate));
  PetscCall(PetscFree((*reduction)->shifts));
  PetscCall(PetscFree(*reduction));
  PetscFunctionReturn(PETSC_SUCCESS);
}
