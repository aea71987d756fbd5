/* krylov_basis.h - an E-orthonormal basis V of the reduction space, grown block by block, and the mould seen in it.
 *
 * The constant temperature 1 is the first vector, so that the heat stored, 1^T E V z, is exact whatever follows. */
#ifndef REDUCE_MOR_KRYLOV_BASIS_H
#define REDUCE_MOR_KRYLOV_BASIS_H

#include <slepcbv.h>

#include "reduce/fem/thermal_system.h"

typedef struct KrylovBasis {
  const ThermalSystem *system;    // borrowed
  Mat ports;                      // [n x p] borrowed: the columns through which heat enters, see ports.h
  BV V;                           // [n x capacity] owned; the first r columns are in use, with V^T E V = I
  PetscInt r, p, capacity, width; // width: largest block that may be added
  PetscReal deflation;            // a direction smaller than this, of a vector of length 1, is dropped
  PetscReal *K;                   // [r x r] V^T K V, column-major with `capacity` rows, 1/s
  PetscReal *inputs;              // [r x p] row-major: V^T ports
  PetscReal *constant;            // [r] V^T E 1
  BV W;                           // [n x width] the block being added; owned
  Mat work;                       // [n x width] owned
  Vec E_one;                      // E 1, owned
} KrylovBasis;

PetscErrorCode krylov_basis_create(const ThermalSystem *system, Mat ports, PetscInt capacity, PetscInt width,
                                   PetscReal deflation, KrylovBasis **basis);
/* The block [n x k] to be filled with new vectors, k <= width; hand it back with krylov_basis_add. */
PetscErrorCode krylov_basis_get_block(KrylovBasis *basis, PetscInt k, Mat *X);
/* Orthonormalise the block against V and in itself, drop what depends on the rest, append; X becomes NULL.
 *   kept  out: vectors appended, the last ones of V. Grows the capacity where needed. */
PetscErrorCode krylov_basis_add(KrylovBasis *basis, Mat *X, PetscInt *kept);
PetscErrorCode krylov_basis_destroy(KrylovBasis **basis);

#endif
