#include "reduce/mor/certificate/laplace_contour.h"

#include <math.h>

/* Points k h of the rule times N: h = width(angle)/N; the hyperbola is s = mu (1 + sin(i theta - angle)). */
static double width(double angle, double ratio)
{
  return acosh(((M_PI - 2.0 * angle) * ratio + 4.0 * angle - M_PI) / ((4.0 * angle - M_PI) * sin(angle)));
}

/* The error falls as exp(-N (pi^2 - 2 pi angle)/width): the angle with the fastest fall. */
static double best_angle(double ratio)
{
  double best = 0.0, fastest = 0.0;
  for (double angle = 0.26 * M_PI; angle < 0.5 * M_PI; angle += 0.005) {
    const double fall = (M_PI * M_PI - 2.0 * M_PI * angle) / width(angle, ratio);
    if (fall > fastest) {
      fastest = fall;
      best = angle;
    }
  }
  return best;
}

void laplace_contour_set(double t1, double t2, LaplaceContour *contour)
{
  const double ratio = t2 / t1, angle = best_angle(ratio), h = width(angle, ratio) / CONTOUR_POINTS;
  const double mu = (4.0 * M_PI * angle - M_PI * M_PI) / (h * t2);
  for (int k = 0; k < CONTOUR_POINTS; k++) { // the other half of the hyperbola is the conjugate one
    const double theta = (k + 0.5) * h;
    contour->s[k] = mu * CMPLX(1.0 - sin(angle) * cosh(theta), cos(angle) * sinh(theta));
    contour->weight[k] = h / M_PI * mu * CMPLX(-sin(angle) * sinh(theta), cos(angle) * cosh(theta));
  }
}
