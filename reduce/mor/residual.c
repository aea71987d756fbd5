#include "reduce/mor/residual.h"

#include "reduce/mor/dense_block.h"
#include "reduce/mor/small_dense.h"
#include "reduce/petsc_compat.h"

/* E >= DIAGONAL_SHARE diag(E): 1/2 for linear and 1/4 for quadratic tetrahedra, on any mesh (the least eigenvalue of
 * one element's: Wathen 1987, IMA J. Numer. Anal. 7, 449); less, for matrices from elsewhere. It only enters what is
 * added for inexact solves. */
static const PetscReal DIAGONAL_SHARE = 0.05;
/* Eigenvalues of R_0's scaled Gram matrix below this share of the largest are dependence or rounding. */
static const PetscReal DEPENDENT = 1e-11;

typedef struct Probes { // inputs, or sums of them, on which inexact solves are examined
  PetscInt k;
  PetscReal *W;            // [p x k]
  PetscReal safety;        // of norms found by them
  const PetscReal *weight; // [p] D's diagonal; borrowed
} Probes;

/* X(i, :) /= E_ii */
static PetscErrorCode divide_by_diagonal(const ThermalSystem *system, Mat X)
{
  Vec diagonal;

  PetscFunctionBeginUser;
  PetscCall(MatCreateVecs(system->E, NULL, &diagonal));
  PetscCall(MatGetDiagonal(system->E, diagonal));
  PetscCall(VecReciprocal(diagonal));
  PetscCall(MatDiagonalScale(X, diagonal, NULL));
  PetscCall(VecDestroy(&diagonal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Y -= X, column by column */
static PetscErrorCode subtract(Mat Y, Mat X)
{
  PetscInt k;
  PetscReal *minus;

  PetscFunctionBeginUser;
  PetscCall(MatGetSize(X, NULL, &k));
  PetscCall(PetscMalloc1((size_t)k, &minus));
  for (PetscInt c = 0; c < k; c++) minus[c] = -1.0;
  PetscCall(dense_block_axpby(Y, 1.0, minus, X));
  PetscCall(PetscFree(minus));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* R_0 = ports - E V B_r */
static PetscErrorCode constant_factor(Residual *residual, const KrylovBasis *basis)
{
  const PetscInt p = residual->p, r = residual->r;
  Mat projected, product;
  PetscReal *inputs;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)r * (size_t)p, &inputs));
  for (PetscInt k = 0; k < r; k++)
    for (PetscInt l = 0; l < p; l++) inputs[k + l * r] = basis->inputs[k * p + l];
  PetscCall(dense_block_create(residual->system->E, p, &projected));
  PetscCall(dense_block_create(residual->system->E, p, &product));
  PetscCall(dense_block_create(residual->system->E, p, &residual->R0));
  PetscCall(krylov_basis_combine(basis, inputs, projected));
  PetscCall(dense_block_multiply(residual->system->E, projected, product));
  PetscCall(dense_block_copy(residual->R0, 0, basis->ports, NULL, p));
  PetscCall(subtract(residual->R0, product));
  PetscCall(MatDestroy(&projected));
  PetscCall(MatDestroy(&product));
  PetscCall(PetscFree(inputs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* X := A^+ X, A [n x n] symmetric positive semi-definite, X [n x k]. Ports may depend on each other (the ambient on the
 * outer patches), so directions without weight are left out. */
static PetscErrorCode solve_small(MPI_Comm comm, PetscInt n, PetscInt k, PetscReal *A, PetscReal *X)
{
  PetscReal *w, *scale, *turned;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc3((size_t)n, &w, (size_t)n, &scale, (size_t)n * (size_t)k, &turned));
  for (PetscInt i = 0; i < n; i++) scale[i] = A[i + i * n] > 0.0 ? 1.0 / PetscSqrtReal(A[i + i * n]) : 0.0;
  for (PetscInt j = 0; j < n; j++)
    for (PetscInt i = 0; i < n; i++) A[i + j * n] *= scale[i] * scale[j];
  for (PetscInt j = 0; j < k; j++)
    for (PetscInt i = 0; i < n; i++) X[i + j * n] *= scale[i];
  PetscCall(small_eigen(comm, n, A, w));
  PetscCall(small_multiply('T', 'N', n, k, n, 1.0, A, X, 0.0, turned));
  for (PetscInt j = 0; j < k; j++)
    for (PetscInt i = 0; i < n; i++) turned[i + j * n] *= w[i] > DEPENDENT * w[n - 1] ? 1.0 / w[i] : 0.0;
  PetscCall(small_multiply('N', 'N', n, k, n, 1.0, A, turned, 0.0, X));
  for (PetscInt j = 0; j < k; j++)
    for (PetscInt i = 0; i < n; i++) X[i + j * n] *= scale[i];
  PetscCall(PetscFree3(w, scale, turned));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* c^T from K V - E V K_r = R_0 c^T by least squares with the weight diag(E)^-1: W = diag(E)^-1 R_0,
 * (W^T R_0) c^T = (K W)^T V - (E W)^T V K_r. */
static PetscErrorCode coupling(Residual *residual, const KrylovBasis *basis, const ModalModel *model)
{
  const ThermalSystem *system = residual->system;
  const PetscInt p = residual->p, r = residual->r;
  MPI_Comm comm = PetscObjectComm((PetscObject)system->E);
  Mat W, product;
  PetscReal *gram, *right, *of_E, *K;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc4((size_t)p * (size_t)p, &gram, (size_t)p * (size_t)r, &right, (size_t)p * (size_t)r, &of_E,
                         (size_t)r * (size_t)r, &K));
  PetscCall(dense_block_create(system->E, p, &W));
  PetscCall(dense_block_create(system->E, p, &product));
  PetscCall(dense_block_copy(W, 0, residual->R0, NULL, p));
  PetscCall(divide_by_diagonal(system, W));
  PetscCall(dense_block_inner(W, residual->R0, gram));
  PetscCall(dense_block_multiply(system->K, W, product));
  PetscCall(krylov_basis_inner(basis, product, right));
  PetscCall(dense_block_multiply(system->E, W, product));
  PetscCall(krylov_basis_inner(basis, product, of_E));
  for (PetscInt j = 0; j < r; j++)
    PetscCall(PetscArraycpy(K + (size_t)j * (size_t)r, basis->K + (size_t)j * (size_t)basis->capacity, (size_t)r));
  PetscCall(small_multiply('N', 'N', p, r, r, -1.0, of_E, K, 1.0, right));
  PetscCall(solve_small(comm, p, r, gram, right));
  PetscCall(small_multiply('N', 'N', p, r, r, 1.0, right, model->Q, 0.0, residual->c)); // [p x r] = c row-major
  PetscCall(MatDestroy(&W));
  PetscCall(MatDestroy(&product));
  PetscCall(PetscFree4(gram, right, of_E, K));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode residual_create(const KrylovBasis *basis, const ModalModel *model, Residual **out)
{
  Residual *residual;

  PetscFunctionBeginUser;
  PetscCall(PetscNew(&residual));
  *out = residual;
  residual->system = basis->system;
  residual->p = basis->p;
  residual->r = basis->r;
  PetscCall(PetscMalloc1((size_t)basis->r * (size_t)basis->p, &residual->c));
  PetscCall(constant_factor(residual, basis));
  PetscCall(coupling(residual, basis, model));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Re or Im of (iw + Lambda)^-1 B as [p x r] column-major, which is row-major [r x p]. */
static void modal_state(const ModalModel *model, PetscReal w, int part, PetscReal *x)
{
  for (PetscInt k = 0; k < model->r; k++) {
    const PetscReal lambda = model->lambda[k], size = lambda * lambda + w * w;
    for (PetscInt l = 0; l < model->p; l++)
      x[k * model->p + l] = (part == 0 ? lambda : -w) / size * model->B[k * model->p + l];
  }
}

PetscErrorCode residual_factor(const Residual *residual, const ModalModel *model, PetscReal w, PetscReal *real,
                               PetscReal *imaginary)
{
  const PetscInt p = residual->p;
  PetscReal *x;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)model->r * (size_t)p, &x));
  for (int part = 0; part < 2; part++) {
    PetscReal *Phi = part == 0 ? real : imaginary;
    modal_state(model, w, part, x);
    PetscCall(small_multiply('N', 'T', p, p, model->r, -1.0, residual->c, x, 0.0, Phi));
    for (PetscInt l = 0; part == 0 && l < p; l++) Phi[l + l * p] += 1.0;
  }
  PetscCall(PetscFree(x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* G >= X^T M^-1 X, M = w E + K, [k x k]. With M Z = X - d:  X^T M^-1 X = X^T Z + d^T Z + d^T M^-1 d, and
 * M >= w E >= w DIAGONAL_SHARE diag(E). */
static PetscErrorCode energy_of(const ThermalSystem *system, ShiftedSolver *solver, Mat X, PetscReal *G)
{
  const PetscReal w = shifted_solver_get_shift(solver);
  Mat Z, d, product;
  PetscInt k;
  PetscReal *part;

  PetscFunctionBeginUser;
  PetscCall(MatGetSize(X, NULL, &k));
  PetscCall(PetscMalloc1((size_t)k * (size_t)k, &part));
  PetscCall(dense_block_create(system->E, k, &Z));
  PetscCall(dense_block_create(system->E, k, &d));
  PetscCall(dense_block_create(system->E, k, &product));
  PetscCall(shifted_solver_solve(solver, X, Z));
  PetscCall(dense_block_inner(X, Z, G));
  PetscCall(dense_block_multiply(system->E, Z, d));
  PetscCall(MatScale(d, -w));
  PetscCall(dense_block_multiply(system->K, Z, product));
  PetscCall(subtract(d, product));
  for (PetscInt c = 0; c < k; c++) part[c] = 1.0;
  PetscCall(dense_block_axpby(d, 1.0, part, X));
  PetscCall(dense_block_inner(d, Z, part));
  for (PetscInt i = 0; i < k * k; i++) G[i] += part[i];
  PetscCall(dense_block_copy(product, 0, d, NULL, k));
  PetscCall(divide_by_diagonal(system, product));
  PetscCall(dense_block_inner(d, product, part));
  for (PetscInt i = 0; i < k * k; i++) G[i] += part[i] / (w * DIAGONAL_SHARE);
  for (PetscInt j = 0; j < k; j++)
    for (PetscInt i = 0; i < j; i++) G[i + j * k] = G[j + i * k] = 0.5 * (G[i + j * k] + G[j + i * k]);
  PetscCall(MatDestroy(&Z));
  PetscCall(MatDestroy(&d));
  PetscCall(MatDestroy(&product));
  PetscCall(PetscFree(part));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode residual_energy(const Residual *residual, ShiftedSolver *solver, PetscReal w, PetscReal *G)
{
  PetscFunctionBeginUser;
  PetscCall(shifted_solver_set_shift(solver, w, residual->p));
  PetscCall(energy_of(residual->system, solver, residual->R0, G));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Add Re and Im of (iw E + K) V x(iw) W, W [p x k]: with V x W = a + ib,  K a - w E b  and  K b + w E a. */
static PetscErrorCode applied(const Residual *residual, const KrylovBasis *basis, const ModalModel *model, PetscReal w,
                              const Probes *probes, Mat of[2])
{
  const ThermalSystem *system = residual->system;
  const PetscInt p = residual->p, r = residual->r, k = probes->k;
  Mat Vx, product;
  PetscReal *x, *xW, *QxW, *factor;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc4((size_t)r * (size_t)p, &x, (size_t)r * (size_t)k, &xW, (size_t)r * (size_t)k, &QxW, (size_t)k,
                         &factor));
  PetscCall(dense_block_create(system->E, k, &Vx));
  PetscCall(dense_block_create(system->E, k, &product));
  for (int part = 0; part < 2; part++) {
    modal_state(model, w, part, x);
    PetscCall(small_multiply('T', 'N', r, k, p, 1.0, x, probes->W, 0.0, xW));
    PetscCall(small_multiply('N', 'N', r, k, r, 1.0, model->Q, xW, 0.0, QxW));
    PetscCall(krylov_basis_combine(basis, QxW, Vx));
    PetscCall(dense_block_multiply(system->K, Vx, product));
    for (PetscInt c = 0; c < k; c++) factor[c] = 1.0;
    PetscCall(dense_block_axpby(of[part], 1.0, factor, product));
    PetscCall(dense_block_multiply(system->E, Vx, product));
    for (PetscInt c = 0; c < k; c++) factor[c] = part == 0 ? w : -w;
    PetscCall(dense_block_axpby(of[1 - part], 1.0, factor, product));
  }
  PetscCall(MatDestroy(&Vx));
  PetscCall(MatDestroy(&product));
  PetscCall(PetscFree4(x, xW, QxW, factor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ||X_r + i X_i||_F^2 in the norm of diag(E)^-1 */
static PetscErrorCode diagonal_size(const ThermalSystem *system, Mat of[2], PetscReal *sum)
{
  PetscInt k;
  Mat scaled;
  PetscReal *dots;

  PetscFunctionBeginUser;
  *sum = 0.0;
  PetscCall(MatGetSize(of[0], NULL, &k));
  PetscCall(PetscMalloc1((size_t)k, &dots));
  PetscCall(dense_block_create(system->E, k, &scaled));
  for (int part = 0; part < 2; part++) {
    PetscCall(dense_block_copy(scaled, 0, of[part], NULL, k));
    PetscCall(divide_by_diagonal(system, scaled));
    PetscCall(dense_block_dots(of[part], scaled, dots));
    for (PetscInt c = 0; c < k; c++) *sum += dots[c];
  }
  PetscCall(MatDestroy(&scaled));
  PetscCall(PetscFree(dots));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* sqrt(lambda_max(X_r^T M^-1 X_r)) + the same of X_i >= the 2-norm of M^(-1/2) (X_r + i X_i), M = w E + K */
static PetscErrorCode solved_size(const ThermalSystem *system, ShiftedSolver *solver, Mat of[2], PetscReal *size)
{
  PetscInt k;
  PetscReal *G, *none, largest;

  PetscFunctionBeginUser;
  *size = 0.0;
  PetscCall(MatGetSize(of[0], NULL, &k));
  PetscCall(PetscMalloc1((size_t)k * (size_t)k, &G));
  PetscCall(PetscCalloc1((size_t)k * (size_t)k, &none));
  for (int part = 0; part < 2; part++) {
    PetscCall(energy_of(system, solver, of[part], G));
    PetscCall(small_hermitian_largest(PetscObjectComm((PetscObject)system->E), k, G, none, &largest));
    *size += PetscSqrtReal(PetscMax(largest, 0.0));
  }
  PetscCall(PetscFree(G));
  PetscCall(PetscFree(none));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ||D x^T V^T R W||_F at iw, of = -R W */
static PetscErrorCode galerkin_slip(const KrylovBasis *basis, const ModalModel *model, PetscReal w,
                                    const Probes *probes, Mat of[2], PetscReal *slip)
{
  const PetscInt p = basis->p, r = basis->r, k = probes->k;
  PetscReal *inner, *turned, *x, *S[2];

  PetscFunctionBeginUser;
  const size_t size = (size_t)r * (size_t)k, square = (size_t)k * (size_t)p;
  PetscCall(PetscMalloc5(size, &inner, size, &turned, (size_t)r * (size_t)p, &x, square, &S[0], square, &S[1]));
  for (int part = 0; part < 2; part++) { // (a + ib)^T (c + id), [k x p]: R^T V of one part times both of x
    PetscCall(krylov_basis_inner(basis, of[part], inner));
    PetscCall(small_multiply('N', 'N', k, r, r, 1.0, inner, model->Q, 0.0, turned));
    for (int other = 0; other < 2; other++) {
      modal_state(model, w, other, x);
      PetscCall(small_multiply('N', 'T', k, p, r, part == 1 && other == 1 ? -1.0 : 1.0, turned, x,
                               part == 0 ? 0.0 : 1.0, S[part == other ? 0 : 1]));
    }
  }
  *slip = 0.0;
  for (PetscInt j = 0; j < p; j++)
    for (PetscInt i = 0; i < k; i++) {
      const PetscReal size_2 = S[0][i + j * k] * S[0][i + j * k] + S[1][i + j * k] * S[1][i + j * k];
      *slip += probes->weight[j] * probes->weight[j] * size_2;
    }
  *slip = probes->safety * PetscSqrtReal(*slip);
  PetscCall(PetscFree5(inner, turned, x, S[0], S[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* W: all inputs, or of many a few random sums with signs +-1/sqrt(k), the same on every rank: then
 * ||X D||_F^2 = E ||X W||_F^2 (Hutchinson 1990, Commun. Stat. Simul. 19, 433), with a spread of at most
 * sqrt(2/k) of it: the root, half as large again, lies above in all but one of some thousand cases. */
static PetscErrorCode choose_probes(PetscInt p, const PetscReal *weight, PetscBool every_input, Probes *probes)
{
  enum { PROBES = 32 };
  const PetscBool all = (PetscBool)(every_input || p <= 2 * PROBES);
  uint64_t random = 0x9e3779b97f4a7c15u;

  PetscFunctionBeginUser;
  *probes = (Probes){.k = all ? p : PROBES, .safety = all ? 1.0 : 1.5, .weight = weight};
  PetscCall(PetscCalloc1((size_t)p * (size_t)probes->k, &probes->W));
  for (PetscInt l = 0; l < p; l++) {
    if (all) probes->W[l + l * p] = weight[l];
    for (PetscInt c = 0; c < probes->k && !all; c++) {
      random = random * 6364136223846793005u + 1442695040888963407u;
      probes->W[l + c * p] = (random >> 63 ? 1.0 : -1.0) * weight[l] / PetscSqrtReal((PetscReal)probes->k);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* of = (R_0 Phi - R) W at iw; what V^T R is, on the way */
static PetscErrorCode spoilt_part(const Residual *residual, const KrylovBasis *basis, const ModalModel *model,
                                  PetscReal w, const Probes *probes, Mat of[2], PetscReal *slip)
{
  const PetscInt p = residual->p, k = probes->k;
  PetscReal *Phi[2], *PhiW;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc3((size_t)p * (size_t)p, &Phi[0], (size_t)p * (size_t)p, &Phi[1], (size_t)p * (size_t)k, &PhiW));
  PetscCall(applied(residual, basis, model, w, probes, of));
  PetscCall(dense_block_combine(of[0], 1.0, -1.0, basis->ports, probes->W, p)); // -R W
  PetscCall(galerkin_slip(basis, model, w, probes, of, slip));
  PetscCall(residual_factor(residual, model, w, Phi[0], Phi[1]));
  for (int part = 0; part < 2; part++) {
    PetscCall(small_multiply('N', 'N', p, k, p, 1.0, Phi[part], probes->W, 0.0, PhiW));
    PetscCall(dense_block_combine(of[part], 1.0, 1.0, residual->R0, PhiW, p));
  }
  PetscCall(PetscFree3(Phi[0], Phi[1], PhiW));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* solve: the size by solves on every input, else an upper bound of it, without any, on the probes */
static PetscErrorCode examine(const Residual *residual, const KrylovBasis *basis, const ModalModel *model,
                              ShiftedSolver *solver, const PetscReal *weight, PetscBool solve, ResidualDefect *defect)
{
  const PetscReal w = shifted_solver_get_shift(solver);
  Mat of[2];
  Probes probes;

  PetscFunctionBeginUser;
  PetscCall(choose_probes(residual->p, weight, solve, &probes));
  PetscCall(dense_block_create(residual->system->E, probes.k, &of[0]));
  PetscCall(dense_block_create(residual->system->E, probes.k, &of[1]));
  PetscCall(spoilt_part(residual, basis, model, w, &probes, of, &defect->slip));
  if (solve) {
    PetscCall(solved_size(residual->system, solver, of, &defect->size));
  } else {
    PetscCall(diagonal_size(residual->system, of, &defect->size));
    defect->size = probes.safety * PetscSqrtReal(defect->size / (w * DIAGONAL_SHARE));
  }
  PetscCall(MatDestroy(&of[0]));
  PetscCall(MatDestroy(&of[1]));
  PetscCall(PetscFree(probes.W));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode residual_defect(const Residual *residual, const KrylovBasis *basis, const ModalModel *model,
                               ShiftedSolver *solver, const PetscReal *weight, PetscReal negligible,
                               ResidualDefect *defect)
{
  PetscFunctionBeginUser;
  PetscCall(examine(residual, basis, model, solver, weight, PETSC_FALSE, defect));
  if (defect->size > negligible) PetscCall(examine(residual, basis, model, solver, weight, PETSC_TRUE, defect));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode residual_destroy(Residual **residual)
{
  PetscFunctionBeginUser;
  if (!*residual) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatDestroy(&(*residual)->R0));
  PetscCall(PetscFree((*residual)->c));
  PetscCall(PetscFree(*residual));
  PetscFunctionReturn(PETSC_SUCCESS);
}
