/* outlet.h - where melt may leave: what has come there is taken out, and counted. */
#ifndef CAST_POUR_OUTLET_H
#define CAST_POUR_OUTLET_H

#include "cast/geometry/surface.h"

typedef enum OutletKind { OUTLET_BOX, OUTLET_PLANE, OUTLET_SURFACE } OutletKind;

typedef struct OutletConfig {
  OutletKind kind;
  double corner[3], size[3];     // m, box: melt in it leaves
  double point[3], normal[3];    // m, unit; plane: melt beyond it, on the side that the normal points to, leaves
  char surface[ROM_NAME_LENGTH]; // named surface of the mould: melt that touches it leaves
} OutletConfig;

/* Has melt at x come to the outlet?
 *   is_patch  [rom's patches] those of the named surface; NULL for the other kinds
 *   touch     m, how near to the surface is touching */
bool outlet_takes(const OutletConfig *outlet, const Surface *surface, const uint8_t *is_patch, double touch,
                  const double x[3]);
/* Patches of the named surface, 1 or 0 each, owned by the caller. Errors: CAST_ERR_INPUT: no such surface. */
CastStatus outlet_find_patches(const OutletConfig *outlet, const RomData *rom, uint8_t **is_patch, CastError *err);

#endif
