#include "reduce/replay/full_run.h"

#include <math.h>

#include "reduce/linear/dense_block.h"
#include "reduce/petsc/petsc_compat.h"
#include "reduce/replay/l_stable.h"

static const PetscReal RTOL = 1e-11;     // of each stage's solve
static const PetscReal SAME_SPAN = 1e-9; // relative

struct FullRun {
  const ThermalSystem *system; // borrowed
  ShiftedSolver *solver;
  PetscInt k, substeps;
  PetscReal span;      // s, that the solver's shift belongs to
  Mat theta, v, right; // [n x k]
};

PetscErrorCode full_run_create(const ThermalSystem *system, PetscInt k, PetscInt substeps, FullRun **out)
{
  FullRun *run;

  PetscFunctionBeginUser;
  PetscCall(PetscNew(&run));
  *out = run;
  run->system = system;
  run->k = k;
  run->substeps = substeps;
  PetscCall(shifted_solver_create(system, RTOL, PETSC_FALSE, &run->solver));
  PetscCall(dense_block_create(system->E, k, &run->theta));
  PetscCall(dense_block_create(system->E, k, &run->v));
  PetscCall(dense_block_create(system->E, k, &run->right));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* theta += d v, the same factor for all columns */
static PetscErrorCode add(FullRun *run, PetscReal d)
{
  PetscReal *factor;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)run->k, &factor));
  for (PetscInt c = 0; c < run->k; c++) factor[c] = d;
  PetscCall(dense_block_axpby(run->theta, 1.0, factor, run->v));
  PetscCall(PetscFree(factor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode step(FullRun *run, const PetscReal *d, Mat F)
{
  const PetscReal s = shifted_solver_get_shift(run->solver);
  PetscReal *factor;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)run->k, &factor));
  for (PetscInt c = 0; c < run->k; c++) factor[c] = 1.0;
  PetscCall(dense_block_multiply(run->system->K, run->theta, run->right));
  PetscCall(dense_block_axpby(run->right, -1.0, factor, F)); // F - K theta
  for (PetscInt c = 0; c < run->k; c++) factor[c] = s;
  for (int k = 0; k < L_STABLE_STAGES; k++) {
    PetscCall(shifted_solver_solve(run->solver, run->right, run->v));
    PetscCall(add(run, d[k]));
    if (k + 1 == L_STABLE_STAGES) break;
    PetscCall(dense_block_multiply(run->system->E, run->v, run->right));
    PetscCall(dense_block_scale(run->right, factor));
  }
  PetscCall(PetscFree(factor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode full_run_advance(FullRun *run, PetscReal span, Mat F)
{
  PetscReal d[L_STABLE_STAGES];

  PetscFunctionBeginUser;
  l_stable_weights(d);
  if (fabs(span - run->span) > SAME_SPAN * span) {
    run->span = span;
    PetscCall(shifted_solver_set_shift(run->solver, (PetscReal)run->substeps / (L_STABLE_GAMMA * span), 1000 * run->k));
  }
  for (PetscInt i = 0; i < run->substeps; i++) PetscCall(step(run, d, F));
  PetscFunctionReturn(PETSC_SUCCESS);
}

Mat full_run_state(const FullRun *run)
{
  return run->theta;
}

PetscReal full_run_advance_mode(PetscReal lambda, PetscReal u, PetscReal span, PetscInt substeps, PetscReal z)
{
  PetscReal d[L_STABLE_STAGES];
  const PetscReal s = (PetscReal)substeps / (L_STABLE_GAMMA * span);

  l_stable_weights(d);
  for (PetscInt i = 0; i < substeps; i++) {
    PetscReal v = (u - lambda * z) / (s + lambda);
    for (int k = 0; k < L_STABLE_STAGES; k++, v *= s / (s + lambda)) z += d[k] * v;
  }
  return z;
}

PetscErrorCode full_run_destroy(FullRun **run)
{
  PetscFunctionBeginUser;
  if (!*run) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(shifted_solver_destroy(&(*run)->solver));
  PetscCall(MatDestroy(&(*run)->theta));
  PetscCall(MatDestroy(&(*run)->v));
  PetscCall(MatDestroy(&(*run)->right));
  PetscCall(PetscFree(*run));
  PetscFunctionReturn(PETSC_SUCCESS);
}
