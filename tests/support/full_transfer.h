/* full_transfer.h - H(iw) = D B^T (iw E + K)^-1 B D, D = diag(area)^(1/2), of the full model on one rank, as a real
 * system of twice the size, [K  -wE; wE  K][Re x; Im x] = [B; 0], by LU, which nothing in the reduction or its
 * certificate uses. */
#ifndef TESTS_SUPPORT_FULL_TRANSFER_H
#define TESTS_SUPPORT_FULL_TRANSFER_H

#include "reduce/mor/reduced_model.h"

/* ||H - H_r||_2/||H_r||_2 at w. */
double transfer_error(const ThermalSystem *system, const ReducedModel *model, PetscReal w);

#endif
