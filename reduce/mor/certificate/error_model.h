/* error_model.h - the error of a reduced model's step responses, from energies of its residual alone.
 *
 * H - H_r = Phi^T G Phi,  G(s) = R_0^T (s E + K)^-1 R_0,  Phi(s) = 1 - c^T (s + Lambda)^-1 B   (residual.h)
 * What the certificate solves for at its rates w_i, Z_i = (w_i E + K)^-1 R_0, spans a Galerkin model of G itself,
 *   G(s) ~ b^T (s + Lambda_e)^-1 b,
 * that agrees with G and with its derivative at every w_i. All of it follows from G(w_i) and Z_i^T E Z_i:
 *   Z_i^T E Z_j = (G(w_i) - G(w_j))/(w_j - w_i),  Z_i^T K Z_j = G(w_j) - w_i Z_i^T E Z_j.
 * An error known to some hundredths of its size is a reference a hundred times as good as what it judges.
 * Reference: as loewner.h. */
#ifndef REDUCE_MOR_CERTIFICATE_ERROR_MODEL_H
#define REDUCE_MOR_CERTIFICATE_ERROR_MODEL_H

#include "reduce/mor/certificate/residual.h"
#include "reduce/mor/model/modal_model.h"

typedef struct ErrorNodes { // borrowed arrays
  PetscInt n, p;
  const PetscReal *rate; // [n] 1/s, ascending
  const PetscReal *G;    // [n x p x p] G(w_i)
  const PetscReal *heat; // [n x p x p] Z_i^T E Z_i
} ErrorNodes;

typedef struct ErrorModel {
  MPI_Comm comm;
  PetscInt n, p;
  PetscReal *lambda; // [n] 1/s, >= 0
  PetscReal *b;      // [n x p] row-major
} ErrorModel;

typedef struct ErrorSteps { // what is asked for
  PetscInt n_inputs, n_times;
  const PetscReal *u;    // [n_inputs x p] row-major
  const PetscReal *time; // [n_times] s, ascending
} ErrorSteps;

/* From the nodes first, first + stride, .. */
PetscErrorCode error_model_create(MPI_Comm comm, const ErrorNodes *nodes, PetscInt first, PetscInt stride,
                                  ErrorModel **error);
/* b^T (w + Lambda_e)^-1 b, [p x p]: G(w) from below, but for inexact solves. */
PetscErrorCode error_model_energy(const ErrorModel *error, PetscReal w, PetscReal *G);
/* temperature [n_times x n_inputs x p]: by how much the full model's step responses exceed those of `model`. */
PetscErrorCode error_model_steps(const ErrorModel *error, const Residual *residual, const ModalModel *model,
                                 const ErrorSteps *steps, PetscReal *temperature);
PetscErrorCode error_model_destroy(ErrorModel **error);

#endif
