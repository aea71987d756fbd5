/* surface_remesh.h - a closed surface of triangles as an STL file has them, made fit to be a mesh's boundary: long
 * edges are halved, short ones collapsed, and edges turned where that makes the angles better (Delaunay). Edges between
 * triangles of different tags, or that meet at more than the split angle, stay, and so do their corners: points leave
 * the surface nowhere by more than the file's own facets do. */
#ifndef REDUCE_MESH_SURFACE_SURFACE_REMESH_H
#define REDUCE_MESH_SURFACE_SURFACE_REMESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "common/error.h"

typedef struct RemeshSurface { // arrays from malloc; grown and replaced
  size_t n_points, n_triangles;
  double *x;         // [n_points*3]; points that no triangle uses are left behind
  int32_t *triangle; // [n_triangles*3] each edge in two triangles, in opposite directions
  int32_t *tag;      // [n_triangles]
} RemeshSurface;

typedef struct RemeshSize { // the edge length wanted at a place
  double (*at)(const void *context, const double x[3]);
  const void *context;
} RemeshSize;

/* Errors: CAST_ERR_MEMORY. */
CastStatus surface_remesh(RemeshSurface *surface, double split_angle, const RemeshSize *size, CastError *err);
/* Number the connected parts of one tag without sharp edges inside: face [n_triangles] 0..; *n_faces. */
CastStatus surface_faces(const RemeshSurface *surface, double split_angle, int32_t *face, size_t *n_faces,
                         CastError *err);

/* The steps and what they share. */
typedef struct RemeshEdge {
  int32_t low, high;   // points
  int32_t triangle[2]; // that share it
  bool sharp;
} RemeshEdge;

/* All edges by their points; *edges from malloc. */
CastStatus remesh_list_edges(const RemeshSurface *surface, double split_angle, RemeshEdge **edges, size_t *n,
                             CastError *err);
const RemeshEdge *remesh_find_edge(const RemeshEdge *edges, size_t n, int32_t a, int32_t b); // NULL: none
void remesh_normal(const double *x, const int32_t *triangle, double normal[3]);              // twice the area
CastStatus remesh_split(RemeshSurface *surface, double split_angle, const RemeshSize *size, CastError *err);
CastStatus remesh_collapse(RemeshSurface *surface, double split_angle, const RemeshSize *size, size_t *n_done,
                           CastError *err);
CastStatus remesh_flip(RemeshSurface *surface, double split_angle, size_t *n_done, CastError *err);

#endif
