#include "reduce/mor/krylov/model_basis.h"

#include "reduce/linear/dense_block.h"
#include "reduce/linear/small_dense.h"
#include "reduce/petsc/petsc_compat.h"

static PetscErrorCode rows_of_vectors(const ModelBasis *basis, PetscInt n, const PetscInt *row, float *rows)
{
  const size_t r = (size_t)basis->r;
  Vec column;
  const PetscScalar *value;

  PetscFunctionBeginUser;
  for (PetscInt k = 0; k < basis->r; k++) {
    PetscCall(BVGetColumn(basis->V, k, &column));
    PetscCall(VecGetArrayRead(column, &value));
    for (PetscInt i = 0; i < n; i++) rows[(size_t)i * r + (size_t)k] = (float)value[row[i]];
    PetscCall(VecRestoreArrayRead(column, &value));
    PetscCall(BVRestoreColumn(basis->V, k, &column));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sums are in double: large parts of the vectors may cancel. */
static PetscErrorCode rows_of_modes(const ModelBasis *basis, PetscInt n, const PetscInt *row, float *rows)
{
  const size_t size = (size_t)n * (size_t)basis->r;
  PetscReal *sum;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1(size, &sum));
  PetscCall(krylov_basis_rows(basis->basis, basis->r, basis->modes, n, row, sum));
  for (size_t i = 0; i < size; i++) rows[i] = (float)sum[i];
  PetscCall(PetscFree(sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode model_basis_rows(const ModelBasis *basis, PetscInt n, const PetscInt *row, float *rows)
{
  PetscFunctionBeginUser;
  if (basis->V)
    PetscCall(rows_of_vectors(basis, n, row, rows));
  else
    PetscCall(rows_of_modes(basis, n, row, rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Columns first, first + stride, .. of the modes, k of them, against all. */
static PetscErrorCode compare_columns(const KrylovBasis *basis, PetscInt r, const PetscReal *modes, PetscInt k,
                                      const PetscInt *column, PetscReal *defect)
{
  const size_t of_basis = (size_t)basis->r;
  PetscReal *chosen, *inner, *G;
  Mat X, EX;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc3(of_basis * (size_t)k, &chosen, of_basis * (size_t)k, &inner, (size_t)r * (size_t)k, &G));
  PetscCall(dense_block_create(basis->system->E, k, &X));
  PetscCall(dense_block_create(basis->system->E, k, &EX));
  for (PetscInt c = 0; c < k; c++)
    PetscCall(PetscArraycpy(chosen + (size_t)c * of_basis, modes + (size_t)column[c] * of_basis, of_basis));
  PetscCall(krylov_basis_combine(basis, chosen, X));
  PetscCall(dense_block_multiply(basis->system->E, X, EX));
  PetscCall(krylov_basis_inner(basis, EX, inner)); // [k x basis->r]
  PetscCall(small_multiply('N', 'N', k, r, basis->r, 1.0, inner, modes, 0.0, G));
  for (PetscInt i = 0; i < r; i++)
    for (PetscInt c = 0; c < k; c++)
      *defect = PetscMax(*defect, PetscAbsReal(G[(size_t)c + (size_t)i * (size_t)k] - (i == column[c] ? 1.0 : 0.0)));
  PetscCall(MatDestroy(&X));
  PetscCall(MatDestroy(&EX));
  PetscCall(PetscFree3(chosen, inner, G));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode model_basis_orthogonality(const KrylovBasis *basis, PetscInt r, const PetscReal *modes,
                                         PetscReal *defect)
{
  enum { WIDTH = 64 };
  const PetscInt k = PetscMin(WIDTH, r);
  PetscInt column[WIDTH];

  PetscFunctionBeginUser;
  *defect = 0.0;
  for (PetscInt c = 0; c < k; c++) column[c] = k > 1 ? (PetscInt)((PetscInt64)c * (r - 1) / (k - 1)) : 0;
  PetscCall(compare_columns(basis, r, modes, k, column, defect));
  PetscFunctionReturn(PETSC_SUCCESS);
}
