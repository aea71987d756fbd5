/* The assembled heat equation of the mould: sums, symmetry, patches, on any number of ranks. */
#include "tests/support/petsc_test.h"

#include <petscksp.h>

#include "reduce/fem/thermal_system.h"
#include "reduce/petsc/petsc_compat.h"
#include "tests/support/box_mould.h"

static const BoxMould BOX = {.size = {0.02, 0.012, 0.03},
                             .cells = {6, 4, 6},
                             .grading = 2.0,
                             .patches = {3, 2},
                             .h_sides = 15.0,
                             .h_top = 40.0,
                             .interface = 0.0075 + 1e-6, // the plane k = 3 of 6, graded
                             .kappa = {1.0, 27.0},
                             .rho = {1800.0, 7750.0},
                             .c = {1100.0, 500.0}};

typedef struct Fixture {
  MouldMesh *mesh;
  ReduceConfig *config;
  ThermalSystem *system;
} Fixture;

static int order = 1; // of the elements

static void assemble(const BoxMould *box, Fixture *f)
{
  TEST_PETSC(box_mould_create(PETSC_COMM_WORLD, box, &f->mesh, &f->config));
  f->config->order = order;
  TEST_PETSC(thermal_system_create(f->mesh, f->config, &f->system));
}

static void release(Fixture *f)
{
  TEST_PETSC(thermal_system_destroy(&f->system));
  TEST_PETSC(box_mould_destroy(&f->mesh, &f->config));
}

/* v^T A v for the constant vector 1. */
static PetscReal sum_of(Mat A)
{
  Vec ones, A_ones;
  PetscReal sum;
  TEST_PETSC(MatCreateVecs(A, &ones, &A_ones));
  TEST_PETSC(VecSet(ones, 1.0));
  TEST_PETSC(MatMult(A, ones, A_ones));
  TEST_PETSC(VecSum(A_ones, &sum));
  TEST_PETSC(VecDestroy(&ones));
  TEST_PETSC(VecDestroy(&A_ones));
  return sum;
}

static void heat_capacity_is_the_sum_over_regions(void **state)
{
  (void)state;
  Fixture f;
  assemble(&BOX, &f);
  const double ground = BOX.size[0] * BOX.size[1], lower = 0.0075, upper = BOX.size[2] - lower;
  const double expected = ground * (lower * BOX.rho[0] * BOX.c[0] + upper * BOX.rho[1] * BOX.c[1]);
  ASSERT_CLOSE(sum_of(f.system->E) / expected, 1.0, 1e-13); // rounding of about 1e4 terms
  release(&f);
}

static void conduction_of_the_constant_is_the_ambient_column(void **state)
{
  (void)state;
  Fixture f;
  Vec ones, difference;
  PetscReal defect, scale, sum;
  assemble(&BOX, &f);
  TEST_PETSC(MatCreateVecs(f.system->K, &ones, &difference));
  TEST_PETSC(VecSet(ones, 1.0));
  TEST_PETSC(MatMult(f.system->K, ones, difference));
  TEST_PETSC(VecAXPY(difference, -1.0, f.system->ambient));
  TEST_PETSC(VecNorm(difference, NORM_INFINITY, &defect));
  TEST_PETSC(MatNorm(f.system->K, NORM_INFINITY, &scale));
  assert_true(defect <= 1e-14 * scale); // rounding of K's rows
  TEST_PETSC(VecSum(f.system->ambient, &sum));
  const double sides = 2 * (BOX.size[0] + BOX.size[1]) * BOX.size[2], top = BOX.size[0] * BOX.size[1];
  ASSERT_CLOSE(sum / (sides * BOX.h_sides + top * BOX.h_top), 1.0, 1e-13);
  assert_false(f.system->singular);
  TEST_PETSC(VecDestroy(&ones));
  TEST_PETSC(VecDestroy(&difference));
  release(&f);
}

static void each_column_of_B_sums_to_one_and_areas_are_exact(void **state)
{
  (void)state;
  Fixture f;
  assemble(&BOX, &f);
  assert_int_equal(f.system->m, 8);
  for (PetscInt l = 0; l < f.system->m; l++) {
    Vec column;
    PetscReal sum, least;
    TEST_PETSC(MatDenseGetColumnVecRead(f.system->B, l, &column));
    TEST_PETSC(VecSum(column, &sum));
    TEST_PETSC(VecMin(column, NULL, &least));
    TEST_PETSC(MatDenseRestoreColumnVecRead(f.system->B, l, &column));
    ASSERT_CLOSE(sum, 1.0, 1e-13);
    assert_true(least >= (order == 1 ? 0.0 : -1e-15)); // a quadratic corner function's integral is zero, rounded
    ASSERT_CLOSE(f.system->area[l] / f.mesh->patch[l].area, 1.0, 1e-12);
  }
  ASSERT_CLOSE(f.system->area[0], BOX.size[0] * BOX.size[1] / 6, 1e-16);
  release(&f);
}

static void matrices_are_symmetric(void **state)
{
  (void)state;
  Fixture f;
  Mat matrices[2];
  assemble(&BOX, &f);
  matrices[0] = f.system->E;
  matrices[1] = f.system->K;
  for (int a = 0; a < 2; a++) {
    Mat transposed;
    PetscReal scale, defect;
    TEST_PETSC(MatTranspose(matrices[a], MAT_INITIAL_MATRIX, &transposed));
    TEST_PETSC(MatNorm(matrices[a], NORM_INFINITY, &scale));
    TEST_PETSC(MatAXPY(transposed, -1.0, matrices[a], DIFFERENT_NONZERO_PATTERN));
    TEST_PETSC(MatNorm(transposed, NORM_INFINITY, &defect));
    assert_true(defect <= 1e-14 * scale); // the order of summation inside an element differs for (i,j) and (j,i)
    TEST_PETSC(MatDestroy(&transposed));
  }
  release(&f);
}

static void heat_through_a_two_layer_wall_at_steady_state_is_exact(void **state)
{
  (void)state;
  /* Either order holds the piecewise linear steady profile exactly. A fixed lower wall is a large h there. */
  BoxMould box = BOX;
  box.h_sides = 0.0;
  Fixture f;
  KSP ksp;
  Vec theta, power, column;
  PetscReal mean_top, mean_bottom;
  assemble(&box, &f);
  TEST_PETSC(MatCreateVecs(f.system->K, &theta, &power));
  for (PetscInt l = 0; l < f.mesh->n_cavity; l++) { // 1 W, spread over the cavity wall
    TEST_PETSC(MatDenseGetColumnVecRead(f.system->B, l, &column));
    TEST_PETSC(VecAXPY(power, 1.0 / (double)f.mesh->n_cavity, column));
    TEST_PETSC(MatDenseRestoreColumnVecRead(f.system->B, l, &column));
  }
  TEST_PETSC(KSPCreate(PETSC_COMM_WORLD, &ksp));
  TEST_PETSC(KSPSetOperators(ksp, f.system->K, f.system->K));
  TEST_PETSC(KSPSetType(ksp, KSPCG));
  TEST_PETSC(KSPSetTolerances(ksp, 1e-13, 0.0, PETSC_DEFAULT, 5000));
  TEST_PETSC(KSPSolve(ksp, power, theta));
  TEST_PETSC(MatDenseGetColumnVecRead(f.system->B, f.mesh->n_cavity + 1, &column));
  TEST_PETSC(VecDot(column, theta, &mean_top));
  TEST_PETSC(MatDenseRestoreColumnVecRead(f.system->B, f.mesh->n_cavity + 1, &column));
  TEST_PETSC(MatDenseGetColumnVecRead(f.system->B, 0, &column));
  TEST_PETSC(VecDot(column, theta, &mean_bottom));
  TEST_PETSC(MatDenseRestoreColumnVecRead(f.system->B, 0, &column));
  const double flux = 1.0 / (box.size[0] * box.size[1]);
  const double top = flux / box.h_top, lower = 0.0075;
  const double bottom = top + flux * (lower / box.kappa[0] + (box.size[2] - lower) / box.kappa[1]);
  ASSERT_CLOSE(mean_top / top, 1.0, 1e-9); // the solver's tolerance times the condition of K
  ASSERT_CLOSE(mean_bottom / bottom, 1.0, 1e-9);
  TEST_PETSC(KSPDestroy(&ksp));
  TEST_PETSC(VecDestroy(&theta));
  TEST_PETSC(VecDestroy(&power));
  release(&f);
}

static void insulated_walls_make_K_singular(void **state)
{
  (void)state;
  BoxMould box = BOX;
  box.h_sides = box.h_top = 0.0;
  Fixture f;
  ThermalSystem *wrapped;
  PetscReal of_ambient;
  assemble(&box, &f);
  assert_true(f.system->singular);
  TEST_PETSC(VecNorm(f.system->ambient, NORM_INFINITY, &of_ambient));
  assert_true(of_ambient == 0.0);
  TEST_PETSC(thermal_system_wrap(f.system->E, f.system->K, f.system->B, NULL, NULL, &wrapped));
  assert_true(wrapped->singular);
  TEST_PETSC(thermal_system_destroy(&wrapped));
  release(&f);
}

static void materials_out_of_range_are_refused(void **state)
{
  (void)state;
  BoxMould box = BOX;
  box.kappa[1] = 0.0;
  Fixture f = {0};
  TEST_PETSC(box_mould_create(PETSC_COMM_WORLD, &box, &f.mesh, &f.config));
  TEST_PETSC(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  const PetscErrorCode code = thermal_system_create(f.mesh, f.config, &f.system);
  TEST_PETSC(PetscPopErrorHandler());
  assert_int_equal(code, PETSC_ERR_ARG_OUTOFRANGE);
  TEST_PETSC(thermal_system_destroy(&f.system));
  TEST_PETSC(box_mould_destroy(&f.mesh, &f.config));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(heat_capacity_is_the_sum_over_regions),
      cmocka_unit_test(conduction_of_the_constant_is_the_ambient_column),
      cmocka_unit_test(each_column_of_B_sums_to_one_and_areas_are_exact),
      cmocka_unit_test(matrices_are_symmetric),
      cmocka_unit_test(heat_through_a_two_layer_wall_at_steady_state_is_exact),
      cmocka_unit_test(insulated_walls_make_K_singular),
      cmocka_unit_test(materials_out_of_range_are_refused),
  };
  if (PetscInitialize(&argc, &argv, NULL, NULL)) return 1;
  int failed = 0;
  for (order = 1; order <= 2; order++)
    failed += cmocka_run_group_tests_name(order == 1 ? "linear elements" : "quadratic elements", tests, NULL, NULL);
  return PetscFinalize() ? 1 : failed;
}
