/* wall_layers.c - which triangles grow layers, and the geometry of a column and of a prism. */
#include "reduce/mesh/layers/wall_layers_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

double layers_height(const Column *column, int k)
{
  const double g = column->growth;
  return column->first * (fabs(g - 1.0) < 1e-9 ? k : (pow(g, k) - 1.0) / (g - 1.0));
}

void layers_point(const Layers *layers, const Column *column, int k, double x[3])
{
  const double *wall = layers->mesh->x + 3 * (size_t)column->wall;
  const double height = layers_height(column, k < column->n ? k : column->n);
  for (int d = 0; d < 3; d++) x[d] = wall[d] + height * column->d[d];
}

int layers_count(const Layers *layers, const int32_t *triangle)
{
  int n = 0;
  for (int k = 0; k < 3; k++) {
    const Column *column = &layers->column[layers->column_of[triangle[k]]];
    n = column->n > n ? column->n : n;
  }
  return n;
}

/* Between (a b c) and (a' b' c'), a < b < c by number, each tetrahedron is a step up by one corner: (a b c c'),
 * (a b b' c'), (a a' b' c'). Where a column has ended there is no step. They wind alternately. */
int layers_cut_prism(const Layers *layers, const int32_t *triangle, int k, int32_t corner[3][4], int level[3][4])
{
  int32_t p[3] = {triangle[0], triangle[1], triangle[2]};
  bool odd = false;
  int n = 0;
  for (int pass = 0; pass < 2; pass++)
    for (int i = 0; i < 2 - pass; i++) {
      if (p[i] < p[i + 1]) continue;
      const int32_t swap = p[i];
      p[i] = p[i + 1];
      p[i + 1] = swap;
      odd = !odd;
    }
  for (int step = 2; step >= 0; step--) {
    if (layers->column[layers->column_of[p[step]]].n <= k) continue;
    for (int i = 0; i < 4; i++) {
      const int at = (odd == (step == 1)) && i < 2 ? 1 - i : i; // the wall's triangles look out of the mould
      corner[n][at] = i <= step ? p[i] : p[i - 1];
      level[n][at] = i <= step ? k : k + 1;
    }
    n++;
  }
  return n;
}

static bool has_layers(const ReduceConfig *config, int32_t surface)
{
  return (size_t)surface < config->n_cavity && config->cavity[surface].layers.kind != LAYERS_NONE;
}

static CastStatus pick_faces(Layers *layers, CastError *err)
{
  const TetMesh *mesh = layers->mesh;
  layers->face = malloc((mesh->n_triangles + 1) * sizeof *layers->face);
  layers->grows = calloc(mesh->n_triangles + 1, sizeof *layers->grows);
  layers->column_of = malloc((mesh->n_points + 1) * sizeof *layers->column_of);
  CAST_CHECK(layers->face && layers->grows && layers->column_of, err, CAST_ERR_MEMORY, "no memory for the layers");
  for (size_t i = 0; i < mesh->n_points; i++) layers->column_of[i] = -1;
  for (size_t t = 0; t < mesh->n_triangles; t++) {
    if (!has_layers(layers->config, mesh->triangle_surface[t])) continue;
    layers->face[layers->n_faces++] = (int32_t)t;
    layers->grows[t] = true;
    for (size_t k = 0; k < 3; k++) layers->column_of[mesh->triangle[3 * t + k]] = 0;
  }
  for (size_t i = 0; i < mesh->n_points; i++)
    if (layers->column_of[i] == 0) layers->column_of[i] = (int32_t)layers->n_columns++;
  layers->column = calloc(layers->n_columns + 1, sizeof *layers->column);
  CAST_CHECK(layers->column, err, CAST_ERR_MEMORY, "no memory for the layers");
  for (size_t i = 0; i < mesh->n_points; i++)
    if (layers->column_of[i] >= 0) layers->column[layers->column_of[i]].wall = (int32_t)i;
  return CAST_OK;
}

static CastStatus grow(Layers *layers, CastError *err)
{
  CAST_CALL(pick_faces(layers, err));
  if (layers->n_faces == 0) return CAST_OK;
  CAST_CALL(layers_place(layers, err));
  CAST_CALL(layers_fit(layers, err));
  CAST_CALL(layers_build(layers, err));
  return tet_mesh_check(layers->mesh, layers->config, err);
}

CastStatus wall_layers_grow(TetMesh *mesh, const ReduceConfig *config, CastError *err)
{
  Layers layers = {.mesh = mesh, .config = config};
  const CastStatus status = grow(&layers, err);
  free(layers.face);
  free(layers.grows);
  free(layers.column_of);
  free(layers.column);
  return status;
}
