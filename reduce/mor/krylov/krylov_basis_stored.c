/* krylov_basis_stored.c - the basis in blocks: small matrices from moments, products with V through its factors. */
#include "reduce/linear/dense_block.h"
#include "reduce/linear/small_dense.h"
#include "reduce/mor/krylov/krylov_basis_private.h"
#include "reduce/petsc/petsc_compat.h"

PetscErrorCode krylov_basis_create_stored(const ThermalSystem *system, Mat ports, const char *folder,
                                          const char *signature, PetscReal deflation, KrylovBasis **out)
{
  KrylovBasis *basis;

  PetscFunctionBeginUser;
  PetscCall(PetscNew(&basis));
  *out = basis;
  PetscCall(krylov_basis_set_problem(system, ports, deflation, basis));
  PetscCall(shift_blocks_create(system->E, basis->p, folder, signature, &basis->blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode krylov_basis_project_stored(KrylovBasis *basis)
{
  LoewnerModel *raw;
  PetscReal capacity, losses;

  PetscFunctionBeginUser;
  PetscCall(loewner_destroy(&basis->raw));
  PetscCall(VecSum(basis->E_one, &capacity));
  PetscCall(VecSum(basis->K_one, &losses));
  PetscCall(loewner_project(basis->blocks, capacity, losses, basis->deflation, &basis->raw));
  raw = basis->raw;
  basis->r = basis->capacity = raw->r;
  PetscCall(PetscFree3(basis->K, basis->inputs, basis->constant));
  PetscCall(PetscMalloc3((size_t)raw->r * (size_t)raw->r, &basis->K, (size_t)raw->r * (size_t)raw->p, &basis->inputs,
                         (size_t)raw->r, &basis->constant));
  PetscCall(PetscArraycpy(basis->K, raw->K, (size_t)raw->r * (size_t)raw->r));
  PetscCall(PetscArraycpy(basis->inputs, raw->inputs, (size_t)raw->r * (size_t)raw->p));
  PetscCall(PetscArraycpy(basis->constant, raw->constant, (size_t)raw->r));
  PetscCall(PetscFree(raw->K)); // they live in the basis now
  PetscCall(PetscFree(raw->inputs));
  PetscCall(PetscFree(raw->constant));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode krylov_basis_stored_combine(const KrylovBasis *basis, const PetscReal *Q, Mat Y)
{
  const PetscInt n_raw = basis->raw->n_raw, p = basis->p;
  PetscInt k;
  PetscReal *TQ;

  PetscFunctionBeginUser;
  PetscCall(MatGetSize(Y, NULL, &k));
  PetscCall(PetscMalloc1((size_t)n_raw * (size_t)k, &TQ));
  PetscCall(small_multiply('N', 'N', n_raw, k, basis->r, 1.0, basis->raw->T, Q, 0.0, TQ));
  for (PetscInt c = 0; c < k; c++) {
    Vec column;
    PetscCall(MatDenseGetColumnVecWrite(Y, c, &column));
    PetscCall(VecSet(column, TQ[(size_t)c * (size_t)n_raw]));
    PetscCall(MatDenseRestoreColumnVecWrite(Y, c, &column));
  }
  for (PetscInt i = 0; i < basis->blocks->n; i++) {
    Mat X;
    PetscCall(shift_blocks_get(basis->blocks, i, &X));
    PetscCall(dense_block_combine(Y, 1.0, 1.0, X, TQ + 1 + i * p, n_raw));
  }
  PetscCall(PetscFree(TQ));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode krylov_basis_stored_inner(const KrylovBasis *basis, Mat Y, PetscReal *G)
{
  const PetscInt n_raw = basis->raw->n_raw, p = basis->p;
  PetscInt k;
  PetscReal *of_raw;
  Mat ones;

  PetscFunctionBeginUser;
  PetscCall(MatGetSize(Y, NULL, &k));
  PetscCall(PetscMalloc1((size_t)n_raw * (size_t)k, &of_raw));
  PetscCall(dense_block_create(basis->system->E, 1, &ones));
  Vec column;
  PetscCall(MatDenseGetColumnVecWrite(ones, 0, &column));
  PetscCall(VecSet(column, 1.0));
  PetscCall(MatDenseRestoreColumnVecWrite(ones, 0, &column));
  PetscCall(dense_block_inner(Y, ones, of_raw));
  PetscCall(MatDestroy(&ones));
  for (PetscInt i = 0; i < basis->blocks->n; i++) {
    Mat X;
    PetscCall(shift_blocks_get(basis->blocks, i, &X));
    PetscCall(dense_block_inner(Y, X, of_raw + (size_t)k * (size_t)(1 + i * p)));
  }
  PetscCall(small_multiply('N', 'N', k, basis->r, n_raw, 1.0, of_raw, basis->raw->T, 0.0, G));
  PetscCall(PetscFree(of_raw));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode krylov_basis_add_rows(Mat X, const PetscReal *Q, PetscInt ldq, PetscInt k, PetscInt n,
                                     const PetscInt *row, PetscReal *rows)
{
  const PetscScalar *value;
  PetscInt p, ld;
  PetscReal *chosen, *part;

  PetscFunctionBeginUser;
  PetscCall(MatGetSize(X, NULL, &p));
  PetscCall(MatDenseGetLDA(X, &ld));
  PetscCall(PetscMalloc2((size_t)n * (size_t)p, &chosen, (size_t)p * (size_t)k, &part));
  PetscCall(MatDenseGetArrayRead(X, &value));
  for (size_t l = 0; l < (size_t)p; l++)
    for (size_t i = 0; i < (size_t)n; i++) chosen[i + l * (size_t)n] = value[(size_t)row[i] + l * (size_t)ld];
  PetscCall(MatDenseRestoreArrayRead(X, &value));
  for (PetscInt c = 0; c < k; c++)
    PetscCall(PetscArraycpy(part + (size_t)c * (size_t)p, Q + (size_t)c * (size_t)ldq, (size_t)p));
  PetscCall(small_multiply('T', 'T', k, n, p, 1.0, part, chosen, 1.0, rows));
  PetscCall(PetscFree2(chosen, part));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode krylov_basis_stored_rows(const KrylovBasis *basis, PetscInt k, const PetscReal *Q, PetscInt n,
                                        const PetscInt *row, PetscReal *rows)
{
  const PetscInt n_raw = basis->raw->n_raw, p = basis->p;
  PetscReal *TQ;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)n_raw * (size_t)k, &TQ));
  PetscCall(small_multiply('N', 'N', n_raw, k, basis->r, 1.0, basis->raw->T, Q, 0.0, TQ));
  for (size_t i = 0; i < (size_t)n; i++)
    for (size_t c = 0; c < (size_t)k; c++) rows[i * (size_t)k + c] = TQ[c * (size_t)n_raw];
  for (PetscInt i = 0; i < basis->blocks->n; i++) {
    Mat X;
    PetscCall(shift_blocks_get(basis->blocks, i, &X));
    PetscCall(krylov_basis_add_rows(X, TQ + 1 + i * p, n_raw, k, n, row, rows));
  }
  PetscCall(PetscFree(TQ));
  PetscFunctionReturn(PETSC_SUCCESS);
}
