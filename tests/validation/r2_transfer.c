/* R2: the transfer function at frequencies that the reduction never saw, H(iw) = D B^T (iw E + K)^-1 B D with
 * D = diag(area)^(1/2), full against reduced. The full model is solved as a real system of twice the size,
 *   [K  -wE; wE  K][Re x; Im x] = [B; 0],
 * by LU, which nothing in the reduction or its certificate uses. */
#include "tests/support/petsc_test.h"

#include <math.h>
#include <petscblaslapack.h>
#include <petscksp.h>
#include <slepcsys.h>

#include "tests/support/mould_case.h"
#include "tests/support/validation.h"

/* ||P + iS||_2 = ||[P -S; S P]||_2 by the largest singular value. */
static double norm_2(PetscInt m, const PetscReal *P, const PetscReal *S)
{
  const PetscInt twice = 2 * m;
  PetscReal *A, *singular, *work;
  PetscBLASInt n = (PetscBLASInt)twice, length = 10 * n, one = 1, info;
  TEST_PETSC(PetscMalloc3((size_t)(twice * twice), &A, (size_t)twice, &singular, (size_t)length, &work));
  for (PetscInt j = 0; j < m; j++)
    for (PetscInt i = 0; i < m; i++) {
      A[i + j * twice] = A[(i + m) + (j + m) * twice] = P[i + j * m];
      A[(i + m) + j * twice] = S[i + j * m];
      A[i + (j + m) * twice] = -S[i + j * m];
    }
  LAPACKgesvd_("N", "N", &n, &n, A, &n, singular, NULL, &one, NULL, &one, work, &length, &info);
  assert_int_equal(info, 0);
  const double largest = singular[0];
  TEST_PETSC(PetscFree3(A, singular, work));
  return largest;
}

static void factorise_double_system(const ThermalSystem *system, PetscReal w, KSP *ksp)
{
  Mat upper, lower, nest, A, blocks[4];
  PC pc;
  TEST_PETSC(MatDuplicate(system->E, MAT_COPY_VALUES, &upper));
  TEST_PETSC(MatScale(upper, -w));
  TEST_PETSC(MatDuplicate(system->E, MAT_COPY_VALUES, &lower));
  TEST_PETSC(MatScale(lower, w));
  blocks[0] = blocks[3] = system->K;
  blocks[1] = upper;
  blocks[2] = lower;
  TEST_PETSC(MatCreateNest(PETSC_COMM_SELF, 2, NULL, 2, NULL, blocks, &nest));
  TEST_PETSC(MatConvert(nest, MATAIJ, MAT_INITIAL_MATRIX, &A));
  TEST_PETSC(KSPCreate(PETSC_COMM_SELF, ksp));
  TEST_PETSC(KSPSetOperators(*ksp, A, A));
  TEST_PETSC(KSPSetType(*ksp, KSPPREONLY));
  TEST_PETSC(KSPGetPC(*ksp, &pc));
  TEST_PETSC(PCSetType(pc, PCLU));
  TEST_PETSC(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  TEST_PETSC(KSPSetUp(*ksp));
  TEST_PETSC(MatDestroy(&A));
  TEST_PETSC(MatDestroy(&nest));
  TEST_PETSC(MatDestroy(&upper));
  TEST_PETSC(MatDestroy(&lower));
}

/* Re and Im of the full H(iw), [m x m]. */
static void full_transfer(const ThermalSystem *system, PetscReal w, PetscReal *P, PetscReal *S)
{
  const PetscInt n = system->n, m = system->m;
  KSP ksp;
  Vec rhs, x, of_patches, half;
  factorise_double_system(system, w, &ksp);
  TEST_PETSC(VecCreateSeq(PETSC_COMM_SELF, 2 * n, &rhs));
  TEST_PETSC(VecDuplicate(rhs, &x));
  TEST_PETSC(MatCreateVecs(system->B, &of_patches, &half));
  for (PetscInt j = 0; j < m; j++) {
    const PetscScalar *from;
    PetscScalar *to;
    TEST_PETSC(VecZeroEntries(rhs));
    TEST_PETSC(MatGetColumnVector(system->B, half, j));
    TEST_PETSC(VecGetArrayRead(half, &from));
    TEST_PETSC(VecGetArray(rhs, &to));
    TEST_PETSC(PetscArraycpy(to, from, (size_t)n));
    TEST_PETSC(VecRestoreArray(rhs, &to));
    TEST_PETSC(VecRestoreArrayRead(half, &from));
    TEST_PETSC(KSPSolve(ksp, rhs, x));
    for (int part = 0; part < 2; part++) {
      TEST_PETSC(VecGetArrayRead(x, &from));
      TEST_PETSC(VecGetArray(half, &to));
      TEST_PETSC(PetscArraycpy(to, from + part * n, (size_t)n));
      TEST_PETSC(VecRestoreArray(half, &to));
      TEST_PETSC(VecRestoreArrayRead(x, &from));
      TEST_PETSC(MatMultTranspose(system->B, half, of_patches));
      TEST_PETSC(VecGetArrayRead(of_patches, &from));
      for (PetscInt i = 0; i < m; i++)
        (part == 0 ? P : S)[i + j * m] = sqrt(system->area[i] * system->area[j]) * from[i];
      TEST_PETSC(VecRestoreArrayRead(of_patches, &from));
    }
  }
  TEST_PETSC(VecDestroy(&rhs));
  TEST_PETSC(VecDestroy(&x));
  TEST_PETSC(VecDestroy(&half));
  TEST_PETSC(VecDestroy(&of_patches));
  TEST_PETSC(KSPDestroy(&ksp));
}

/* ||H - H_r||_2/||H_r||_2 at w. */
static double transfer_error(const ThermalSystem *system, const ReducedModel *model, PetscReal w)
{
  const PetscInt m = system->m;
  PetscReal *P, *S, *Pr, *Sr;
  TEST_PETSC(PetscMalloc2((size_t)(m * m), &P, (size_t)(m * m), &S));
  TEST_PETSC(PetscCalloc2((size_t)(m * m), &Pr, (size_t)(m * m), &Sr));
  full_transfer(system, w, P, S);
  for (PetscInt k = 0; k < model->r; k++) {
    const PetscReal lambda = model->lambda[k], size = lambda * lambda + w * w;
    for (PetscInt j = 0; j < m; j++)
      for (PetscInt i = 0; i < m; i++) {
        const PetscReal b = model->B[k * m + i] * model->B[k * m + j] * sqrt(system->area[i] * system->area[j]);
        Pr[i + j * m] += b * lambda / size;
        Sr[i + j * m] -= b * w / size;
      }
  }
  const double norm = norm_2(m, Pr, Sr);
  for (PetscInt i = 0; i < m * m; i++) P[i] -= Pr[i], S[i] -= Sr[i];
  const double error = norm_2(m, P, S) / norm;
  TEST_PETSC(PetscFree2(P, S));
  TEST_PETSC(PetscFree2(Pr, Sr));
  return error;
}

static void certificate_bounds_the_error_at_unseen_frequencies(void **state)
{
  (void)state;
  const double start = validation_cpu_time();
  MouldCase mould;
  ReducedModel *model;
  const ReductionConfig config = rational_config();
  double worst = 0.0, bound = 0.0, least_ratio = 1e300, most_ratio = 0.0;
  validation_begin("R2");
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &INVESTMENT_BOX, &mould));
  TEST_PETSC(reduced_model_create(mould.system, &config, NULL, &model));
  for (size_t i = 0; i < model->certificate.n_frequencies; i++) {
    const double w = model->certificate.frequency[i], error = transfer_error(mould.system, model, w);
    const double ratio = model->certificate.transfer_bound[i] / error;
    printf("w = %.3g rad/s: error %.2e, bound %.2e, ratio %.2f\n", w, error, model->certificate.transfer_bound[i],
           ratio);
    worst = fmax(worst, error);
    bound = fmax(bound, model->certificate.transfer_bound[i]);
    least_ratio = fmin(least_ratio, ratio);
    most_ratio = fmax(most_ratio, ratio);
  }
  validation_write(&(ValidationRow){
      .id = "R2",
      .quantity = "H(iw) at the certificate's frequencies, relative 2-norm, against the certified bound",
      .reference = "full model, real 2n x 2n LU",
      .ours = validation_text("bound %.1e, %.2f to %.2f times the error", bound, least_ratio, most_ratio),
      .error = validation_text("%.1e", worst),
      .target = "below the bound, at most 3 times smaller",
      .resolution = validation_text("%d unknowns, %d patches, %d states", (int)mould.system->n, (int)mould.system->m,
                                    (int)model->r),
      .cpu_seconds = validation_cpu_time() - start});
  assert_true(model->certificate.n_frequencies >= 3);
  assert_true(least_ratio >= 1.0);
  assert_true(most_ratio <= 3.0);
  TEST_PETSC(reduced_model_destroy(&model));
  TEST_PETSC(mould_case_destroy(&mould));
}

static void frequencies_between_are_no_worse_than_the_certified_ones(void **state)
{
  (void)state;
  const double start = validation_cpu_time();
  enum { BETWEEN = 9 };
  MouldCase mould;
  ReducedModel *model;
  const ReductionConfig config = rational_config();
  double worst = 0.0, bound = 0.0;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &INVESTMENT_BOX, &mould));
  TEST_PETSC(reduced_model_create(mould.system, &config, NULL, &model));
  for (size_t i = 0; i < model->certificate.n_frequencies; i++)
    bound = fmax(bound, model->certificate.transfer_bound[i]);
  for (int i = 0; i < BETWEEN; i++) // 1/t_end to 1/t_start, at irregular places
    worst = fmax(worst, transfer_error(mould.system, model, 0.01 * pow(1e5, (i + 0.37) / BETWEEN)));
  validation_write(
      &(ValidationRow){.id = "R2",
                       .quantity = "H(iw) at nine other frequencies over the band, relative 2-norm",
                       .reference = "full model, real 2n x 2n LU",
                       .ours = validation_text("largest certified bound %.1e", bound),
                       .error = validation_text("%.1e", worst),
                       .target = "the largest certified bound",
                       .resolution = validation_text("%d unknowns, %d patches, %d states", (int)mould.system->n,
                                                     (int)mould.system->m, (int)model->r),
                       .cpu_seconds = validation_cpu_time() - start});
  assert_true(worst <= bound);
  TEST_PETSC(reduced_model_destroy(&model));
  TEST_PETSC(mould_case_destroy(&mould));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(certificate_bounds_the_error_at_unseen_frequencies),
      cmocka_unit_test(frequencies_between_are_no_worse_than_the_certified_ones),
  };
  if (SlepcInitialize(&argc, &argv, NULL, NULL)) return 1;
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  return SlepcFinalize() ? 1 : failed;
}
