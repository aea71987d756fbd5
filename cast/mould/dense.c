#include "cast/mould/dense.h"

#include "cast/kernel/dispatch.h"

SIMD_CLONES double dense_dot(const double *a, const double *b, size_t n)
{
  double sum = 0.0;
#pragma omp simd reduction(+ : sum)
  for (size_t l = 0; l < n; l++) sum += a[l] * b[l];
  return sum;
}

SIMD_CLONES void dense_add(double scale, const double *a, double *sum, size_t n)
{
#pragma omp simd
  for (size_t l = 0; l < n; l++) sum[l] += scale * a[l];
}
