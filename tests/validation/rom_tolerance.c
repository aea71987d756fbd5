/* The tolerance kept: step responses of every patch, reduced against full model, from 1 ms to 100 s. The full model is
 * integrated by a scheme that shares nothing with the reduction or its certificate, and twice, to know its own error.
 * Beside it stands the paper's method, five moments at s0 = 0. */
#include "tests/support/petsc_test.h"

#include <math.h>
#include <slepcsys.h>

#include "tests/support/mould_case.h"
#include "tests/support/validation.h"

enum { N_TIMES = 18 };
static const double T_FIRST = 1e-3, RATIO = 1.9684194472866112; // 1 ms RATIO^17 = 100 s

typedef struct Case {
  MouldCase mould;
  PetscReal *exact; // [N_TIMES x m x m] input by input
  double integration_error;
} Case;

static size_t at(PetscInt m, PetscInt i, PetscInt j)
{
  return ((size_t)i * (size_t)m + (size_t)j) * (size_t)m;
}

/* Largest |dT| of any patch over the largest rise of that response: over the whole time, or so far. */
static double largest_error(const Case *c, const PetscReal *other, bool so_far)
{
  const PetscInt m = c->mould.system->m;
  double worst = 0.0;
  for (PetscInt j = 0; j < m; j++) {
    double rise = 0.0;
    for (PetscInt i = 0; i < N_TIMES && !so_far; i++)
      for (PetscInt l = 0; l < m; l++) rise = fmax(rise, fabs(c->exact[at(m, i, j) + (size_t)l]));
    for (PetscInt i = 0; i < N_TIMES; i++) {
      double difference = 0.0;
      for (PetscInt l = 0; l < m; l++) {
        rise = fmax(rise, fabs(c->exact[at(m, i, j) + (size_t)l]));
        difference = fmax(difference, fabs(c->exact[at(m, i, j) + (size_t)l] - other[at(m, i, j) + (size_t)l]));
      }
      worst = fmax(worst, difference / rise);
    }
  }
  return worst;
}

static int set_up(void **state)
{
  static Case c;
  PetscReal *coarse;
  PetscInt m;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &INVESTMENT_BOX, &c.mould));
  m = c.mould.system->m;
  TEST_PETSC(PetscMalloc2(at(m, N_TIMES, 0), &c.exact, at(m, N_TIMES, 0), &coarse));
  TEST_PETSC(full_step_responses(c.mould.system, c.mould.system->B, T_FIRST, RATIO, N_TIMES, 12, c.exact));
  TEST_PETSC(full_step_responses(c.mould.system, c.mould.system->B, T_FIRST, RATIO, N_TIMES, 6, coarse));
  c.integration_error = largest_error(&c, coarse, true); // of the coarser one: the finer one's is smaller still
  *state = &c;
  validation_begin("ROM tolerance");
  return 0;
}

static int tear_down(void **state)
{
  Case *c = *state;
  TEST_PETSC(PetscFree(c->exact));
  TEST_PETSC(mould_case_destroy(&c->mould));
  return 0;
}

typedef struct Measured {
  double of_all, so_far, certified, seconds;
  int states;
  bool met;
} Measured;

static Measured measure(const Case *c, const ReductionConfig *config)
{
  const PetscInt m = c->mould.system->m;
  const double start = validation_cpu_time();
  ReducedModel *model;
  PetscReal *reduced;
  Measured measured;
  TEST_PETSC(reduced_model_create(c->mould.system, config, NULL, &model));
  measured.seconds = validation_cpu_time() - start;
  TEST_PETSC(PetscMalloc1(at(m, N_TIMES, 0), &reduced));
  for (PetscInt i = 0; i < N_TIMES; i++)
    for (PetscInt j = 0; j < m; j++)
      reduced_step_response(model, j, T_FIRST * pow(RATIO, (double)i), reduced + at(m, i, j));
  measured.of_all = largest_error(c, reduced, false);
  measured.so_far = largest_error(c, reduced, true);
  measured.certified = model->certificate.step_error_max;
  measured.met = model->certificate.met;
  measured.states = (int)model->r;
  TEST_PETSC(PetscFree(reduced));
  TEST_PETSC(reduced_model_destroy(&model));
  return measured;
}

static void write_row(const Case *c, const char *method, double target, Measured measured)
{
  validation_write(&(ValidationRow){
      .id = "ROM tolerance",
      .quantity = validation_text("%s: |dT| over the largest rise, steps on all patches, 1 ms to 100 s", method),
      .reference = validation_text("full model, L-stable order 5 (own error %.0e)", c->integration_error),
      .ours = validation_text("%d states, certified %.1e", measured.states, measured.certified),
      .error = validation_text("%.1e; over the rise so far %.1e", measured.of_all, measured.so_far),
      .target = target > 0 ? validation_text("%.0e", target) : "none (baseline)",
      .resolution = validation_text("%d unknowns, %d patches", (int)c->mould.system->n, (int)c->mould.system->m),
      .cpu_seconds = measured.seconds});
}

static void check_rational(const Case *c, double tolerance)
{
  ReductionConfig config = rational_config();
  config.tolerance = tolerance;
  const Measured measured = measure(c, &config);
  write_row(c, "rational, balanced", tolerance, measured);
  assert_true(c->integration_error < 0.05 * tolerance);
  assert_true(measured.met);
  assert_true(measured.certified <= tolerance);
  assert_true(measured.so_far <= measured.certified); // the certificate speaks for the patches it did not sample, too
  assert_true(measured.of_all <= tolerance);
}

static void rational_reduction_keeps_a_tolerance_of_a_thousandth(void **state)
{
  check_rational(*state, 1e-3);
}

static void rational_reduction_keeps_a_tolerance_of_a_hundredth(void **state)
{
  check_rational(*state, 1e-2);
}

static void rational_reduction_keeps_a_tight_tolerance(void **state)
{
  check_rational(*state, 1e-4);
}

static void five_moments_at_zero_miss_the_filling_and_say_so(void **state)
{
  const ReductionConfig config = arnoldi_config();
  const Measured measured = measure(*state, &config);
  write_row(*state, "arnoldi, s0 = 0, 5 moments (the paper)", 0.0, measured);
  assert_false(measured.met);
  assert_true(measured.so_far > 0.01);
  /* The certificate samples patches and times; the measured error is of all patches at other times. */
  assert_true(measured.certified >= 0.9 * measured.so_far);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rational_reduction_keeps_a_tolerance_of_a_thousandth),
      cmocka_unit_test(rational_reduction_keeps_a_tolerance_of_a_hundredth),
      cmocka_unit_test(rational_reduction_keeps_a_tight_tolerance),
      cmocka_unit_test(five_moments_at_zero_miss_the_filling_and_say_so),
  };
  if (SlepcInitialize(&argc, &argv, NULL, NULL)) return 1;
  const int failed = cmocka_run_group_tests(tests, set_up, tear_down);
  return SlepcFinalize() ? 1 : failed;
}
