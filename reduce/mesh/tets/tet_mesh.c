/* tet_mesh.c - storage and measures; the checks are in tet_mesh_check.c. */
#include "reduce/mesh/tets/tet_mesh.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>
#include "common/vector.h"

CastStatus tet_mesh_create(size_t n_points, size_t n_tets, size_t n_triangles, TetMesh **mesh, CastError *err)
{
  *mesh = NULL;
  CAST_CHECK(n_points < INT32_MAX && n_tets < INT32_MAX / 4 && n_triangles < INT32_MAX / 3, err, CAST_ERR_INPUT,
             "a mesh of %zu points and %zu tetrahedra is too large: at most %d tetrahedra", n_points, n_tets,
             INT32_MAX / 4);
  TetMesh *made = calloc(1, sizeof *made);
  CAST_CHECK(made, err, CAST_ERR_MEMORY, "no memory for the mesh");
  made->n_points = n_points;
  made->n_tets = n_tets;
  made->n_triangles = n_triangles;
  made->x = calloc(3 * n_points + 1, sizeof *made->x);
  made->tet = calloc(4 * n_tets + 1, sizeof *made->tet);
  made->tet_region = calloc(n_tets + 1, sizeof *made->tet_region);
  made->tet_tag = calloc(n_tets + 1, sizeof *made->tet_tag);
  made->triangle = calloc(3 * n_triangles + 1, sizeof *made->triangle);
  made->triangle_surface = calloc(n_triangles + 1, sizeof *made->triangle_surface);
  made->triangle_entity = calloc(n_triangles + 1, sizeof *made->triangle_entity);
  if (!made->x || !made->tet || !made->tet_region || !made->tet_tag || !made->triangle || !made->triangle_surface ||
      !made->triangle_entity) {
    tet_mesh_destroy(&made);
    return cast_error_set(err, CAST_ERR_MEMORY, "no memory for a mesh of %zu tetrahedra", n_tets);
  }
  *mesh = made;
  return CAST_OK;
}

void tet_mesh_destroy(TetMesh **mesh)
{
  if (!mesh || !*mesh) return;
  TetMesh *old = *mesh;
  free(old->x);
  free(old->tet);
  free(old->tet_region);
  free(old->tet_tag);
  free(old->triangle);
  free(old->triangle_surface);
  free(old->triangle_entity);
  free(old->triangle_tet);
  free(old);
  *mesh = NULL;
}

static const double *point(const TetMesh *mesh, int32_t i)
{
  return mesh->x + 3 * (size_t)i;
}

void tet_mesh_triangle_normal(const TetMesh *mesh, const int32_t *triangle, double normal[3])
{
  double u[3], v[3];
  vec_between(point(mesh, triangle[0]), point(mesh, triangle[1]), u);
  vec_between(point(mesh, triangle[0]), point(mesh, triangle[2]), v);
  vec_cross(u, v, normal);
}

double tet_mesh_tet_volume(const TetMesh *mesh, const int32_t *tet)
{
  double normal[3], w[3];
  tet_mesh_triangle_normal(mesh, tet, normal);
  vec_between(point(mesh, tet[0]), point(mesh, tet[3]), w);
  return vec_dot(normal, w) / 6.0;
}

/* r_in = 3 V/A;  r_out = sqrt(s (s-a)(s-b)(s-c)) / (6 V) with a, b, c the products of opposite edges and 2 s their sum
 * (Crelle's formula). */
double tet_mesh_tet_quality(const TetMesh *mesh, const int32_t *tet)
{
  static const int opposite[3][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}};
  static const int face[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
  const double volume = tet_mesh_tet_volume(mesh, tet);
  double product[3], area = 0.0;
  for (int k = 0; k < 3; k++)
    product[k] = vec_distance(point(mesh, tet[opposite[k][0]]), point(mesh, tet[opposite[k][1]])) *
                 vec_distance(point(mesh, tet[opposite[k][2]]), point(mesh, tet[opposite[k][3]]));
  for (int k = 0; k < 4; k++) {
    const int32_t triangle[3] = {tet[face[k][0]], tet[face[k][1]], tet[face[k][2]]};
    double normal[3];
    tet_mesh_triangle_normal(mesh, triangle, normal);
    area += 0.5 * vec_norm(normal);
  }
  const double s = 0.5 * (product[0] + product[1] + product[2]);
  const double square = s * (s - product[0]) * (s - product[1]) * (s - product[2]);
  if (!(volume > 0.0) || !(square > 0.0)) return 0.0;
  return 3.0 * (3.0 * volume / area) * 6.0 * volume / sqrt(square);
}

void tet_mesh_sort_corners(int32_t p[3])
{
  for (int pass = 0; pass < 2; pass++)
    for (int k = 0; k < 2; k++)
      if (p[k] > p[k + 1]) {
        const int32_t swap = p[k];
        p[k] = p[k + 1];
        p[k + 1] = swap;
      }
}

typedef struct WallHeight {
  double height, area;
} WallHeight;

static int by_height(const void *left, const void *right)
{
  const WallHeight *a = left, *b = right;
  if (a->height != b->height) return a->height < b->height ? -1 : 1;
  return (a->area > b->area) - (a->area < b->area);
}

/* The height below which `share` of the area lies. */
static double height_of_share(size_t n, const WallHeight *wall, double share)
{
  double total = 0.0, below = 0.0;
  size_t i = 0;
  for (size_t k = 0; k < n; k++) total += wall[k].area;
  while (i + 1 < n && below + wall[i].area < share * total) below += wall[i++].area;
  return n > 0 ? wall[i].height : 0.0;
}

static void measure_tets(const TetMesh *mesh, TetMeshMeasures *measures)
{
  for (size_t t = 0; t < mesh->n_tets; t++) {
    const int32_t *tet = mesh->tet + 4 * t;
    measures->volume += tet_mesh_tet_volume(mesh, tet);
    if (t >= mesh->n_tets - mesh->n_layer_tets) continue;
    const double quality = tet_mesh_tet_quality(mesh, tet);
    if (quality >= measures->worst_quality) continue;
    measures->worst_quality = quality;
    memcpy(measures->worst_place, point(mesh, tet[0]), sizeof measures->worst_place);
  }
}

CastStatus tet_mesh_measure(const TetMesh *mesh, const ReduceConfig *config, TetMeshMeasures *measures, CastError *err)
{
  WallHeight *wall = malloc((mesh->n_triangles + 1) * sizeof *wall);
  CAST_CHECK(wall, err, CAST_ERR_MEMORY, "no memory to measure the mesh");
  size_t n = 0;
  *measures = (TetMeshMeasures){.worst_quality = DBL_MAX, .shortest_edge = DBL_MAX};
  measure_tets(mesh, measures);
  for (size_t t = 0; t < mesh->n_triangles; t++) {
    if ((size_t)mesh->triangle_surface[t] >= config->n_cavity) continue;
    const int32_t *triangle = mesh->triangle + 3 * t;
    double normal[3];
    tet_mesh_triangle_normal(mesh, triangle, normal);
    const double area = 0.5 * vec_norm(normal);
    wall[n++] =
        (WallHeight){3.0 * tet_mesh_tet_volume(mesh, mesh->tet + 4 * (size_t)mesh->triangle_tet[t]) / area, area};
    for (int k = 0; k < 3; k++)
      measures->shortest_edge =
          fmin(measures->shortest_edge, vec_distance(point(mesh, triangle[k]), point(mesh, triangle[(k + 1) % 3])));
  }
  qsort(wall, n, sizeof *wall, by_height);
  measures->first_layer = n > 0 ? wall[n / 2].height : 0.0;
  measures->thick_layer = height_of_share(n, wall, 0.95);
  free(wall);
  return CAST_OK;
}
