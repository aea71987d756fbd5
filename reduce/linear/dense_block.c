#include "reduce/linear/dense_block.h"

#include <petscblaslapack.h>

#include "reduce/petsc/petsc_compat.h"

/* A block's numbers on this rank, column c at x + c * ld. */
typedef struct Columns {
  PetscScalar *x;
  PetscInt n, k, ld;
} Columns;

static PetscErrorCode columns_get(Mat X, Columns *columns)
{
  PetscFunctionBeginUser;
  PetscCall(MatGetLocalSize(X, &columns->n, NULL));
  PetscCall(MatGetSize(X, NULL, &columns->k));
  PetscCall(MatDenseGetLDA(X, &columns->ld));
  PetscCall(MatDenseGetArray(X, &columns->x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode columns_restore(Mat X, Columns *columns)
{
  PetscFunctionBeginUser;
  PetscCall(MatDenseRestoreArray(X, &columns->x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode dense_block_create(Mat A, PetscInt k, Mat *X)
{
  PetscInt n_local, n;

  PetscFunctionBeginUser;
  PetscCall(MatGetLocalSize(A, &n_local, NULL));
  PetscCall(MatGetSize(A, &n, NULL));
  PetscCall(MatCreateDense(PetscObjectComm((PetscObject)A), n_local, PETSC_DECIDE, n, k, NULL, X));
  PetscCall(MatAssemblyBegin(*X, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*X, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode dense_block_multiply(Mat A, Mat X, Mat Y)
{
  PetscFunctionBeginUser;
  PetscCall(MatProductCreateWithMat(A, X, NULL, Y));
  PetscCall(MatProductSetType(Y, MATPRODUCT_AB));
  PetscCall(MatProductSetFromOptions(Y));
  PetscCall(MatProductSymbolic(Y));
  PetscCall(MatProductNumeric(Y));
  PetscCall(MatProductClear(Y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode dense_block_dots(Mat X, Mat Y, PetscReal *dots)
{
  Columns x, y;

  PetscFunctionBeginUser;
  PetscCall(columns_get(X, &x));
  if (X == Y)
    y = x;
  else
    PetscCall(columns_get(Y, &y));
  for (PetscInt c = 0; c < x.k; c++) {
    const PetscScalar *a = x.x + (size_t)c * (size_t)x.ld, *b = y.x + (size_t)c * (size_t)y.ld;
    PetscReal sum[4] = {0.0, 0.0, 0.0, 0.0}; // four chains: the processor adds them side by side
    PetscInt i = 0;
    for (; i + 4 <= x.n; i += 4)
      for (PetscInt lane = 0; lane < 4; lane++) sum[lane] += a[i + lane] * b[i + lane];
    for (; i < x.n; i++) sum[0] += a[i] * b[i];
    dots[c] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, dots, (int)x.k, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)X)));
  if (X != Y) PetscCall(columns_restore(Y, &y));
  PetscCall(columns_restore(X, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode dense_block_axpby(Mat Y, PetscReal beta, const PetscReal *alpha, Mat X)
{
  Columns x, y;

  PetscFunctionBeginUser;
  PetscCall(columns_get(X, &x));
  PetscCall(columns_get(Y, &y));
  for (PetscInt c = 0; c < x.k; c++) {
    const PetscScalar *from = x.x + (size_t)c * (size_t)x.ld;
    PetscScalar *to = y.x + (size_t)c * (size_t)y.ld;
    for (PetscInt i = 0; i < x.n; i++) to[i] = beta * to[i] + alpha[c] * from[i];
  }
  PetscCall(columns_restore(Y, &y));
  PetscCall(columns_restore(X, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode dense_block_aypx(Mat Y, const PetscReal *beta, Mat X)
{
  Columns x, y;

  PetscFunctionBeginUser;
  PetscCall(columns_get(X, &x));
  PetscCall(columns_get(Y, &y));
  for (PetscInt c = 0; c < x.k; c++) {
    const PetscScalar *from = x.x + (size_t)c * (size_t)x.ld;
    PetscScalar *to = y.x + (size_t)c * (size_t)y.ld;
    for (PetscInt i = 0; i < x.n; i++) to[i] = from[i] + beta[c] * to[i];
  }
  PetscCall(columns_restore(Y, &y));
  PetscCall(columns_restore(X, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode dense_block_scale(Mat X, const PetscReal *factor)
{
  Columns x;

  PetscFunctionBeginUser;
  PetscCall(columns_get(X, &x));
  for (PetscInt c = 0; c < x.k; c++) {
    PetscScalar *of_column = x.x + (size_t)c * (size_t)x.ld;
    for (PetscInt i = 0; i < x.n; i++) of_column[i] *= factor[c];
  }
  PetscCall(columns_restore(X, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode dense_block_inner(Mat X, Mat Y, PetscReal *G)
{
  Columns x, y;
  PetscBLASInt n, kx, ky, ldx, ldy;
  const PetscScalar one = 1.0, zero = 0.0;

  PetscFunctionBeginUser;
  PetscCall(columns_get(X, &x));
  if (X == Y)
    y = x;
  else
    PetscCall(columns_get(Y, &y));
  PetscCall(PetscBLASIntCast(x.n, &n));
  PetscCall(PetscBLASIntCast(x.k, &kx));
  PetscCall(PetscBLASIntCast(y.k, &ky));
  PetscCall(PetscBLASIntCast(PetscMax(x.ld, 1), &ldx));
  PetscCall(PetscBLASIntCast(PetscMax(y.ld, 1), &ldy));
  PetscCallBLAS("BLASgemm", BLASgemm_("T", "N", &kx, &ky, &n, &one, x.x, &ldx, y.x, &ldy, &zero, G, &kx));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, G, (int)(x.k * y.k), MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)X)));
  if (X != Y) PetscCall(columns_restore(Y, &y));
  PetscCall(columns_restore(X, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode dense_block_combine(Mat Y, PetscReal beta, PetscReal alpha, Mat X, const PetscReal *Q, PetscInt ldq)
{
  Columns x, y;
  PetscBLASInt n, kx, ky, ldx, ldy, ldQ;

  PetscFunctionBeginUser;
  PetscCall(columns_get(X, &x));
  PetscCall(columns_get(Y, &y));
  PetscCall(PetscBLASIntCast(x.n, &n));
  PetscCall(PetscBLASIntCast(x.k, &kx));
  PetscCall(PetscBLASIntCast(y.k, &ky));
  PetscCall(PetscBLASIntCast(PetscMax(x.ld, 1), &ldx));
  PetscCall(PetscBLASIntCast(PetscMax(y.ld, 1), &ldy));
  PetscCall(PetscBLASIntCast(ldq, &ldQ));
  PetscCallBLAS("BLASgemm", BLASgemm_("N", "N", &n, &ky, &kx, &alpha, x.x, &ldx, Q, &ldQ, &beta, y.x, &ldy));
  PetscCall(columns_restore(Y, &y));
  PetscCall(columns_restore(X, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode dense_block_copy(Mat Y, PetscInt to, Mat X, const PetscInt *column, PetscInt k)
{
  Columns x, y;

  PetscFunctionBeginUser;
  PetscCall(columns_get(X, &x));
  PetscCall(columns_get(Y, &y));
  for (PetscInt c = 0; c < k; c++) {
    const PetscInt from = column ? column[c] : c;
    PetscCall(PetscArraycpy(y.x + (size_t)(to + c) * (size_t)y.ld, x.x + (size_t)from * (size_t)x.ld, (size_t)x.n));
  }
  PetscCall(columns_restore(Y, &y));
  PetscCall(columns_restore(X, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}
