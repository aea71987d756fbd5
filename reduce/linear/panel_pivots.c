/* panel_pivots.c
 * The factor has no entry but those of A. Most of what is left out between rows of conduction is added to the pivot, so
 * that the constant hardly sees the difference; elsewhere (blunt angles between elements' faces, heat capacity) that
 * could make it indefinite.
 * Reference: Gustafsson 1978, BIT 18, 142. */
#include "reduce/linear/panel_pivots.h"

#include "reduce/petsc/petsc_compat.h"

static const PetscReal ADDED_SHARE = 0.95;  // of what is left out: with all of it small pivots come up
static const PetscReal HARDLY = 0.01;       // positive over negative entries of a row that is conduction
static const PetscReal LEAST_PIVOT = 0.005; // over the diagonal

typedef struct RowSums { // of a row of A
  PetscReal above;       // negative entries right of the diagonal
  PetscBool conduction;  // hardly any entry off the diagonal is positive
} RowSums;

static RowSums sum_row(const PivotRows *A, PetscInt i)
{
  PetscReal above = 0.0, positive = 0.0, negative = 0.0;
  for (PetscInt k = A->row[i]; k < A->row[i + 1]; k++) {
    const PetscReal a = A->value[k];
    if (A->column[k] > i) above += PetscMin(a, 0.0);
    if (A->column[k] != i) *(a < 0.0 ? &negative : &positive) += PetscAbsReal(a);
  }
  return (RowSums){.above = above, .conduction = (PetscBool)(positive <= HARDLY * negative)};
}

PetscErrorCode panel_pivots(const PivotRows *A, PetscReal *pivot)
{
  RowSums *sum;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)A->n, &sum));
  for (PetscInt i = 0; i < A->n; i++) {
    sum[i] = sum_row(A, i);
    pivot[i] = A->diagonal[i];
    for (PetscInt k = A->row[i]; k < A->row[i + 1] && A->column[k] < i; k++) {
      const PetscInt j = A->column[k];
      const PetscReal a = A->value[k];
      const PetscBool add = (PetscBool)(a < 0.0 && sum[i].conduction && sum[j].conduction);
      pivot[i] -= a / pivot[j] * (a + (add ? ADDED_SHARE * (sum[j].above - a) : 0.0));
    }
    pivot[i] = PetscMax(pivot[i], LEAST_PIVOT * A->diagonal[i]);
  }
  PetscCall(PetscFree(sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}
