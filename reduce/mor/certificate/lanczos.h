/* lanczos.h - shift-and-invert Lanczos for several inputs side by side, each with its own short recurrence.
 *   S = (pole E + K)^-1 E,  self-adjoint in the E inner product,  S V = V T,  V^T E V = I */
#ifndef REDUCE_MOR_CERTIFICATE_LANCZOS_H
#define REDUCE_MOR_CERTIFICATE_LANCZOS_H

#include "reduce/linear/shifted_solver.h"

enum { LANCZOS_MAX = 64 };

typedef struct Lanczos {
  const ThermalSystem *system;            // borrowed
  ShiftedSolver *solver;                  // borrowed
  Mat ports;                              // [n x p] borrowed: outputs
  PetscInt k, p, steps;                   // inputs, outputs, vectors so far
  Mat previous, current, E_current, next; // [n x k] owned
  PetscReal *alpha, *beta; // [LANCZOS_MAX x k] diagonal of T; beta[q] couples q - 1 and q, beta[0] = ||x_0||_E
  PetscReal *outputs;      // [LANCZOS_MAX x k x p] ports^T v_q
} Lanczos;

/* Starts from x_0 = (pole E + K)^-1 F, F [n x k]. */
PetscErrorCode lanczos_create(const ThermalSystem *system, ShiftedSolver *solver, Mat ports, Mat F, Lanczos **lanczos);
/* One vector more for each input. */
PetscErrorCode lanczos_step(Lanczos *lanczos);
/* ports^T theta(t) [n_times x p] for input j, theta the step response, from the vectors so far. */
PetscErrorCode lanczos_response(const Lanczos *lanczos, PetscInt j, PetscInt n_times, const PetscReal *time,
                                PetscReal *temperature);
PetscErrorCode lanczos_destroy(Lanczos **lanczos);

#endif
