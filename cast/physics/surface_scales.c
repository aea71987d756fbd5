#include "cast/physics/surface_scales.h"

#include "cast/kernel/interface.h"

/* g(z) = 2 pi int_z W r dr, the gradient of the fill z below a flat surface */
static double flat_gradient(KernelKind kernel, double h, double z)
{
  enum { PARTS = 200 };
  const double step = (kernel_support(kernel) * h - z) / PARTS;
  double sum = 0.0;
  for (int k = 0; k < PARTS; k++) {
    const double r = z + (k + 0.5) * step;
    sum += r * kernel_value(kernel, r, h) * step;
  }
  return 2.0 * pair_pi * sum;
}

/* c(z) = 1/2 + int_0^z g, the fill at the depth z */
static double flat_fill(KernelKind kernel, double h, double z)
{
  enum { PARTS = 100 };
  double sum = 0.5;
  for (int k = 0; k < PARTS; k++) sum += flat_gradient(kernel, h, (k + 0.5) * z / PARTS) * z / PARTS;
  return sum;
}

static void set_depths(KernelKind kernel, double h, SurfaceScales *scales)
{
  enum { PARTS = 400 };
  const double step = kernel_support(kernel) * h / PARTS;
  double depth = 0.0, share = 0.0;
  for (int k = 0; k < PARTS; k++) {
    const double z = (k + 0.5) * step,
                 w = interface_share(flat_gradient(kernel, h, z) / scales->flat, interface_measured_low);
    scales->radius += 4.0 * pair_pi * z * z * z * kernel_value(kernel, z, h) * step;
    depth += w * z;
    share += w;
  }
  scales->depth = depth / share;
}

/* What crosses a plane at right angles to a flat surface or wall is to be the tension: pairs across the plane see c of
 * the stress at the depth where melt fills c, which a wall's stress is divided by already. Melt that has settled lies
 * in layers, the first half a spacing deep. */
static void set_stresses(KernelKind kernel, double h, double spacing, SurfaceScales *scales)
{
  double free = 0.0, wet = 0.0;
  for (double z = 0.5 * spacing; z < kernel_support(kernel) * h; z += spacing) {
    const double g = flat_gradient(kernel, h, z);
    free += interface_stress(g / scales->flat) * flat_fill(kernel, h, z) * spacing;
    wet += g * spacing;
  }
  scales->free = 1.0 / free;
  scales->wet = 1.0 / wet;
}

SurfaceScales surface_scales(KernelKind kernel, double h, double spacing)
{
  SurfaceScales scales = {.flat = flat_gradient(kernel, h, 0.0)};
  set_depths(kernel, h, &scales);
  set_stresses(kernel, h, spacing, &scales);
  return scales;
}
