/* R5: the reduced mould is passive: V^T E V = I, V^T K V = Lambda >= 0 and C = B^T, so that Re H(iw) is positive
 * semi-definite and no sequence of heat flows gets out more than went in. */
#include "tests/support/petsc_test.h"

#include <math.h>
#include <petscblaslapack.h>
#include <slepcsys.h>

#include "tests/support/mould_case.h"
#include "tests/support/validation.h"

/* max |V^T A V - diag(expected)| */
static double projection_defect(const ReducedModel *model, Mat A, const PetscReal *expected)
{
  Mat G;
  const PetscScalar *values;
  double defect = 0.0;
  TEST_PETSC(MatCreateSeqDense(PETSC_COMM_SELF, model->r, model->r, NULL, &G));
  TEST_PETSC(BVMatProject(model->V, A, model->V, G));
  TEST_PETSC(MatDenseGetArrayRead(G, &values));
  for (PetscInt j = 0; j < model->r; j++)
    for (PetscInt i = 0; i < model->r; i++)
      defect = fmax(defect, fabs(values[i + j * model->r] - (i == j ? (expected ? expected[i] : 1.0) : 0.0)));
  TEST_PETSC(MatDenseRestoreArrayRead(G, &values));
  TEST_PETSC(MatDestroy(&G));
  return defect;
}

/* Least eigenvalue of Re H(iw) = B^T Lambda (Lambda^2 + w^2)^-1 B over its largest. */
static double least_eigenvalue(const ReducedModel *model, double w)
{
  PetscBLASInt m = (PetscBLASInt)model->m, length = 10 * m, info;
  PetscReal *P, *value, *work;
  TEST_PETSC(PetscCalloc3((size_t)(m * m), &P, (size_t)m, &value, (size_t)length, &work));
  for (PetscInt k = 0; k < model->r; k++) {
    const double weight = model->lambda[k] / (model->lambda[k] * model->lambda[k] + w * w);
    for (PetscInt j = 0; j < m; j++)
      for (PetscInt i = 0; i < m; i++) P[i + j * m] += weight * model->B[k * m + i] * model->B[k * m + j];
  }
  LAPACKsyev_("N", "L", &m, P, &m, value, work, &length, &info);
  assert_int_equal(info, 0);
  const double least = value[0] / value[m - 1];
  TEST_PETSC(PetscFree3(P, value, work));
  return least;
}

static void check_passivity(const char *method, const BoxMould *box, ReductionConfig config)
{
  const double start = validation_cpu_time();
  MouldCase mould;
  ReducedModel *model;
  double least = 1e300;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, box, &mould));
  TEST_PETSC(reduced_model_create(mould.system, &config, NULL, &model));
  TEST_PETSC(reduced_model_make_vectors(model));
  const double of_E = projection_defect(model, mould.system->E, NULL);
  const double of_K = projection_defect(model, mould.system->K, model->lambda) / model->lambda[model->r - 1];
  for (int i = 0; i <= 30; i++) least = fmin(least, least_eigenvalue(model, pow(10.0, -4.0 + 0.3 * i)));
  validation_write(
      &(ValidationRow){.id = "R5",
                       .quantity = validation_text("%s: V^T E V = I, V^T K V = Lambda >= 0, Re H(iw) >= 0", method),
                       .reference = "by construction",
                       .ours = validation_text("least lambda %.3g 1/s, least eigenvalue of Re H over the largest %.1e",
                                               model->lambda[0], least),
                       .error = validation_text("%.1e, %.1e", of_E, of_K),
                       .target = "1e-10",
                       .resolution = validation_text("%d unknowns, %d states", (int)mould.system->n, (int)model->r),
                       .cpu_seconds = validation_cpu_time() - start});
  assert_true(of_E <= 1e-10);
  assert_true(of_K <= 1e-10);
  assert_true(model->lambda[0] >= 0.0);
  assert_true(least >= -1e-12);
  TEST_PETSC(reduced_model_destroy(&model));
  TEST_PETSC(mould_case_destroy(&mould));
}

static void rational_reduction_is_passive(void **state)
{
  (void)state;
  validation_begin("R5");
  check_passivity("rational, balanced", &INVESTMENT_BOX, rational_config());
}

static void arnoldi_reduction_is_passive(void **state)
{
  (void)state;
  check_passivity("arnoldi", &INVESTMENT_BOX, arnoldi_config());
}

static void reduction_of_an_insulated_mould_is_passive(void **state)
{
  (void)state;
  BoxMould box = INVESTMENT_BOX;
  box.h_sides = box.h_top = 0.0;
  check_passivity("rational, insulated mould", &box, rational_config());
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rational_reduction_is_passive),
      cmocka_unit_test(arnoldi_reduction_is_passive),
      cmocka_unit_test(reduction_of_an_insulated_mould_is_passive),
  };
  if (SlepcInitialize(&argc, &argv, NULL, NULL)) return 1;
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  return SlepcFinalize() ? 1 : failed;
}
