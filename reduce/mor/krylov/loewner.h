/* loewner.h - Galerkin projection on a rational Krylov space from moments alone, without its vectors.
 *
 * With X_a = [M^-1 E]^(a-1) M^-1 ports at shift s (M = s E + K) and Y_b likewise at t, the resolvent identity
 *   M_s^-1 E M_t^-1 = (M_s^-1 - M_t^-1)/(t - s)
 * gives f(a, b) = X_a^T E Y_b = (f(a, b - 1) - f(a - 1, b))/(t - s) from f(a, 0) = ports^T X_a and f(0, b); for s = t
 * it is the moment a + b - 1 there. K follows from K Y_b = E Y_(b-1) - t E Y_b, E Y_0 = ports.
 * Reference: Mayo & Antoulas 2007, Linear Algebra Appl. 425, 634 (Loewner matrices).
 * The moments must be exact to many digits: the vectors are nearly dependent. */
#ifndef REDUCE_MOR_KRYLOV_LOEWNER_H
#define REDUCE_MOR_KRYLOV_LOEWNER_H

#include "reduce/mor/krylov/shift_blocks.h"

typedef struct LoewnerModel { // in an orthonormal basis V = [1, X_1, X_2, ..] T
  PetscInt r, n_raw, p;
  PetscReal *T;        // [n_raw x r] column-major
  PetscReal *K;        // [r x r] V^T K V, 1/s
  PetscReal *inputs;   // [r x p] row-major V^T ports
  PetscReal *constant; // [r] V^T E 1
} LoewnerModel;

/* capacity: 1^T E 1, J/K; losses: 1^T K 1, W/K; deflation: a direction smaller
 * than this, of a vector of length 1, is dropped. Every rank gets the same. */
PetscErrorCode loewner_project(const ShiftBlocks *blocks, PetscReal capacity, PetscReal losses, PetscReal deflation,
                               LoewnerModel **model);
PetscErrorCode loewner_destroy(LoewnerModel **model);

#endif
