/* pair.h - every formula between two particles and of one particle's state, once.
 * Pure inline functions of plain numbers. Those between two particles stand in pair_formulas.h and exist for double,
 * and with _f for float: the vectorised loops of physics/ and the plain ones use the same text.
 *
 * Kernels (q = r/h, W = norm w(q)/h^3, F = -W'/r = norm f(q)/h^5, f = -w'/q):
 *   Wendland C2      w = (1 - q/2)^4 (2q + 1)                  q < 2   Wendland 1995
 *   cubic spline     w = (2 - q)^3 - 4 (1 - q)^3               q < 2   Monaghan & Lattanzio 1985
 *   quintic spline   w = (3 - q)^5 - 6 (2 - q)^5 + 15 (1 - q)^5  q < 3  Morris, Fox & Zhu 1997
 *   Lucy             w = (1 + 3q)(1 - q)^3                     q < 1   Lucy 1977
 * each bracket being zero where it would be negative. No branch and, but for the two splines, no division: these are
 * evaluated for whole vectors of pairs, most of whose time is spent here. */
#ifndef CAST_KERNEL_PAIR_H
#define CAST_KERNEL_PAIR_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "cast/kernel/kernel.h"

#define PAIR_INLINE static inline __attribute__((always_inline, unused))

static const double pair_pi = 3.14159265358979323846;

PAIR_INLINE double shape_support(KernelKind kind)
{
  return kind == KERNEL_QUINTIC_SPLINE ? 3.0 : kind == KERNEL_LUCY ? 1.0 : 2.0;
}

PAIR_INLINE double shape_norm(KernelKind kind)
{
  switch (kind) {
  case KERNEL_CUBIC_SPLINE:
    return 1.0 / (4.0 * pair_pi);
  case KERNEL_QUINTIC_SPLINE:
    return 1.0 / (120.0 * pair_pi);
  case KERNEL_LUCY:
    return 105.0 / (16.0 * pair_pi);
  case KERNEL_WENDLAND_C2:
  default:
    return 21.0 / (16.0 * pair_pi);
  }
}

/* A bound on the steepest slope -w'(q) = q f(q), for the kernel without its norm. */
PAIR_INLINE double shape_steepest(KernelKind kind)
{
  switch (kind) {
  case KERNEL_CUBIC_SPLINE:
    return 4.0; // at q = 2/3
  case KERNEL_QUINTIC_SPLINE:
    return 56.0; // 55.2 at q = 0.76
  case KERNEL_LUCY:
    return 1.8; // 16/9 at q = 1/3
  case KERNEL_WENDLAND_C2:
  default:
    return 1.06; // 135/128 at q = 1/2
  }
}

/* Rounded to the nearest whole number, halves to the even one: -x gives the opposite. gcc makes vectors of this
 * builtin, not of lrintf with its long result. */
PAIR_INLINE int32_t nearest_whole(float x)
{
#if defined(__GNUC__) && !defined(__clang__)
  return __builtin_irintf(x);
#else
  return (int32_t)lrintf(x);
#endif
}

#define REAL double
#define NAME(name) name
#include "cast/kernel/pair_formulas.h"
#undef NAME
#undef REAL

#define REAL float
#define NAME(name) name##_f
#include "cast/kernel/pair_formulas.h"
#undef NAME
#undef REAL

/* ---- one particle's state ---- */

/* Tait: p = rho0 c0^2/gamma ((rho/rho0)^gamma - 1)                                   (docs/theory, eq. 14) */
PAIR_INLINE double tait_pressure(double rho, double rho0, double c0, double gamma)
{
  const double s = rho / rho0, s3 = s * s * s;
  const double power = gamma == 7.0 ? s3 * s3 * s : pow(s, gamma);
  return rho0 * c0 * c0 / gamma * (power - 1.0);
}

/* A drop pulled out of a bulk loses density with its neighbours, and gets it back when it joins one again: a number
 * that says "torn", not that the melt swells. TORN_FROM 2 % of stretching (twice the weak compressibility) it is partly
 * torn, from TORN_WHOLLY 5 % on wholly: torn_fraction goes from 0 to 1. */
#define TORN_FROM 0.98
#define TORN_WHOLLY 0.95

PAIR_INLINE double torn_fraction(double rho, double rho0)
{
  const double missing = (TORN_FROM - rho / rho0) / (TORN_FROM - TORN_WHOLLY);
  return missing > 1.0 ? 1.0 : positive(missing);
}

/* Particles nearer to each other than APART_BELOW spacings are pushed apart, with at most APART_STRENGTH c0^2/rho0 for
 * P_i + P_j (docs/performance, thin features, tells how they were chosen). Melt at rest stands wider. */
#define APART_BELOW 0.8
#define APART_STRENGTH 0.1

/* The density that a particle's volume, kg/m3, and all but its pressure and its continuity go by. */
PAIR_INLINE double whole_density(double rho, double rho0)
{
  const double least = TORN_WHOLLY * rho0;
  return rho > least ? rho : least;
}

/* Pressure that particles act with: Tait's, but a torn melt no longer pulls (else a drop of little density would pull
 * at all it meets, with p/rho^2); with cut_tension none ever does. */
PAIR_INLINE double melt_pressure(double rho, double rho0, double c0, double gamma, bool cut_tension)
{
  const double p = tait_pressure(rho, rho0, c0, gamma), pull = cut_tension ? 0.0 : 1.0 - torn_fraction(rho, rho0);
  return p > 0.0 ? p : p * pull;
}

/* Tait's inverse; a pressure below that of vacuum (-rho0 c0^2/gamma) gives the density of nearly nothing. */
PAIR_INLINE double tait_density(double p, double rho0, double c0, double gamma)
{
  const double s = 1.0 + p * gamma / (rho0 * c0 * c0);
  return rho0 * pow(s > 1e-6 ? s : 1e-6, 1.0 / gamma);
}

/* What density diffusion evens out, kg/m3: integral dp/rho of Tait's equation less the potential of the body forces
 * ("held": g.x + |w x r|^2/2), times rho0/c0^2, so that near rho0 it is rho - rho0 - rho0 held/c0^2. In a fluid
 * at rest grad p = rho g makes it uniform, exactly, so hydrostatic pressure is not diffused away: the aim of Fourtakas
 * et al. 2019 (Comput. Fluids 190), who subtract a hydrostatic density difference pair by pair; as a field of each
 * particle it costs nothing in the pair and holds for any gamma. (Antuono et al. 2010 get there by corrected gradients,
 * a second pass over all pairs.)
 */
PAIR_INLINE double diffused_density(double rho, double rho0, double c0, double gamma, double held)
{
  const double s = rho / rho0, s3 = s * s * s;
  const double power = gamma == 7.0 ? s3 * s3 : pow(s, gamma - 1.0);
  return rho0 * ((power - 1.0) / (gamma - 1.0) - held / (c0 * c0));
}

/* A torn particle would have to be squeezed back to rho0 before its pressure keeps it out of a wall. Until then the
 * wall answers with the pressure rho0 c0 u of sudden impact ("water hammer"), u being the speed into the wall: dv_i/dt
 * = n impact_push, n = sum_j V_j F_ij d over the wall. */
PAIR_INLINE double impact_push(double torn, double c0, double speed_into_wall)
{
  return torn * c0 * positive(speed_into_wall);
}

#endif
