/* matrix_files.h - E, K, B and C as their files have them: do they describe a mould? (internal to reduce/io) */
#ifndef REDUCE_IO_MATRIX_FILES_H
#define REDUCE_IO_MATRIX_FILES_H

#include "reduce/config/config.h"
#include "reduce/io/matrix_market.h"

typedef struct MatrixFiles {
  PetscInt n, m;        // unknowns, inputs
  MarketMatrix E, K, B; // K as in the file: -K where that holds A. B with columns that sum to 1
  PetscReal *area;      // [m] m2; 1 where the file's inputs are watts
} MatrixFiles;

/* Errors: CAST_ERR_FORMAT with the file, the line and the entry: a matrix of another size, not symmetric, with a
 * diagonal that no mould has, inputs that are not watts, outputs that are not B^T. */
CastStatus matrix_files_read(const MatricesConfig *config, MatrixFiles *files, CastError *err);
void matrix_files_free(MatrixFiles *files);

#endif
