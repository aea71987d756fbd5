/* What a reduced model lacks, found from energies of its residual, against the full model's own responses. */
#include "tests/support/petsc_test.h"

#include <complex.h>
#include <math.h>
#include <slepcsys.h>

#include "reduce/mor/certificate/certificate.h"
#include "reduce/mor/certificate/laplace_contour.h"
#include "reduce/mor/krylov/ports.h"
#include "reduce/petsc/petsc_compat.h"
#include "tests/support/mould_case.h"

static const PetscReal T_START = 0.05, T_END = 50.0;

static void a_step_response_comes_back_from_its_transform(void **state)
{
  (void)state;
  static const double rate[] = {1e-3, 0.02, 1.0, 50.0, 1e4}, T1 = 0.2, T2 = 12.0; // 1/s, s
  LaplaceContour contour;
  laplace_contour_set(T1, T2, &contour);
  for (size_t l = 0; l < sizeof rate / sizeof *rate; l++)
    for (double t = T1; t <= T2; t *= 1.5) {
      double f = 0.0;
      for (int k = 0; k < CONTOUR_POINTS; k++) {
        const double complex s = contour.s[k];
        f += cimag(cexp(s * t) * contour.weight[k] / (s * (s + rate[l])));
      }
      ASSERT_CLOSE(f, modal_phi(rate[l], t), 1e-6 * modal_phi(rate[l], T2)); // exp(-32 * 0.69) is 3e-10, its factor 1e3
    }
}

typedef struct Coarse { // a model of one shift
  MouldCase mould;
  Mat ports;
  ShiftedSolver *solver;
  KrylovBasis *basis;
  ModalModel *model;
} Coarse;

static void create_coarse(Coarse *coarse)
{
  Mat block;
  PetscInt kept, p;
  PetscReal ambient;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &SMALL_BOX, &coarse->mould));
  const ThermalSystem *system = coarse->mould.system;
  TEST_PETSC(ports_create(system, &coarse->ports, &ambient));
  TEST_PETSC(MatGetSize(coarse->ports, NULL, &p));
  TEST_PETSC(shifted_solver_create(system, 1e-10, PETSC_FALSE, &coarse->solver));
  TEST_PETSC(krylov_basis_create(system, coarse->ports, p + 1, p, 1e-10, &coarse->basis));
  TEST_PETSC(shifted_solver_set_shift(coarse->solver, 1.0, p));
  TEST_PETSC(krylov_basis_get_block(coarse->basis, p, &block));
  TEST_PETSC(shifted_solver_solve(coarse->solver, coarse->ports, block));
  TEST_PETSC(krylov_basis_add(coarse->basis, &block, &kept));
  TEST_PETSC(modal_model_create(PETSC_COMM_WORLD, coarse->basis->r, p, coarse->basis->K, coarse->basis->capacity,
                                coarse->basis->inputs, coarse->basis->constant, system->singular, &coarse->model));
}

static void destroy_coarse(Coarse *coarse)
{
  TEST_PETSC(modal_model_destroy(&coarse->model));
  TEST_PETSC(krylov_basis_destroy(&coarse->basis));
  TEST_PETSC(shifted_solver_destroy(&coarse->solver));
  TEST_PETSC(MatDestroy(&coarse->ports));
  TEST_PETSC(mould_case_destroy(&coarse->mould));
}

/* The full model's responses by Lanczos, which knows nothing of the model. */
static void solve_reference(const Coarse *coarse, StepReference *reference)
{
  for (PetscInt w = 0; w < reference->n_windows; w++) {
    TEST_PETSC(shifted_solver_set_shift(coarse->solver, reference->pole[w], 100));
    TEST_PETSC(step_reference_solve(reference, coarse->mould.system, coarse->solver, w, 1e-7));
  }
  TEST_PETSC(step_reference_finish(reference));
}

static void what_a_model_lacks_is_found_from_its_residual(void **state)
{
  (void)state;
  Coarse coarse;
  StepReference *solved, *found;
  Certificate *certificate;
  PetscReal error, worst = 0.0;
  create_coarse(&coarse);
  const ThermalSystem *system = coarse.mould.system;
  TEST_PETSC(step_reference_create(system, coarse.ports, T_START, T_END, &solved));
  TEST_PETSC(step_reference_create(system, coarse.ports, T_START, T_END, &found));
  solve_reference(&coarse, solved);
  TEST_PETSC(step_reference_compare(solved, coarse.model, NULL, &error));
  assert_true(error > 0.05); // one shift for three decades
  TEST_PETSC(certificate_create(coarse.basis, coarse.model, coarse.solver, 1.0 / T_END, 1.0 / T_START, &certificate));
  TEST_PETSC(certificate_correct(certificate, found));
  for (PetscInt t = 0; t < solved->n_times; t++)
    for (PetscInt j = 0; j < solved->n_inputs; j++)
      for (PetscInt i = 0; i < solved->p; i++) {
        const size_t at = (size_t)(t * solved->n_inputs + j), of_port = at * (size_t)solved->p + (size_t)i;
        worst = fmax(worst, fabs(found->temperature[of_port] - solved->temperature[of_port]) / solved->rise[at]);
      }
  print_message("error of the model %.2e, its correction misses %.2e, said to miss %.2e\n", error, worst, found->error);
  assert_true(worst <= found->error + solved->error);
  assert_true(found->error < 0.3 * error); // enough to judge by: reduction_judge.c
  TEST_PETSC(certificate_destroy(&certificate));
  TEST_PETSC(step_reference_destroy(&solved));
  TEST_PETSC(step_reference_destroy(&found));
  destroy_coarse(&coarse);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_step_response_comes_back_from_its_transform),
                                     cmocka_unit_test(what_a_model_lacks_is_found_from_its_residual)};
  if (SlepcInitialize(&argc, &argv, NULL, NULL)) return 1;
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  return SlepcFinalize() ? 1 : failed;
}
