/* triangle_tree.h - triangles in a tree of boxes, for the question
 *   f(x) = min over triangles t of (offset_t + slope * |x - t|).
 * With offset 0 and slope 1 it is the distance to the surface; with the mesh size at the wall as offset and the growth
 * as slope it is the graded mesh size. Exact; constant once built. */
#ifndef REDUCE_MESH_SURFACE_TRIANGLE_TREE_H
#define REDUCE_MESH_SURFACE_TRIANGLE_TREE_H

#include <stddef.h>
#include "common/error.h"

typedef struct TriangleTree TriangleTree;

/*  corners [n*9]  three points a triangle, copied;  offset [n] copied, NULL: all zero
 * Errors: CAST_ERR_ARGUMENT (n = 0), CAST_ERR_MEMORY. */
CastStatus triangle_tree_create(size_t n, const double *corners, const double *offset, double slope,
                                TriangleTree **tree, CastError *err);
void triangle_tree_destroy(TriangleTree **tree);
/* f(x), or `limit` if f(x) is not below it (a small limit makes it cheap). */
double triangle_tree_query(const TriangleTree *tree, const double x[3], double limit);

#endif
