/* laplace_contour.h - a function of time from its Laplace transform, all of whose singularities lie on s <= 0:
 *   f(t) = Im sum_k e^(s_k t) w_k F(s_k),  t1 <= t <= t2, within about 1e-6 of its size at t2 for t2 = 60 t1
 * Reference: Weideman & Trefethen 2007, Math. Comp. 76, 1341 (midpoint rule on a hyperbola, one for a window of times).
 */
#ifndef REDUCE_MOR_CERTIFICATE_LAPLACE_CONTOUR_H
#define REDUCE_MOR_CERTIFICATE_LAPLACE_CONTOUR_H

#include <complex.h>

enum { CONTOUR_POINTS = 32 };

typedef struct LaplaceContour {
  double complex s[CONTOUR_POINTS], weight[CONTOUR_POINTS]; // 1/s
} LaplaceContour;

/* 0 < t1 <= t2, s; t2/t1 up to about 100 */
void laplace_contour_set(double t1, double t2, LaplaceContour *contour);

#endif
