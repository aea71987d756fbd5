/* mould_case.h - a box mould assembled and ready to be reduced, and its full model integrated in time by a scheme that
 * shares nothing with the reduction. */
#ifndef TESTS_SUPPORT_MOULD_CASE_H
#define TESTS_SUPPORT_MOULD_CASE_H

#include "reduce/mor/reduced_model.h"
#include "tests/support/box_mould.h"

typedef struct MouldCase {
  MouldMesh *mesh;
  ReduceConfig *config;
  ThermalSystem *system;
} MouldCase;

/* Phosphate investment, 24 x 16 x 20 mm, eight patches, thin layers at the cavity wall, Robin outside. */
extern const BoxMould INVESTMENT_BOX;
/* 9 x 6 x 12 mm of it, six patches: small enough for a second or two in all. */
extern const BoxMould SMALL_BOX;

PetscErrorCode mould_case_create(MPI_Comm comm, const BoxMould *box, MouldCase *mould);
PetscErrorCode mould_case_destroy(MouldCase *mould);

/* rational, 1 ms to 100 s, tolerance 1e-3, second stage; tight solves */
ReductionConfig rational_config(void);
/* the paper's method: s0 = 0, five moments */
ReductionConfig arnoldi_config(void);

/* Step responses of the full model: heat F [n x k] switched on at t = 0, temperatures out [n_times x k x m] of all
 * patches at t_first ratio^i, i < n_times. L-stable singly diagonally implicit scheme of order 5, `steps` equal steps
 * up to t_first and from each time to the next. */
PetscErrorCode full_step_responses(const ThermalSystem *system, Mat F, PetscReal t_first, PetscReal ratio,
                                   PetscInt n_times, PetscInt steps, PetscReal *temperature);
/* The same of the reduced model by the exact solution, for patch j's step: [m] at time t. */
void reduced_step_response(const ReducedModel *model, PetscInt j, PetscReal t, PetscReal *temperature);

#endif
