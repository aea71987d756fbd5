/* The order of the elements, against an exact solution of -div(kappa grad u) + s rho c u = f on a box with insulated
 * sides and floor and a Robin ceiling:
 *   u = cos(pi x/a) cos(pi y/b) cos(mu z),   kappa mu sin(mu c) = h cos(mu c),
 *   f = (kappa (pi^2/a^2 + pi^2/b^2 + mu^2) + s rho c) u */
#include "tests/support/petsc_test.h"

#include <math.h>
#include <petscksp.h>

#include "reduce/fem/thermal_system.h"
#include "tests/support/box_mould.h"

static const double S = 0.05; // 1/s, where storage and conduction matter alike

static BoxMould box_of(int cells, double grading)
{
  const BoxMould box = {.size = {0.02, 0.016, 0.012},
                        .cells = {cells, cells, cells},
                        .grading = grading,
                        .patches = {1, 1},
                        .h_top = 120.0,
                        .kappa = {1.4},
                        .rho = {1800.0},
                        .c = {1100.0}};
  return box;
}

/* mu c in (0, pi/2): kappa mu sin(mu c) - h cos(mu c) grows from -h to kappa mu. */
static double robin_root(const BoxMould *box)
{
  double low = 0.0, high = 0.5 * M_PI / box->size[2];
  for (int i = 0; i < 200; i++) {
    const double mu = 0.5 * (low + high), x = mu * box->size[2];
    if (box->kappa[0] * mu * sin(x) < box->h_top * cos(x))
      low = mu;
    else
      high = mu;
  }
  return 0.5 * (low + high);
}

static PetscErrorCode exact_solution(const BoxMould *box, double mu, DM dm, Vec u)
{
  PetscSection section;
  Vec coordinates;
  DM coordinate_dm;
  PetscInt first, last;
  const PetscScalar *x;
  PetscScalar *values, *at;

  PetscFunctionBeginUser;
  PetscCall(DMGetCoordinatesLocal(dm, &coordinates));
  PetscCall(DMGetCoordinateDM(dm, &coordinate_dm));
  PetscCall(DMGetGlobalSection(dm, &section));
  PetscCall(DMPlexGetDepthStratum(dm, 0, &first, &last));
  PetscCall(VecGetArrayRead(coordinates, &x));
  PetscCall(VecGetArray(u, &values));
  for (PetscInt v = first; v < last; v++) {
    const PetscScalar *point;
    PetscCall(DMPlexPointGlobalRef(dm, v, values, &at));
    if (!at) continue;
    PetscCall(DMPlexPointLocalRead(coordinate_dm, v, x, &point));
    *at = cos(M_PI * point[0] / box->size[0]) * cos(M_PI * point[1] / box->size[1]) * cos(mu * point[2]);
  }
  PetscCall(VecRestoreArray(u, &values));
  PetscCall(VecRestoreArrayRead(coordinates, &x));
  PetscFunctionReturn(0);
}

/* L2 norm of (nodal solution - interpolant of u), over the L2 norm of u, by E's own quadrature. */
static double solution_error(int cells, double grading)
{
  const BoxMould box = box_of(cells, grading);
  const double mu = robin_root(&box);
  const double laplace =
      M_PI * M_PI / (box.size[0] * box.size[0]) + M_PI * M_PI / (box.size[1] * box.size[1]) + mu * mu;
  MouldMesh *mesh;
  ReduceConfig *config;
  ThermalSystem *system;
  Mat M;
  Vec u, rhs, solution;
  KSP ksp;
  PetscReal error, norm;
  TEST_PETSC(box_mould_create(PETSC_COMM_WORLD, &box, &mesh, &config));
  TEST_PETSC(thermal_system_create(mesh, config, &system));
  TEST_PETSC(MatCreateVecs(system->E, &u, &rhs));
  TEST_PETSC(VecDuplicate(u, &solution));
  TEST_PETSC(exact_solution(&box, mu, mesh->dm, u));
  TEST_PETSC(MatMult(system->E, u, rhs)); // int rho c u phi; f = (laplace kappa/(rho c) + s) rho c u
  TEST_PETSC(VecScale(rhs, laplace * box.kappa[0] / (box.rho[0] * box.c[0]) + S));
  TEST_PETSC(MatDuplicate(system->K, MAT_COPY_VALUES, &M));
  TEST_PETSC(MatAXPY(M, S, system->E, SAME_NONZERO_PATTERN));
  TEST_PETSC(KSPCreate(PETSC_COMM_WORLD, &ksp));
  TEST_PETSC(KSPSetOperators(ksp, M, M));
  TEST_PETSC(KSPSetType(ksp, KSPCG));
  TEST_PETSC(KSPSetTolerances(ksp, 1e-12, 0.0, PETSC_DEFAULT, 5000));
  TEST_PETSC(KSPSolve(ksp, rhs, solution));
  TEST_PETSC(VecAXPY(solution, -1.0, u));
  TEST_PETSC(MatMult(system->E, solution, rhs));
  TEST_PETSC(VecDot(solution, rhs, &error));
  TEST_PETSC(MatMult(system->E, u, rhs));
  TEST_PETSC(VecDot(u, rhs, &norm));
  TEST_PETSC(KSPDestroy(&ksp));
  TEST_PETSC(MatDestroy(&M));
  TEST_PETSC(VecDestroy(&u));
  TEST_PETSC(VecDestroy(&rhs));
  TEST_PETSC(VecDestroy(&solution));
  TEST_PETSC(thermal_system_destroy(&system));
  TEST_PETSC(box_mould_destroy(&mesh, &config));
  return sqrt(error / norm);
}

static void check_order(double grading)
{
  const double coarse = solution_error(8, grading), fine = solution_error(16, grading);
  const double order = log2(coarse / fine);
  printf("grading %.1f: error %.3e with 8 cells, %.3e with 16, order %.3f\n", grading, coarse, fine, order);
  ASSERT_CLOSE(order, 2.0, 0.15); // the next term of the error is of order 4 on a uniform mesh, 3 on a graded one
  assert_true(fine < 1e-2);
}

static void linear_elements_converge_with_order_two_in_L2(void **state)
{
  (void)state;
  check_order(1.0);
}

static void linear_elements_converge_with_order_two_on_a_graded_mesh(void **state)
{
  (void)state;
  check_order(2.0);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(linear_elements_converge_with_order_two_in_L2),
      cmocka_unit_test(linear_elements_converge_with_order_two_on_a_graded_mesh),
  };
  if (PetscInitialize(&argc, &argv, NULL, NULL)) return 1;
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  return PetscFinalize() ? 1 : failed;
}
