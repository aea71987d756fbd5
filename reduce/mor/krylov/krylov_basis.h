/* krylov_basis.h - an E-orthonormal basis V of the reduction space, grown block by block, and the mould seen in it.
 *
 * A basis of many inputs is not kept as such: V = [1, X_1, X_2, ..] T, the blocks X as they were solved for, on disk or
 * in memory, and all that is small from their moments (loewner.h).
 *
 * The constant temperature 1 is the first vector, so that the heat stored, 1^T E V z, is exact whatever follows. */
#ifndef REDUCE_MOR_KRYLOV_KRYLOV_BASIS_H
#define REDUCE_MOR_KRYLOV_KRYLOV_BASIS_H

#include <slepcbv.h>

#include "reduce/fem/thermal_system.h"
#include "reduce/mor/krylov/loewner.h"

typedef struct KrylovBasis {
  const ThermalSystem *system;    // borrowed
  Mat ports;                      // [n x p] borrowed: the columns through which heat enters, see ports.h
  BV V;                           // [n x capacity] owned; the first r columns are in use, with V^T E V = I
                                  // NULL: in blocks
  PetscInt r, p, capacity, width; // width: largest block that may be added
  PetscReal deflation;            // a direction smaller than this, of a vector of length 1, is dropped
  PetscReal *K;                   // [r x r] V^T K V, column-major with `capacity` rows, 1/s
  PetscReal *inputs;              // [r x p] row-major: V^T ports
  PetscReal *constant;            // [r] V^T E 1
  BV W;                           // [n x width] the block being added; owned
  Mat work;                       // [n x width] owned
  Vec E_one, K_one;               // E 1 and K 1, owned
  ShiftBlocks *blocks;            // owned; NULL: V is there
  LoewnerModel *raw;              // with blocks: T; owned
} KrylovBasis;

PetscErrorCode krylov_basis_create(const ThermalSystem *system, Mat ports, PetscInt capacity, PetscInt width,
                                   PetscReal deflation, KrylovBasis **basis);
/* The block [n x k] to be filled with new vectors, k <= width; hand it back with krylov_basis_add. */
PetscErrorCode krylov_basis_get_block(KrylovBasis *basis, PetscInt k, Mat *X);
/* Orthonormalise the block against V and in itself, drop what depends on the rest, append; X becomes NULL.
 *   kept  out: vectors appended, the last ones of V. Grows the capacity where needed. */
PetscErrorCode krylov_basis_add(KrylovBasis *basis, Mat *X, PetscInt *kept);
/* A basis in blocks, without vectors yet. folder, signature: see shift_blocks.h. */
PetscErrorCode krylov_basis_create_stored(const ThermalSystem *system, Mat ports, const char *folder,
                                          const char *signature, PetscReal deflation, KrylovBasis **basis);
/* Take the blocks that are complete into the basis: r, K, inputs, constant. */
PetscErrorCode krylov_basis_project_stored(KrylovBasis *basis);
/* Y = V Q, Q [r x k] column-major. */
PetscErrorCode krylov_basis_combine(const KrylovBasis *basis, const PetscReal *Q, Mat Y);
/* G = Y^T V, [k x r] column-major. */
PetscErrorCode krylov_basis_inner(const KrylovBasis *basis, Mat Y, PetscReal *G);
/* Rows of V Q, Q [r x k] column-major; with blocks each is read once. rows [n x k] row-major.
 *   row  [n] local numbers */
PetscErrorCode krylov_basis_rows(const KrylovBasis *basis, PetscInt k, const PetscReal *Q, PetscInt n,
                                 const PetscInt *row, PetscReal *rows);
/* V Q, Q [r x k] column-major, as a BV of its own; V is gone. Not of a basis in blocks. */
PetscErrorCode krylov_basis_take(KrylovBasis *basis, PetscInt k, const PetscReal *Q, BV *taken);
PetscErrorCode krylov_basis_destroy(KrylovBasis **basis);

#endif
