/* The parts a reduction is made of, each against what it should be exactly. */
#include "tests/support/petsc_test.h"

#include <math.h>
#include <slepcsys.h>

#include "reduce/linear/dense_block.h"
#include "reduce/linear/small_dense.h"
#include "reduce/mor/certificate/lanczos.h"
#include "reduce/mor/certificate/residual.h"
#include "reduce/mor/krylov/krylov_basis.h"
#include "reduce/mor/krylov/shifts.h"
#include "reduce/mor/second_stage.h"
#include "reduce/petsc/petsc_compat.h"
#include "tests/support/mould_case.h"

static double worst_residual(const ThermalSystem *system, PetscReal s, Mat B, Mat X)
{
  PetscInt k;
  Mat KX, EX;
  PetscReal *minus, *r, *b;
  double worst = 0.0;
  TEST_PETSC(MatGetSize(B, NULL, &k));
  TEST_PETSC(PetscMalloc3((size_t)k, &minus, (size_t)k, &r, (size_t)k, &b));
  TEST_PETSC(dense_block_create(system->E, k, &KX));
  TEST_PETSC(dense_block_create(system->E, k, &EX));
  TEST_PETSC(dense_block_multiply(system->K, X, KX));
  TEST_PETSC(dense_block_multiply(system->E, X, EX));
  for (PetscInt c = 0; c < k; c++) minus[c] = s;
  TEST_PETSC(dense_block_axpby(KX, 1.0, minus, EX));
  for (PetscInt c = 0; c < k; c++) minus[c] = -1.0;
  TEST_PETSC(dense_block_axpby(KX, 1.0, minus, B));
  TEST_PETSC(dense_block_dots(KX, KX, r));
  TEST_PETSC(dense_block_dots(B, B, b));
  for (PetscInt c = 0; c < k; c++) worst = fmax(worst, sqrt(r[c] / b[c]));
  TEST_PETSC(MatDestroy(&KX));
  TEST_PETSC(MatDestroy(&EX));
  TEST_PETSC(PetscFree3(minus, r, b));
  return worst;
}

static void every_solve_meets_the_tolerance_asked_for(void **state)
{
  (void)state;
  static const PetscReal shifts[] = {0.0, 1e-3, 1.0, 1e5}, tolerances[] = {1e-4, 1e-8};
  MouldCase mould;
  Mat X;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &SMALL_BOX, &mould));
  TEST_PETSC(dense_block_create(mould.system->E, mould.system->m, &X));
  for (int iterative = 0; iterative < 2; iterative++)
    for (int i = 0; i < 8; i++) {
      ShiftedSolver *solver;
      TEST_PETSC(shifted_solver_create(mould.system, tolerances[i / 4], (PetscBool)iterative, &solver));
      TEST_PETSC(shifted_solver_set_shift(solver, shifts[i % 4], mould.system->m));
      TEST_PETSC(shifted_solver_solve(solver, mould.system->B, X));
      assert_true(worst_residual(mould.system, shifts[i % 4], mould.system->B, X) <= 1.001 * tolerances[i / 4]);
      assert_int_equal(shifted_solver_get_count(solver).columns, mould.system->m);
      TEST_PETSC(shifted_solver_destroy(&solver));
    }
  TEST_PETSC(MatDestroy(&X));
  TEST_PETSC(mould_case_destroy(&mould));
}

static void high_shifts_do_without_a_factor(void **state)
{
  (void)state;
  MouldCase mould;
  ShiftedSolver *solver;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &SMALL_BOX, &mould));
  TEST_PETSC(shifted_solver_create(mould.system, 1e-6, PETSC_FALSE, &solver));
  TEST_PETSC(shifted_solver_set_shift(solver, 1e6, 8));
  assert_int_equal(shifted_solver_get_count(solver).setups, 0);
  TEST_PETSC(shifted_solver_set_shift(solver, 1e-3, 1000));
  assert_int_equal(shifted_solver_get_count(solver).setups, 1);
  TEST_PETSC(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  assert_int_equal(shifted_solver_set_shift(solver, -1.0, 1), PETSC_ERR_ARG_OUTOFRANGE);
  TEST_PETSC(PetscPopErrorHandler());
  TEST_PETSC(shifted_solver_destroy(&solver));
  TEST_PETSC(mould_case_destroy(&mould));
}

/* 37 columns: two panels of 16 and one that is not full. 1e-11: several rounds of single precision. */
static void sweeps_in_single_precision_reach_what_double_precision_asks_for(void **state)
{
  (void)state;
  enum { COLUMNS = 37 };
  static const PetscReal shifts[] = {1e-3, 1.0, 1e5}, tolerances[] = {1e-4, 1e-6, 1e-11};
  MouldCase mould;
  Mat B, X;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &SMALL_BOX, &mould));
  TEST_PETSC(dense_block_create(mould.system->E, COLUMNS, &B));
  TEST_PETSC(dense_block_create(mould.system->E, COLUMNS, &X));
  TEST_PETSC(MatSetRandom(B, NULL));
  for (int i = 0; i < 9; i++) {
    ShiftedSolver *solver;
    TEST_PETSC(shifted_solver_create(mould.system, tolerances[i / 3], PETSC_TRUE, &solver));
    TEST_PETSC(shifted_solver_set_shift(solver, shifts[i % 3], COLUMNS));
    TEST_PETSC(shifted_solver_solve(solver, B, X));
    assert_true(worst_residual(mould.system, shifts[i % 3], B, X) <= 1.001 * tolerances[i / 3]);
    assert_int_equal(shifted_solver_get_count(solver).setups, 0); // no other preconditioner had to help
    TEST_PETSC(shifted_solver_destroy(&solver));
  }
  TEST_PETSC(MatDestroy(&B));
  TEST_PETSC(MatDestroy(&X));
  TEST_PETSC(mould_case_destroy(&mould));
}

/* Step responses by one real pole over a ratio of 50 in time, against the L-stable scheme of order 5. */
static void lanczos_step_responses_agree_with_time_integration(void **state)
{
  (void)state;
  enum { TIMES = 7, STEPS = 32 };
  const PetscReal t_first = 0.1;
  MouldCase mould;
  ShiftedSolver *solver;
  Lanczos *lanczos;
  PetscReal *exact, *ours, time[TIMES], rise = 0.0, worst = 0.0;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &SMALL_BOX, &mould));
  const size_t m = (size_t)mould.system->m;
  TEST_PETSC(PetscMalloc2(TIMES * m * m, &exact, TIMES * m, &ours));
  TEST_PETSC(full_step_responses(mould.system, mould.system->B, t_first, 2.0, TIMES, 8, exact));
  TEST_PETSC(shifted_solver_create(mould.system, 1e-13, PETSC_FALSE, &solver));
  for (int i = 0; i < TIMES; i++) time[i] = t_first * pow(2.0, i);
  TEST_PETSC(shifted_solver_set_shift(solver, 8.0 / (8.0 * t_first), 100));
  TEST_PETSC(lanczos_create(mould.system, solver, mould.system->B, mould.system->B, &lanczos));
  for (int step = 0; step < STEPS; step++) TEST_PETSC(lanczos_step(lanczos));
  for (size_t j = 0; j < m; j++) {
    TEST_PETSC(lanczos_response(lanczos, (PetscInt)j, TIMES, time, ours));
    for (size_t i = 0; i < TIMES; i++)
      for (size_t l = 0; l < m; l++) {
        rise = fmax(rise, fabs(exact[(i * m + j) * m + l]));
        worst = fmax(worst, fabs(exact[(i * m + j) * m + l] - ours[i * m + l]));
      }
  }
  assert_true(worst / rise < 1e-6); // Chebyshev coefficients of phi left out after 32 terms: 3e-8; the scheme has 1e-7
  TEST_PETSC(lanczos_destroy(&lanczos));
  TEST_PETSC(shifted_solver_destroy(&solver));
  TEST_PETSC(PetscFree2(exact, ours));
  TEST_PETSC(mould_case_destroy(&mould));
}

/* H - H_r at the real s, [m x m], of the one-shift basis. */
static void error_at(const ThermalSystem *system, ShiftedSolver *solver, const ModalModel *model, PetscReal s,
                     PetscReal *error)
{
  const PetscInt m = system->m;
  Mat X;
  TEST_PETSC(shifted_solver_set_shift(solver, s, m));
  TEST_PETSC(dense_block_create(system->E, m, &X));
  TEST_PETSC(shifted_solver_solve(solver, system->B, X));
  TEST_PETSC(dense_block_inner(system->B, X, error));
  for (PetscInt k = 0; k < model->r; k++)
    for (PetscInt j = 0; j < m; j++)
      for (PetscInt i = 0; i < m; i++)
        error[i + j * m] -= model->B[k * m + i] * model->B[k * m + j] / (s + model->lambda[k]);
  TEST_PETSC(MatDestroy(&X));
}

/* The residual knows the error of H where nothing was solved for, and asks for the directions that carry it: with all
 * of them in the basis the error there is gone, with the larger ones it is below what was to be left. */
static void residual_directions_carry_the_error(void **state)
{
  (void)state;
  enum { MOST = 16 };
  const PetscReal s = 10.0;
  MouldCase mould;
  KrylovBasis *basis;
  ShiftedSolver *solver;
  Residual *residual;
  ModalModel *model;
  Mat X, block;
  PetscInt kept, k;
  PetscReal error[MOST * MOST], value[MOST], weight[MOST], largest;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &SMALL_BOX, &mould));
  const PetscInt m = mould.system->m;
  assert_true(m <= MOST);
  for (PetscInt l = 0; l < m; l++) weight[l] = 1.0;
  TEST_PETSC(shifted_solver_create(mould.system, 1e-12, PETSC_FALSE, &solver));
  TEST_PETSC(krylov_basis_create(mould.system, mould.system->B, 3 * m + 1, m, 1e-10, &basis));
  TEST_PETSC(shifted_solver_set_shift(solver, 1.0, m));
  TEST_PETSC(krylov_basis_get_block(basis, m, &block));
  TEST_PETSC(shifted_solver_solve(solver, mould.system->B, block));
  TEST_PETSC(krylov_basis_add(basis, &block, &kept));
  for (int round = 0; round < 2; round++) {
    TEST_PETSC(modal_model_create(PETSC_COMM_WORLD, basis->r, m, basis->K, basis->capacity, basis->inputs,
                                  basis->constant, PETSC_FALSE, &model));
    TEST_PETSC(residual_create(basis, model, &residual));
    error_at(mould.system, solver, model, s, error);
    TEST_PETSC(small_eigen(PETSC_COMM_WORLD, m, error, value));
    const PetscReal least = round == 0 ? 0.5 * (value[m / 2] + value[m / 2 - 1]) : 0.0;
    TEST_PETSC(residual_directions(residual, model, solver, s, weight, least, &X, &largest));
    ASSERT_CLOSE(largest / value[m - 1], 1.0, 1e-6);
    TEST_PETSC(MatGetSize(X, NULL, &k));
    if (round == 0) assert_int_equal(k, m - m / 2);
    TEST_PETSC(krylov_basis_get_block(basis, k, &block));
    TEST_PETSC(dense_block_copy(block, 0, X, NULL, k));
    TEST_PETSC(krylov_basis_add(basis, &block, &kept));
    TEST_PETSC(MatDestroy(&X));
    const PetscReal before = largest;
    TEST_PETSC(modal_model_destroy(&model));
    TEST_PETSC(modal_model_create(PETSC_COMM_WORLD, basis->r, m, basis->K, basis->capacity, basis->inputs,
                                  basis->constant, PETSC_FALSE, &model));
    error_at(mould.system, solver, model, s, error);
    TEST_PETSC(small_eigen(PETSC_COMM_WORLD, m, error, value));
    assert_true(value[m - 1] < (round == 0 ? 1.001 * least : 1e-8 * before));
    TEST_PETSC(residual_destroy(&residual));
    TEST_PETSC(modal_model_destroy(&model));
  }
  TEST_PETSC(krylov_basis_destroy(&basis));
  TEST_PETSC(shifted_solver_destroy(&solver));
  TEST_PETSC(mould_case_destroy(&mould));
}

static void basis_drops_what_it_holds_already(void **state)
{
  (void)state;
  MouldCase mould;
  KrylovBasis *basis;
  Mat X;
  PetscInt kept;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &SMALL_BOX, &mould));
  const PetscInt m = mould.system->m;
  TEST_PETSC(krylov_basis_create(mould.system, mould.system->B, 4, m, 1e-8, &basis)); // capacity 4: it has to grow
  assert_int_equal(basis->r, 1);
  for (int round = 0; round < 2; round++) {
    TEST_PETSC(krylov_basis_get_block(basis, m, &X));
    TEST_PETSC(dense_block_copy(X, 0, mould.system->B, NULL, m));
    TEST_PETSC(krylov_basis_add(basis, &X, &kept));
    assert_int_equal(kept, round == 0 ? m : 0);
  }
  assert_int_equal(basis->r, m + 1);
  double capacity = 0.0;
  for (PetscInt k = 0; k < basis->r; k++) capacity += basis->constant[k] * basis->constant[k];
  ASSERT_CLOSE(capacity / (SMALL_BOX.size[0] * SMALL_BOX.size[1] * SMALL_BOX.size[2] * 1800.0 * 1100.0), 1.0, 1e-12);
  TEST_PETSC(krylov_basis_destroy(&basis));
  TEST_PETSC(mould_case_destroy(&mould));
}

/* A chain of decaying modes, one port: 1/rate in the Gramian falls fast, so few states are needed. */
static void second_stage_keeps_what_is_allowed_and_the_constant(void **state)
{
  (void)state;
  enum { R = 24, TIMES = 9 };
  PetscReal K[R * R] = {0}, B[R], constant[R], time[TIMES], weight = 1.0, before = 0.0, after = 0.0;
  PetscReal u = 1.0, z[R], full, reduced, at_end;
  ModalModel *model, *smaller;
  for (int k = 0; k < R; k++) {
    K[k + R * k] = 0.01 * pow(1.7, k);
    B[k] = 1.0 / sqrt(1.0 + k);
    constant[k] = k == 0 ? 2.0 : k == 3 ? -0.5 : 0.0;
    before += constant[k] * constant[k];
  }
  for (int t = 0; t < TIMES; t++) time[t] = pow(10.0, -2.0 + 0.5 * t);
  TEST_PETSC(modal_model_create(PETSC_COMM_SELF, R, 1, K, R, B, constant, PETSC_FALSE, &model));
  SecondStage stage = {.weight = &weight, .early_weight = 0.4, .n_times = TIMES, .time = time, .allowed = 1e-3};
  TEST_PETSC(second_stage_truncate(model, &stage, &smaller));
  assert_non_null(smaller);
  assert_true(smaller->r < R);
  assert_true(stage.reached > 0.0 && stage.reached <= 1e-3);
  for (PetscInt k = 0; k < smaller->r; k++) after += smaller->constant[k] * smaller->constant[k];
  ASSERT_CLOSE(after, before, 1e-12);
  modal_model_step_response(model, time[TIMES - 1], &u, z, &at_end);
  for (int t = 0; t < TIMES; t++) {
    modal_model_step_response(model, time[t], &u, z, &full);
    modal_model_step_response(smaller, time[t], &u, z, &reduced);
    ASSERT_CLOSE(reduced, full, 1e-3 * modal_rise_scale(full, at_end, time[t], time[TIMES - 1]));
  }
  TEST_PETSC(modal_model_destroy(&smaller));
  TEST_PETSC(modal_model_destroy(&model));
}

/* One input, and the constant a mode of its own: balanced truncation of the rest, whose error bound is reached at w = 0
 * (Liu, Sreeram & Teo 1998: state-space symmetric systems). */
static void balanced_truncation_keeps_its_bound_and_reaches_it_at_rest(void **state)
{
  (void)state;
  enum { R = 16, TIMES = 9 };
  PetscReal K[R * R] = {0}, B[R], constant[R] = {1.5}, time[TIMES], weight = 0.5, largest = 0.0;
  ModalModel *model, *smaller;
  for (int k = 0; k < R; k++) {
    K[k + R * k] = k == 0 ? 0.0 : 0.05 * pow(1.9, k);
    B[k] = 1.0 / (1.0 + 0.3 * k);
  }
  for (int t = 0; t < TIMES; t++) time[t] = pow(10.0, -2.0 + 0.5 * t);
  TEST_PETSC(modal_model_create(PETSC_COMM_SELF, R, 1, K, R, B, constant, PETSC_TRUE, &model));
  SecondStage stage = {.weight = &weight, .singular = PETSC_TRUE, .n_times = TIMES, .time = time, .allowed = 1e-2};
  TEST_PETSC(second_stage_truncate(model, &stage, &smaller));
  assert_non_null(smaller);
  for (int i = 0; i <= 160; i++) {
    PetscReal difference;
    TEST_PETSC(modal_model_difference(model, smaller, pow(10.0, -4.0 + 0.05 * i), &difference));
    largest = PetscMax(largest, difference);
  }
  assert_true(stage.bound > 0.0);
  ASSERT_CLOSE(largest / stage.bound, 1.0, 1e-4); // from below, but for w = 1e-4 instead of 0
  TEST_PETSC(modal_model_destroy(&smaller));
  TEST_PETSC(modal_model_destroy(&model));
}

static void phi_is_smooth_where_the_rate_vanishes(void **state)
{
  (void)state;
  ASSERT_CLOSE(modal_phi(0.0, 3.0), 3.0, 0.0);
  ASSERT_CLOSE(modal_phi(2.0, 1.0), (1.0 - exp(-2.0)) / 2.0, 1e-16);
  ASSERT_CLOSE(modal_phi(0.99e-8, 1.0), modal_phi(1.01e-8, 1.0), 2e-10); // both sides of the switch to the series
  ASSERT_CLOSE(modal_phi(1e9, 1.0), 1e-9, 1e-24);
}

static void planned_shifts_span_the_band_of_times(void **state)
{
  (void)state;
  ShiftPlan loose, tight;
  PetscInt of_loose = 0, of_tight = 0;
  TEST_PETSC(shifts_plan(1e-3, 100.0, 1e-2, &loose));
  TEST_PETSC(shifts_plan(1e-3, 100.0, 1e-5, &tight));
  ASSERT_CLOSE(tight.shift[0] * 100.0, 1.0, 1e-12);
  ASSERT_CLOSE(tight.shift[tight.n - 1] * 1e-3, 1.0, 1e-12);
  for (PetscInt i = 0; i < loose.n; i++) of_loose += loose.moments[i];
  for (PetscInt i = 0; i < tight.n; i++) {
    of_tight += tight.moments[i];
    if (i > 1)
      ASSERT_CLOSE(tight.shift[i] / tight.shift[i - 1], tight.shift[1] / tight.shift[0],
                   1e-9 * tight.shift[1] / tight.shift[0]);
  }
  assert_true(of_tight > of_loose && of_loose >= 4);
  TEST_PETSC(shifts_plan_destroy(&loose));
  TEST_PETSC(shifts_plan_destroy(&tight));
}

static void a_shift_is_added_where_the_error_is(void **state)
{
  (void)state;
  const PetscReal shifts[] = {0.01, 1.0, 100.0}, time[] = {1e-3, 0.1, 10.0};
  PetscReal early[] = {0.0, 1.0, 0.0}, late[] = {0.0, 0.0, 1.0}, s;
  TEST_PETSC(shifts_suggest(3, shifts, 3, time, early, &s));
  ASSERT_CLOSE(s, 10.0, 1e-12);
  TEST_PETSC(shifts_suggest(3, shifts, 3, time, late, &s));
  ASSERT_CLOSE(s, 0.1, 1e-14);
}

static void largest_eigenvalue_of_a_hermitian_matrix_is_found(void **state)
{
  (void)state;
  /* [2 i; -i 2] has the eigenvalues 1 and 3. */
  const PetscReal P[] = {2.0, 0.0, 0.0, 2.0}, S[] = {0.0, -1.0, 1.0, 0.0};
  PetscReal largest;
  TEST_PETSC(small_hermitian_largest(PETSC_COMM_SELF, 2, P, S, &largest));
  ASSERT_CLOSE(largest, 3.0, 1e-14);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_solve_meets_the_tolerance_asked_for),
      cmocka_unit_test(high_shifts_do_without_a_factor),
      cmocka_unit_test(sweeps_in_single_precision_reach_what_double_precision_asks_for),
      cmocka_unit_test(lanczos_step_responses_agree_with_time_integration),
      cmocka_unit_test(residual_directions_carry_the_error),
      cmocka_unit_test(basis_drops_what_it_holds_already),
      cmocka_unit_test(second_stage_keeps_what_is_allowed_and_the_constant),
      cmocka_unit_test(balanced_truncation_keeps_its_bound_and_reaches_it_at_rest),
      cmocka_unit_test(phi_is_smooth_where_the_rate_vanishes),
      cmocka_unit_test(planned_shifts_span_the_band_of_times),
      cmocka_unit_test(a_shift_is_added_where_the_error_is),
      cmocka_unit_test(largest_eigenvalue_of_a_hermitian_matrix_is_found),
  };
  if (SlepcInitialize(&argc, &argv, NULL, NULL)) return 1;
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  return SlepcFinalize() ? 1 : failed;
}
