/* small_dense.h - small symmetric eigenproblems and products, the same on every rank. Matrices column-major. */
#ifndef REDUCE_LINEAR_SMALL_DENSE_H
#define REDUCE_LINEAR_SMALL_DENSE_H

#include <petscsys.h>

/* A [n x n] symmetric becomes its eigenvectors, w [n] its eigenvalues ascending. Rank 0 computes, so that every rank
 * holds the same bits whatever its processor. */
PetscErrorCode small_eigen(MPI_Comm comm, PetscInt n, PetscReal *A, PetscReal *w);
/* C = alpha op(A) op(B) + beta C, [rows x columns], `inner` summed; leading dimensions are those of tight arrays. */
PetscErrorCode small_multiply(char op_A, char op_B, PetscInt rows, PetscInt columns, PetscInt inner, PetscReal alpha,
                              const PetscReal *A, const PetscReal *B, PetscReal beta, PetscReal *C);
/* Largest eigenvalue of the Hermitian matrix P + iS (P symmetric, S antisymmetric), both [n x n]. */
PetscErrorCode small_hermitian_largest(MPI_Comm comm, PetscInt n, const PetscReal *P, const PetscReal *S,
                                       PetscReal *largest);

#endif
