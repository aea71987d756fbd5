#include "reduce/mor/online_cost.h"

#include <petscksp.h>
#include <petsctime.h>
#include <time.h>

#include "reduce/mor/model/modal_model.h"
#include "reduce/petsc/petsc_compat.h"

static const double SHORTEST = 0.02; // s of measuring

static double cpu_now(void)
{
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* a . b in as many partial sums as a vector register has lanes: the compiler may not reorder one. */
static PetscReal dot(PetscInt n, const PetscReal *restrict a, const PetscReal *restrict b)
{
  enum { LANES = 8 };
  PetscReal partial[LANES] = {0.0}, sum = 0.0;
  PetscInt i = 0;
  for (; i + LANES <= n; i += LANES)
    for (PetscInt c = 0; c < LANES; c++) partial[c] += a[i + c] * b[i + c];
  for (; i < n; i++) sum += a[i] * b[i];
  for (PetscInt c = 0; c < LANES; c++) sum += partial[c];
  return sum;
}

/* One step of the exponential scheme: z = decay z + phi B q, T = B^T z. */
static void step(const ReducedModel *model, const PetscReal *decay, const PetscReal *phi, const PetscReal *restrict q,
                 PetscReal *restrict z, PetscReal *restrict T)
{
  const PetscInt m = model->m;
  for (PetscInt l = 0; l < m; l++) T[l] = 0.0;
  for (PetscInt k = 0; k < model->r; k++) {
    const PetscReal *restrict row = model->B + (size_t)k * (size_t)m;
    z[k] = decay[k] * z[k] + phi[k] * dot(m, row, q);
    const PetscReal state = z[k];
    for (PetscInt l = 0; l < m; l++) T[l] += row[l] * state;
  }
}

PetscErrorCode online_cost_measure(const ReducedModel *model, OnlineCost *cost)
{
  static const PetscReal DT = 1e-5; // s
  const size_t r = (size_t)model->r, m = (size_t)model->m;
  PetscReal *decay, *phi, *q, *z, *T;
  long steps = 0;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc5(r, &decay, r, &phi, m, &q, r, &z, m, &T));
  for (size_t k = 0; k < r; k++) {
    decay[k] = PetscExpReal(-model->lambda[k] * DT);
    phi[k] = modal_phi(model->lambda[k], DT);
    z[k] = 0.0;
  }
  for (size_t l = 0; l < m; l++) q[l] = 1.0;
  step(model, decay, phi, q, z, T); // warm
  const double start = cpu_now();
  double now = start;
  while (now - start < SHORTEST) {
    for (int i = 0; i < 16; i++, steps++) {
      step(model, decay, phi, q, z, T);
      q[steps % (long)m] = 1.0 / (1.0 + T[0] * T[0]); // each step needs the one before
    }
    now = cpu_now();
  }
  cost->seconds = (now - start) / (PetscReal)steps;
  cost->multiplications = 2.0 * (PetscReal)r * (PetscReal)m + 2.0 * (PetscReal)r;
  PetscCall(PetscFree5(decay, phi, q, z, T));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the full model ---- */

enum { FULL_STEPS = 10 };

static PetscErrorCode full_step_solver(const ThermalSystem *system, PetscReal dt, KSP *ksp)
{
  Mat A;
  PC pc;

  PetscFunctionBeginUser;
  PetscCall(MatDuplicate(system->K, MAT_COPY_VALUES, &A));
  PetscCall(MatAXPY(A, 1.0 / dt, system->E, UNKNOWN_NONZERO_PATTERN));
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)A), ksp));
  PetscCall(KSPSetOptionsPrefix(*ksp, "full_step_"));
  PetscCall(KSPSetOperators(*ksp, A, A));
  PetscCall(KSPSetType(*ksp, KSPCG));
  PetscCall(KSPGetPC(*ksp, &pc));
  PetscCall(PCSetType(pc, PCJACOBI));
  PetscCall(KSPSetTolerances(*ksp, 1e-6, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(KSPSetInitialGuessNonzero(*ksp, PETSC_TRUE));
  PetscCall(KSPSetErrorIfNotConverged(*ksp, PETSC_TRUE));
  PetscCall(KSPSetFromOptions(*ksp));
  PetscCall(KSPSetUp(*ksp));
  PetscCall(MatDestroy(&A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode full_step_measure(const ThermalSystem *system, PetscReal dt, FullStepCost *cost)
{
  KSP ksp;
  Vec theta, rhs, power, q;
  PetscLogDouble flops[2], all, begun, ended;
  PetscInt iterations = 0;

  PetscFunctionBeginUser;
  PetscCall(full_step_solver(system, dt, &ksp));
  PetscCall(MatCreateVecs(system->B, &q, &power));
  PetscCall(VecDuplicate(power, &theta));
  PetscCall(VecDuplicate(power, &rhs));
  PetscCall(VecSet(q, 1.0));
  PetscCall(MatMult(system->B, q, power)); // the heat's sum over patches costs next to nothing: B is sparse by nature
  PetscCall(VecSet(theta, 0.0));
  PetscCall(PetscGetFlops(&flops[0]));
  PetscCall(PetscTime(&begun));
  const double cpu_begun = cpu_now();
  for (PetscInt step = 0; step < FULL_STEPS; step++) {
    PetscInt taken;
    PetscCall(MatMult(system->E, theta, rhs));
    PetscCall(VecAXPBY(rhs, 1.0, 1.0 / dt, power));
    PetscCall(KSPSolve(ksp, rhs, theta));
    PetscCall(KSPGetIterationNumber(ksp, &taken));
    iterations += taken;
  }
  PetscCall(PetscTime(&ended));
  PetscCall(PetscGetFlops(&flops[1]));
  const PetscLogDouble here = flops[1] - flops[0];
  PetscCallMPI(MPI_Allreduce(&here, &all, 1, MPI_DOUBLE, MPI_SUM, PetscObjectComm((PetscObject)ksp)));
  *cost = (FullStepCost){all / FULL_STEPS, (ended - begun) / FULL_STEPS, (cpu_now() - cpu_begun) / FULL_STEPS,
                         (PetscReal)iterations / FULL_STEPS};
  PetscCall(VecDestroy(&q));
  PetscCall(VecDestroy(&power));
  PetscCall(VecDestroy(&theta));
  PetscCall(VecDestroy(&rhs));
  PetscCall(KSPDestroy(&ksp));
  PetscFunctionReturn(PETSC_SUCCESS);
}
