/* model_basis.h - where the reduced model's vectors are, and single rows of them. */
#ifndef REDUCE_MOR_KRYLOV_MODEL_BASIS_H
#define REDUCE_MOR_KRYLOV_MODEL_BASIS_H

#include "reduce/mor/krylov/krylov_basis.h"

typedef struct ModelBasis { // borrowed
  BV V;                     // [n x r] in modal form; NULL: not made, but
  const KrylovBasis *basis; // the basis that the model was made in
  const PetscReal *modes;   // [basis->r x r] the model's states in it
  PetscInt r;
} ModelBasis;

/* Rows of the modal basis, rows [n x r] row-major. With blocks each is read once. Collective.
 *   row  [n] local numbers */
PetscErrorCode model_basis_rows(const ModelBasis *basis, PetscInt n, const PetscInt *row, float *rows);
/* max |V^T E V - I| of the basis' modes; of a large one, over a sample of 64 of its columns.
 *   modes  [basis->r x r] */
PetscErrorCode model_basis_orthogonality(const KrylovBasis *basis, PetscInt r, const PetscReal *modes,
                                         PetscReal *defect);

#endif
