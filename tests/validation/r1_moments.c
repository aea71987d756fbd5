/* R1: the paper's block Arnoldi matches the first q moments m_k = B^T [(s0 E + K)^-1 E]^k (s0 E + K)^-1 B of every
 * input. Galerkin projection of a symmetric system matches as many again. */
#include "tests/support/petsc_test.h"

#include <math.h>
#include <petscksp.h>
#include <slepcsys.h>

#include "tests/support/mould_case.h"
#include "tests/support/validation.h"

enum { Q = 5 };

/* Moments 0 .. 2 q - 1 of the full model by their recursion and a full-rank factor, [2 q x m x m]. */
static void full_moments(const ThermalSystem *system, PetscReal s0, PetscReal *moments)
{
  const PetscInt m = system->m;
  Mat A, X, EX;
  KSP ksp;
  PC pc;
  Vec column, of_patches;
  const PetscScalar *values;
  TEST_PETSC(MatDuplicate(system->K, MAT_COPY_VALUES, &A));
  TEST_PETSC(MatAXPY(A, s0, system->E, SAME_NONZERO_PATTERN));
  TEST_PETSC(KSPCreate(PETSC_COMM_WORLD, &ksp));
  TEST_PETSC(KSPSetOperators(ksp, A, A));
  TEST_PETSC(KSPSetType(ksp, KSPPREONLY));
  TEST_PETSC(KSPGetPC(ksp, &pc));
  TEST_PETSC(PCSetType(pc, PCCHOLESKY));
  TEST_PETSC(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  TEST_PETSC(MatDuplicate(system->B, MAT_COPY_VALUES, &X));
  TEST_PETSC(MatDuplicate(system->B, MAT_COPY_VALUES, &EX));
  TEST_PETSC(MatCreateVecs(system->B, &of_patches, NULL));
  for (PetscInt k = 0; k < 2 * Q; k++) {
    TEST_PETSC(KSPMatSolve(ksp, EX, X));
    for (PetscInt j = 0; j < m; j++) {
      TEST_PETSC(MatDenseGetColumnVecRead(X, j, &column));
      TEST_PETSC(MatMultTranspose(system->B, column, of_patches));
      TEST_PETSC(MatDenseRestoreColumnVecRead(X, j, &column));
      TEST_PETSC(VecGetArrayRead(of_patches, &values));
      for (PetscInt i = 0; i < m; i++) moments[(k * m + j) * m + i] = values[i];
      TEST_PETSC(VecRestoreArrayRead(of_patches, &values));
    }
    TEST_PETSC(MatDestroy(&EX));
    TEST_PETSC(MatMatMult(system->E, X, MAT_INITIAL_MATRIX, PETSC_DEFAULT, &EX));
  }
  TEST_PETSC(VecDestroy(&of_patches));
  TEST_PETSC(MatDestroy(&X));
  TEST_PETSC(MatDestroy(&EX));
  TEST_PETSC(MatDestroy(&A));
  TEST_PETSC(KSPDestroy(&ksp));
}

/* Largest ||m_k - reduced||/||m_k|| over the inputs, for moment k. */
static double moment_error(const ReducedModel *model, PetscReal s0, PetscInt k, const PetscReal *moments)
{
  const PetscInt m = model->m;
  double worst = 0.0;
  for (PetscInt j = 0; j < m; j++) {
    double difference = 0.0, size = 0.0;
    for (PetscInt i = 0; i < m; i++) {
      double reduced = 0.0;
      for (PetscInt a = 0; a < model->r; a++)
        reduced += model->B[a * m + i] * model->B[a * m + j] * pow(s0 + model->lambda[a], -(double)(k + 1));
      const double full = moments[(k * m + j) * m + i];
      difference += (full - reduced) * (full - reduced);
      size += full * full;
    }
    worst = fmax(worst, sqrt(difference / size));
  }
  return worst;
}

static void check_moments(double s0)
{
  const double start = validation_cpu_time();
  MouldCase mould;
  ReducedModel *model;
  ReductionConfig config = arnoldi_config();
  PetscReal *moments;
  double first = 0.0, all = 0.0;
  config.s0 = s0;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &INVESTMENT_BOX, &mould));
  TEST_PETSC(PetscMalloc1((size_t)(2 * Q * mould.system->m * mould.system->m), &moments));
  full_moments(mould.system, s0, moments);
  TEST_PETSC(reduced_model_create(mould.system, &config, NULL, &model));
  for (PetscInt k = 0; k < 2 * Q; k++) {
    const double error = moment_error(model, s0, k, moments);
    if (k < Q) first = fmax(first, error);
    all = fmax(all, error);
  }
  validation_write(&(ValidationRow){
      .id = "R1",
      .quantity = validation_text("first %d moments at s0 = %g 1/s, relative", Q, s0),
      .reference = "full model, recursion",
      .ours = validation_text("%d states, the first %d moments too: %.1e", (int)model->r, 2 * Q, all),
      .error = validation_text("%.1e", first),
      .target = "1e-10",
      .resolution = validation_text("%d unknowns, %d patches", (int)mould.system->n, (int)mould.system->m),
      .cpu_seconds = validation_cpu_time() - start});
  assert_true(first <= 1e-10);
  assert_true(all <= 1e-8); // rounding grows with the power of the inverse
  assert_true(model->certificate.moment_error <= 1e-10);
  TEST_PETSC(PetscFree(moments));
  TEST_PETSC(reduced_model_destroy(&model));
  TEST_PETSC(mould_case_destroy(&mould));
}

static void moments_at_zero_are_matched(void **state)
{
  (void)state;
  validation_begin("R1");
  check_moments(0.0);
}

static void moments_at_a_shift_are_matched(void **state)
{
  (void)state;
  check_moments(0.5);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(moments_at_zero_are_matched),
      cmocka_unit_test(moments_at_a_shift_are_matched),
  };
  if (SlepcInitialize(&argc, &argv, NULL, NULL)) return 1;
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  return SlepcFinalize() ? 1 : failed;
}
