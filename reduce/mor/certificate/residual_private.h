/* residual_private.h - what the files of residual.h share. */
#ifndef REDUCE_MOR_CERTIFICATE_RESIDUAL_PRIVATE_H
#define REDUCE_MOR_CERTIFICATE_RESIDUAL_PRIVATE_H

#include "reduce/mor/certificate/residual.h"

/* E >= DIAGONAL_SHARE diag(E): 1/2 for linear and 1/4 for quadratic tetrahedra, on any mesh (the least eigenvalue of
 * one element's: Wathen 1987, IMA J. Numer. Anal. 7, 449); less, for matrices from elsewhere. It only enters what is
 * added for inexact solves. */
#define RESIDUAL_DIAGONAL_SHARE 0.05

/* Of norms found by 32 random sums, sum of squares = chi squared with 32 degrees where all lies in one direction, which
 * is the worst: half the norm or less is found once in some hundred thousand cases. */
enum { RESIDUAL_PROBES = 32 };
#define RESIDUAL_PROBE_SAFETY 2.0

/* X(i, :) *= E_ii^power */
PetscErrorCode residual_scale_by_diagonal(const ThermalSystem *system, PetscReal power, Mat X);
/* Re or Im of (iw + Lambda)^-1 B as [p x r] column-major, which is row-major [r x p]. */
void residual_modal_state(const ModalModel *model, PetscReal w, int part, PetscReal *x);
/* X^T (w E + K)^-1 X, [k x k], at the solver's present shift w. G lies above it, plain and heat as near as the solves.
 *   plain, heat  out, or both NULL: X^T M^-1 X and X^T M^-1 E M^-1 X */
PetscErrorCode residual_energy_of(const ThermalSystem *system, ShiftedSolver *solver, Mat X, PetscReal *G,
                                  PetscReal *plain, PetscReal *heat);

#endif
