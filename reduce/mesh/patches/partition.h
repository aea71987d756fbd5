/* partition.h - cut a surface into compact, connected parts of equal area that do not wrap round edges.
 *
 * 1. Charts: the surface is cut where two of the geometry's faces meet at a sharp angle; charts far smaller than a part
 *    (the tip of a pin) join the neighbour with which they share the longest border.
 * 2. Each chart of area S gets n = round(S/target) parts, at least one, each meant to have S/n. Seeds are spread by
 *    farthest-point sampling; then Lloyd's iteration: every triangle goes to the seed nearest along the surface
 * (Dijkstra over triangle centres), the seed moves to the middle of its part. Each seed's distance carries a weight
 * that grows while its part is too small (an additively weighted Voronoi diagram): a part is connected, as a shortest
 * path never leaves it.
 * 3. Triangles on borders change sides while that lowers sum (A_l/A - 1)^2 + c * border/sqrt(A) and parts stay
 * connected. No randomness; ties go to the lower index. */
#ifndef REDUCE_MESH_PATCHES_PARTITION_H
#define REDUCE_MESH_PATCHES_PARTITION_H

#include "reduce/mesh/surface/surface_graph.h"

/*  target_area  m2;  0: one part for the whole surface
 *  part [n]     out: number of each triangle's part, 0 .. n_parts-1, numbered by their first triangles
 * Errors: CAST_ERR_MEMORY. */
CastStatus partition_surface(const SurfaceGraph *graph, double target_area, int32_t *part, size_t *n_parts,
                             CastError *err);

/* The steps. */

/* Step 1: number the charts 0.. in chart [n]. */
CastStatus partition_charts(const SurfaceGraph *graph, double target_area, int32_t *chart, size_t *n_charts,
                            CastError *err);
/* Step 2: parts first .. first+n_parts-1 for the triangles listed, which are one connected chart. */
CastStatus partition_grow(const SurfaceGraph *graph, size_t n, const int32_t *triangles, size_t n_parts, int32_t first,
                          int32_t *part, CastError *err);
/* Step 3, over the same triangles. */
CastStatus partition_balance(const SurfaceGraph *graph, size_t n, const int32_t *triangles, size_t n_parts,
                             int32_t first, int32_t *part, CastError *err);

#endif
