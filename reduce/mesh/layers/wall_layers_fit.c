/* wall_layers_fit.c - lower the columns until all volumes are good. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "common/vector.h"
#include "reduce/mesh/layers/wall_layers_private.h"

static const double LEAST_VOLUME = 0.12;  // of a squeezed tetrahedron, of what it was
static const double LEAST_QUALITY = 0.35; // the same of its radius ratio, where that is below GOOD_QUALITY then
static const double GOOD_QUALITY = 0.12;
static const double LEAST_PIECE = 0.2; // of a piece of a prism, of its third of area times height

/* A tetrahedron of its own, to be measured. */
static TetMesh lone_tet(double x[12])
{
  return (TetMesh){.n_points = 4, .n_tets = 1, .x = x};
}

static const int32_t ALL[4] = {0, 1, 2, 3};

static bool is_squeezed_well(const Layers *layers, const int32_t *tet)
{
  double x[12];
  for (int k = 0; k < 4; k++) {
    const int32_t c = layers->column_of[tet[k]];
    if (c >= 0)
      layers_point(layers, &layers->column[c], layers->column[c].n, x + 3 * k);
    else
      memcpy(x + 3 * k, layers->mesh->x + 3 * (size_t)tet[k], 3 * sizeof *x);
  }
  const TetMesh lone = lone_tet(x);
  if (tet_mesh_tet_volume(&lone, ALL) < LEAST_VOLUME * tet_mesh_tet_volume(layers->mesh, tet)) return false;
  const double quality = tet_mesh_tet_quality(&lone, ALL);
  return quality > GOOD_QUALITY || quality > LEAST_QUALITY * tet_mesh_tet_quality(layers->mesh, tet);
}

static bool is_cut_well(const Layers *layers, const int32_t *triangle, int k)
{
  int32_t corner[3][4];
  int level[3][4];
  double normal[3];
  const int n = layers_cut_prism(layers, triangle, k, corner, level);
  tet_mesh_triangle_normal(layers->mesh, triangle, normal);
  const double area = 0.5 * vec_norm(normal);
  for (int i = 0; i < n; i++) {
    double x[12], rise = 0.0;
    for (int c = 0; c < 4; c++) {
      const Column *column = &layers->column[layers->column_of[corner[i][c]]];
      layers_point(layers, column, level[i][c], x + 3 * c);
      if (level[i][c] == k + 1 && k < column->n)
        rise = fmax(rise, layers_height(column, k + 1) - layers_height(column, k));
    }
    const TetMesh lone = lone_tet(x);
    if (tet_mesh_tet_volume(&lone, ALL) < LEAST_PIECE * area * rise / 3.0) return false;
  }
  return true;
}

static void lower_at(const Layers *layers, const int32_t *points, int n, bool *lower)
{
  for (int k = 0; k < n; k++)
    if (layers->column_of[points[k]] >= 0) lower[layers->column_of[points[k]]] = true;
}

/* All faults are found before any column is lowered, so that the order of the elements does not matter. */
static bool find_faults(const Layers *layers, bool *lower)
{
  const TetMesh *mesh = layers->mesh;
  bool found = false;
  for (size_t t = 0; t < mesh->n_tets; t++) {
    const int32_t *tet = mesh->tet + 4 * t;
    int n = 0;
    for (int k = 0; k < 4; k++) n += layers->column_of[tet[k]] >= 0 && layers->column[layers->column_of[tet[k]]].n > 0;
    if (n == 0 || is_squeezed_well(layers, tet)) continue;
    lower_at(layers, tet, 4, lower);
    found = true;
  }
  for (size_t i = 0; i < layers->n_faces; i++) {
    const int32_t *triangle = mesh->triangle + 3 * layers->face[i];
    bool good = true;
    for (int k = 0; good && k < layers_count(layers, triangle); k++) good = is_cut_well(layers, triangle, k);
    if (good) continue;
    lower_at(layers, triangle, 3, lower);
    found = true;
  }
  return found;
}

CastStatus layers_fit(Layers *layers, CastError *err)
{
  bool *lower = malloc(layers->n_columns + 1);
  CAST_CHECK(lower, err, CAST_ERR_MEMORY, "no memory for the layers");
  for (bool again = true; again;) {
    memset(lower, 0, layers->n_columns);
    again = find_faults(layers, lower);
    for (size_t c = 0; c < layers->n_columns; c++)
      if (lower[c] && layers->column[c].n > 0) layers->column[c].n--;
  }
  free(lower);
  return CAST_OK;
}
