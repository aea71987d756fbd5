/* wall_layers_private.h - the steps behind wall_layers.h. */
#ifndef REDUCE_MESH_LAYERS_WALL_LAYERS_PRIVATE_H
#define REDUCE_MESH_LAYERS_WALL_LAYERS_PRIVATE_H

#include "reduce/mesh/layers/wall_layers.h"

typedef struct Column { // of points over a wall point
  int32_t wall;         // that point
  int32_t above;        // point w_1; the others follow
  int n;                // layers; 0: none here
  double d[3];          // direction, scaled: t d is t away from the farthest plane of the wall at the point
  double first, growth; // m
} Column;

typedef struct Layers {
  TetMesh *mesh; // borrowed
  const ReduceConfig *config;
  size_t n_faces, n_columns;
  int32_t *face;      // [n_faces] owned: the mesh's triangles that layers grow on
  bool *grows;        // [mesh->n_triangles] owned: is it one of those?
  int32_t *column_of; // [mesh->n_points] owned: -1: not on the wall
  Column *column;     // [n_columns] owned
} Layers;

/* The columns with their directions and the most layers for which there is room over the wall triangles. */
CastStatus layers_place(Layers *layers, CastError *err);
/* Lower n until all volumes are good. */
CastStatus layers_fit(Layers *layers, CastError *err);
/* The mesh with the layers in it; unchecked. */
CastStatus layers_build(const Layers *layers, CastError *err);

/* t_k of a column, m. */
double layers_height(const Column *column, int k);
/* w_k, m; above the column's top: the top. */
void layers_point(const Layers *layers, const Column *column, int k, double x[3]);
/* The tetrahedra of layer k (0: at the wall) over a wall triangle: corners as (corner of `order`, level above the
 * wall), those that collapse left out. order: the triangle's corners by number. Returns how many. */
int layers_cut_prism(const Layers *layers, const int32_t *triangle, int k, int32_t corner[3][4], int level[3][4]);
int layers_count(const Layers *layers, const int32_t *triangle); // layers over a triangle: the most of its columns

#endif
