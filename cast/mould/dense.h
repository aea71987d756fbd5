/* dense.h - long rows of numbers, in the widest form that the processor has. */
#ifndef CAST_MOULD_DENSE_H
#define CAST_MOULD_DENSE_H

#include <stddef.h>

double dense_dot(const double *a, const double *b, size_t n);
void dense_add(double scale, const double *a, double *sum, size_t n); // sum += scale a
#endif
