/* reduction_judge.c - what is known of a reduction's error while it is under way.
 * The reference is what the reduced model lacks, found from its residual (error_model.h), and serves until the error
 * has fallen to where the reference's own matters; with very many inputs, or without a rational Krylov space, it is
 * solved for (step_reference.h). */
#include <math.h>

#include "reduce/mor/reduction.h"
#include "reduce/petsc/petsc_compat.h"

enum { EXPECTED_STEPS = 20 }; // of the reference in one window

static const PetscReal REFERENCE_SHARE = 0.01;  // of the tolerance: error of a reference that is solved for
static const PetscReal FIRST_STAGE_SHARE = 0.6; // of the tolerance, where a second stage follows
static const PetscReal POLE_REACH = 2.2;        // a shift within this ratio of a window's pole serves it
static const PetscReal STALE = 0.1;             // of the target: error of a reference that is found anew
static const PetscReal DOUBTFUL = 0.3;          // of what is judged: error of a reference that is solved for instead

PetscReal reduction_first_stage_target(const ReductionConfig *config)
{
  return config->tolerance * (config->second_stage ? FIRST_STAGE_SHARE : 1.0);
}

PetscBool reduction_knows_missing(const Reduction *reduction)
{
  return (PetscBool)(reduction->config->method == REDUCTION_RATIONAL && reduction->p <= CERTIFICATE_MOST_PORTS &&
                     !reduction->doubtful);
}

PetscInt reduction_columns(const Reduction *reduction, PetscInt moments)
{
  return moments * reduction->p +
         (reduction_knows_missing(reduction) ? 0 : EXPECTED_STEPS * reduction->reference->n_inputs);
}

/* rest: every window, whatever the shift. */
static PetscErrorCode solve_windows(Reduction *reduction, PetscBool rest)
{
  StepReference *reference = reduction->reference;
  const ReductionConfig *config = reduction->config;

  PetscFunctionBeginUser;
  shifted_solver_set_tolerance(reduction->solver, PetscMin(reduction->rtol, 1e-3 * config->tolerance));
  for (PetscInt w = 0; w < reference->n_windows; w++) {
    if (reference->done[w]) continue;
    if (rest)
      PetscCall(shifted_solver_set_shift(reduction->solver, reference->pole[w], EXPECTED_STEPS * reference->n_inputs));
    const PetscReal s = shifted_solver_get_shift(reduction->solver), ratio = reference->pole[w] / s;
    if (s <= 0.0 || ratio > POLE_REACH || ratio < 1.0 / POLE_REACH) continue;
    PetscCall(
        step_reference_solve(reference, reduction->system, reduction->solver, w, REFERENCE_SHARE * config->tolerance));
  }
  shifted_solver_set_tolerance(reduction->solver, reduction->rtol);
  if (rest) PetscCall(step_reference_finish(reference));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode reduction_solve_windows(Reduction *reduction, PetscBool rest)
{
  const double start = log_wall_time();

  PetscFunctionBeginUser;
  if (!rest && reduction_knows_missing(reduction)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(solve_windows(reduction, rest));
  reduction->seconds_certificate += log_wall_time() - start;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The reference anew. */
static PetscErrorCode find_missing(Reduction *reduction, PetscReal *error)
{
  StepReference *reference = reduction->reference;
  const double start = log_wall_time();

  PetscFunctionBeginUser;
  PetscCall(reduction_begin_certificate(reduction));
  const double begun = log_wall_time();
  PetscCall(certificate_correct(reduction->certificate, reference));
  PetscCall(step_reference_compare(reference, reduction->modal, error, &reduction->step_error));
  reduction->seconds_certificate += log_wall_time() - begun;
  if (reference->error > DOUBTFUL * PetscMax(reduction->step_error, reduction_first_stage_target(reduction->config))) {
    log_info(reduction->log,
             "what the reduced model lacks is known to %.2e of the rise only: the full model's step "
             "responses are solved for (%.1f s so far)",
             (double)reference->error, log_wall_time() - start);
    reduction->doubtful = PETSC_TRUE;
    step_reference_forget(reference);
    PetscCall(reduction_solve_windows(reduction, PETSC_TRUE));
    PetscCall(step_reference_compare(reference, reduction->modal, error, &reduction->step_error));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode reduction_judge(Reduction *reduction, PetscReal *error)
{
  const KrylovBasis *basis = reduction->basis;
  const StepReference *reference = reduction->reference;
  const PetscReal target = reduction_first_stage_target(reduction->config);

  PetscFunctionBeginUser;
  PetscCall(certificate_destroy(&reduction->certificate));
  PetscCall(modal_model_destroy(&reduction->modal));
  PetscCall(modal_model_create(PetscObjectComm((PetscObject)reduction->system->E), basis->r, reduction->p, basis->K,
                               basis->capacity, basis->inputs, basis->constant, reduction->system->singular,
                               &reduction->modal));
  if (reference->done[0]) PetscCall(step_reference_compare(reference, reduction->modal, error, &reduction->step_error));
  /* The basis that will do is judged by its own residual; the certificate wants that anyway. */
  const PetscBool stale = (PetscBool)(!reference->done[0] || reference->error > STALE * target);
  if (reduction_knows_missing(reduction) && (stale || reduction->step_error <= target))
    PetscCall(find_missing(reduction, error));
  PetscFunctionReturn(PETSC_SUCCESS);
}
