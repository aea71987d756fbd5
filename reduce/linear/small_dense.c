#include "reduce/linear/small_dense.h"

#include <petscblaslapack.h>
#include <slepcblaslapack.h>

#include "reduce/petsc/collective.h"
#include "reduce/petsc/petsc_compat.h"

/* job 'V': with eigenvectors, 'N': without */
static PetscErrorCode eigen_here(const char *job, PetscInt n, PetscReal *A, PetscReal *w)
{
  PetscBLASInt size, info, length = -1, integer_length = -1, first_integer, *integer_work;
  PetscReal first, *work;

  PetscFunctionBeginUser;
  PetscCall(PetscBLASIntCast(n, &size));
  PetscCallBLAS("LAPACKsyevd",
                LAPACKsyevd_(job, "L", &size, A, &size, w, &first, &length, &first_integer, &integer_length, &info));
  PetscCall(PetscBLASIntCast((PetscInt)first, &length));
  integer_length = first_integer;
  PetscCall(PetscMalloc2((size_t)length, &work, (size_t)integer_length, &integer_work));
  PetscCallBLAS("LAPACKsyevd",
                LAPACKsyevd_(job, "L", &size, A, &size, w, work, &length, integer_work, &integer_length, &info));
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK syevd on a %" PetscInt_FMT " matrix: info = %d", n,
             (int)info);
  PetscCall(PetscFree2(work, integer_work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode small_eigen(MPI_Comm comm, PetscInt n, PetscReal *A, PetscReal *w)
{
  PetscMPIInt rank;

  PetscFunctionBeginUser;
  if (n == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) PetscCall(eigen_here("V", n, A, w));
  PetscCall(collective_wait(comm));
  PetscCallMPI(MPI_Bcast(w, (int)n, MPIU_REAL, 0, comm));
  for (PetscInt c = 0; c < n; c++) // by column: n * n may exceed what an int counts
    PetscCallMPI(MPI_Bcast(A + (size_t)c * (size_t)n, (int)n, MPIU_REAL, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode small_multiply(char op_A, char op_B, PetscInt rows, PetscInt columns, PetscInt inner, PetscReal alpha,
                              const PetscReal *A, const PetscReal *B, PetscReal beta, PetscReal *C)
{
  PetscBLASInt m, n, k, lda, ldb, ldc;

  PetscFunctionBeginUser;
  if (rows == 0 || columns == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscBLASIntCast(rows, &m));
  PetscCall(PetscBLASIntCast(columns, &n));
  PetscCall(PetscBLASIntCast(inner, &k));
  lda = PetscMax(op_A == 'N' ? m : k, 1);
  ldb = PetscMax(op_B == 'N' ? k : n, 1);
  ldc = m;
  PetscCallBLAS("BLASgemm", BLASgemm_(&op_A, &op_B, &m, &n, &k, &alpha, A, &lda, B, &ldb, &beta, C, &ldc));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* P + iS and the real symmetric [[P, -S], [S, P]] have the same eigenvalues, the latter each twice. */
PetscErrorCode small_hermitian_largest(MPI_Comm comm, PetscInt n, const PetscReal *P, const PetscReal *S,
                                       PetscReal *largest)
{
  PetscMPIInt rank;
  PetscReal *A, *w;
  const size_t size = (size_t)n, twice = 2 * size;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc2(twice * twice, &A, twice, &w));
  for (size_t j = 0; j < size; j++)
    for (size_t i = 0; i < size; i++) {
      A[i + j * twice] = A[(i + size) + (j + size) * twice] = P[i + j * size];
      A[(i + size) + j * twice] = S[i + j * size];
      A[i + (j + size) * twice] = -S[i + j * size];
    }
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) PetscCall(eigen_here("N", 2 * n, A, w));
  PetscCall(collective_wait(comm));
  PetscCallMPI(MPI_Bcast(w, (int)twice, MPIU_REAL, 0, comm));
  *largest = w[twice - 1];
  PetscCall(PetscFree2(A, w));
  PetscFunctionReturn(PETSC_SUCCESS);
}
