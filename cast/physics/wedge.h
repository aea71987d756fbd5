/* wedge.h - what a kernel sees of a wedge of melt between a wall and a free surface that meets it at the contact
 * angle, and what it would see were there melt behind the wall as well, under the same plane.  (docs/theory, Surface
 * tension) The wedge is exact: a flat wall, a flat surface; integrals over the kernel, tabulated over what a particle
 * knows, how much of its kernel walls fill and how much of the rest melt fills. Lengths in h. */
#ifndef CAST_PHYSICS_WEDGE_H
#define CAST_PHYSICS_WEDGE_H

#include "cast/kernel/kernel.h"
#include "common/error.h"

typedef struct Wedge Wedge; // of one contact angle; constant once created

typedef struct WedgePlace { // of a particle near a wall
  double height;            // h, above the wall
  double depth;             // h, below the surface
  double lean;              // what is missing to n . away of the surface's normal
  double raise;             // size of the true gradient over that seen
} WedgePlace;

/*  contact_angle  rad, in the melt
 * Errors: CAST_ERR_MEMORY. */
CastStatus wedge_create(KernelKind kernel, double contact_angle, Wedge **wedge, CastError *err);
void wedge_destroy(Wedge **wedge);
/*  walls  share of the kernel that walls fill;  fill  share of the rest that melt fills */
WedgePlace wedge_look(const Wedge *wedge, double walls, double fill);

#endif
