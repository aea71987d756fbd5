/* moments.h - moments of the full model that a reduction is to match, kept as it computes them:
 *   y_k = ports^T [(s E + K)^-1 E]^k (s E + K)^-1 b,  reduced: B_r^T (s + Lambda)^-(k + 1) b_r */
#ifndef REDUCE_MOR_MODEL_MOMENTS_H
#define REDUCE_MOR_MODEL_MOMENTS_H

#include "reduce/linear/shifted_solver.h"
#include "reduce/mor/model/modal_model.h"

typedef struct Moments {
  PetscInt n, capacity, n_inputs, p;
  PetscReal *shift; // [n] 1/s
  PetscInt *power;  // [n] k
  PetscReal *value; // [n x n_inputs x p]
} Moments;

PetscErrorCode moments_create(PetscInt n_inputs, PetscInt p, Moments **moments);
/* value [p x n_inputs] column-major: one column an input. */
PetscErrorCode moments_append(Moments *moments, PetscReal shift, PetscInt power, const PetscReal *value);
/* The first q moments of the inputs F [n x n_inputs] at the solver's shift, by their own recursion. */
PetscErrorCode moments_compute(Moments *moments, const ThermalSystem *system, ShiftedSolver *solver, Mat ports, Mat F,
                               PetscInt q);
/* Largest relative difference, in the 2-norm over the outputs; u [n_inputs x p]: the inputs as heat through the ports.
 * NAN where nothing was kept. */
PetscErrorCode moments_compare(const Moments *moments, const ModalModel *model, const PetscReal *u, PetscReal *error);
PetscErrorCode moments_destroy(Moments **moments);

#endif
