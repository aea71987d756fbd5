#include "tests/support/mould_case.h"

#include <math.h>
#include <petscksp.h>

#include "reduce/petsc/petsc_compat.h"
#include "reduce/replay/l_stable.h"

const BoxMould INVESTMENT_BOX = {.size = {0.024, 0.016, 0.02},
                                 .cells = {12, 8, 16},
                                 .grading = 2.5,
                                 .patches = {4, 2},
                                 .h_sides = 15.0,
                                 .h_top = 15.0,
                                 .kappa = {1.0},
                                 .rho = {1800.0},
                                 .c = {1100.0}};

const BoxMould SMALL_BOX = {.size = {0.009, 0.006, 0.012},
                            .cells = {6, 4, 8},
                            .grading = 2.0,
                            .patches = {3, 2},
                            .h_sides = 15.0,
                            .h_top = 40.0,
                            .kappa = {1.0},
                            .rho = {1800.0},
                            .c = {1100.0}};

PetscErrorCode mould_case_create(MPI_Comm comm, const BoxMould *box, MouldCase *mould)
{
  PetscFunctionBeginUser;
  PetscCall(box_mould_create(comm, box, &mould->mesh, &mould->config));
  PetscCall(thermal_system_create(mould->mesh, mould->config, &mould->system));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode mould_case_destroy(MouldCase *mould)
{
  PetscFunctionBeginUser;
  PetscCall(thermal_system_destroy(&mould->system));
  PetscCall(box_mould_destroy(&mould->mesh, &mould->config));
  PetscFunctionReturn(PETSC_SUCCESS);
}

ReductionConfig rational_config(void)
{
  return (ReductionConfig){.method = REDUCTION_RATIONAL,
                           .t_start = 1e-3,
                           .t_end = 100.0,
                           .tolerance = 1e-3,
                           .deflation = 1e-8,
                           .second_stage = true,
                           .early_weight = 0.4,
                           .solver_rtol = 1e-13};
}

ReductionConfig arnoldi_config(void)
{
  ReductionConfig config = rational_config();
  config.method = REDUCTION_ARNOLDI;
  config.moments = 5;
  config.second_stage = false;
  return config;
}

/* theta <- theta + gamma dt sum_k d_k v_k,  v_1 = M^-1 (F - K theta),  v_k+1 = M^-1 E v_k,  M = E + gamma dt K. */
static PetscErrorCode advance(const ThermalSystem *system, KSP ksp, PetscReal dt, const PetscReal *d, Mat F, Mat theta,
                              Mat v, Mat rhs)
{
  PetscFunctionBeginUser;
  PetscCall(MatMatMult(system->K, theta, MAT_REUSE_MATRIX, PETSC_DEFAULT, &rhs));
  PetscCall(MatAYPX(rhs, -1.0, F, SAME_NONZERO_PATTERN));
  for (int k = 0; k < L_STABLE_STAGES; k++) {
    PetscCall(KSPMatSolve(ksp, rhs, v));
    PetscCall(MatAXPY(theta, L_STABLE_GAMMA * dt * d[k], v, SAME_NONZERO_PATTERN));
    if (k + 1 < L_STABLE_STAGES) {
      Mat Ev;
      PetscCall(MatMatMult(system->E, v, MAT_INITIAL_MATRIX, PETSC_DEFAULT, &Ev));
      PetscCall(MatCopy(Ev, rhs, SAME_NONZERO_PATTERN));
      PetscCall(MatDestroy(&Ev));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The Cholesky factor of E + gamma dt K. */
static PetscErrorCode factorise(const ThermalSystem *system, PetscReal dt, KSP ksp, Mat M)
{
  PC pc;

  PetscFunctionBeginUser;
  PetscCall(MatCopy(system->E, M, SAME_NONZERO_PATTERN));
  PetscCall(MatAXPY(M, L_STABLE_GAMMA * dt, system->K, SAME_NONZERO_PATTERN));
  PetscCall(KSPSetOperators(ksp, M, M));
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCCHOLESKY));
  PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  PetscCall(KSPSetUp(ksp));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode read_outputs(const ThermalSystem *system, Mat theta, PetscReal *temperature)
{
  PetscInt k;
  Vec column, of_patches, on_all;
  VecScatter to_all;
  const PetscScalar *values;

  PetscFunctionBeginUser;
  PetscCall(MatGetSize(theta, NULL, &k));
  PetscCall(MatCreateVecs(system->B, &of_patches, NULL));
  PetscCall(VecScatterCreateToAll(of_patches, &to_all, &on_all));
  for (PetscInt j = 0; j < k; j++) {
    PetscCall(MatDenseGetColumnVecRead(theta, j, &column));
    PetscCall(MatMultTranspose(system->B, column, of_patches));
    PetscCall(MatDenseRestoreColumnVecRead(theta, j, &column));
    PetscCall(VecScatterBegin(to_all, of_patches, on_all, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecScatterEnd(to_all, of_patches, on_all, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecGetArrayRead(on_all, &values));
    PetscCall(PetscArraycpy(temperature + j * system->m, values, (size_t)system->m));
    PetscCall(VecRestoreArrayRead(on_all, &values));
  }
  PetscCall(VecScatterDestroy(&to_all));
  PetscCall(VecDestroy(&on_all));
  PetscCall(VecDestroy(&of_patches));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode full_step_responses(const ThermalSystem *system, Mat F, PetscReal t_first, PetscReal ratio,
                                   PetscInt n_times, PetscInt steps, PetscReal *temperature)
{
  Mat M, theta, v, rhs;
  KSP ksp;
  PetscReal d[L_STABLE_STAGES];
  PetscInt k;

  PetscFunctionBeginUser;
  l_stable_weights(d);
  PetscCall(MatGetSize(F, NULL, &k));
  PetscCall(MatDuplicate(system->E, MAT_COPY_VALUES, &M));
  PetscCall(MatDuplicate(F, MAT_DO_NOT_COPY_VALUES, &theta));
  PetscCall(MatZeroEntries(theta));
  PetscCall(MatDuplicate(F, MAT_COPY_VALUES, &v));
  PetscCall(MatMatMult(system->K, theta, MAT_INITIAL_MATRIX, PETSC_DEFAULT, &rhs));
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)system->E), &ksp));
  for (PetscInt i = 0; i < n_times; i++) {
    const PetscReal span = i == 0 ? t_first : t_first * pow(ratio, (double)i - 1.0) * (ratio - 1.0);
    const PetscReal dt = span / (PetscReal)steps;
    PetscCall(factorise(system, dt, ksp, M));
    for (PetscInt step = 0; step < steps; step++) PetscCall(advance(system, ksp, dt, d, F, theta, v, rhs));
    PetscCall(read_outputs(system, theta, temperature + (size_t)i * (size_t)k * (size_t)system->m));
  }
  PetscCall(KSPDestroy(&ksp));
  PetscCall(MatDestroy(&M));
  PetscCall(MatDestroy(&theta));
  PetscCall(MatDestroy(&v));
  PetscCall(MatDestroy(&rhs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void reduced_step_response(const ReducedModel *model, PetscInt j, PetscReal t, PetscReal *temperature)
{
  for (PetscInt i = 0; i < model->m; i++) temperature[i] = 0.0;
  for (PetscInt k = 0; k < model->r; k++) {
    const PetscReal *row = model->B + (size_t)k * (size_t)model->m, x = model->lambda[k] * t;
    const PetscReal state = row[j] * (x > 1e-8 ? -expm1(-x) / model->lambda[k] : t * (1.0 - 0.5 * x));
    for (PetscInt i = 0; i < model->m; i++) temperature[i] += row[i] * state;
  }
}
