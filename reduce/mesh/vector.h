/* vector.h - three numbers. */
#ifndef REDUCE_MESH_VECTOR_H
#define REDUCE_MESH_VECTOR_H

#include <math.h>

static inline void vector_between(const double from[3], const double to[3], double v[3])
{
  for (int d = 0; d < 3; d++) v[d] = to[d] - from[d];
}

static inline double vector_dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void vector_cross(const double a[3], const double b[3], double c[3])
{
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double vector_norm(const double v[3])
{
  return sqrt(vector_dot(v, v));
}

static inline double vector_distance(const double a[3], const double b[3])
{
  double v[3];
  vector_between(a, b, v);
  return vector_norm(v);
}

#endif
