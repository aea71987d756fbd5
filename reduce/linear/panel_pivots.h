/* panel_pivots.h - the pivots of a modified incomplete Cholesky factor without fill, all of the factor that is not in
 * the matrix already. */
#ifndef REDUCE_LINEAR_PANEL_PIVOTS_H
#define REDUCE_LINEAR_PANEL_PIVOTS_H

#include <petscsys.h>

typedef struct PivotRows { // compressed rows, symmetric, columns ascending; borrowed
  PetscInt n;
  const PetscInt *row, *column; // [n + 1], [row[n]]
  const PetscScalar *value;     // [row[n]]
  const PetscScalar *diagonal;  // [n] positive
} PivotRows;

/* pivot [n] out: positive */
PetscErrorCode panel_pivots(const PivotRows *A, PetscReal *pivot);

#endif
