/* placement.h - where melt stands at the start, and what the cavity's volume is. */
#ifndef CAST_GEOMETRY_PLACEMENT_H
#define CAST_GEOMETRY_PLACEMENT_H

#include "cast/geometry/surface.h"

typedef struct PointSet {
  ptrdiff_t n;
  double *x[3]; // m
} PointSet;
void points_destroy(PointSet *points);
/* Room for `more` points; n is left as it is. Errors: CAST_ERR_MEMORY. */
CastStatus points_reserve(PointSet *points, ptrdiff_t more, CastError *err);
/* Is x outside the mould, and its surface at least `clearance` m away? */
bool placement_is_clear(const Surface *surface, const double x[3], double clearance);

/* Lattice points origin + (i + 1/2) spacing inside the box [corner, corner + size] that are outside the mould and at
 * least 0.4 spacing from its surface; appended to `points` (start from a zeroed set). Errors: CAST_ERR_INPUT if none.
 */
CastStatus placement_add_block(const Surface *surface, double spacing, const double origin[3], const double corner[3],
                               const double size[3], PointSet *points, CastError *err);
/* The same for the whole cavity below height z = level (m). */
CastStatus placement_add_cavity_below(const Surface *surface, double spacing, const double origin[3], double level,
                                      PointSet *points, CastError *err);

/* The cavity as lattice cells: void cells within the bounding box of the cavity wall (it ends at the rims of openings)
 * that are connected to that wall; their volumes add up to the cavity's. Each belongs to the named surface nearest to
 * it, so that filling can be told by feature. A mould whose cavity wall is flat has none. */
typedef struct CavityCells {
  ptrdiff_t n;
  double cell;      // m, edge
  double *x[3];     // m, centres (of the part that is void)
  double *volume;   // m3, void part of the cell
  int32_t *surface; // index into names
  size_t n_surfaces;
  char (*names)[ROM_NAME_LENGTH]; // named cavity surfaces, in the ROM's order
} CavityCells;
CastStatus cavity_cells_create(const Surface *surface, const RomData *rom, double spacing, const double origin[3],
                               CavityCells *cells, CastError *err);
void cavity_cells_destroy(CavityCells *cells);
/* Width (m) of the thinnest cavity feature, for the report before a run: rays from points of the cavity wall straight
 * to the wall that faces them; the width that 1 % of the wall's area stays below. where: such a point. If no walls face
 * each other, the least extent of the cavity wall. Errors: CAST_ERR_INPUT without cavity wall, CAST_ERR_MEMORY. */
CastStatus cavity_thinnest_gap(const Surface *surface, double *gap, double where[3], CastError *err);

#endif
