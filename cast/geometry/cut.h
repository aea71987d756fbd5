/* cut.h - how much of a box the mould fills, and where: volume and first moment of (box and mould).
 * Exact where the surface in the box is a plane, convex or concave; else the box is cut in eight, down to an eighth of
 * its edge, where the tangent plane at the nearest point stands for the surface. */
#ifndef CAST_GEOMETRY_CUT_H
#define CAST_GEOMETRY_CUT_H

#include "cast/geometry/surface_internal.h"

typedef struct CutPart {
  double volume;    // m3
  double moment[3]; // m4, about the origin
} CutPart;

typedef struct CutBox {
  double low[3], high[3]; // m
} CutBox;

void cut_add(CutPart *part, double scale, const CutPart *other); // part += scale other
void cut_whole(const CutBox *box, CutPart *part);
/* The part of the box inside the mould. `sheet`: NULL for the whole surface; else the foot of a thin wall's side, and
 * only triangles that face as it does (less than 107 degrees apart) and are in its sight count, as if they were the
 * mould's only wall and the box, where none of them passes, lay behind it. Returns whether any of those triangles
 * passes through the box. */
bool cut_box(const Surface *surface, const CutBox *box, const SurfaceHit *sheet, CutPart *part);

#endif
