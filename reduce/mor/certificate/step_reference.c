#include "reduce/mor/certificate/step_reference.h"

#include <math.h>
#include <stdlib.h>

#include "reduce/linear/dense_block.h"
#include "reduce/mor/certificate/lanczos.h"
#include "reduce/petsc/petsc_compat.h"

enum { SAMPLED_PATCHES = 6, TIMES_PER_DECADE = 8 };

static const PetscReal WINDOW = 50.0;   // ratio of a window's last time to its first
static const PetscReal POLE_TIME = 8.0; // pole * (the window's middle): 1 to 60 over the window

typedef struct PatchArea {
  PetscReal area;
  PetscInt patch;
} PatchArea;

static int by_area(const void *a, const void *b)
{
  const PatchArea *first = a, *second = b;
  if (first->area != second->area) return first->area < second->area ? -1 : 1;
  return (first->patch > second->patch) - (first->patch < second->patch);
}

/* Patches at even ranks of area, the smallest and the largest among them. */
static PetscErrorCode sample_patches(const ThermalSystem *system, StepReference *reference)
{
  PatchArea *order;

  PetscFunctionBeginUser;
  reference->n_patches = PetscMin(SAMPLED_PATCHES, system->m);
  PetscCall(PetscMalloc1((size_t)reference->n_patches, &reference->patch));
  PetscCall(PetscMalloc1((size_t)system->m, &order));
  for (PetscInt l = 0; l < system->m; l++) order[l] = (PatchArea){system->area[l], l};
  qsort(order, (size_t)system->m, sizeof *order, by_area);
  for (PetscInt j = 0; j < reference->n_patches; j++) {
    const PetscInt rank = reference->n_patches > 1 ? j * (system->m - 1) / (reference->n_patches - 1) : 0;
    reference->patch[j] = order[rank].patch;
  }
  PetscCall(PetscFree(order));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The inputs as heat through the ports, and on the mesh: F = ports u^T (u row-major is u^T column-major). */
static PetscErrorCode set_inputs(const ThermalSystem *system, StepReference *reference)
{
  const PetscInt p = reference->p, ambient = p > system->m ? 1 : 0;

  PetscFunctionBeginUser;
  reference->n_inputs = reference->n_patches + 1 + ambient;
  PetscCall(PetscCalloc1((size_t)reference->n_inputs * (size_t)p, &reference->u));
  for (PetscInt j = 0; j < reference->n_patches; j++) reference->u[j * p + reference->patch[j]] = 1.0;
  for (PetscInt l = 0; l < system->m; l++) reference->u[reference->n_patches * p + l] = system->area[l];
  if (ambient) reference->u[(reference->n_patches + 1) * p + system->m] = 1.0;
  PetscCall(dense_block_create(system->E, reference->n_inputs, &reference->F));
  PetscCall(dense_block_combine(reference->F, 0.0, 1.0, reference->ports, reference->u, p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode step_reference_create(const ThermalSystem *system, Mat ports, PetscReal t_start, PetscReal t_end,
                                     StepReference **out)
{
  StepReference *reference;
  const PetscReal ratio = t_end / t_start;

  PetscFunctionBeginUser;
  PetscCheck(t_start > 0.0 && ratio > 1.0, PetscObjectComm((PetscObject)system->E), PETSC_ERR_ARG_OUTOFRANGE,
             "band of times from %g to %g s: 0 < t_start < t_end is expected", (double)t_start, (double)t_end);
  PetscCall(PetscNew(&reference));
  *out = reference;
  reference->ports = ports;
  PetscCall(MatGetSize(ports, NULL, &reference->p));
  PetscCall(sample_patches(system, reference));
  PetscCall(set_inputs(system, reference));
  reference->n_times = 1 + (PetscInt)ceil(TIMES_PER_DECADE * log10(ratio) - 1e-9);
  reference->n_windows = (PetscInt)ceil(log(ratio) / log(WINDOW) - 1e-9);
  PetscCall(PetscMalloc3((size_t)reference->n_times, &reference->time, (size_t)reference->n_windows, &reference->pole,
                         (size_t)reference->n_windows, &reference->done));
  for (PetscInt t = 0; t < reference->n_times; t++)
    reference->time[t] = t_start * pow(ratio, (double)t / (double)(reference->n_times - 1));
  reference->time[reference->n_times - 1] = t_end;
  for (PetscInt w = 0; w < reference->n_windows; w++) {
    reference->pole[w] = POLE_TIME / (t_start * pow(ratio, ((double)w + 0.5) / (double)reference->n_windows));
    reference->done[w] = PETSC_FALSE;
  }
  const size_t responses = (size_t)reference->n_times * (size_t)reference->n_inputs;
  PetscCall(PetscCalloc2(responses * (size_t)reference->p, &reference->temperature, responses, &reference->rise));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Times [*first, *last) belong to window w: nearest to its middle, on the log scale. */
static void window_times(const StepReference *reference, PetscInt w, PetscInt *first, PetscInt *last)
{
  const PetscReal span = log(reference->time[reference->n_times - 1] / reference->time[0]);
  *first = *last = 0;
  for (PetscInt t = 0; t < reference->n_times; t++) {
    const PetscReal position = log(reference->time[t] / reference->time[0]) / span * (PetscReal)reference->n_windows;
    const PetscInt of_time = PetscMin((PetscInt)(position + 1e-9), reference->n_windows - 1);
    if (of_time < w) *first = t + 1;
    if (of_time <= w) *last = t + 1;
  }
}

/* Write the responses so far; *change: their largest difference from what stood there, over the rise in the window. */
static PetscErrorCode update(StepReference *reference, const Lanczos *lanczos, PetscInt first, PetscInt last,
                             PetscReal *change)
{
  const size_t p = (size_t)reference->p, n_inputs = (size_t)reference->n_inputs;
  PetscReal *fresh;

  PetscFunctionBeginUser;
  *change = 0.0;
  PetscCall(PetscMalloc1((size_t)(last - first) * p, &fresh));
  for (PetscInt j = 0; j < reference->n_inputs; j++) {
    PetscCall(lanczos_response(lanczos, j, last - first, reference->time + first, fresh));
    PetscReal at_end = 0.0;
    for (size_t i = 0; i < p; i++) at_end = PetscMax(at_end, PetscAbsReal(fresh[(size_t)(last - 1 - first) * p + i]));
    for (PetscInt t = first; t < last; t++) {
      PetscReal *stored = reference->temperature + ((size_t)t * n_inputs + (size_t)j) * p, size = 0.0, difference = 0.0;
      const PetscReal *now = fresh + (size_t)(t - first) * p;
      for (size_t i = 0; i < p; i++) {
        size = PetscMax(size, PetscAbsReal(now[i]));
        difference = PetscMax(difference, PetscAbsReal(now[i] - stored[i]));
        stored[i] = now[i];
      }
      size = modal_rise_scale(size, at_end, reference->time[t], reference->time[last - 1]);
      if (size > 0.0) *change = PetscMax(*change, difference / size);
    }
  }
  PetscCall(PetscFree(fresh));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode step_reference_solve(StepReference *reference, const ThermalSystem *system, ShiftedSolver *solver,
                                    PetscInt w, PetscReal accuracy)
{
  Lanczos *lanczos = NULL;
  PetscInt first, last;
  PetscReal change = PETSC_MAX_REAL, before = PETSC_MAX_REAL;

  PetscFunctionBeginUser;
  window_times(reference, w, &first, &last);
  reference->done[w] = PETSC_TRUE;
  if (last <= first) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(lanczos_create(system, solver, reference->ports, reference->F, &lanczos));
  /* Two small changes in a row: one alone may be a plateau. */
  while ((change > accuracy || before > accuracy) && lanczos->steps < LANCZOS_MAX - 1) {
    PetscCall(lanczos_step(lanczos));
    before = change;
    PetscCall(update(reference, lanczos, first, last, &change));
  }
  reference->steps += lanczos->steps + 1;
  reference->error = PetscMax(reference->error, PetscMax(change, before));
  PetscCall(lanczos_destroy(&lanczos));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode step_reference_set(StepReference *reference, const ModalModel *model, const PetscReal *missing,
                                  const PetscReal *doubt)
{
  const size_t p = (size_t)reference->p, n_inputs = (size_t)reference->n_inputs;
  PetscReal *state;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)model->r, &state));
  for (size_t t = 0; t < (size_t)reference->n_times; t++)
    for (size_t j = 0; j < n_inputs; j++) {
      PetscReal *at = reference->temperature + (t * n_inputs + j) * p;
      modal_model_step_response(model, reference->time[t], reference->u + j * p, state, at);
      for (size_t i = 0; i < p; i++) at[i] += missing[(t * n_inputs + j) * p + i];
    }
  PetscCall(PetscFree(state));
  for (PetscInt w = 0; w < reference->n_windows; w++) reference->done[w] = PETSC_TRUE;
  PetscCall(step_reference_finish(reference));
  reference->error = 0.0;
  for (size_t response = 0; response < (size_t)reference->n_times * n_inputs; response++)
    for (size_t i = 0; i < p && reference->rise[response] > 0.0; i++)
      reference->error = PetscMax(reference->error, doubt[response * p + i] / reference->rise[response]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

void step_reference_forget(StepReference *reference)
{
  for (PetscInt w = 0; w < reference->n_windows; w++) reference->done[w] = PETSC_FALSE;
  reference->error = 0.0;
}

PetscErrorCode step_reference_finish(StepReference *reference)
{
  const size_t p = (size_t)reference->p, n_inputs = (size_t)reference->n_inputs;

  PetscFunctionBeginUser;
  const size_t n_times = (size_t)reference->n_times;
  for (size_t t = 0; t < n_times; t++)
    for (size_t j = 0; j < n_inputs; j++) {
      const PetscReal *now = reference->temperature + (t * n_inputs + j) * p;
      PetscReal rise = t > 0 ? reference->rise[(t - 1) * n_inputs + j] : 0.0;
      for (size_t i = 0; i < p; i++) rise = PetscMax(rise, PetscAbsReal(now[i]));
      reference->rise[t * n_inputs + j] = rise;
    }
  for (size_t t = 0; t + 1 < n_times; t++)
    for (size_t j = 0; j < n_inputs; j++)
      reference->rise[t * n_inputs + j] =
          modal_rise_scale(reference->rise[t * n_inputs + j], reference->rise[(n_times - 1) * n_inputs + j],
                           reference->time[t], reference->time[n_times - 1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode step_reference_compare(const StepReference *reference, const ModalModel *model, PetscReal *error,
                                      PetscReal *worst)
{
  const size_t p = (size_t)reference->p, n_inputs = (size_t)reference->n_inputs;
  PetscReal *state, *temperature;

  PetscFunctionBeginUser;
  *worst = 0.0;
  PetscCall(PetscMalloc2((size_t)model->r, &state, p, &temperature));
  for (size_t t = 0; t < (size_t)reference->n_times; t++) {
    PetscReal at_time = 0.0;
    for (size_t j = 0; j < n_inputs; j++) {
      const PetscReal *exact = reference->temperature + (t * n_inputs + j) * p;
      PetscReal difference = 0.0;
      modal_model_step_response(model, reference->time[t], reference->u + j * p, state, temperature);
      for (size_t i = 0; i < p; i++) difference = PetscMax(difference, PetscAbsReal(temperature[i] - exact[i]));
      if (reference->rise[t * n_inputs + j] > 0.0)
        at_time = PetscMax(at_time, difference / reference->rise[t * n_inputs + j]);
    }
    if (error) error[t] = at_time;
    *worst = PetscMax(*worst, at_time);
  }
  PetscCall(PetscFree2(state, temperature));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode step_reference_destroy(StepReference **reference)
{
  PetscFunctionBeginUser;
  if (!*reference) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*reference)->patch));
  PetscCall(PetscFree((*reference)->u));
  PetscCall(MatDestroy(&(*reference)->F));
  PetscCall(PetscFree3((*reference)->time, (*reference)->pole, (*reference)->done));
  PetscCall(PetscFree2((*reference)->temperature, (*reference)->rise));
  PetscCall(PetscFree(*reference));
  PetscFunctionReturn(PETSC_SUCCESS);
}
