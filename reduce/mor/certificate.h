/* certificate.h - what is known of a reduced model's error, from real symmetric positive definite solves only. */
#ifndef REDUCE_MOR_CERTIFICATE_H
#define REDUCE_MOR_CERTIFICATE_H

#include <slepcbv.h>

#include "reduce/mor/modal_model.h"
#include "reduce/mor/shifted_solver.h"

/* Upper bound of ||H(iw) - H_r(iw)||_2/||H_r(iw)||_2, H weighted with the patches' areas,
 * H = D B^T (iw E + K)^-1 B D, D = diag(area)^(1/2). V [n x r] is the basis of `model` in modal form. The solver takes
 * the shift w. Costs one preconditioner and 2 m solves. */
PetscErrorCode certificate_transfer_bound(const ThermalSystem *system, BV V, const ModalModel *model,
                                          ShiftedSolver *solver, PetscReal w, PetscReal *bound);
/* max |V^T E V - I| */
PetscErrorCode certificate_orthogonality(const ThermalSystem *system, BV V, PetscReal *defect);

#endif
