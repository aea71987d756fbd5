/* reduction_finish.c - the second stage of a reduction, its certificate, and what is said about it. */
#include <math.h>

#include "reduce/mor/certificate/certificate.h"
#include "reduce/mor/krylov/model_basis.h"
#include "reduce/mor/reduction.h"
#include "reduce/mor/second_stage.h"
#include "reduce/petsc/petsc_compat.h"

static const PetscReal ARNOLDI_WARNING = 0.01;
static const PetscReal BOUND_RTOL = 1e-4; // what a solve leaves over is added to the bound, and enters squared

/* Weights that make the entries of H relative: port l gets rise_l^(-1/2), rise_l its temperature at t_end after a step;
 * as input and as output it so has 1/rise_l. */
static PetscErrorCode port_weights(const Reduction *reduction, PetscReal *weight)
{
  const size_t p = (size_t)reduction->p;
  PetscReal *u, *state, *temperature;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc3(p, &u, (size_t)reduction->modal->r, &state, p, &temperature));
  PetscCall(PetscArrayzero(u, p));
  for (size_t l = 0; l < p; l++) {
    u[l] = 1.0;
    modal_model_step_response(reduction->modal, reduction->config->t_end, u, state, temperature);
    u[l] = 0.0;
    weight[l] = 1.0 / sqrt(temperature[l]); // positive: a sum of squares
  }
  PetscCall(PetscFree3(u, state, temperature));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest change of the transfer function over the band of rates and a decade beyond its ends. */
static PetscErrorCode compare_stages(Reduction *reduction, const ModalModel *smaller)
{
  const ReductionConfig *config = reduction->config;
  const PetscInt n = 1 + (PetscInt)ceil(4.0 * log10(100.0 * config->t_end / config->t_start));

  PetscFunctionBeginUser;
  for (PetscInt i = 0; i < n; i++) {
    PetscReal difference;
    const PetscReal w = 0.1 / config->t_end * pow(10.0, (PetscReal)i / 4.0);
    PetscCall(modal_model_difference(reduction->modal, smaller, w, &difference));
    reduction->second_stage_bound = PetscMax(reduction->second_stage_bound, difference);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode reduction_shorten(Reduction *reduction)
{
  const ReductionConfig *config = reduction->config;
  const StepReference *reference = reduction->reference;
  SecondStage stage = {.early_weight = config->early_weight,
                       .singular = reduction->system->singular,
                       .n_times = reference->n_times,
                       .time = reference->time,
                       .allowed = 0.9 * (config->tolerance - reduction->step_error),
                       .reference = reference,
                       .limit = 0.98 * config->tolerance - reference->error};
  ModalModel *smaller;
  const double start = log_wall_time();

  PetscFunctionBeginUser;
  if (!config->second_stage || stage.allowed <= 0.0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1((size_t)reduction->p, &stage.weight));
  PetscCall(port_weights(reduction, stage.weight));
  PetscCall(second_stage_truncate(reduction->modal, &stage, &smaller));
  PetscCall(PetscFree(stage.weight));
  reduction->second_stage_error = stage.reached;
  if (!smaller) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(compare_stages(reduction, smaller));
  log_info(reduction->log, "second stage: %d states become %d; %.1f s", (int)reduction->modal->r, (int)smaller->r,
           log_wall_time() - start);
  if (config->early_weight == 0.0) {
    log_info(reduction->log,
             "balanced truncation: a-priori bound %.3g K/W of the transfer function's error, %.3g K/W found",
             (double)stage.bound, (double)reduction->second_stage_bound);
    reduction->second_stage_bound = stage.bound;
  }
  reduction->projected = reduction->modal;
  reduction->modal = smaller;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Over the band of rates, 1/t_end to 1/t_start. The reduction has seen real shifts only: no frequency is known to it.
 */
PetscErrorCode reduction_begin_certificate(Reduction *reduction)
{
  const ReductionConfig *config = reduction->config;
  const double start = log_wall_time();

  PetscFunctionBeginUser;
  if (reduction->certificate) PetscFunctionReturn(PETSC_SUCCESS);
  shifted_solver_set_tolerance(reduction->solver, BOUND_RTOL);
  PetscCall(certificate_create(reduction->basis, reduction->modal, reduction->solver, 1.0 / config->t_end,
                               1.0 / config->t_start, &reduction->certificate));
  shifted_solver_set_tolerance(reduction->solver, reduction->rtol);
  reduction->seconds_certificate += log_wall_time() - start;
  log_info(reduction->log, "certificate: residual's energy over the band %.1f s", log_wall_time() - start);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode reduction_certify(Reduction *reduction, RomCertificate *certificate)
{
  const ReductionConfig *config = reduction->config;
  const StepReference *reference = reduction->reference;

  PetscFunctionBeginUser;
  certificate->n_times = (size_t)reference->n_times;
  PetscCall(PetscMalloc2(certificate->n_times, &certificate->time, certificate->n_times, &certificate->step_error));
  PetscCall(PetscArraycpy(certificate->time, reference->time, certificate->n_times));
  PetscCall(step_reference_compare(reference, reduction->modal, certificate->step_error, &certificate->step_error_max));
  /* The second stage is known on every input, the first on the sampled ones: their sum speaks for the rest too. */
  certificate->step_error_max =
      reference->error + PetscMax(certificate->step_error_max, reduction->step_error + reduction->second_stage_error);
  certificate->met = certificate->step_error_max <= config->tolerance;
  certificate->sampled_patches = reference->n_patches;
  if (reduction->second_stage_error > 0.0) // the second stage keeps responses, not moments
    certificate->moment_error = (double)NAN;
  else
    PetscCall(moments_compare(reduction->moments, reduction->modal, reference->u, &certificate->moment_error));
  certificate->second_stage_bound = reduction->second_stage_bound;
  PetscCall(model_basis_orthogonality(reduction->basis, reduction->modal->r, reduction->modal->Q,
                                      &certificate->orthogonality));
  PetscInt n;
  PetscCall(certificate_transfer_bounds(reduction->certificate, reduction->modal, &n, &certificate->frequency,
                                        &certificate->transfer_bound));
  certificate->n_frequencies = (size_t)n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

void reduction_report(const Reduction *reduction, const RomCertificate *certificate)
{
  const ReductionConfig *config = reduction->config;
  const PetscBool arnoldi = (PetscBool)(config->method == REDUCTION_ARNOLDI);
  double bound = 0.0;

  for (size_t i = 0; i < certificate->n_frequencies; i++) bound = fmax(bound, certificate->transfer_bound[i]);
  log_info(reduction->log,
           "certificate: steps on %ld sampled patches, all together and the ambient differ from the full model "
           "by at most %.2e of the largest rise from %g to %g s; transfer function by at most %.2e from %.3g to "
           "%.3g rad/s; orthogonality defect %.1e",
           certificate->sampled_patches, certificate->step_error_max, config->t_start, config->t_end, bound,
           1.0 / config->t_end, 1.0 / config->t_start, certificate->orthogonality);
  if (certificate->met)
    log_info(reduction->log, "the tolerance %.2e is met with %d states", config->tolerance, (int)reduction->modal->r);
  else
    log_warn(reduction->log, "the tolerance %.2e is NOT met: the error is %.2e with %d states", config->tolerance,
             certificate->step_error_max, (int)reduction->modal->r);
  if (config->method == REDUCTION_MODAL && !certificate->met)
    log_warn(reduction->log,
             "method modal: slow modes know little of where and when heat enters (error %.1f %%); "
             "method rational reaches the tolerance",
             100.0 * certificate->step_error_max);
  if (arnoldi && certificate->step_error_max > ARNOLDI_WARNING)
    log_warn(reduction->log,
             "method arnoldi: %ld moments at %g 1/s know little of times near %g s (error %.1f %%); method rational "
             "reaches the tolerance",
             config->moments, config->s0, config->t_start, 100.0 * certificate->step_error_max);
}
