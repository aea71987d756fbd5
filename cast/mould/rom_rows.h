/* rom_rows.h - the rows of B_r as a step reads them: in double, or where they do not fit in the processor's cache in
 * single precision, as then their size is what a step costs. Heat stays exact: what the rounding takes from or adds to
 * 1^T E V B_r q is put back along 1^T E V, so that each watt that goes in is a watt held. */
#ifndef CAST_MOULD_ROM_ROWS_H
#define CAST_MOULD_ROM_ROWS_H

#include "common/rom/rom.h"

typedef struct RomRows {
  size_t r, m;
  const double *wide; // [r*m] borrowed
  float *narrow;      // [r*m]; NULL: wide is read
  double *missing;    // [m] per joule through each patch, what narrow rows have less; with narrow
  double *share;      // [r] constant/|constant|^2: where it is put; with narrow
} RomRows;

/*  rom  borrowed. Errors: CAST_ERR_MEMORY. */
CastStatus rom_rows_create(const RomData *rom, RomRows *rows, CastError *err);
void rom_rows_free(RomRows *rows);
/* What `q` [m] brings through the patches beyond the rows' own products, times `share` for each state; 0 in double. */
double rom_rows_missing(const RomRows *rows, const double *q);
/* Rows k .. k + n - 1, n <= ROM_ROWS_AT_ONCE: each number of narrow ones is read once and sums are stored once. */
enum { ROM_ROWS_AT_ONCE = 4 };
/* product [n]: the rows times q */
void rom_rows_dot(const RomRows *rows, size_t k, size_t n, const double *q, double *product);
/* sum [m] += scale [n] times the rows; the same with the factors `further` to other, where that is given */
void rom_rows_add(const RomRows *rows, size_t k, size_t n, const double *scale, double *sum, const double *further,
                  double *other);
#endif
