/* The reduced mould as a whole: what it conserves, what it refuses, what its certificate says. */
#include "tests/support/petsc_test.h"

#include <math.h>
#include <slepcsys.h>

#include "reduce/petsc/petsc_compat.h"
#include "tests/support/mould_case.h"

static void reduce(const BoxMould *box, const ReductionConfig *config, MouldCase *mould, ReducedModel **model)
{
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, box, mould));
  TEST_PETSC(reduced_model_create(mould->system, config, NULL, model));
}

static void release(MouldCase *mould, ReducedModel **model)
{
  TEST_PETSC(reduced_model_destroy(model));
  TEST_PETSC(mould_case_destroy(mould));
}

static double capacity_of(const BoxMould *box)
{
  return box->size[0] * box->size[1] * box->size[2] * box->rho[0] * box->c[0];
}

static void check_stored_heat(const ReductionConfig *config)
{
  MouldCase mould;
  ReducedModel *model;
  double capacity = 0.0;
  reduce(&SMALL_BOX, config, &mould, &model);
  for (PetscInt k = 0; k < model->r; k++) capacity += model->constant[k] * model->constant[k];
  ASSERT_CLOSE(capacity / capacity_of(&SMALL_BOX), 1.0, 1e-12); // 1 lies in the space: |V^T E 1|^2 = 1^T E 1
  for (PetscInt l = 0; l < model->m; l++) {
    double heat = 0.0;
    for (PetscInt k = 0; k < model->r; k++) heat += model->constant[k] * model->B[k * model->m + l];
    ASSERT_CLOSE(heat, 1.0, 1e-12); // 1 W in is 1 W stored
  }
  release(&mould, &model);
}

static void heat_put_in_is_heat_stored(void **state)
{
  (void)state;
  const ReductionConfig rational = rational_config(), arnoldi = arnoldi_config();
  check_stored_heat(&rational);
  check_stored_heat(&arnoldi);
}

static void ambient_alone_brings_every_patch_to_the_ambient_temperature(void **state)
{
  (void)state;
  MouldCase mould;
  ReducedModel *model;
  const ReductionConfig config = rational_config();
  reduce(&SMALL_BOX, &config, &mould, &model);
  for (PetscInt l = 0; l < model->m; l++) {
    double temperature = 0.0;
    for (PetscInt k = 0; k < model->r; k++)
      temperature += model->B[k * model->m + l] * model->ambient[k] / model->lambda[k];
    ASSERT_CLOSE(temperature, 1.0, 1e-9); // K 1 = ambient and 1 lies in the space: exact but for the solves
  }
  release(&mould, &model);
}

static void basis_is_orthonormal_and_modal(void **state)
{
  (void)state;
  MouldCase mould;
  ReducedModel *model;
  Vec column, E_column;
  const ReductionConfig config = rational_config();
  reduce(&SMALL_BOX, &config, &mould, &model);
  assert_true(model->certificate.orthogonality < 1e-12);
  TEST_PETSC(MatCreateVecs(mould.system->K, &E_column, NULL));
  TEST_PETSC(reduced_model_make_vectors(model));
  for (PetscInt k = 0; k < model->r; k += 7) {
    PetscReal energy;
    TEST_PETSC(BVGetColumn(model->V, k, &column));
    TEST_PETSC(MatMult(mould.system->K, column, E_column));
    TEST_PETSC(VecDot(column, E_column, &energy));
    TEST_PETSC(BVRestoreColumn(model->V, k, &column));
    ASSERT_CLOSE(energy, model->lambda[k], 1e-11 * model->lambda[model->r - 1]);
    if (k > 0) assert_true(model->lambda[k] >= model->lambda[k - 1]);
  }
  TEST_PETSC(VecDestroy(&E_column));
  release(&mould, &model);
}

static void second_stage_shortens_within_the_tolerance(void **state)
{
  (void)state;
  MouldCase mould;
  ReducedModel *model, *whole;
  ReductionConfig config = rational_config();
  reduce(&SMALL_BOX, &config, &mould, &model);
  config.second_stage = false;
  TEST_PETSC(reduced_model_create(mould.system, &config, NULL, &whole));
  assert_true(model->certificate.met && whole->certificate.met);
  assert_true(model->r < whole->r);
  assert_true(model->certificate.second_stage_bound > 0.0);
  assert_true(whole->certificate.second_stage_bound == 0.0);
  assert_true(whole->certificate.moment_error < 1e-9); // without it the moments at the shifts are matched
  TEST_PETSC(reduced_model_destroy(&whole));
  release(&mould, &model);
}

/* Insulated, the constant is a mode itself, so the space holds nothing but modes: K v = lambda E v for each. */
static void modal_finds_the_slowest_modes(void **state)
{
  (void)state;
  MouldCase mould;
  ReducedModel *model;
  BoxMould box = SMALL_BOX;
  ReductionConfig config = rational_config();
  Vec v, Kv, Ev;
  config.method = REDUCTION_MODAL;
  config.modes = 12;
  config.second_stage = false;
  box.h_sides = box.h_top = 0.0;
  reduce(&box, &config, &mould, &model);
  assert_int_equal(model->r, 12);
  assert_true(isnan(model->certificate.moment_error) && !model->certificate.met);
  TEST_PETSC(MatCreateVecs(mould.system->K, &Ev, &Kv));
  TEST_PETSC(reduced_model_make_vectors(model));
  for (PetscInt k = 0; k < model->r; k++) {
    PetscReal left, size;
    TEST_PETSC(BVGetColumn(model->V, k, &v));
    TEST_PETSC(MatMult(mould.system->K, v, Kv));
    TEST_PETSC(MatMult(mould.system->E, v, Ev));
    TEST_PETSC(BVRestoreColumn(model->V, k, &v));
    TEST_PETSC(VecNorm(Ev, NORM_2, &size));
    TEST_PETSC(VecAXPY(Kv, -model->lambda[k], Ev));
    TEST_PETSC(VecNorm(Kv, NORM_2, &left));
    assert_true(left <=
                1e-5 * model->lambda[model->r - 1] * size); // eigenvalues to 1e-8: vectors to its root and better
  }
  PetscReal longest = PetscMax(box.size[0], PetscMax(box.size[1], box.size[2]));
  ASSERT_CLOSE(model->lambda[1] * PetscSqr(longest / PETSC_PI) * 1800.0 * 1100.0, 1.0, 0.05); // coarse mesh, kappa = 1
  TEST_PETSC(VecDestroy(&Ev));
  TEST_PETSC(VecDestroy(&Kv));
  release(&mould, &model);
}

static void insulated_mould_keeps_its_heat_for_ever(void **state)
{
  (void)state;
  MouldCase mould;
  ReducedModel *model;
  BoxMould box = SMALL_BOX;
  const ReductionConfig config = rational_config();
  box.h_sides = box.h_top = 0.0;
  reduce(&box, &config, &mould, &model);
  assert_true(model->lambda[0] == 0.0);
  assert_true(model->lambda[1] > 0.0);
  ASSERT_CLOSE(fabs(model->constant[0]) / sqrt(capacity_of(&box)), 1.0, 1e-9); // the mode at rest is the constant
  assert_true(model->certificate.met);
  release(&mould, &model);
}

static void moments_at_zero_of_an_insulated_mould_are_refused(void **state)
{
  (void)state;
  MouldCase mould;
  ReducedModel *model = NULL;
  BoxMould box = SMALL_BOX;
  const ReductionConfig config = arnoldi_config();
  box.h_sides = box.h_top = 0.0;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &box, &mould));
  TEST_PETSC(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  const PetscErrorCode code = reduced_model_create(mould.system, &config, NULL, &model);
  TEST_PETSC(PetscPopErrorHandler());
  assert_int_equal(code, PETSC_ERR_USER);
  TEST_PETSC(mould_case_destroy(&mould));
}

static void shifts_that_the_user_gives_are_used_as_they_are(void **state)
{
  (void)state;
  MouldCase mould;
  ReducedModel *model;
  double shifts[] = {10.0, 0.1};
  ReductionConfig config = rational_config();
  config.n_shifts = 2;
  config.shifts = shifts;
  config.second_stage = false;
  reduce(&SMALL_BOX, &config, &mould, &model);
  assert_int_equal(model->n_shifts, 2);
  ASSERT_CLOSE(model->shifts[0] * model->shifts[1], 1.0, 1e-15);
  assert_int_equal(model->moments, 1);
  assert_false(model->certificate.met); // two shifts are too few for five decades, and the certificate says so
  assert_true(model->certificate.step_error_max > config.tolerance);
  release(&mould, &model);
}

static void transfer_function_matches_the_full_model_at_the_shifts(void **state)
{
  (void)state;
  MouldCase mould;
  ReducedModel *model;
  ReductionConfig config = rational_config();
  config.second_stage = false;
  reduce(&SMALL_BOX, &config, &mould, &model);
  const size_t size = (size_t)model->m * (size_t)model->m;
  PetscReal *full, *reduced;
  TEST_PETSC(PetscMalloc2(size, &full, size, &reduced));
  for (PetscInt s = 0; s < model->n_shifts; s++) {
    double difference = 0.0, norm = 0.0;
    TEST_PETSC(thermal_system_transfer(mould.system, model->shifts[s], 1e-13, full));
    TEST_PETSC(reduced_model_transfer(model, model->shifts[s], reduced));
    for (size_t i = 0; i < size; i++) {
      difference += (full[i] - reduced[i]) * (full[i] - reduced[i]);
      norm += full[i] * full[i];
    }
    assert_true(sqrt(difference / norm) < 1e-10);
  }
  TEST_PETSC(PetscFree2(full, reduced));
  release(&mould, &model);
}

/* Conjugate gradients with BoomerAMG in place of the factor: the same model to the solver's tolerance. */
static void iterative_solves_give_the_same_model(void **state)
{
  (void)state;
  MouldCase mould;
  ReducedModel *model, *iterated;
  ReductionConfig config = rational_config();
  config.second_stage = false;
  reduce(&SMALL_BOX, &config, &mould, &model);
  config.iterative = true;
  config.solver_rtol = 1e-11;
  TEST_PETSC(reduced_model_create(mould.system, &config, NULL, &iterated));
  const size_t size = (size_t)model->m * (size_t)model->m;
  PetscReal *direct, *other;
  TEST_PETSC(PetscMalloc2(size, &direct, size, &other));
  for (int i = -2; i < 4; i++) {
    TEST_PETSC(reduced_model_transfer(model, pow(10.0, i), direct));
    TEST_PETSC(reduced_model_transfer(iterated, pow(10.0, i), other));
    for (size_t k = 0; k < size; k++) ASSERT_CLOSE(other[k], direct[k], 1e-7 * direct[0]);
  }
  TEST_PETSC(PetscFree2(direct, other));
  TEST_PETSC(reduced_model_destroy(&iterated));
  release(&mould, &model);
}

/* Two identical columns of B: the block loses rank, deflation drops what depends on the rest. */
static void dependent_inputs_are_deflated(void **state)
{
  (void)state;
  MouldCase mould;
  ThermalSystem *twice;
  ReducedModel *model, *of_twice;
  ReductionConfig config = rational_config();
  Mat B;
  PetscInt n_local;
  PetscReal area[16];
  config.second_stage = false;
  reduce(&SMALL_BOX, &config, &mould, &model);
  const PetscInt m = mould.system->m;
  TEST_PETSC(MatGetLocalSize(mould.system->E, &n_local, NULL));
  TEST_PETSC(MatCreateDense(PETSC_COMM_WORLD, n_local, PETSC_DECIDE, mould.system->n, m + 1, NULL, &B));
  for (PetscInt l = 0; l <= m; l++) {
    Vec from, to;
    area[l] = mould.system->area[l < m ? l : 0];
    TEST_PETSC(MatDenseGetColumnVecRead(mould.system->B, l < m ? l : 0, &from));
    TEST_PETSC(MatDenseGetColumnVecWrite(B, l, &to));
    TEST_PETSC(VecCopy(from, to));
    TEST_PETSC(MatDenseRestoreColumnVecWrite(B, l, &to));
    TEST_PETSC(MatDenseRestoreColumnVecRead(mould.system->B, l < m ? l : 0, &from));
  }
  TEST_PETSC(thermal_system_wrap(mould.system->E, mould.system->K, B, mould.system->ambient, area, &twice));
  TEST_PETSC(reduced_model_create(twice, &config, NULL, &of_twice));
  assert_int_equal(of_twice->r, model->r);
  assert_true(of_twice->certificate.orthogonality < 1e-12);
  for (PetscInt k = 0; k < of_twice->r; k++)
    ASSERT_CLOSE(of_twice->B[k * (m + 1) + m], of_twice->B[k * (m + 1)], 1e-9 * fabs(of_twice->B[k * (m + 1)]) + 1e-9);
  TEST_PETSC(MatDestroy(&B));
  TEST_PETSC(thermal_system_destroy(&twice));
  TEST_PETSC(reduced_model_destroy(&of_twice));
  release(&mould, &model);
}

static void bad_settings_are_refused(void **state)
{
  (void)state;
  MouldCase mould;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &SMALL_BOX, &mould));
  ReductionConfig bad[3] = {rational_config(), rational_config(), arnoldi_config()};
  bad[0].t_start = 200.0; // after t_end
  bad[1].tolerance = 0.0;
  bad[2].moments = 0;
  for (int i = 0; i < 3; i++) {
    ReducedModel *model = NULL;
    TEST_PETSC(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
    const PetscErrorCode code = reduced_model_create(mould.system, &bad[i], NULL, &model);
    TEST_PETSC(PetscPopErrorHandler());
    assert_int_equal(code, PETSC_ERR_ARG_OUTOFRANGE);
    assert_null(model);
  }
  TEST_PETSC(mould_case_destroy(&mould));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(heat_put_in_is_heat_stored),
      cmocka_unit_test(ambient_alone_brings_every_patch_to_the_ambient_temperature),
      cmocka_unit_test(basis_is_orthonormal_and_modal),
      cmocka_unit_test(second_stage_shortens_within_the_tolerance),
      cmocka_unit_test(modal_finds_the_slowest_modes),
      cmocka_unit_test(insulated_mould_keeps_its_heat_for_ever),
      cmocka_unit_test(moments_at_zero_of_an_insulated_mould_are_refused),
      cmocka_unit_test(shifts_that_the_user_gives_are_used_as_they_are),
      cmocka_unit_test(transfer_function_matches_the_full_model_at_the_shifts),
      cmocka_unit_test(iterative_solves_give_the_same_model),
      cmocka_unit_test(dependent_inputs_are_deflated),
      cmocka_unit_test(bad_settings_are_refused),
  };
  if (SlepcInitialize(&argc, &argv, NULL, NULL)) return 1;
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  return SlepcFinalize() ? 1 : failed;
}
