/* reduced_model.c - the course of a reduction, and what leaves it. */
#include "reduce/mor/reduced_model.h"

#include <math.h>

#include "reduce/mor/reduction.h"
#include "reduce/petsc/petsc_compat.h"

static PetscErrorCode check_config(const ThermalSystem *system, const ReductionConfig *config)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)system->E);

  PetscFunctionBeginUser;
  PetscCheck(config->t_start > 0.0 && config->t_end > config->t_start, comm, PETSC_ERR_ARG_OUTOFRANGE,
             "reduction.times: from %g to %g s; 0 < t_start < t_end is expected", config->t_start, config->t_end);
  PetscCheck(config->tolerance > 0.0 && config->tolerance < 1.0, comm, PETSC_ERR_ARG_OUTOFRANGE,
             "reduction.tolerance: %g; above 0 and below 1 is expected", config->tolerance);
  PetscCheck(config->method != REDUCTION_ARNOLDI || config->moments >= 1, comm, PETSC_ERR_ARG_OUTOFRANGE,
             "reduction.moments: %ld; at least 1 is expected", config->moments);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode hand_over_arrays(const Reduction *reduction, ReducedModel *model)
{
  const ModalModel *modal = reduction->modal;
  const size_t r = (size_t)modal->r, m = (size_t)reduction->system->m, p = (size_t)modal->p;

  PetscFunctionBeginUser;
  model->r = modal->r;
  model->m = reduction->system->m;
  PetscCall(PetscMalloc4(r, &model->lambda, r * m, &model->B, r, &model->ambient, r, &model->constant));
  PetscCall(PetscArraycpy(model->lambda, modal->lambda, r));
  PetscCall(PetscArraycpy(model->constant, modal->constant, r));
  for (size_t k = 0; k < r; k++) {
    PetscCall(PetscArraycpy(model->B + k * m, modal->B + k * p, m));
    model->ambient[k] = p > m ? reduction->ambient_sum * modal->B[k * p + m] : 0.0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As it is: of its modal form a few rows are wanted at most. */
static void hand_over_basis(Reduction *reduction, ReducedModel *model)
{
  model->basis = reduction->basis;
  model->basis->ports = NULL; // they go with the reduction
  reduction->basis = NULL;
  model->modes = reduction->modal->Q;
  reduction->modal->Q = NULL;
}

PetscErrorCode reduced_model_create(const ThermalSystem *system, const ReductionConfig *config, Log *log,
                                    ReducedModel **out)
{
  ReducedModel *model;
  Reduction *reduction = NULL;
  const double start = log_wall_time();

  PetscFunctionBeginUser;
  PetscCall(check_config(system, config));
  PetscCall(PetscNew(&model));
  *out = model;
  PetscCall(reduction_create(system, config, log, &reduction));
  if (config->method == REDUCTION_ARNOLDI)
    PetscCall(reduction_run_arnoldi(reduction));
  else if (config->method == REDUCTION_MODAL)
    PetscCall(reduction_run_modal(reduction));
  else
    PetscCall(reduction_run_rational(reduction));
  PetscCall(reduction_begin_certificate(reduction));
  PetscCall(reduction_shorten(reduction));
  PetscCall(hand_over_arrays(reduction, model));
  const double reduced = log_wall_time();
  PetscCall(reduction_certify(reduction, &model->certificate));
  hand_over_basis(reduction, model);
  model->n_shifts = reduction->n_shifts;
  model->shifts = reduction->shifts;
  reduction->shifts = NULL;
  model->moments = reduction->moments_per_shift;
  model->seconds_reduction = reduced - start - reduction->seconds_certificate;
  model->seconds_certificate = log_wall_time() - reduced + reduction->seconds_certificate;
  reduction_report(reduction, &model->certificate);
  PetscCall(reduction_destroy(&reduction));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode reduced_model_make_vectors(ReducedModel *model)
{
  PetscFunctionBeginUser;
  if (model->V) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(krylov_basis_take(model->basis, model->r, model->modes, &model->V));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode reduced_model_destroy(ReducedModel **model)
{
  PetscFunctionBeginUser;
  if (!*model) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree4((*model)->lambda, (*model)->B, (*model)->ambient, (*model)->constant));
  PetscCall(BVDestroy(&(*model)->V));
  PetscCall(krylov_basis_destroy(&(*model)->basis));
  PetscCall(PetscFree((*model)->modes));
  PetscCall(PetscFree((*model)->shifts));
  PetscCall(PetscFree2((*model)->certificate.frequency, (*model)->certificate.transfer_bound));
  PetscCall(PetscFree2((*model)->certificate.time, (*model)->certificate.step_error));
  PetscCall(PetscFree(*model));
  PetscFunctionReturn(PETSC_SUCCESS);
}
