/* The order of the elements in L2: p + 1 for elements of order p. Two exact solutions on a box:
 *
 * -div(kappa grad u) + s rho c u = f with insulated sides and floor and a Robin ceiling,
 *   u = cos(pi x/a) cos(pi y/b) cos(mu z),   kappa mu sin(mu c) = h cos(mu c),
 *   f = (kappa (pi^2/a^2 + pi^2/b^2 + mu^2) + s rho c) u;
 *
 * and the Laplace transform of H3, a flux q switched on at the wall z = 0 of a slab of thickness L, insulated beyond:
 *   u = q/(kappa k s) cosh(k (L - z))/sinh(k L),   k = sqrt(s/alpha), at s = 1/t where t is a time of the filling. */
#include "tests/support/petsc_test.h"

#include <math.h>
#include <petscksp.h>

#include "reduce/fem/thermal_system.h"
#include "tests/support/box_mould.h"

static const double S = 0.05; // 1/s, where storage and conduction matter alike in the box

typedef struct Exact {
  const BoxMould *box;
  double mu; // 1/m, of the first solution
  double k;  // 1/m, of the second
} Exact;

static PetscErrorCode cosines(PetscInt dim, PetscReal t, const PetscReal x[], PetscInt n, PetscScalar *u, void *of)
{
  const Exact *exact = of;
  (void)dim, (void)t, (void)n;
  *u = cos(M_PI * x[0] / exact->box->size[0]) * cos(M_PI * x[1] / exact->box->size[1]) * cos(exact->mu * x[2]);
  return 0;
}

static PetscErrorCode heated_slab(PetscInt dim, PetscReal t, const PetscReal x[], PetscInt n, PetscScalar *u, void *of)
{
  const Exact *exact = of;
  const double L = exact->box->size[2],
               s = exact->k * exact->k * exact->box->kappa[0] / exact->box->rho[0] / exact->box->c[0];
  const double flux = 1.0 / (exact->box->size[0] * exact->box->size[1]); // 1 W in all
  (void)dim, (void)t, (void)n;
  *u = flux / (exact->box->kappa[0] * exact->k * s) * cosh(exact->k * (L - x[2])) / sinh(exact->k * L);
  return 0;
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

typedef struct Problem {
  MouldMesh *mesh;
  ReduceConfig *config;
  ThermalSystem *system;
  Vec solution, rhs;
} Problem;

static void assemble(const BoxMould *box, int order, Problem *problem)
{
  TEST_PETSC(box_mould_create(PETSC_COMM_WORLD, box, &problem->mesh, &problem->config));
  problem->config->order = order;
  TEST_PETSC(thermal_system_create(problem->mesh, problem->config, &problem->system));
  TEST_PETSC(MatCreateVecs(problem->system->E, &problem->solution, &problem->rhs));
}

static void solve(Problem *problem, double s)
{
  Mat M;
  KSP ksp;
  TEST_PETSC(MatDuplicate(problem->system->K, MAT_COPY_VALUES, &M));
  TEST_PETSC(MatAXPY(M, s, problem->system->E, SAME_NONZERO_PATTERN));
  TEST_PETSC(KSPCreate(PETSC_COMM_WORLD, &ksp));
  TEST_PETSC(KSPSetOperators(ksp, M, M));
  TEST_PETSC(KSPSetType(ksp, KSPCG));
  TEST_PETSC(KSPSetTolerances(ksp, 1e-12, 0.0, PETSC_DEFAULT, 5000));
  TEST_PETSC(KSPSolve(ksp, problem->rhs, problem->solution));
  TEST_PETSC(KSPDestroy(&ksp));
  TEST_PETSC(MatDestroy(&M));
}

/* L2 norm of the solution's difference from u, over that of u; by quadrature, so that it is no error at nodes alone. */
static double release_and_compare(Problem *problem,
                                  PetscErrorCode (*u)(PetscInt, PetscReal, const PetscReal[], PetscInt, PetscScalar *,
                                                      void *),
                                  Exact *exact)
{
  PetscErrorCode (*functions[1])(PetscInt, PetscReal, const PetscReal[], PetscInt, PetscScalar *, void *) = {u};
  void *contexts[1] = {exact};
  PetscReal error, norm;
  TEST_PETSC(DMComputeL2Diff(problem->mesh->dm, 0.0, functions, contexts, problem->solution, &error));
  TEST_PETSC(VecZeroEntries(problem->solution));
  TEST_PETSC(DMComputeL2Diff(problem->mesh->dm, 0.0, functions, contexts, problem->solution, &norm));
  TEST_PETSC(VecDestroy(&problem->solution));
  TEST_PETSC(VecDestroy(&problem->rhs));
  TEST_PETSC(thermal_system_destroy(&problem->system));
  TEST_PETSC(box_mould_destroy(&problem->mesh, &problem->config));
  return error / norm;
}

static double cosines_error(int order, int cells, double grading)
{
  const BoxMould box = {.size = {0.02, 0.016, 0.012},
                        .cells = {cells, cells, cells},
                        .grading = grading,
                        .patches = {1, 1},
                        .h_top = 120.0,
                        .kappa = {1.4},
                        .rho = {1800.0},
                        .c = {1100.0}};
  Exact exact = {.box = &box, .mu = robin_root(&box)};
  const double laplace =
      M_PI * M_PI / (box.size[0] * box.size[0]) + M_PI * M_PI / (box.size[1] * box.size[1]) + exact.mu * exact.mu;
  PetscErrorCode (*functions[1])(PetscInt, PetscReal, const PetscReal[], PetscInt, PetscScalar *, void *) = {cosines};
  void *contexts[1] = {&exact};
  Problem problem;
  assemble(&box, order, &problem);
  TEST_PETSC(DMProjectFunction(problem.mesh->dm, 0.0, functions, contexts, INSERT_VALUES, problem.solution));
  // int rho c u phi; f = (laplace kappa/(rho c) + s) rho c u
  TEST_PETSC(MatMult(problem.system->E, problem.solution, problem.rhs));
  TEST_PETSC(VecScale(problem.rhs, laplace * box.kappa[0] / (box.rho[0] * box.c[0]) + S));
  solve(&problem, S);
  return release_and_compare(&problem, cosines, &exact);
}

static double slab_error(int order, int layers, double grading)
{
  const BoxMould box = {.size = {0.001, 0.001, 0.01},
                        .cells = {layers / 8, layers / 8, layers}, // a fixed size along the wall would leave order 1
                        .grading = grading,
                        .patches = {1, 1},
                        .kappa = {1.0},
                        .rho = {1800.0},
                        .c = {1100.0}};
  const double s = 1.0; // 1/s: depth 0.7 mm
  Exact exact = {.box = &box, .k = sqrt(s * box.rho[0] * box.c[0] / box.kappa[0])};
  Problem problem;
  assemble(&box, order, &problem);
  TEST_PETSC(MatGetColumnVector(problem.system->B, problem.rhs, 0)); // 1 W switched on: 1/s
  TEST_PETSC(VecScale(problem.rhs, 1.0 / s));
  solve(&problem, s);
  return release_and_compare(&problem, heated_slab, &exact);
}

static void check_order(const char *name, int order, double coarse, double fine, double largest)
{
  const double found = log2(coarse / fine);
  printf("%s, elements of order %d: error %.3e, with half the size %.3e, order %.3f\n", name, order, coarse, fine,
         found);
  ASSERT_CLOSE(found, order + 1.0, 0.15); // the next terms of the error are an order higher, or two on a uniform mesh
  assert_true(fine < largest);
}

static void linear_elements_converge_with_order_two_in_L2(void **state)
{
  (void)state;
  check_order("cosines", 1, cosines_error(1, 8, 1.0), cosines_error(1, 16, 1.0), 1.5e-2);
}

static void linear_elements_converge_with_order_two_on_a_graded_mesh(void **state)
{
  (void)state;
  check_order("cosines, graded mesh", 1, cosines_error(1, 8, 2.0), cosines_error(1, 16, 2.0), 1.5e-2);
}

static void quadratic_elements_converge_with_order_three_in_L2(void **state)
{
  (void)state;
  check_order("cosines", 2, cosines_error(2, 4, 1.0), cosines_error(2, 8, 1.0), 2e-3);
}

static void quadratic_elements_converge_with_order_three_on_a_graded_mesh(void **state)
{
  (void)state;
  check_order("cosines, graded mesh", 2, cosines_error(2, 4, 2.0), cosines_error(2, 8, 2.0), 2e-3);
}

static void both_converge_as_they_should_under_a_flux_at_the_wall(void **state)
{
  (void)state;
  check_order("H3, transformed", 1, slab_error(1, 16, 2.0), slab_error(1, 32, 2.0), 1e-2);
  check_order("H3, transformed", 2, slab_error(2, 16, 2.0), slab_error(2, 32, 2.0), 2e-4);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(linear_elements_converge_with_order_two_in_L2),
      cmocka_unit_test(linear_elements_converge_with_order_two_on_a_graded_mesh),
      cmocka_unit_test(quadratic_elements_converge_with_order_three_in_L2),
      cmocka_unit_test(quadratic_elements_converge_with_order_three_on_a_graded_mesh),
      cmocka_unit_test(both_converge_as_they_should_under_a_flux_at_the_wall),
  };
  if (PetscInitialize(&argc, &argv, NULL, NULL)) return 1;
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  return PetscFinalize() ? 1 : failed;
}
