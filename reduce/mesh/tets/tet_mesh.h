/* tet_mesh.h - the whole mould as plain arrays on one rank, between the mesher and the distributed mesh. */
#ifndef REDUCE_MESH_TETS_TET_MESH_H
#define REDUCE_MESH_TETS_TET_MESH_H

#include <stddef.h>
#include <stdint.h>
#include "reduce/config/config.h"

typedef struct TetMesh {
  size_t n_points, n_tets, n_triangles;
  size_t n_layer_tets;       // the last ones are thin layers at the cavity wall
  double *x;                 // [n_points*3] m
  int32_t *tet;              // [n_tets*4] points; volume (x1-x0) x (x2-x0) . (x3-x0) / 6 > 0 once checked
  int32_t *tet_region;       // [n_tets] region of the config
  size_t *tet_tag;           // [n_tets] the mesher's number, for messages
  int32_t *triangle;         // [n_triangles*3] points; once checked: the boundary, wound out of the mould
  int32_t *triangle_surface; // [n_triangles] surface (cavity's first, then the outer ones), -1: none
  int32_t *triangle_entity;  // [n_triangles] the geometry's surface that it is part of
  int32_t *triangle_tet;     // [n_triangles] the tetrahedron behind it; NULL before the check
} TetMesh;

typedef struct TetMeshMeasures {
  double volume;         // m3
  double worst_quality;  // least radius ratio 3 r_in/r_out: 1 for a regular tetrahedron, 0 for a flat one; of those
                         // outside the layers, which are flat by intent
  double worst_place[3]; // m, where it is
  double shortest_edge;  // m, of the cavity's triangles
  double first_layer;    // m, median height over the cavity's triangles of the tetrahedra behind them
  double thick_layer;    // m, the height that 95 % of the cavity's area stay below
} TetMeshMeasures;

CastStatus tet_mesh_create(size_t n_points, size_t n_tets, size_t n_triangles, TetMesh **mesh, CastError *err);
void tet_mesh_destroy(TetMesh **mesh);

/* Check that the tetrahedra are positive, in a region, in one connected piece, and that their boundary is closed,
 * does not touch itself and is named everywhere; then keep of the triangles the boundary alone, wound outwards.
 * Errors: CAST_ERR_INPUT with all faults, by element, entity, region and place. */
CastStatus tet_mesh_check(TetMesh *mesh, const ReduceConfig *config, CastError *err);
/* The mesh must have been checked. */
CastStatus tet_mesh_measure(const TetMesh *mesh, const ReduceConfig *config, TetMeshMeasures *measures, CastError *err);

/* Twice the area, along the normal, m2. */
void tet_mesh_triangle_normal(const TetMesh *mesh, const int32_t *triangle, double normal[3]);
double tet_mesh_tet_volume(const TetMesh *mesh, const int32_t *tet); // m3, signed
double tet_mesh_tet_quality(const TetMesh *mesh, const int32_t *tet);
void tet_mesh_sort_corners(int32_t corner[3]); // of a triangle, ascending

#endif
