/* shifts.h - where the rational Krylov space takes its real shifts. */
#ifndef REDUCE_MOR_KRYLOV_SHIFTS_H
#define REDUCE_MOR_KRYLOV_SHIFTS_H

#include <petscsys.h>

typedef struct ShiftPlan {
  PetscInt n;
  PetscReal *shift;  // [n] 1/s, ascending
  PetscInt *moments; // [n] vectors an input at each
} ShiftPlan;

/* Shifts log-spaced from 1/t_end to 1/t_start, with several vectors an input at each, enough for the tolerance on most
 * moulds. */
PetscErrorCode shifts_plan(PetscReal t_start, PetscReal t_end, PetscReal tolerance, ShiftPlan *plan);
/* One vector an input at each of the given shifts. */
PetscErrorCode shifts_plan_given(PetscInt n, const PetscReal *shifts, ShiftPlan *plan);
PetscErrorCode shifts_plan_destroy(ShiftPlan *plan);
/* One shift more: in the gap between shifts (or beyond an end) that is widest for the error at the times it serves.
 *   shifts [n] in any order;  time, error [n_times] */
PetscErrorCode shifts_suggest(PetscInt n, const PetscReal *shifts, PetscInt n_times, const PetscReal *time,
                              const PetscReal *error, PetscReal *suggestion);

#endif
