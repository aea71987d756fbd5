/* What a step of the reduced model replaces: one implicit step of the full model of the same mould, by conjugate
 * gradients from the last state, as a melt's changing time step asks for, and by a Cholesky factor, which serves as
 * long as the time step stays what it is. A box of investment with thin layers at a cavity wall of 7 x 7 patches,
 * reduced to 1e-3 from 1 ms on. Processor time of one rank. full_step [cells along an edge, 45: 97,000 unknowns [factor
 * it: 1]] */
#include <math.h>
#include <petscksp.h>
#include <slepcsys.h>

#include "reduce/mor/online_cost.h"
#include "reduce/petsc/petsc_compat.h"
#include "tests/bench/bench.h"
#include "tests/support/mould_case.h"

enum { SOLVES = 3, PATCHES = 7 };

static void print_row(const char *what, double seconds, double reduced, const char *note)
{
  printf("  %-34s %12.4g ms %10.0f times a step of the reduced model%s\n", what, 1e3 * seconds, seconds / reduced,
         note);
  fflush(stdout);
}

/* (E/dt + K) factorised once, and solved with. */
static PetscErrorCode time_factor(const ThermalSystem *system, PetscReal dt, double *factor, double *solve)
{
  Mat A;
  KSP ksp;
  PC pc;
  Vec rhs, theta;

  PetscFunctionBeginUser;
  PetscCall(MatDuplicate(system->K, MAT_COPY_VALUES, &A));
  PetscCall(MatAXPY(A, 1.0 / dt, system->E, SAME_NONZERO_PATTERN));
  PetscCall(MatSetOption(A, MAT_SPD, PETSC_TRUE));
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &ksp));
  PetscCall(KSPSetOperators(ksp, A, A));
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCCHOLESKY));
  PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  PetscCall(KSPSetFromOptions(ksp));
  const double begun = bench_cpu_time();
  PetscCall(KSPSetUp(ksp));
  *factor = bench_cpu_time() - begun;
  PetscCall(MatCreateVecs(A, &theta, &rhs));
  PetscCall(VecSet(theta, 1.0));
  const double solving = bench_cpu_time();
  for (int step = 0; step < SOLVES; step++) {
    PetscCall(MatMult(system->E, theta, rhs));
    PetscCall(VecScale(rhs, 1.0 / dt));
    PetscCall(KSPSolve(ksp, rhs, theta));
  }
  *solve = (bench_cpu_time() - solving) / SOLVES;
  PetscCall(VecDestroy(&rhs));
  PetscCall(VecDestroy(&theta));
  PetscCall(KSPDestroy(&ksp));
  PetscCall(MatDestroy(&A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode compare(const ThermalSystem *system, PetscBool factorise)
{
  static const PetscReal DT[] = {5e-6, 5e-5, 1e-3}; // s: of the melt, of the mould within it, of early cooling
  ReductionConfig config = rational_config();
  ReducedModel *model;
  OnlineCost online;
  double factor = 0.0, solve = 0.0;

  PetscFunctionBeginUser;
  config.solver_rtol = 1e-5; // enough for 1e-3
  const double begun = bench_cpu_time();
  PetscCall(reduced_model_create(system, &config, NULL, &model));
  PetscCall(online_cost_measure(model, &online));
  printf("full model of %" PetscInt_FMT " unknowns, %" PetscInt_FMT " patches; reduced to %" PetscInt_FMT
         " states in %.0f s\n",
         system->n, system->m, model->r, bench_cpu_time() - begun);
  print_row("step of the reduced model", online.seconds, online.seconds, "");
  for (size_t k = 0; k < sizeof DT / sizeof *DT; k++) {
    FullStepCost cost;
    char what[64], note[64];
    PetscCall(full_step_measure(system, DT[k], &cost));
    snprintf(what, sizeof what, "full, conjugate gradients, %g us", 1e6 * DT[k]);
    snprintf(note, sizeof note, " (%.1f iterations)", cost.iterations);
    print_row(what, cost.processor, online.seconds, note);
  }
  if (factorise) {
    PetscCall(time_factor(system, DT[0], &factor, &solve));
    print_row("full, one solve with the factor", solve, online.seconds, "");
    print_row("full, factor and solve (new dt)", factor + solve, online.seconds, "");
  }
  PetscCall(reduced_model_destroy(&model));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  BoxMould box = INVESTMENT_BOX;
  MouldCase mould;

  PetscCall(SlepcInitialize(NULL, NULL, NULL, NULL));
  const double unknowns = argc > 1 ? strtod(argv[1], NULL) : 97000.0;
  const int across = (int)PetscMax(lround(cbrt(unknowns) / PATCHES), 1) * PATCHES;
  for (int k = 0; k < 2; k++) {
    box.patches[k] = PATCHES;
    box.cells[k] = across;
  }
  box.cells[2] = (int)PetscMax(lround(unknowns / ((across + 1.0) * (across + 1.0))) - 1, 2);
  PetscCall(mould_case_create(PETSC_COMM_WORLD, &box, &mould));
  PetscCall(compare(mould.system, argc > 2 ? strtol(argv[2], NULL, 10) != 0 : PETSC_TRUE));
  PetscCall(mould_case_destroy(&mould));
  return (int)SlepcFinalize();
}
