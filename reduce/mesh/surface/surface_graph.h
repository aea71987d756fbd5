/* surface_graph.h - triangles of a surface and which of them are neighbours: what patches are made from. */
#ifndef REDUCE_MESH_SURFACE_SURFACE_GRAPH_H
#define REDUCE_MESH_SURFACE_SURFACE_GRAPH_H

#include <stddef.h>
#include <stdint.h>
#include "common/error.h"

typedef struct SurfaceGraph {
  size_t n;
  double *area;       // [n] m2
  double *centre;     // [n*3] m
  double *normal;     // [n*3] unit
  int32_t *neighbour; // [n*3] across edge k (corner k to k + 1); -1: none in this surface
  double *border;     // [n*3] m, length of the edge
  double *step;       // [n*3] m, from centre to centre over the middle of the edge
  int32_t *entity;    // [n] the geometry's surface that the triangle is part of
} SurfaceGraph;

/*  x [points*3] m, triangle [n*3], entity [n]: borrowed, copied. Each edge may belong to at most two of the triangles.
 * Errors: CAST_ERR_ARGUMENT, CAST_ERR_MEMORY. */
CastStatus surface_graph_create(const double *x, size_t n, const int32_t *triangle, const int32_t *entity,
                                SurfaceGraph **graph, CastError *err);
void surface_graph_destroy(SurfaceGraph **graph);

#endif
