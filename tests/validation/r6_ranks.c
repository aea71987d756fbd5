/* R6: the same reduced model on 1, 2 and 4 ranks. One program on four ranks splits its communicator, reduces the same
 * mould on each part, and compares H_r(s) over the band. */
#include "tests/support/petsc_test.h"

#include <math.h>
#include <slepcsys.h>

#include "tests/support/mould_case.h"
#include "tests/support/validation.h"

enum { SHIFTS = 7 };

typedef struct Answer {
  int states;
  PetscInt m;
  PetscReal *H; // [SHIFTS x m x m]
} Answer;

/* Reduce on the first n_ranks ranks; rank 0 takes the answer. */
static void reduce_on(int n_ranks, const ReductionConfig *config, Answer *answer)
{
  MPI_Comm comm;
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_split(PETSC_COMM_WORLD, rank < n_ranks ? 0 : MPI_UNDEFINED, rank, &comm);
  if (comm == MPI_COMM_NULL) return;
  MouldCase mould;
  ReducedModel *model;
  TEST_PETSC(mould_case_create(comm, &INVESTMENT_BOX, &mould));
  TEST_PETSC(reduced_model_create(mould.system, config, NULL, &model));
  answer->states = (int)model->r;
  answer->m = model->m;
  const size_t size = (size_t)model->m * (size_t)model->m;
  TEST_PETSC(PetscMalloc1(SHIFTS * size, &answer->H));
  for (int i = 0; i < SHIFTS; i++)
    TEST_PETSC(reduced_model_transfer(model, pow(10.0, -3.0 + i), answer->H + (size_t)i * size));
  TEST_PETSC(reduced_model_destroy(&model));
  TEST_PETSC(mould_case_destroy(&mould));
  MPI_Comm_free(&comm);
}

static double difference(const Answer *a, const Answer *b)
{
  const size_t size = (size_t)a->m * (size_t)a->m;
  double worst = 0.0;
  for (int i = 0; i < SHIFTS; i++) {
    double of_H = 0.0, of_difference = 0.0;
    for (size_t k = (size_t)i * size; k < (size_t)(i + 1) * size; k++) {
      of_H += a->H[k] * a->H[k];
      of_difference += (a->H[k] - b->H[k]) * (a->H[k] - b->H[k]);
    }
    worst = fmax(worst, sqrt(of_difference / of_H));
  }
  return worst;
}

static void compare_ranks(const char *method, const ReductionConfig *config)
{
  static const int counts[] = {1, 2, 4};
  const double start = validation_cpu_time();
  Answer answer[3] = {{0}};
  int rank, size;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  assert_int_equal(size, 4);
  for (int i = 0; i < 3; i++) reduce_on(counts[i], config, &answer[i]);
  if (rank > 0) {
    for (int i = 0; i < 3; i++) TEST_PETSC(PetscFree(answer[i].H));
    return;
  }
  const double on_2 = difference(&answer[0], &answer[1]), on_4 = difference(&answer[0], &answer[2]);
  validation_write(&(ValidationRow){
      .id = "R6 ranks",
      .quantity = validation_text("%s: H_r(s) from 1e-3 to 1e3 1/s on 2 and 4 ranks against 1", method),
      .reference = "each other",
      .ours = validation_text("%d, %d and %d states", answer[0].states, answer[1].states, answer[2].states),
      .error = validation_text("%.1e, %.1e", on_2, on_4),
      .target = "1e-8",
      .resolution = validation_text("%d patches", (int)answer[0].m),
      .cpu_seconds = validation_cpu_time() - start});
  assert_true(answer[0].states == answer[1].states && answer[0].states == answer[2].states);
  assert_true(on_2 <= 1e-8);
  assert_true(on_4 <= 1e-8);
  for (int i = 0; i < 3; i++) TEST_PETSC(PetscFree(answer[i].H));
}

static void rational_reduction_is_the_same_on_one_two_and_four_ranks(void **state)
{
  (void)state;
  int rank;
  const ReductionConfig config = rational_config();
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank == 0) validation_begin("R6 ranks");
  compare_ranks("rational, balanced", &config);
}

static void arnoldi_reduction_is_the_same_on_one_two_and_four_ranks(void **state)
{
  (void)state;
  const ReductionConfig config = arnoldi_config();
  compare_ranks("arnoldi", &config);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rational_reduction_is_the_same_on_one_two_and_four_ranks),
      cmocka_unit_test(arnoldi_reduction_is_the_same_on_one_two_and_four_ranks),
  };
  if (SlepcInitialize(&argc, &argv, NULL, NULL)) return 1;
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  return SlepcFinalize() ? 1 : failed;
}
