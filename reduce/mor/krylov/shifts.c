/* shifts.c
 * With N vectors an input, spread evenly over the logarithm of the rate, the error of a Galerkin reduction falls like
 * exp(-c N/decades) (Zolotarev's problem on an interval of rates; Druskin, Knizhnerman & Zaslavsky 2009, SIAM J. Sci.
 * Comput. 31, 3760). What counts is the density of poles: three vectors at one shift do nearly as well as one at each
 * of three shifts, for a third of the factors. */
#include "reduce/mor/krylov/shifts.h"

#include <math.h>

#include "reduce/petsc/petsc_compat.h"

enum { VECTORS_PER_SHIFT = 3, FEWEST_SHIFTS = 2 };

/* error = FIRST exp(-DECAY N/decades), decades of t_end/t_start: measured on moulds of 1e4 and 1e5 unknowns with 7 and
 * 50 patches. */
static const PetscReal FIRST = 0.5, DECAY = 3.0;

static PetscErrorCode allocate_plan(PetscInt n, ShiftPlan *plan)
{
  PetscFunctionBeginUser;
  plan->n = n;
  PetscCall(PetscMalloc2((size_t)n, &plan->shift, (size_t)n, &plan->moments));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode shifts_plan(PetscReal t_start, PetscReal t_end, PetscReal tolerance, ShiftPlan *plan)
{
  const PetscReal ratio = t_end / t_start;
  const PetscInt vectors = PetscMax(1, (PetscInt)ceil(log10(ratio) / DECAY * log(FIRST / tolerance)));
  const PetscInt n = PetscMax(FEWEST_SHIFTS, (vectors + VECTORS_PER_SHIFT - 1) / VECTORS_PER_SHIFT);

  PetscFunctionBeginUser;
  PetscCall(allocate_plan(n, plan));
  for (PetscInt i = 0; i < n; i++) {
    plan->shift[i] = pow(ratio, (PetscReal)i / (PetscReal)(n - 1)) / t_end;
    plan->moments[i] = PetscMax(1, vectors / n + (i < vectors % n ? 1 : 0));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode shifts_plan_given(PetscInt n, const PetscReal *shifts, ShiftPlan *plan)
{
  PetscFunctionBeginUser;
  PetscCall(allocate_plan(n, plan));
  PetscCall(PetscArraycpy(plan->shift, shifts, (size_t)n));
  PetscCall(PetscSortReal(n, plan->shift));
  for (PetscInt i = 0; i < n; i++) plan->moments[i] = 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode shifts_plan_destroy(ShiftPlan *plan)
{
  PetscFunctionBeginUser;
  PetscCall(PetscFree2(plan->shift, plan->moments));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal error_at(PetscReal t, PetscInt n_times, const PetscReal *time, const PetscReal *error)
{
  PetscInt nearest = 0;
  for (PetscInt i = 1; i < n_times; i++)
    if (fabs(log(time[i] / t)) < fabs(log(time[nearest] / t))) nearest = i;
  return error[nearest];
}

PetscErrorCode shifts_suggest(PetscInt n, const PetscReal *shifts, PetscInt n_times, const PetscReal *time,
                              const PetscReal *error, PetscReal *suggestion)
{
  PetscReal *sorted, best = -1.0;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)n, &sorted));
  PetscCall(PetscArraycpy(sorted, shifts, (size_t)n));
  PetscCall(PetscSortReal(n, sorted));
  const PetscReal usual = n > 1 ? log(sorted[n - 1] / sorted[0]) / (PetscReal)(n - 1) : 1.0;
  for (PetscInt i = -1; i < n; i++) {
    const PetscBool beyond = (PetscBool)(i < 0 || i == n - 1);
    const PetscReal gap = beyond ? 0.5 * usual : log(sorted[i + 1] / sorted[i]); // an end counts as half a gap
    const PetscReal s = i < 0        ? sorted[0] * exp(-usual)
                        : i == n - 1 ? sorted[n - 1] * exp(usual)
                                     : sqrt(sorted[i] * sorted[i + 1]);
    const PetscReal score = error_at(1.0 / s, n_times, time, error) * gap * gap;
    if (score > best) {
      best = score;
      *suggestion = s;
    }
  }
  PetscCall(PetscFree(sorted));
  PetscFunctionReturn(PETSC_SUCCESS);
}
