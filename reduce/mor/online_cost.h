/* online_cost.h - what a step of a reduced model costs castrun, and what the full model's would. */
#ifndef REDUCE_MOR_ONLINE_COST_H
#define REDUCE_MOR_ONLINE_COST_H

#include "reduce/fem/thermal_system.h"
#include "reduce/mor/reduced_model.h"

typedef struct OnlineCost {
  PetscReal multiplications; // of one step: decay and input of each state, B q and B^T z
  PetscReal seconds;         // measured on this rank, one thread, the model in cache as far as it fits
} OnlineCost;

PetscErrorCode online_cost_measure(const ReducedModel *model, OnlineCost *cost);

typedef struct FullStepCost {
  PetscReal operations; // of one step, multiplications and additions as PETSc counts them, all ranks
  PetscReal seconds;    // wall
  PetscReal processor;  // s, processor time of this rank
  PetscReal iterations;
} FullStepCost;

/* One step of the full model as the founding paper takes it: backward Euler, (E/dt + K) theta' = E/dt theta + B q, here
 * by conjugate gradients with the diagonal as preconditioner, from the last state to 1e-6 (castrun's dt changes, so
 * that a factor would serve for one step only). Mean of a few steps under 1 W on all patches. Options:
 * -full_step_ksp_type and so on. Collective. Errors: PETSC_ERR_NOT_CONVERGED. */
PetscErrorCode full_step_measure(const ThermalSystem *system, PetscReal dt, FullStepCost *cost);

#endif
