/* surface_scales.h - what a kernel makes of a flat surface of melt: numbers that surface tension counts in.
 *                                                                                  (docs/theory, Surface tension) */
#ifndef CAST_PHYSICS_SURFACE_SCALES_H
#define CAST_PHYSICS_SURFACE_SCALES_H

#include "cast/kernel/kernel.h"

typedef struct SurfaceScales {
  double flat;   // 1/m, gradient of the fill at a flat surface
  double radius; // m, mean radius of the kernel
  double depth;  // m, mean depth of particles whose curvature is measured
  double free;   // 1/m, stress of the free surface over sigma and interface_stress
  double wet;    // stress on a wall over its tension, the gradient of what it fills and 1 - that
} SurfaceScales;

/*  h, spacing  m */
SurfaceScales surface_scales(KernelKind kernel, double h, double spacing);

#endif
