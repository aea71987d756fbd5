/* step_reference.h - step responses of the FULL model, against which a reduced one is judged.
 *
 * theta(t) = phi_t(A) E^-1 b, A = E^-1 K, phi_t(lambda) = (1 - exp(-lambda t))/lambda: heat b switched on at t = 0.
 * Inputs followed: sampled patches (smallest, largest, and areas between), all patches together at one flux, ambient.
 * The band of times is cut into windows, each served by one real pole. */
#ifndef REDUCE_MOR_CERTIFICATE_STEP_REFERENCE_H
#define REDUCE_MOR_CERTIFICATE_STEP_REFERENCE_H

#include "reduce/linear/shifted_solver.h"
#include "reduce/mor/model/modal_model.h"

typedef struct StepReference {
  Mat ports;                       // [n x p] borrowed
  PetscInt p, n_inputs, n_patches; // n_patches of the inputs are single patches, the first ones
  PetscInt *patch;                 // [n_patches]
  PetscReal *u;                    // [n_inputs x p] row-major: the input as heat through the ports
  Mat F;                           // [n x n_inputs] the same on the mesh; owned
  PetscInt n_times;
  PetscReal *time;        // [n_times] s, log-spaced from t_start to t_end
  PetscReal *temperature; // [n_times x n_inputs x p] K, of all ports
  PetscReal *rise;        // [n_times x n_inputs] K: modal_rise_scale over the patches
  PetscInt n_windows;
  PetscReal *pole; // [n_windows] 1/s, ideal; one near it does as well
  PetscBool *done; // [n_windows]
  PetscInt steps;  // Lanczos vectors taken in all windows, of n_inputs columns each
  PetscReal error; // largest change of the last iterations over the rise: the reference's own error
} StepReference;

/* ports: borrowed for the reference's life. Collective. */
PetscErrorCode step_reference_create(const ThermalSystem *system, Mat ports, PetscReal t_start, PetscReal t_end,
                                     StepReference **reference);
/* Compute the responses in window w with the solver's present shift as the pole, until they change by less than
 * `accuracy` of the rise. */
PetscErrorCode step_reference_solve(StepReference *reference, const ThermalSystem *system, ShiftedSolver *solver,
                                    PetscInt w, PetscReal accuracy);
/* All windows at once: the model's own responses and what they lack, both [n_times x n_inputs x p].
 *   doubt  by how much `missing` may be wrong */
PetscErrorCode step_reference_set(StepReference *reference, const ModalModel *model, const PetscReal *missing,
                                  const PetscReal *doubt);
/* No window is solved any more. */
void step_reference_forget(StepReference *reference);
/* After all windows: the rises. */
PetscErrorCode step_reference_finish(StepReference *reference);
/* error[i] [n_times]: largest |dT| of any patch at that time over the rise, over all inputs.
 * worst: their maximum; a NULL error is not filled. */
PetscErrorCode step_reference_compare(const StepReference *reference, const ModalModel *model, PetscReal *error,
                                      PetscReal *worst);
PetscErrorCode step_reference_destroy(StepReference **reference);

#endif
