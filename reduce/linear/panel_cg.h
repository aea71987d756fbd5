/* panel_cg.h - conjugate gradients for many right-hand sides of one sparse symmetric positive definite matrix, in
 * single precision and 16 columns at a time, preconditioned within each process by a modified incomplete
 * Cholesky factor without fill, of which only the diagonal has to be kept. What it
 * leaves over is for the caller to measure in double precision, and to solve for again. */
#ifndef REDUCE_LINEAR_PANEL_CG_H
#define REDUCE_LINEAR_PANEL_CG_H

#include <petscmat.h>

typedef struct PanelCg PanelCg;

/* A [n x n] MATAIJ with its diagonal, borrowed: must outlive it. Collective. */
PetscErrorCode panel_cg_create(Mat A, PanelCg **cg);
/* Take A's present values. Errors: a diagonal entry that is not positive. */
PetscErrorCode panel_cg_take_values(PanelCg *cg);
/* X += A^-1 R, column by column so closely that the residual's 2-norm falls to length[c], or, as single precision
 * goes, to 1e-5 of what R's was; at most `limit` iterations.
 *   R, X  [n x k] dense;  length [k];  iterations  out: the most that a column took
 *   columns of R that are no longer than length[c] are left alone */
PetscErrorCode panel_cg_solve(PanelCg *cg, Mat R, Mat X, const PetscReal *length, PetscInt limit, PetscInt *iterations);
PetscErrorCode panel_cg_destroy(PanelCg **cg);

#endif
