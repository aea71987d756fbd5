/* The reduction whose vectors are kept in blocks, against the one with an orthonormal basis in memory. */
#include "tests/support/petsc_test.h"

#include <math.h>
#include <slepcsys.h>
#include <stdlib.h>
#include <unistd.h>

#include "reduce/linear/dense_block.h"
#include "reduce/mor/krylov/shift_blocks.h"
#include "reduce/petsc/petsc_compat.h"
#include "tests/support/mould_case.h"

static BoxMould small_box(double h)
{
  return (BoxMould){.size = {0.009, 0.006, 0.012},
                    .cells = {6, 4, 8},
                    .grading = 2.0,
                    .patches = {3, 2},
                    .h_sides = h,
                    .h_top = 2.0 * h,
                    .kappa = {1.0},
                    .rho = {1800.0},
                    .c = {1100.0}};
}

/* Largest difference of the step responses of every patch over the largest rise. */
static double difference(const ReducedModel *a, const ReducedModel *b)
{
  enum { MOST = 16 };
  double worst = 0.0, of_a[MOST], of_b[MOST];
  assert_true(a->m == b->m && a->m <= MOST);
  for (PetscInt j = 0; j < a->m; j++)
    for (double t = 1e-3; t < 101.0; t *= 10.0) {
      double rise = 0.0, apart = 0.0;
      reduced_step_response(a, j, t, of_a);
      reduced_step_response(b, j, t, of_b);
      for (PetscInt l = 0; l < a->m; l++) {
        rise = fmax(rise, fabs(of_a[l]));
        apart = fmax(apart, fabs(of_a[l] - of_b[l]));
      }
      worst = fmax(worst, apart / rise);
    }
  return worst;
}

/* Rows of the modes, which are not kept as vectors: the constant temperature is V (V^T E 1), and B_r = V^T B. */
static void check_rows(const ReducedModel *model, const ThermalSystem *system)
{
  const ModelBasis basis = {model->V, model->basis, model->modes, model->r};
  const PetscScalar *value;
  PetscInt n, first;
  TEST_PETSC(MatGetLocalSize(system->B, &n, NULL));
  TEST_PETSC(MatGetOwnershipRange(system->B, &first, NULL));
  PetscInt *row = malloc((size_t)n * sizeof *row);
  float *rows = malloc((size_t)n * (size_t)model->r * sizeof *rows);
  double *B = calloc((size_t)model->r * (size_t)model->m, sizeof *B), apart = 0.0, size = 0.0;
  for (PetscInt i = 0; i < n; i++) row[i] = i;
  TEST_PETSC(model_basis_rows(&basis, n, row, rows));
  for (PetscInt i = 0; i < n; i++) {
    double one = 0.0;
    for (PetscInt k = 0; k < model->r; k++) one += (double)rows[i * model->r + k] * model->constant[k];
    ASSERT_CLOSE(one, 1.0, 1e-4); // float, of some hundred terms
  }
  for (PetscInt l = 0; l < model->m; l++) {
    Vec column;
    TEST_PETSC(MatCreateVecs(system->E, &column, NULL));
    TEST_PETSC(MatGetColumnVector(system->B, column, l));
    TEST_PETSC(VecGetArrayRead(column, &value));
    for (PetscInt k = 0; k < model->r; k++)
      for (PetscInt i = 0; i < n; i++) B[k * model->m + l] += (double)rows[i * model->r + k] * value[i];
    TEST_PETSC(VecRestoreArrayRead(column, &value));
    TEST_PETSC(VecDestroy(&column));
  }
  MPI_Allreduce(MPI_IN_PLACE, B, (int)(model->r * model->m), MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  for (PetscInt e = 0; e < model->r * model->m; e++) {
    apart = fmax(apart, fabs(B[e] - model->B[e]));
    size = fmax(size, fabs(model->B[e]));
  }
  assert_true(apart < 1e-5 * size);
  free(row);
  free(rows);
  free(B);
}

static void check_against_memory(double h, bool second_stage)
{
  const BoxMould box = small_box(h);
  ReductionConfig config = rational_config();
  MouldCase mould;
  ReducedModel *memory, *stored;
  config.second_stage = second_stage;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &box, &mould));
  config.basis = BASIS_MEMORY;
  TEST_PETSC(reduced_model_create(mould.system, &config, NULL, &memory));
  config.basis = BASIS_DISK;
  TEST_PETSC(reduced_model_create(mould.system, &config, NULL, &stored));
  /* The same space but for directions below 0.03 of the tolerance; a second stage may choose another order. */
  assert_true(difference(memory, stored) < (second_stage ? 2e-3 : 3e-5));
  assert_true(stored->certificate.met);
  assert_true(stored->certificate.orthogonality < 1e-3); // only the weakest directions lose digits
  for (size_t i = 0; i < stored->certificate.n_frequencies; i++)
    assert_true(stored->certificate.transfer_bound[i] < 3.0 * memory->certificate.transfer_bound[i] + 1e-3);
  for (PetscInt l = 0; l < stored->m; l++) {
    double heat = 0.0;
    for (PetscInt k = 0; k < stored->r; k++) heat += stored->constant[k] * stored->B[k * stored->m + l];
    ASSERT_CLOSE(heat, 1.0, 1e-10); // 1 W in is 1 W stored, whatever the vectors have lost
  }
  assert_null(stored->V);
  check_rows(memory, mould.system);
  check_rows(stored, mould.system);
  TEST_PETSC(reduced_model_destroy(&memory));
  TEST_PETSC(reduced_model_destroy(&stored));
  TEST_PETSC(mould_case_destroy(&mould));
}

static void vectors_in_blocks_give_the_same_model(void **state)
{
  (void)state;
  check_against_memory(15.0, false);
  check_against_memory(15.0, true);
}

static void vectors_in_blocks_give_the_same_model_of_an_insulated_mould(void **state)
{
  (void)state;
  check_against_memory(0.0, false);
}

/* The folder that all ranks use, empty. */
static void choose_folder(char folder[64])
{
  PetscMPIInt rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  snprintf(folder, 64, "stored_XXXXXX");
  if (rank == 0) assert_non_null(mkdtemp(folder));
  MPI_Bcast(folder, 64, MPI_CHAR, 0, PETSC_COMM_WORLD);
}

static void a_folder_of_vectors_goes_with_the_model(void **state)
{
  (void)state;
  const BoxMould box = small_box(15.0);
  ReductionConfig config = rational_config();
  MouldCase mould;
  ReducedModel *in_memory, *on_disk;
  char folder[64];
  choose_folder(folder);
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &box, &mould));
  config.basis = BASIS_DISK;
  TEST_PETSC(reduced_model_create(mould.system, &config, NULL, &in_memory));
  config.scratch = folder;
  TEST_PETSC(reduced_model_create(mould.system, &config, NULL, &on_disk));
  assert_true(difference(in_memory, on_disk) < 1e-8);
  TEST_PETSC(reduced_model_destroy(&in_memory));
  TEST_PETSC(reduced_model_destroy(&on_disk)); // until then the modes' rows are there for the asking
  MPI_Barrier(PETSC_COMM_WORLD);
  assert_int_not_equal(access(folder, F_OK), 0);
  TEST_PETSC(mould_case_destroy(&mould));
}

/* One complete shift of two blocks and a third block of one that is not. */
static void store_some(const ThermalSystem *system, const char *folder)
{
  const size_t p = (size_t)system->m;
  ShiftBlocks *blocks;
  ShiftMoments shift = {.s = 0.25, .q = 2};
  Mat X;
  TEST_PETSC(shift_blocks_create(system->E, system->m, folder, "ours | 1.5 2.5", &blocks));
  TEST_PETSC(dense_block_create(system->E, system->m, &X));
  TEST_PETSC(PetscMalloc1(4 * p * p, &shift.mu));
  TEST_PETSC(PetscMalloc1(4 * p, &shift.heat));
  for (size_t i = 0; i < 4 * p * p; i++) shift.mu[i] = 1.0 / (double)(i + 3);
  for (size_t i = 0; i < 4 * p; i++) shift.heat[i] = (double)i;
  for (int k = 0; k < 3; k++) {
    TEST_PETSC(dense_block_copy(X, 0, system->B, NULL, system->m));
    TEST_PETSC(MatScale(X, 1.0 + k));
    TEST_PETSC(shift_blocks_add(blocks, X));
    if (k == 1) TEST_PETSC(shift_blocks_complete(blocks, &shift));
  }
  TEST_PETSC(MatDestroy(&X));
  TEST_PETSC(shift_blocks_destroy(&blocks, PETSC_FALSE));
}

static void shifts_that_were_complete_survive_an_interruption(void **state)
{
  (void)state;
  const BoxMould box = small_box(15.0);
  MouldCase mould;
  ShiftBlocks *blocks;
  Mat X, expected;
  PetscReal apart;
  char folder[64];
  choose_folder(folder);
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &box, &mould));
  store_some(mould.system, folder);
  TEST_PETSC(shift_blocks_create(mould.system->E, mould.system->m, folder, "ours | 1.5000000000001 2.5",
                                 &blocks)); // as ranks add up
  assert_int_equal(blocks->n_shifts, 1);
  assert_int_equal(blocks->n, 2);
  assert_true(blocks->shift[0].s == 0.25 && blocks->shift[0].q == 2);
  assert_true(blocks->shift[0].mu[5] == 1.0 / 8.0 && blocks->shift[0].heat[7] == 7.0);
  TEST_PETSC(shift_blocks_get(blocks, 1, &X));
  TEST_PETSC(MatDuplicate(mould.system->B, MAT_COPY_VALUES, &expected));
  TEST_PETSC(MatAXPY(expected, -0.5, X, SAME_NONZERO_PATTERN));
  TEST_PETSC(MatNorm(expected, NORM_FROBENIUS, &apart));
  assert_true(apart == 0.0);
  TEST_PETSC(shift_blocks_destroy(&blocks, PETSC_FALSE));
  TEST_PETSC(shift_blocks_destroy(&blocks, PETSC_TRUE));
  TEST_PETSC(MatDestroy(&expected));
  TEST_PETSC(mould_case_destroy(&mould));
}

static void shifts_of_another_problem_are_not_taken(void **state)
{
  (void)state;
  const char *const others[] = {"another | 1.5 2.5", "ours | 1.50001 2.5", "ours | 1.5", "ours | 1.5 2.5 3.5", "ours"};
  const BoxMould box = small_box(15.0);
  MouldCase mould;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &box, &mould));
  for (size_t k = 0; k < sizeof others / sizeof *others; k++) {
    ShiftBlocks *blocks;
    char folder[64];
    choose_folder(folder);
    store_some(mould.system, folder);
    TEST_PETSC(shift_blocks_create(mould.system->E, mould.system->m, folder, others[k], &blocks));
    assert_int_equal(blocks->n_shifts, 0);
    TEST_PETSC(shift_blocks_destroy(&blocks, PETSC_TRUE));
  }
  TEST_PETSC(mould_case_destroy(&mould));
}

static void a_folder_that_cannot_be_made_is_named(void **state)
{
  (void)state;
  const BoxMould box = small_box(15.0);
  MouldCase mould;
  ShiftBlocks *blocks;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &box, &mould));
  TEST_PETSC(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  assert_int_equal(shift_blocks_create(mould.system->E, mould.system->m, "/nowhere/at/all", "ours", &blocks),
                   PETSC_ERR_FILE_WRITE);
  TEST_PETSC(PetscPopErrorHandler());
  TEST_PETSC(mould_case_destroy(&mould));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(vectors_in_blocks_give_the_same_model),
      cmocka_unit_test(vectors_in_blocks_give_the_same_model_of_an_insulated_mould),
      cmocka_unit_test(a_folder_of_vectors_goes_with_the_model),
      cmocka_unit_test(shifts_that_were_complete_survive_an_interruption),
      cmocka_unit_test(shifts_of_another_problem_are_not_taken),
      cmocka_unit_test(a_folder_that_cannot_be_made_is_named),
  };
  if (SlepcInitialize(&argc, &argv, NULL, NULL)) return 1;
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  return SlepcFinalize() ? 1 : failed;
}
