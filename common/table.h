/* table.h - a function given by points, linear between them and constant outside
 * (or continued with the end slopes: table_interpolate_open). */
#ifndef COMMON_TABLE_H
#define COMMON_TABLE_H

#include <stddef.h>
#include "common/error.h"

typedef struct Table {
  size_t n;  // points; 0: no table
  double *x; // [n] strictly increasing
  double *y; // [n]
} Table;

/* Copy the points, checking that x strictly increases and all is finite. */
CastStatus table_create(size_t n, const double *x, const double *y, Table *table, CastError *err);
void table_destroy(Table *table);
double table_evaluate(const Table *table, double x); // constant outside; NaN for NaN, unless the table has one point
/* The segment [x[i], x[i+1]] that holds `at`, the last one that begins at or below it, or the first or last; n >= 2. */
size_t table_segment(const double *x, size_t n, double at);
double table_slope(const Table *table, double x); // dy/dx of the segment; 0 outside
double table_integral(const Table *table, double from, double to); // of y dx, exact; negative where to < from
/* The same on bare arrays of n >= 2 points, continued beyond both ends with the slope of the end segment. */
double table_interpolate_open(const double *x, const double *y, size_t n, double at);

#endif
