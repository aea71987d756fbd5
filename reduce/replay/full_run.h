/* full_run.h - the full model in time, for several heat inputs side by side:
 *   E dtheta/dt = -K theta + F,   theta(0) = 0,   F [n x k] W, constant over each span of time
 * by an L-stable one-step scheme of order 5 with one matrix for all its stages, and the same scheme for one mode, so
 * that its error can be told from a model whose exact answer is known. */
#ifndef REDUCE_REPLAY_FULL_RUN_H
#define REDUCE_REPLAY_FULL_RUN_H

#include "reduce/linear/shifted_solver.h"

typedef struct FullRun FullRun;

/* `system` borrowed, must outlive the run. substeps: steps of a span, at least 1. Collective. */
PetscErrorCode full_run_create(const ThermalSystem *system, PetscInt k, PetscInt substeps, FullRun **run);
/* The span's end; spans of the same length (to 1e-9) share one factorisation. Collective. */
PetscErrorCode full_run_advance(FullRun *run, PetscReal span, Mat F);
Mat full_run_state(const FullRun *run); // [n x k] theta, K above preheat; borrowed
PetscErrorCode full_run_destroy(FullRun **run);

/* z of dz/dt = -lambda z + u after a span, by the same scheme. */
PetscReal full_run_advance_mode(PetscReal lambda, PetscReal u, PetscReal span, PetscInt substeps, PetscReal z);

#endif
