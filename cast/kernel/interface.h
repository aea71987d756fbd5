/* interface.h - formulas of the free surface: how surely a particle belongs to it, and how it is curved there.
 * Pure inline functions of plain numbers. Symmetric matrices are stored as xx, xy, xz, yy, yz, zz. */
#ifndef CAST_KERNEL_INTERFACE_H
#define CAST_KERNEL_INTERFACE_H

#include "cast/kernel/pair.h"

/* Of the gradient at a flat surface: curvature is measured above. */
static const double interface_measured_low = 0.3;

/* 0 below `low`, 1 above twice that, smooth between: x the size of the fill's gradient over that at a flat surface. */
PAIR_INLINE double interface_share(double x, double low)
{
  const double s = (x - low) / low;
  return s <= 0.0 ? 0.0 : s >= 1.0 ? 1.0 : s * s * (3.0 - 2.0 * s);
}

/* Sums of least squares for the gradient of the unit normal: G = sum w F (n_i - n_j) d, M = sum w F d d; then
 * grad n = G M^-1 whatever side of the particle its neighbours are on. */
typedef struct InterfaceSums {
  double G[3][3], M[6]; // M dimensionless, G 1/m
} InterfaceSums;

typedef struct InterfaceShape {
  double curvature; // 1/m, k1 + k2, above 0 for a drop
  double square;    // 1/m2, k1^2 + k2^2
} InterfaceShape;

/* Normals point into the melt. What is added to M keeps a lone neighbour from making it singular, and takes 0.6 % off
 * where the surface is well sampled (M = 1/2 along it). */
PAIR_INLINE InterfaceShape interface_shape(const InterfaceSums *sums)
{
  const double floor = 3e-3, *m = sums->M;
  const double a = m[0] + floor, b = m[1], c = m[2], d = m[3] + floor, e = m[4], f = m[5] + floor;
  const double A = d * f - e * e, B = c * e - b * f, C = b * e - c * d;
  const double per = 1.0 / (a * A + b * B + c * C);
  const double inverse[3][3] = {{A * per, B * per, C * per},
                                {B * per, (a * f - c * c) * per, (b * c - a * e) * per},
                                {C * per, (b * c - a * e) * per, (a * d - b * b) * per}};
  double slope[3][3], square = 0.0;
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      slope[p][q] = 0.0;
      for (int r = 0; r < 3; r++) slope[p][q] += sums->G[p][r] * inverse[r][q];
    }
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) square += slope[p][q] * slope[q][p];
  return (InterfaceShape){-(slope[0][0] + slope[1][1] + slope[2][2]), positive(square)};
}

/* Curvature that the force is to act with, from that measured at the mean depth `depth` below the surface, where a
 * drop's radii are shorter, and for a force spread by a kernel of mean radius `radius`, whose sum is 1 + radius k/4 on
 * a ball. Hollows are left as they are: they are those of menisci in narrow places, too few particles for such series.
 */
PAIR_INLINE double interface_at_surface(InterfaceShape shape, double depth, double radius)
{
  const double k = shape.curvature, excess = 0.25 * radius * k * k + depth * shape.square;
  return k > 0.0 ? k * k / (k + excess) : k;
}

/* Stress of the surface over sigma, times a length: x, the size of the fill's gradient over that at a flat surface,
 * less what noise has. Its slope rises smoothly from 0 at interface_stress_low to 1 at interface_stress_high. */
static const double interface_stress_low = 0.1, interface_stress_high = 0.3;
PAIR_INLINE double interface_stress(double x)
{
  const double width = interface_stress_high - interface_stress_low, s = (x - interface_stress_low) / width;
  return s <= 0.0   ? 0.0
         : s >= 1.0 ? x - 0.5 * (interface_stress_low + interface_stress_high)
                    : width * s * s * s * (1.0 - 0.5 * s);
}

/* stress += size (1 - n n), a tension along the surface of normal n */
PAIR_INLINE void interface_add_stress(double size, const double n[3], double stress[6])
{
  for (int a = 0, q = 0; a < 3; a++)
    for (int b = a; b < 3; b++, q++) stress[q] += size * ((a == b ? 1.0 : 0.0) - n[a] * n[b]);
}

PAIR_INLINE void interface_times_stress(const double s[6], const double x[3], double y[3])
{
  y[0] = s[0] * x[0] + s[1] * x[1] + s[2] * x[2];
  y[1] = s[1] * x[0] + s[3] * x[1] + s[4] * x[2];
  y[2] = s[2] * x[0] + s[4] * x[1] + s[5] * x[2];
}

/* keep = (1 + facing/small)^-1; keep x is what is left of x along all walls; facing = sum of g a a over walls of
 * normals a */
PAIR_INLINE void interface_along_walls(const double facing[6], double small, double keep[6])
{
  const double *m = facing, a = 1.0 + m[0] / small, b = m[1] / small, c = m[2] / small, d = 1.0 + m[3] / small,
               e = m[4] / small, f = 1.0 + m[5] / small;
  const double A = d * f - e * e, B = c * e - b * f, C = b * e - c * d, per = 1.0 / (a * A + b * B + c * C);
  keep[0] = A * per;
  keep[1] = B * per;
  keep[2] = C * per;
  keep[3] = (a * f - c * c) * per;
  keep[4] = (b * c - a * e) * per;
  keep[5] = (a * d - b * b) * per;
}

#endif
