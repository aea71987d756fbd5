/* krylov_basis_private.h - what the basis in vectors and the basis in blocks share. */
#ifndef REDUCE_MOR_KRYLOV_KRYLOV_BASIS_PRIVATE_H
#define REDUCE_MOR_KRYLOV_KRYLOV_BASIS_PRIVATE_H

#include "reduce/mor/krylov/krylov_basis.h"

/* What does not depend on how the vectors are kept. */
PetscErrorCode krylov_basis_set_problem(const ThermalSystem *system, Mat ports, PetscReal deflation,
                                        KrylovBasis *basis);
/* Of a basis in blocks, as krylov_basis_combine: Y = [1, X_1, ..] (T Q) */
PetscErrorCode krylov_basis_stored_combine(const KrylovBasis *basis, const PetscReal *Q, Mat Y);
/* As krylov_basis_inner: (Y^T [1, X_1, ..]) T */
PetscErrorCode krylov_basis_stored_inner(const KrylovBasis *basis, Mat Y, PetscReal *G);
/* As krylov_basis_rows. */
PetscErrorCode krylov_basis_stored_rows(const KrylovBasis *basis, PetscInt k, const PetscReal *Q, PetscInt n,
                                        const PetscInt *row, PetscReal *rows);
/* rows += X(row, :) Q, Q [p x k] with ldq rows; rows [n x k] row-major, which is [k x n] */
PetscErrorCode krylov_basis_add_rows(Mat X, const PetscReal *Q, PetscInt ldq, PetscInt k, PetscInt n,
                                     const PetscInt *row, PetscReal *rows);

#endif
