/* cavity_names.h - the named surface that is nearest to each cell of the cavity; for cavity_cells.c. */
#ifndef CAST_GEOMETRY_CAVITY_NAMES_H
#define CAST_GEOMETRY_CAVITY_NAMES_H

#include "cast/geometry/cavity_mask.h"
#include "cast/geometry/placement.h"

/* Fill cells->surface from cells->x.
 *   list           [cells->n] ascending numbers in the mask
 *   name_of_patch  [patches] index into cells->names, -1: an outer one
 * Errors: CAST_ERR_MEMORY. */
CastStatus cavity_name_cells(const CavityMask *mask, const int32_t *list, const int32_t *name_of_patch,
                             CavityCells *cells, CastError *err);

#endif
