/* shift_blocks.h - the raw vectors of a rational Krylov space, one block [n x p] for each solve, in memory or as files
 * in a folder: a basis of many inputs is larger than the memory, and what is on disk survives an interruption.
 *
 * A folder holds block-I.RANK (the rank's rows, column by column), moments-I (what is known of a shift), and
 * `manifest`: the problem's signature and the shifts that are complete. */
#ifndef REDUCE_MOR_KRYLOV_SHIFT_BLOCKS_H
#define REDUCE_MOR_KRYLOV_SHIFT_BLOCKS_H

#include <petscmat.h>

/* X_k = (s E + K)^-1 [E (s E + K)^-1]^(k-1) ports, k = 1..q. */
typedef struct ShiftMoments {
  PetscReal s; // 1/s
  PetscInt q;
  PetscReal *mu;   // [2q x p x p] ports^T [(s E + K)^-1 E]^k (s E + K)^-1 ports, k < 2q
  PetscReal *heat; // [2q x p] 1^T E X_k, and after them 1^T K X_k
} ShiftMoments;

typedef struct ShiftBlocks {
  MPI_Comm comm;
  PetscInt p, n_shifts, n; // n: blocks, in the order of the shifts
  ShiftMoments *shift;     // [n_shifts]
  char *folder;            // NULL: in memory
  Mat *block;              // [n] in memory
  Mat window;              // [n x p] the block read last; from a folder
  PetscInt in_window;      // its number; -1: none
} ShiftBlocks;

/* folder: made if missing; where it holds shifts with the same signature they are taken over, else they are removed.
 *   signature  text, or text | numbers: numbers are compared to 1e-9, what is before them to the letter
 *   like  a matrix with the row layout. Errors: PETSC_ERR_FILE_OPEN, PETSC_ERR_FILE_WRITE. Collective, as all here. */
PetscErrorCode shift_blocks_create(Mat like, PetscInt p, const char *folder, const char *signature,
                                   ShiftBlocks **blocks);
/* Take block X, number `n`, of a shift that is not complete yet. X is copied. */
PetscErrorCode shift_blocks_add(ShiftBlocks *blocks, Mat X);
/* The shift is complete with the last q blocks: now it counts, also after an interruption. mu, heat: handed over. */
PetscErrorCode shift_blocks_complete(ShiftBlocks *blocks, const ShiftMoments *moments);
/* Block i, to be read only, valid until the next call. */
PetscErrorCode shift_blocks_get(ShiftBlocks *blocks, PetscInt i, Mat *X);
/* finished: the folder is removed. */
PetscErrorCode shift_blocks_destroy(ShiftBlocks **blocks, PetscBool finished);

#endif
