/* reduction.h - one reduction under way (internal to reduce/mor). */
#ifndef REDUCE_MOR_REDUCTION_H
#define REDUCE_MOR_REDUCTION_H

#include "reduce/linear/shifted_solver.h"
#include "reduce/mor/certificate/certificate.h"
#include "reduce/mor/certificate/step_reference.h"
#include "reduce/mor/krylov/krylov_basis.h"
#include "reduce/mor/krylov/ports.h"
#include "reduce/mor/krylov/shifts.h"
#include "reduce/mor/model/modal_model.h"
#include "reduce/mor/model/moments.h"
#include "reduce/mor/reduced_model.h"

typedef struct Reduction {
  const ThermalSystem *system;   // borrowed
  const ReductionConfig *config; // borrowed
  Log *log;                      // borrowed, may be NULL
  Mat ports;                     // [n x p] owned
  PetscInt p;
  PetscReal ambient_sum; // W/K, of the ambient column; 0: none
  ShiftedSolver *solver;
  PetscReal rtol; // of the basis' solves
  KrylovBasis *basis;
  StepReference *reference;
  Moments *moments;
  ModalModel *modal;        // of the basis as it stands, or what the second stage made of it
  ModalModel *projected;    // the same before the second stage; NULL without one
  Certificate *certificate; // of the basis and the modal model as they stand; NULL: not made
  PetscInt n_shifts;
  PetscReal *shifts; // [n_shifts] in the order taken, 1/s
  PetscBool doubtful; // the residual was seen not to say what the reference is
  PetscInt moments_per_shift;
  PetscReal step_error;         // of the first stage, on the sampled inputs
  PetscReal second_stage_error; // what the second stage adds, on every input
  PetscReal second_stage_bound; // K/W, of the transfer function: a priori, or the largest difference found
  double seconds_certificate; // spent on it and on the reference so far
} Reduction;

PetscErrorCode reduction_create(const ThermalSystem *system, const ReductionConfig *config, Log *log,
                                Reduction **reduction);
/* The paper's block Arnoldi: q moments at s0. */
PetscErrorCode reduction_run_arnoldi(Reduction *reduction);
/* One block of solves at each of several real shifts, and more shifts until the step responses meet the tolerance. */
PetscErrorCode reduction_run_rational(Reduction *reduction);
/* The same with the vectors kept in blocks, for more inputs than fit in memory. */
PetscErrorCode reduction_run_stored(Reduction *reduction);
/* Is there reason to? The input says so, or the vectors would take too much memory. */
PetscBool reduction_is_stored(const Reduction *reduction);
/* What reduction_run_* share. */
PetscErrorCode reduction_plan_shifts(const Reduction *reduction, ShiftPlan *plan);
PetscErrorCode reduction_record_shift(Reduction *reduction, PetscReal s);
PetscErrorCode reduction_keep_moments(Reduction *reduction, Mat X);
enum { REDUCTION_MOST_ADDED_SHIFTS = 12 };
/* Does the residual say what the full model's step responses are? Else the reference's windows are solved for. */
PetscBool reduction_knows_missing(const Reduction *reduction);
/* To be solved for at one shift with so many vectors an input, and for the reference. */
PetscInt reduction_columns(const Reduction *reduction, PetscInt moments);
/* The reference's windows that the solver's present shift serves, if any are solved for; rest: all that are left. */
PetscErrorCode reduction_solve_windows(Reduction *reduction, PetscBool rest);
/* Modal form of the basis as it stands, and its error at the reference's times, or NULL, and in all. */
PetscErrorCode reduction_judge(Reduction *reduction, PetscReal *error);
PetscReal reduction_first_stage_target(const ReductionConfig *config);
/* The slowest modes, without regard to where heat enters. */
PetscErrorCode reduction_run_modal(Reduction *reduction);
/* The full model's part of the certificate, of the basis as it stands, unless it is there. */
PetscErrorCode reduction_begin_certificate(Reduction *reduction);
/* Second stage, where the input asks for it. */
PetscErrorCode reduction_shorten(Reduction *reduction);
PetscErrorCode reduction_certify(Reduction *reduction, RomCertificate *certificate);
void reduction_report(const Reduction *reduction, const RomCertificate *certificate);
PetscErrorCode reduction_destroy(Reduction **reduction);

#endif
