#include "tests/support/symmetric_eigen.h"

#include <math.h>

static void rotate(double *a, double *b, double c, double s)
{
  const double x = *a, y = *b;
  *a = c * x - s * y;
  *b = s * x + c * y;
}

void symmetric_eigenvectors(size_t n, double *A, double *V)
{
  for (size_t i = 0; i < n; i++) V[i * n + i] = 1.0;
  for (int sweep = 0; sweep < 60; sweep++) {
    double off = 0.0, diagonal = 0.0;
    for (size_t p = 0; p < n; p++)
      for (size_t q = 0; q < n; q++) *(p == q ? &diagonal : &off) += A[p * n + q] * A[p * n + q];
    if (off <= 1e-30 * diagonal) return;
    for (size_t p = 0; p < n; p++)
      for (size_t q = p + 1; q < n; q++) {
        if (A[p * n + q] == 0.0) continue;
        const double theta = 0.5 * atan2(2.0 * A[p * n + q], A[q * n + q] - A[p * n + p]);
        const double c = cos(theta), s = sin(theta);
        for (size_t k = 0; k < n; k++) rotate(&A[k * n + p], &A[k * n + q], c, s);
        for (size_t k = 0; k < n; k++) rotate(&A[p * n + k], &A[q * n + k], c, s);
        for (size_t k = 0; k < n; k++) rotate(&V[k * n + p], &V[k * n + q], c, s);
      }
  }
}
