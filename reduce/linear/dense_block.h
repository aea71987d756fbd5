/* dense_block.h - blocks of vectors, [n x k] dense, distributed by rows like the matrices they meet.
 * Small results (k or k x k numbers) are the same on every rank. */
#ifndef REDUCE_LINEAR_DENSE_BLOCK_H
#define REDUCE_LINEAR_DENSE_BLOCK_H

#include <petscmat.h>

/* A zero block of k vectors with the row layout of A. */
PetscErrorCode dense_block_create(Mat A, PetscInt k, Mat *X);
/* Y = A X. */
PetscErrorCode dense_block_multiply(Mat A, Mat X, Mat Y);
/* dots[c] = x_c . y_c,  [k] */
PetscErrorCode dense_block_dots(Mat X, Mat Y, PetscReal *dots);
/* y_c = beta y_c + alpha[c] x_c */
PetscErrorCode dense_block_axpby(Mat Y, PetscReal beta, const PetscReal *alpha, Mat X);
/* y_c = x_c + beta[c] y_c */
PetscErrorCode dense_block_aypx(Mat Y, const PetscReal *beta, Mat X);
/* x_c *= factor[c] */
PetscErrorCode dense_block_scale(Mat X, const PetscReal *factor);
/* G = X^T Y, [kx x ky] column-major. */
PetscErrorCode dense_block_inner(Mat X, Mat Y, PetscReal *G);
/* Y = beta Y + alpha X Q, Q [kx x ky] column-major with ldq rows. */
PetscErrorCode dense_block_combine(Mat Y, PetscReal beta, PetscReal alpha, Mat X, const PetscReal *Q, PetscInt ldq);
/* Copy columns: Y(:, to + c) = X(:, column[c]), c < k. column NULL: the first k. */
PetscErrorCode dense_block_copy(Mat Y, PetscInt to, Mat X, const PetscInt *column, PetscInt k);

#endif
