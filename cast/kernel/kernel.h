/* kernel.h - SPH smoothing kernels in three dimensions, W(r) = w(r/h)/h^3, and F with grad W_ij = -(r_i - r_j) F_ij.
 * F >= 0 for all of them. Pure functions; the vectorised loops in physics/ use the same formulas. */
#ifndef CAST_KERNEL_KERNEL_H
#define CAST_KERNEL_KERNEL_H

typedef enum KernelKind { KERNEL_WENDLAND_C2, KERNEL_CUBIC_SPLINE, KERNEL_QUINTIC_SPLINE, KERNEL_LUCY } KernelKind;

/* Support radius in smoothing lengths: 2, 2, 3, and 1 for Lucy. */
double kernel_support(KernelKind kind);
const char *kernel_name(KernelKind kind); // as in input files: "wendland-c2", "cubic-spline", "quintic-spline", "lucy"
double kernel_value(KernelKind kind, double r, double h); // 1/m3
double kernel_slope(KernelKind kind, double r, double h); // F, 1/m5
#endif
