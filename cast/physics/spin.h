/* spin.h - the accelerations that a melt feels in the frame of a mould that turns: pure formulas.
 *   dv/dt = .. - w x (w x r) - dw/dt x r - 2 w x v,   r = x - point     (docs/theory, eq. 15a; Landau & Lifshitz,
 * Mechanics, section 39). The first is the slope of the potential |w x r|^2/2; the second (Euler's) has none; the third
 * (Coriolis') does no work. */
#ifndef CAST_PHYSICS_SPIN_H
#define CAST_PHYSICS_SPIN_H

#include "cast/kernel/pair.h"

typedef struct Spin { // all zero: the mould stands still
  double point[3];    // m, on the axis
  double rate[3];     // rad/s, angular velocity w
  double spin_up[3];  // rad/s2, dw/dt
} Spin;

PAIR_INLINE double spin_rate2(const Spin *spin)
{
  const double *w = spin->rate;
  return w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
}

PAIR_INLINE bool spin_is_none(const Spin *spin)
{
  const double *e = spin->spin_up;
  return spin_rate2(spin) == 0.0 && e[0] == 0.0 && e[1] == 0.0 && e[2] == 0.0;
}

/* Centrifugal and Euler's acceleration at the place x, m/s2, added to a. */
PAIR_INLINE void spin_add_acceleration(const Spin *spin, const double x[3], double a[3])
{
  const double *w = spin->rate, *e = spin->spin_up;
  const double r[3] = {x[0] - spin->point[0], x[1] - spin->point[1], x[2] - spin->point[2]};
  const double w2 = spin_rate2(spin), along = w[0] * r[0] + w[1] * r[1] + w[2] * r[2];
  a[0] += w2 * r[0] - w[0] * along - (e[1] * r[2] - e[2] * r[1]);
  a[1] += w2 * r[1] - w[1] * along - (e[2] * r[0] - e[0] * r[2]);
  a[2] += w2 * r[2] - w[2] * along - (e[0] * r[1] - e[1] * r[0]);
}

/* |w x r|^2/2, m2/s2: its slope is the centrifugal acceleration. */
PAIR_INLINE double spin_potential(const Spin *spin, double x, double y, double z)
{
  const double *w = spin->rate, rx = x - spin->point[0], ry = y - spin->point[1], rz = z - spin->point[2];
  const double along = w[0] * rx + w[1] * ry + w[2] * rz;
  return 0.5 * (spin_rate2(spin) * (rx * rx + ry * ry + rz * rz) - along * along);
}

#endif
