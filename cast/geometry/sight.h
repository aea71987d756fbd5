/* sight.h - what a place in the void sees for certain: a quick yes where surface_separates and walls_seen would look
 * along the way; where the answer is false they must be asked. */
#ifndef CAST_GEOMETRY_SIGHT_H
#define CAST_GEOMETRY_SIGHT_H

#include "cast/geometry/surface.h"

enum { SIGHT_MOST = 512, SIGHT_MET = 2048 };

typedef struct SightPlanes {
  int32_t n;
  double normal[3][SIGHT_MOST], offset[SIGHT_MOST]; // the plane normal . x = offset
} SightPlanes;

typedef struct Sight {
  const Surface *surface;
  double from[3];
  double range, overhang, margin; // m
  bool usable;                    // false: too many triangles, nothing is certain
  int32_t n_met, met[SIGHT_MET];  // a hashed set of the triangles met
  SightPlanes behind, front;      // of the triangles that `from` lies behind and in front of
} Sight;

/* Look round from x, which is not in the mould; the other ends lie within `length` m. */
void sight_from(const Surface *surface, const double x[3], double length, Sight *sight);
/* Surely nothing separates `from` and y, which is not in the mould either. */
bool sight_is_free(const Sight *sight, const double y[3]);
/* Surely `from` sees the wall particle at `place` (not an echo) with this normal. */
bool sight_meets_wall(const Sight *sight, const double place[3], const double normal[3]);
/* Surely no mould lies on the way to `place`: an echo there is not felt. */
bool sight_enters_nothing(const Sight *sight, const double place[3]);

#endif
