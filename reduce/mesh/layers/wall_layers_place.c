/* wall_layers_place.c - where each column stands, which way it goes, and how many layers its place has room for. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "common/vector.h"
#include "reduce/mesh/layers/wall_layers_private.h"
#include "reduce/mesh/tets/resolution.h"

static const double LARGEST_SHARE = 0.75; // of the height of the tetrahedron behind a wall triangle
static const double SAME_PLANE = 0.9;     // cosine: faces that are facets of one smooth face
static const double LEAST_LIFT = 0.15;    // d . n with each wall triangle: a column nearer to a wall than this is none
static const double LARGEST_STRETCH = 2.5;

typedef struct Incidence { // unit normals of faces at each column, in the faces' order
  size_t *start;           // [n_columns + 1]
  double *normal;          // [n*3]
} Incidence;

typedef struct SortedFace {
  int32_t point[3]; // ascending
  int32_t tet;
} SortedFace;

static int by_points(const void *left, const void *right)
{
  const SortedFace *a = left, *b = right;
  for (int k = 0; k < 3; k++)
    if (a->point[k] != b->point[k]) return a->point[k] < b->point[k] ? -1 : 1;
  return (a->tet > b->tet) - (a->tet < b->tet);
}

static bool touches(const Layers *layers, const int32_t *points, int n)
{
  for (int k = 0; k < n; k++)
    if (layers->column_of[points[k]] >= 0) return true;
  return false;
}

static int32_t *append_face(int32_t *faces, size_t *n, const int32_t *points)
{
  memcpy(faces + 3 * *n, points, 3 * sizeof *points);
  (*n)++;
  return faces;
}

/* Faces at the wall between tetrahedra of different regions, behind those that faces holds already. */
static CastStatus add_interfaces(const Layers *layers, int32_t **faces, size_t *n, CastError *err)
{
  static const int sides[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
  const TetMesh *mesh = layers->mesh;
  size_t near = 0, k = 0;
  for (size_t t = 0; t < mesh->n_tets; t++) near += touches(layers, mesh->tet + 4 * t, 4);
  SortedFace *list = malloc((4 * near + 1) * sizeof *list);
  int32_t *more = realloc(*faces, 3 * (*n + 2 * near + 1) * sizeof *more);
  if (more) *faces = more;
  if (!list || !more) {
    free(list);
    return cast_error_set(err, CAST_ERR_MEMORY, "no memory for the layers");
  }
  for (size_t t = 0; t < mesh->n_tets; t++) {
    if (!touches(layers, mesh->tet + 4 * t, 4)) continue;
    for (int s = 0; s < 4; s++, k++) {
      list[k].tet = (int32_t)t;
      for (int c = 0; c < 3; c++) list[k].point[c] = mesh->tet[4 * t + (size_t)sides[s][c]];
      tet_mesh_sort_corners(list[k].point);
    }
  }
  qsort(list, k, sizeof *list, by_points);
  for (size_t i = 0; i + 1 < k; i++)
    if (memcmp(list[i].point, list[i + 1].point, sizeof list[i].point) == 0 &&
        mesh->tet_region[list[i].tet] != mesh->tet_region[list[i + 1].tet] && touches(layers, list[i].point, 3))
      append_face(*faces, n, list[i].point);
  free(list);
  return CAST_OK;
}

/* The faces in which columns have to stay: the outside's, and those between regions. */
static CastStatus list_fences(const Layers *layers, int32_t **faces, size_t *n, CastError *err)
{
  const TetMesh *mesh = layers->mesh;
  *n = 0;
  *faces = malloc((3 * mesh->n_triangles + 1) * sizeof **faces);
  CAST_CHECK(*faces, err, CAST_ERR_MEMORY, "no memory for the layers");
  for (size_t t = 0; t < mesh->n_triangles; t++)
    if (!layers->grows[t] && touches(layers, mesh->triangle + 3 * t, 3)) append_face(*faces, n, mesh->triangle + 3 * t);
  return layers->config->n_regions > 1 ? add_interfaces(layers, faces, n, err) : CAST_OK;
}

static CastStatus gather_normals(const Layers *layers, size_t n, const int32_t *faces, Incidence *at, CastError *err)
{
  at->start = calloc(layers->n_columns + 2, sizeof *at->start);
  at->normal = malloc((9 * n + 1) * sizeof *at->normal);
  CAST_CHECK(at->start && at->normal, err, CAST_ERR_MEMORY, "no memory for the layers");
  for (size_t i = 0; i < 3 * n; i++)
    if (layers->column_of[faces[i]] >= 0) at->start[layers->column_of[faces[i]] + 2]++;
  for (size_t c = 1; c <= layers->n_columns; c++) at->start[c + 1] += at->start[c];
  for (size_t i = 0; i < n; i++) {
    double normal[3];
    tet_mesh_triangle_normal(layers->mesh, faces + 3 * i, normal);
    const double size = vec_norm(normal);
    for (size_t k = 0; k < 3; k++) {
      const int32_t column = layers->column_of[faces[3 * i + k]];
      if (column < 0) continue;
      double *to = at->normal + 3 * at->start[column + 1]++;
      for (int d = 0; d < 3; d++) to[d] = -normal[d] / size; // into the mould
    }
  }
  return CAST_OK;
}

static void remove_part(double v[3], const double unit[3])
{
  const double part = vec_dot(v, unit);
  for (int d = 0; d < 3; d++) v[d] -= part * unit[d];
}

/* An orthonormal basis of the normals of the planes that meet here; how many. Facets of one smooth face count as one
 * plane, their mean. */
static int span_fences(const double *normal, size_t n, double basis[3][3])
{
  int rank = 0;
  for (size_t i = 0; i < n && rank < 3; i++) {
    double mean[3] = {0, 0, 0};
    for (size_t k = 0; k < n; k++) {
      const double cosine = vec_dot(normal + 3 * i, normal + 3 * k);
      for (int d = 0; fabs(cosine) > SAME_PLANE && d < 3; d++) mean[d] += copysign(normal[3 * k + (size_t)d], cosine);
    }
    for (int d = 0; d < 3; d++) basis[rank][d] = mean[d];
    const double size = vec_norm(mean);
    for (int r = 0; r < rank; r++) remove_part(basis[rank], basis[r]);
    const double left = vec_norm(basis[rank]);
    if (left < sqrt(1.0 - SAME_PLANE * SAME_PLANE) * size) continue;
    for (int d = 0; d < 3; d++) basis[rank][d] /= left;
    rank++;
  }
  return rank;
}

/* The direction of largest least d . n: the centre of the smallest ball about the normals' ends (Badoiu and Clarkson
 * 2003), in the fences' common subspace. Returns the least d . n of the unit direction. */
static double choose_direction(const double *normal, size_t n, const double (*fence)[3], int rank, double unit[3])
{
  enum { STEPS = 400 };
  double c[3] = {0, 0, 0}, least = DBL_MAX;
  for (int step = 0; step < STEPS; step++) {
    double farthest = -1.0, to[3] = {0, 0, 0};
    for (size_t i = 0; i < n; i++) {
      double p[3] = {normal[3 * i], normal[3 * i + 1], normal[3 * i + 2]};
      for (int r = 0; r < rank; r++) remove_part(p, fence[r]);
      const double distance = vec_distance(c, p);
      if (distance <= farthest) continue;
      farthest = distance;
      memcpy(to, p, sizeof to);
    }
    for (int d = 0; d < 3; d++) c[d] += (to[d] - c[d]) / (step + 1);
  }
  const double size = vec_norm(c);
  for (int d = 0; d < 3; d++) unit[d] = size > 0 ? c[d] / size : 0.0;
  for (size_t i = 0; i < n; i++) least = fmin(least, vec_dot(unit, normal + 3 * i));
  return least;
}

static void direct_column(Column *column, const Incidence *wall, const Incidence *fences, size_t c)
{
  double basis[3][3], unit[3];
  const int rank = span_fences(fences->normal + 3 * fences->start[c], fences->start[c + 1] - fences->start[c], basis);
  const double least = choose_direction(wall->normal + 3 * wall->start[c], wall->start[c + 1] - wall->start[c],
                                        (const double(*)[3])basis, rank, unit);
  const double stretch = least > LEAST_LIFT ? fmin(1.0 / least, LARGEST_STRETCH) : 0.0;
  for (int d = 0; d < 3; d++) column->d[d] = stretch * unit[d];
}

static CastStatus direct_columns(Layers *layers, CastError *err)
{
  Incidence wall = {0}, fences = {0};
  int32_t *faces = malloc((3 * layers->n_faces + 1) * sizeof *faces), *fence = NULL;
  size_t n = 0, n_fences = 0;
  CastStatus status = faces ? CAST_OK : cast_error_set(err, CAST_ERR_MEMORY, "no memory for the layers");
  for (size_t i = 0; status == CAST_OK && i < layers->n_faces; i++)
    append_face(faces, &n, layers->mesh->triangle + 3 * layers->face[i]);
  if (status == CAST_OK) status = list_fences(layers, &fence, &n_fences, err);
  if (status == CAST_OK) status = gather_normals(layers, n, faces, &wall, err);
  if (status == CAST_OK) status = gather_normals(layers, n_fences, fence, &fences, err);
  for (size_t c = 0; status == CAST_OK && c < layers->n_columns; c++)
    direct_column(&layers->column[c], &wall, &fences, c);
  free(faces);
  free(fence);
  free(wall.start);
  free(wall.normal);
  free(fences.start);
  free(fences.normal);
  return status;
}

typedef struct Room { // at a column
  double height;      // m, of the least tetrahedron behind its wall triangles
  int most;
} Room;

/* Where wall triangles with different wishes meet, the finer wins. */
static void note_wish(const Layers *layers, int32_t triangle, Room *room)
{
  const TetMesh *mesh = layers->mesh;
  const LayersConfig *wish = &layers->config->cavity[mesh->triangle_surface[triangle]].layers;
  const int32_t tet = mesh->triangle_tet[triangle];
  const Material *material = &layers->config->region[mesh->tet_region[tet]].material;
  const double first = wish->first > 0 ? wish->first : resolution_layer(layers->config, material);
  double normal[3];
  tet_mesh_triangle_normal(mesh, mesh->triangle + 3 * triangle, normal);
  const double height = 6.0 * tet_mesh_tet_volume(mesh, mesh->tet + 4 * tet) / vec_norm(normal);
  for (int k = 0; k < 3; k++) {
    const int32_t c = layers->column_of[mesh->triangle[3 * triangle + k]];
    Column *column = &layers->column[c];
    column->first = column->first > 0 ? fmin(column->first, first) : first;
    column->growth = column->growth > 0 ? fmin(column->growth, wish->growth) : wish->growth;
    room[c].height = room[c].height > 0 ? fmin(room[c].height, height) : height;
    room[c].most = wish->count > room[c].most ? wish->count : room[c].most;
  }
}

/* As many layers as leave the tetrahedron behind its share; one at least where that is thicker than the first. */
static void count_layers(Column *column, const Room *room)
{
  if (vec_norm(column->d) == 0.0 || room->height <= column->first) return;
  column->n = 1;
  column->first = fmin(column->first, 0.5 * room->height);
  while (column->n < room->most && layers_height(column, column->n + 1) <= LARGEST_SHARE * room->height) column->n++;
}

CastStatus layers_place(Layers *layers, CastError *err)
{
  CAST_CALL(direct_columns(layers, err));
  Room *room = calloc(layers->n_columns, sizeof *room);
  CAST_CHECK(room, err, CAST_ERR_MEMORY, "no memory for the layers");
  for (size_t i = 0; i < layers->n_faces; i++) note_wish(layers, layers->face[i], room);
  for (size_t c = 0; c < layers->n_columns; c++) count_layers(&layers->column[c], &room[c]);
  free(room);
  return CAST_OK;
}
