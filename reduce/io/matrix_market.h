/* matrix_market.h - real matrices as text, as other programs write them.
 * Reference: Boisvert, Pozo & Remington 1996, The Matrix Market exchange formats, NISTIR 5935. */
#ifndef REDUCE_IO_MATRIX_MARKET_H
#define REDUCE_IO_MATRIX_MARKET_H

#include <petscsystypes.h>
#include <stddef.h>
#include "common/error.h"

typedef struct MarketEntry {
  PetscInt row, column; // from 0
  PetscReal value;
  long line; // of the file
} MarketEntry;

typedef struct MarketMatrix {
  char *path;
  PetscInt rows, columns;
  size_t n;
  MarketEntry *entry; // [n] by row, then column; both triangles where the file holds one; array files without zeros
} MarketMatrix;

/* Coordinate files, general or symmetric, and general array files; real or integer. Errors: CAST_ERR_IO;
 * CAST_ERR_FORMAT with file and line for anything else, numbers that are not finite, indices out of range, entries that
 * stand twice, are too few or too many. */
CastStatus market_read(const char *path, MarketMatrix *matrix, CastError *err);
/* The entry at (row, column), or NULL. */
MarketEntry *market_find(const MarketMatrix *matrix, PetscInt row, PetscInt column);
void market_free(MarketMatrix *matrix);

#endif
