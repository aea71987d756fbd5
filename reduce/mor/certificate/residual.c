#include "reduce/mor/certificate/residual_private.h"

#include "reduce/linear/dense_block.h"
#include "reduce/linear/small_dense.h"
#include "reduce/petsc/petsc_compat.h"

/* Eigenvalues of R_0's scaled Gram matrix below this share of the largest are dependence or rounding. */
static const PetscReal DEPENDENT = 1e-11;

PetscErrorCode residual_scale_by_diagonal(const ThermalSystem *system, PetscReal power, Mat X)
{
  Vec diagonal;

  PetscFunctionBeginUser;
  PetscCall(MatCreateVecs(system->E, NULL, &diagonal));
  PetscCall(MatGetDiagonal(system->E, diagonal));
  PetscCall(VecPow(diagonal, power));
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

/* +1 or -1, whatever the numbering's distribution over processes */
static PetscReal random_sign(PetscInt row, PetscInt column)
{
  uint64_t z = (uint64_t)row * RESIDUAL_PROBES + (uint64_t)column + 1;
  z *= 0x9e3779b97f4a7c15u; // splitmix64
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z >> 63 ? 1.0 : -1.0;
}

/* W = [diag(E)^-1 R_0, S], S = diag(E)^(-1/2) random signs/sqrt(k) */
static PetscErrorCode test_vectors(const Residual *residual, Mat *W)
{
  const PetscInt p = residual->p, k = RESIDUAL_PROBES;
  PetscInt first, last, ld;
  PetscScalar *sign;
  Mat R, S;

  PetscFunctionBeginUser;
  PetscCall(dense_block_create(residual->system->E, p + k, W));
  PetscCall(dense_block_copy(*W, 0, residual->R0, NULL, p));
  PetscCall(MatDenseGetSubMatrix(*W, PETSC_DECIDE, PETSC_DECIDE, 0, p, &R));
  PetscCall(residual_scale_by_diagonal(residual->system, -1.0, R));
  PetscCall(MatDenseRestoreSubMatrix(*W, &R));
  PetscCall(MatGetOwnershipRange(*W, &first, &last));
  PetscCall(MatDenseGetLDA(*W, &ld));
  PetscCall(MatDenseGetArray(*W, &sign));
  for (PetscInt c = 0; c < k; c++)
    for (PetscInt i = first; i < last; i++)
      sign[(size_t)(i - first) + (size_t)(p + c) * (size_t)ld] = random_sign(i, c) / PetscSqrtReal((PetscReal)k);
  PetscCall(MatDenseRestoreArray(*W, &sign));
  PetscCall(MatDenseGetSubMatrix(*W, PETSC_DECIDE, PETSC_DECIDE, p, p + k, &S));
  PetscCall(residual_scale_by_diagonal(residual->system, -0.5, S));
  PetscCall(MatDenseRestoreSubMatrix(*W, &S));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* right = W^T (K V - E V K_r) Q [k x r], gram = W^T R_0 [k x p] */
static PetscErrorCode test(const Residual *residual, const KrylovBasis *basis, const ModalModel *model, Mat W,
                           PetscReal *right, PetscReal *gram)
{
  const ThermalSystem *system = residual->system;
  const PetscInt r = residual->r;
  PetscInt k;
  PetscReal *inner;
  Mat product;

  PetscFunctionBeginUser;
  PetscCall(MatGetSize(W, NULL, &k));
  PetscCall(PetscMalloc1((size_t)k * (size_t)r, &inner));
  PetscCall(dense_block_create(system->E, k, &product));
  PetscCall(dense_block_inner(W, residual->R0, gram));
  PetscCall(dense_block_multiply(system->E, W, product));
  PetscCall(krylov_basis_inner(basis, product, inner));
  PetscCall(small_multiply('N', 'N', k, r, r, -1.0, inner, model->Q, 0.0, right));
  for (PetscInt j = 0; j < r; j++)
    for (PetscInt i = 0; i < k; i++) right[i + j * k] *= model->lambda[j];
  PetscCall(dense_block_multiply(system->K, W, product));
  PetscCall(krylov_basis_inner(basis, product, inner));
  PetscCall(small_multiply('N', 'N', k, r, r, 1.0, inner, model->Q, 1.0, right));
  PetscCall(MatDestroy(&product));
  PetscCall(PetscFree(inner));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* c^T from K V - E V K_r = R_0 c^T by least squares with the weight diag(E)^-1: W = diag(E)^-1 R_0,
 * (W^T R_0) c^T = (K W)^T V - (E W)^T V K_r, all in modes; and S^T of what is left of the equation. */
static PetscErrorCode coupling(Residual *residual, const KrylovBasis *basis, const ModalModel *model)
{
  const PetscInt p = residual->p, r = residual->r, k = RESIDUAL_PROBES, both = p + k;
  Mat W;
  PetscReal *gram, *right, *square, *of_probes;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc4((size_t)both * (size_t)p, &gram, (size_t)both * (size_t)r, &right, (size_t)p * (size_t)p,
                         &square, (size_t)k * (size_t)p, &of_probes));
  PetscCall(test_vectors(residual, &W));
  PetscCall(test(residual, basis, model, W, right, gram));
  PetscCall(MatDestroy(&W));
  for (PetscInt j = 0; j < p; j++) {
    PetscCall(PetscArraycpy(square + j * p, gram + j * both, (size_t)p));
    PetscCall(PetscArraycpy(of_probes + j * k, gram + j * both + p, (size_t)k));
  }
  for (PetscInt j = 0; j < r; j++) {
    PetscCall(PetscArraycpy(residual->c + (size_t)j * (size_t)p, right + (size_t)j * (size_t)both, (size_t)p));
    PetscCall(PetscArraycpy(residual->left + (size_t)j * (size_t)k, right + (size_t)j * (size_t)both + p, (size_t)k));
  }
  PetscCall(solve_small(model->comm, p, r, square, residual->c)); // [p x r] = c row-major
  PetscCall(small_multiply('N', 'N', k, r, p, -1.0, of_probes, residual->c, 1.0, residual->left));
  PetscCall(PetscFree4(gram, right, square, of_probes));
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
  PetscCall(PetscMalloc1((size_t)basis->r * (size_t)RESIDUAL_PROBES, &residual->left));
  PetscCall(constant_factor(residual, basis));
  PetscCall(coupling(residual, basis, model));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void residual_modal_state(const ModalModel *model, PetscReal w, int part, PetscReal *x)
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
    residual_modal_state(model, w, part, x);
    PetscCall(small_multiply('N', 'T', p, p, model->r, -1.0, residual->c, x, 0.0, Phi));
    for (PetscInt l = 0; part == 0 && l < p; l++) Phi[l + l * p] += 1.0;
  }
  PetscCall(PetscFree(x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void make_symmetric(PetscInt k, PetscReal *A)
{
  for (PetscInt j = 0; j < k; j++)
    for (PetscInt i = 0; i < j; i++) A[i + j * k] = A[j + i * k] = 0.5 * (A[i + j * k] + A[j + i * k]);
}

/* With M Z = X - d:  X^T M^-1 X = X^T Z + d^T Z + d^T M^-1 d, and M >= w E >= w RESIDUAL_DIAGONAL_SHARE diag(E). */
PetscErrorCode residual_energy_of(const ThermalSystem *system, ShiftedSolver *solver, Mat X, PetscReal *G,
                                  PetscReal *plain, PetscReal *heat)
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
  if (heat) PetscCall(dense_block_inner(d, Z, heat));
  PetscCall(MatScale(d, -w));
  PetscCall(dense_block_multiply(system->K, Z, product));
  PetscCall(subtract(d, product));
  for (PetscInt c = 0; c < k; c++) part[c] = 1.0;
  PetscCall(dense_block_axpby(d, 1.0, part, X));
  PetscCall(dense_block_inner(d, Z, part));
  for (PetscInt i = 0; i < k * k; i++) G[i] += part[i];
  make_symmetric(k, G);
  if (plain) PetscCall(PetscArraycpy(plain, G, (size_t)k * (size_t)k));
  if (heat) make_symmetric(k, heat);
  PetscCall(dense_block_copy(product, 0, d, NULL, k));
  PetscCall(residual_scale_by_diagonal(system, -1.0, product));
  PetscCall(dense_block_inner(d, product, part));
  make_symmetric(k, part);
  for (PetscInt i = 0; i < k * k; i++) G[i] += part[i] / (w * RESIDUAL_DIAGONAL_SHARE);
  PetscCall(MatDestroy(&Z));
  PetscCall(MatDestroy(&d));
  PetscCall(MatDestroy(&product));
  PetscCall(PetscFree(part));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode residual_energy(const Residual *residual, ShiftedSolver *solver, PetscReal w, PetscReal *G,
                               PetscReal *plain, PetscReal *heat)
{
  PetscFunctionBeginUser;
  PetscCall(shifted_solver_set_shift(solver, w, residual->p));
  PetscCall(residual_energy_of(residual->system, solver, residual->R0, G, plain, heat));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode residual_destroy(Residual **residual)
{
  PetscFunctionBeginUser;
  if (!*residual) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatDestroy(&(*residual)->R0));
  PetscCall(PetscFree((*residual)->c));
  PetscCall(PetscFree((*residual)->left));
  PetscCall(PetscFree(*residual));
  PetscFunctionReturn(PETSC_SUCCESS);
}
