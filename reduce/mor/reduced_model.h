/* reduced_model.h - the mould reduced by Galerkin projection on a rational Krylov space, in modal form. */
#ifndef REDUCE_MOR_REDUCED_MODEL_H
#define REDUCE_MOR_REDUCED_MODEL_H

#include <slepcbv.h>
#include "common/log.h"
#include "common/rom/rom.h"
#include "reduce/mor/krylov/model_basis.h"

typedef struct ReducedModel {
  PetscInt r, m;
  PetscReal *lambda;   // [r] 1/s ascending
  PetscReal *B;        // [r*m] row-major
  PetscReal *ambient;  // [r]
  PetscReal *constant; // [r]
  KrylovBasis *basis;  // owned; with
  PetscReal *modes;    // [basis->r x r] the states in it
  BV V;                // [n x r] the same as E-orthonormal vectors in modal form, distributed; owned; NULL: not made
  PetscInt n_shifts;
  PetscReal *shifts; // [n_shifts] 1/s
  PetscInt moments;
  RomCertificate certificate;
  double seconds_reduction, seconds_certificate;
} ReducedModel;

/* Reduce, certify, and enrich until the certificate meets config->tolerance (rational) or warn (arnoldi). Collective;
 * the same answer on any number of ranks to solver tolerance. Says what it does in `log` (rank 0; NULL elsewhere). */
PetscErrorCode reduced_model_create(const ThermalSystem *system, const ReductionConfig *config, Log *log,
                                    ReducedModel **model);
/* Make V. The basis is gone then, as V takes its memory. Not of a basis in blocks, which may be larger than that. */
PetscErrorCode reduced_model_make_vectors(ReducedModel *model);
PetscErrorCode reduced_model_destroy(ReducedModel **model);

/* H_r(s) = B^T (s + Lambda)^-1 B and the full H(s) = B^T (s E + K)^-1 B at a real s; [m*m] row-major, on every rank. */
PetscErrorCode reduced_model_transfer(const ReducedModel *model, PetscReal s, PetscReal *H);
PetscErrorCode thermal_system_transfer(const ThermalSystem *system, PetscReal s, PetscReal rtol, PetscReal *H);

#endif
