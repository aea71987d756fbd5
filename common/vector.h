/* vector.h - three-vectors of doubles; out may be one of the operands. */
#ifndef COMMON_VECTOR_H
#define COMMON_VECTOR_H

#include <math.h>
#include <stdbool.h>

static inline double vec_dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void vec_sub(const double a[3], const double b[3], double out[3])
{
  for (int k = 0; k < 3; k++) out[k] = a[k] - b[k];
}

/* out = to - from */
static inline void vec_between(const double from[3], const double to[3], double out[3])
{
  vec_sub(to, from, out);
}

/* out = a + s b */
static inline void vec_axpy(double s, const double b[3], const double a[3], double out[3])
{
  for (int k = 0; k < 3; k++) out[k] = a[k] + s * b[k];
}

static inline void vec_copy(const double a[3], double out[3])
{
  for (int k = 0; k < 3; k++) out[k] = a[k];
}

static inline void vec_cross(const double a[3], const double b[3], double out[3])
{
  const double c[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  vec_copy(c, out);
}

static inline double vec_norm(const double a[3])
{
  return sqrt(vec_dot(a, a));
}

/* Scale to length one; returns the length it had. A zero vector stays zero. */
static inline double vec_normalise(double a[3])
{
  const double length = vec_norm(a);
  if (length > 0.0)
    for (int k = 0; k < 3; k++) a[k] /= length;
  return length;
}

static inline double vec_distance2(const double a[3], const double b[3])
{
  double d[3];
  vec_sub(a, b, d);
  return vec_dot(d, d);
}

static inline double vec_distance(const double a[3], const double b[3])
{
  return sqrt(vec_distance2(a, b));
}

/* Does the box hold the place? Its borders count. */
static inline bool vec_in_box(const double corner[3], const double size[3], const double x[3])
{
  bool inside = true;
  for (int k = 0; k < 3; k++) inside = inside && x[k] >= corner[k] && x[k] <= corner[k] + size[k];
  return inside;
}

#endif
