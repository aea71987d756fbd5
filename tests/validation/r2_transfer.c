/* R2: the transfer function at frequencies that the reduction never saw, H(iw) = D B^T (iw E + K)^-1 B D with
 * D = diag(area)^(1/2), full against reduced, and against what is certified there. */
#include "tests/support/petsc_test.h"

#include <math.h>
#include <slepcsys.h>

#include "tests/support/full_transfer.h"
#include "tests/support/mould_case.h"
#include "tests/support/validation.h"

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
