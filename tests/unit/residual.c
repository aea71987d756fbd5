/* What inexact solves and a projection from moments spoil of a residual's identities, as found by sums, by solves, and
 * from the vectors themselves. */
#include "tests/support/petsc_test.h"

#include <math.h>
#include <slepcsys.h>
#include <stdlib.h>

#include "reduce/linear/dense_block.h"
#include "reduce/mor/certificate/residual.h"
#include "reduce/mor/krylov/ports.h"
#include "reduce/petsc/petsc_compat.h"
#include "tests/support/mould_case.h"

static const PetscReal SHIFT = 1.0; // 1/s

typedef struct Case { // a model of one shift
  MouldCase mould;
  Mat ports;
  PetscInt p;
  ShiftedSolver *solver;
  KrylovBasis *basis;
  ModalModel *model;
  Residual *residual;
  PetscReal *weight;
} Case;

static void begin(Case *c, PetscReal rtol)
{
  PetscReal ambient;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &SMALL_BOX, &c->mould));
  TEST_PETSC(ports_create(c->mould.system, &c->ports, &ambient));
  TEST_PETSC(MatGetSize(c->ports, NULL, &c->p));
  TEST_PETSC(shifted_solver_create(c->mould.system, rtol, PETSC_TRUE, &c->solver));
  TEST_PETSC(shifted_solver_set_shift(c->solver, SHIFT, c->p));
  c->weight = malloc((size_t)c->p * sizeof *c->weight);
  for (PetscInt l = 0; l < c->p; l++) c->weight[l] = 1.0 + 0.1 * (double)l;
}

static void finish(Case *c)
{
  const KrylovBasis *V = c->basis;
  TEST_PETSC(modal_model_create(PETSC_COMM_WORLD, V->r, c->p, V->K, V->capacity, V->inputs, V->constant,
                                c->mould.system->singular, &c->model));
}

static void end(Case *c)
{
  TEST_PETSC(residual_destroy(&c->residual));
  TEST_PETSC(modal_model_destroy(&c->model));
  TEST_PETSC(krylov_basis_destroy(&c->basis));
  TEST_PETSC(shifted_solver_destroy(&c->solver));
  TEST_PETSC(MatDestroy(&c->ports));
  TEST_PETSC(mould_case_destroy(&c->mould));
  free(c->weight);
}

/* Inexact solves leave a size that random sums of inputs with solves, and sums of rows without, find from above. */
static void random_sums_find_no_less_than_solves_on_every_input(void **state)
{
  (void)state;
  Case c;
  Mat block;
  PetscInt kept;
  PetscReal every, some, none;
  begin(&c, 1e-4);
  TEST_PETSC(krylov_basis_create(c.mould.system, c.ports, c.p + 1, c.p, 1e-10, &c.basis));
  TEST_PETSC(krylov_basis_get_block(c.basis, c.p, &block));
  TEST_PETSC(shifted_solver_solve(c.solver, c.ports, block));
  TEST_PETSC(krylov_basis_add(c.basis, &block, &kept));
  finish(&c);
  TEST_PETSC(residual_create(c.basis, c.model, &c.residual));
  for (PetscReal w = 0.1; w < 20.0; w *= 10.0) {
    TEST_PETSC(shifted_solver_set_shift(c.solver, w, c.p));
    const ResidualExam all = {c.weight, 0.0, c.p}, sums = {c.weight, 0.0, 0};
    TEST_PETSC(residual_defect(c.residual, c.basis, c.model, c.solver, &all, &every));
    TEST_PETSC(residual_defect(c.residual, c.basis, c.model, c.solver, &sums, &some));
    TEST_PETSC(residual_defect_by_sums(c.residual, c.model, w, c.weight, &none));
    print_message("rate %g: %.3e by solves on every input, %.3e on sums, %.3e without solves\n", w, every, some, none);
    assert_true(every > 0.0 && some >= every && none >= every);
    assert_true(some < 4.0 * sqrt((double)c.p) * every); // Frobenius' norm, its safety of 2, and chance
    const ResidualExam enough = {c.weight, 1.01 * none, c.p};
    TEST_PETSC(residual_defect(c.residual, c.basis, c.model, c.solver, &enough, &some));
    assert_true(some == none); // no solve was asked for
  }
  end(&c);
}

/* One shift, X = (s E + K)^-1 ports, kept as a block in memory. */
static void store_shift(Case *c)
{
  const ThermalSystem *system = c->mould.system;
  const size_t square = (size_t)c->p * (size_t)c->p;
  ShiftMoments shift = {.s = SHIFT, .q = 1};
  Mat X, EX;
  TEST_PETSC(krylov_basis_create_stored(system, c->ports, NULL, "", 1e-5, &c->basis));
  TEST_PETSC(dense_block_create(system->E, c->p, &X));
  TEST_PETSC(dense_block_create(system->E, c->p, &EX));
  TEST_PETSC(shifted_solver_solve(c->solver, c->ports, X));
  TEST_PETSC(shift_blocks_add(c->basis->blocks, X));
  TEST_PETSC(dense_block_multiply(system->E, X, EX));
  TEST_PETSC(PetscMalloc1(2 * square, &shift.mu));
  TEST_PETSC(PetscMalloc1(2 * (size_t)c->p, &shift.heat));
  TEST_PETSC(dense_block_inner(c->ports, X, shift.mu));
  TEST_PETSC(dense_block_inner(X, EX, shift.mu + square));
  for (PetscInt l = 0; l < c->p; l++) {
    Vec column;
    TEST_PETSC(MatDenseGetColumnVecRead(X, l, &column));
    TEST_PETSC(VecDot(c->basis->E_one, column, &shift.heat[l]));
    TEST_PETSC(VecDot(c->basis->K_one, column, &shift.heat[c->p + l]));
    TEST_PETSC(MatDenseRestoreColumnVecRead(X, l, &column));
  }
  TEST_PETSC(shift_blocks_complete(c->basis->blocks, &shift));
  TEST_PETSC(krylov_basis_project_stored(c->basis));
  TEST_PETSC(MatDestroy(&X));
  TEST_PETSC(MatDestroy(&EX));
}

/* ||D x^T V^T R D||_F at iw from V itself: V^T R = V^T ports - (iw V^T E V + V^T K V) Q x. */
static double slip_from_vectors(const Case *c, double w)
{
  const ThermalSystem *system = c->mould.system;
  const size_t r = (size_t)c->basis->r, p = (size_t)c->p;
  double *one = calloc(r * r, sizeof *one), *ports = malloc(r * p * sizeof *ports), *E = malloc(r * r * sizeof *E),
         *K = malloc(r * r * sizeof *K), *x[2], *R[2], sum = 0.0;
  Mat V, product;
  for (size_t k = 0; k < r; k++) one[k + k * r] = 1.0;
  TEST_PETSC(dense_block_create(system->E, (PetscInt)r, &V));
  TEST_PETSC(dense_block_create(system->E, (PetscInt)r, &product));
  TEST_PETSC(krylov_basis_combine(c->basis, one, V));
  TEST_PETSC(dense_block_multiply(system->E, V, product));
  TEST_PETSC(dense_block_inner(V, product, E));
  TEST_PETSC(dense_block_multiply(system->K, V, product));
  TEST_PETSC(dense_block_inner(V, product, K));
  TEST_PETSC(dense_block_inner(V, c->ports, ports));
  for (int part = 0; part < 2; part++) { // x in the basis: Q (iw + Lambda)^-1 B
    x[part] = calloc(r * p, sizeof *x[part]);
    R[part] = calloc(r * p, sizeof *R[part]);
    for (size_t k = 0; k < r; k++) {
      const double lambda = c->model->lambda[k], factor = (part == 0 ? lambda : -w) / (lambda * lambda + w * w);
      for (size_t l = 0; l < p; l++)
        for (size_t i = 0; i < r; i++) x[part][i + l * r] += c->model->Q[i + k * r] * factor * c->model->B[k * p + l];
    }
  }
  for (size_t l = 0; l < p; l++)
    for (size_t i = 0; i < r; i++) {
      R[0][i + l * r] = ports[i + l * r];
      for (size_t k = 0; k < r; k++) {
        R[0][i + l * r] -= K[i + k * r] * x[0][k + l * r] - w * E[i + k * r] * x[1][k + l * r];
        R[1][i + l * r] -= K[i + k * r] * x[1][k + l * r] + w * E[i + k * r] * x[0][k + l * r];
      }
    }
  for (size_t j = 0; j < p; j++)
    for (size_t l = 0; l < p; l++) {
      double re = 0.0, im = 0.0;
      for (size_t k = 0; k < r; k++) {
        re += x[0][k + j * r] * R[0][k + l * r] - x[1][k + j * r] * R[1][k + l * r];
        im += x[0][k + j * r] * R[1][k + l * r] + x[1][k + j * r] * R[0][k + l * r];
      }
      sum += c->weight[j] * c->weight[j] * c->weight[l] * c->weight[l] * (re * re + im * im);
    }
  TEST_PETSC(MatDestroy(&V));
  TEST_PETSC(MatDestroy(&product));
  for (int part = 0; part < 2; part++) free(x[part]), free(R[part]);
  free(one), free(ports), free(E), free(K);
  return sqrt(sum);
}

static void a_projection_that_slips_is_seen_at_all_rates_at_once(void **state)
{
  (void)state;
  enum { RATES = 3 };
  static const double rate[RATES] = {0.05, 1.0, 30.0};
  double slip[RATES];
  Case c;
  begin(&c, 1e-10);
  store_shift(&c);
  finish(&c);
  TEST_PETSC(residual_create(c.basis, c.model, &c.residual));
  TEST_PETSC(residual_slip(c.residual, c.basis, c.model, c.weight, RATES, rate, slip));
  double sound[RATES];
  for (int i = 0; i < RATES; i++) sound[i] = slip[i];
  for (PetscInt k = 1; k < c.model->r; k++) c.model->lambda[k] *= 1.0 + 1e-3 * (double)k; // K_r that is not V^T K V
  TEST_PETSC(residual_slip(c.residual, c.basis, c.model, c.weight, RATES, rate, slip));
  for (int i = 0; i < RATES; i++) {
    const double expected = slip_from_vectors(&c, rate[i]);
    print_message("rate %g: %.3e, from the vectors %.3e; %.1e without the fault\n", rate[i], slip[i], expected,
                  sound[i]);
    assert_true(sound[i] < 1e-5 * expected); // moments to 1e-10
    ASSERT_CLOSE(slip[i], expected, 1e-6 * expected);
  }
  end(&c);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(random_sums_find_no_less_than_solves_on_every_input),
                                     cmocka_unit_test(a_projection_that_slips_is_seen_at_all_rates_at_once)};
  if (SlepcInitialize(&argc, &argv, NULL, NULL)) return 1;
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  return SlepcFinalize() ? 1 : failed;
}
