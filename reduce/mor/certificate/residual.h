/* residual.h - what a rational Krylov model leaves over, for every s at once.
 *
 * V^T E V = I spans (s_j E + K)^-1 ports for some shifts, or block Krylov spaces there. The residual
 *   R(s) = ports - (s E + K) V x(s),   x(s) = (s + K_r)^-1 B_r
 * is orthogonal to V and lies in the span of E V and the ports, so that
 *   R(s) = R_0 Phi(s),   R_0 = ports - E V B_r [n x p],   Phi(s) = I - c^T x(s) [p x p],   K V - E V K_r = R_0 c^T.
 * (Druskin & Simoncini 2011, Syst. Control Lett. 60, 546, for one input.) Inexact solves break the last equation a
 * little; by how much is measured. */
#ifndef REDUCE_MOR_CERTIFICATE_RESIDUAL_H
#define REDUCE_MOR_CERTIFICATE_RESIDUAL_H

#include "reduce/linear/shifted_solver.h"
#include "reduce/mor/krylov/krylov_basis.h"
#include "reduce/mor/model/modal_model.h"

typedef struct Residual {
  const ThermalSystem *system; // borrowed
  PetscInt p, r;
  Mat R0;          // [n x p] owned
  PetscReal *c;    // [r x p] row-major, in the modes of the model
  PetscReal *left; // [k x r] S^T (K V - E V K_r - R_0 c^T) of k random sums S, diag(E)^(1/2) S with entries +-1/sqrt(k)
} Residual;

/* model: of the basis as it stands. Costs a few products of [n x r] with [n x p]. */
PetscErrorCode residual_create(const KrylovBasis *basis, const ModalModel *model, Residual **residual);
/* Re and Im of Phi(iw), [p x p] column-major. */
PetscErrorCode residual_factor(const Residual *residual, const ModalModel *model, PetscReal w, PetscReal *real,
                               PetscReal *imaginary);
/* G >= R_0^T (w E + K)^-1 R_0 in the sense of quadratic forms, [p x p] column-major, from p solves; what the solver
 * leaves over is added. The solver takes the shift w.
 *   plain  out: the same without what is added
 *   heat   out: Z^T E Z, Z = (w E + K)^-1 R_0, minus the derivative by w */
PetscErrorCode residual_energy(const Residual *residual, ShiftedSolver *solver, PetscReal w, PetscReal *G,
                               PetscReal *plain, PetscReal *heat);
/* What inexact solves have spoilt of R = R_0 Phi at a rate. */
typedef struct ResidualExam {
  const PetscReal *weight; // [p] D's diagonal, borrowed
  PetscReal negligible;    // a size below it, found without any solve, will do
  PetscInt most_inputs;    // else solves are made on all inputs, or, of more, on random sums of them
} ResidualExam;

/* An upper bound of ||(R(iw) - R_0 Phi(iw)) D|| in the norm of (w E + K)^-1, w the solver's present shift. The basis
 * must be the one that the residual was created with. */
PetscErrorCode residual_defect(const Residual *residual, const KrylovBasis *basis, const ModalModel *model,
                               ShiftedSolver *solver, const ResidualExam *exam, PetscReal *size);
/* What a projection from moments has spoilt of V^T R = 0, ||D x^T V^T R D||_F at n rates, slip [n]:
 *   H - H_r = R^T (iw E + K)^-1 R + x^T V^T R. */
PetscErrorCode residual_slip(const Residual *residual, const KrylovBasis *basis, const ModalModel *model,
                             const PetscReal *weight, PetscInt n, const PetscReal *rate, PetscReal *slip);
/* An upper bound of the size at any rate w, without solves and without the basis. */
PetscErrorCode residual_defect_by_sums(const Residual *residual, const ModalModel *model, PetscReal w,
                                       const PetscReal *weight, PetscReal *size);
/* The directions in which the error of H at the real rate s, 1/s, is above `least`, and its largest value:
 *   D (H - H_r)(s) D = D Phi^T R_0^T (s E + K)^-1 R_0 Phi D,  D = diag(weight) [p],
 * whose eigenvectors U with larger eigenvalues [k] give X = (s E + K)^-1 R(s) D U, [n x k], what the basis lacks most.
 * The solver takes the shift s. X: caller destroys; NULL where k = 0. */
PetscErrorCode residual_directions(const Residual *residual, const ModalModel *model, ShiftedSolver *solver,
                                   PetscReal s, const PetscReal *weight, PetscReal least, Mat *X, PetscReal *largest);
PetscErrorCode residual_destroy(Residual **residual);

#endif
