/* wall_geometry_sort.c - an order by place, the same on any number of ranks. */
#include <stdlib.h>
#include <string.h>
#include "reduce/io/wall_geometry_private.h"

typedef struct PlacedPoint {
  double x[3];
  PetscInt number; // global
  size_t from;     // place before sorting
  int32_t to;      // place after
} PlacedPoint;

static int by_place(const void *left, const void *right)
{
  const PlacedPoint *a = left, *b = right;
  for (int d = 0; d < 3; d++)
    if (a->x[d] != b->x[d]) return a->x[d] < b->x[d] ? -1 : 1;
  return (a->number > b->number) - (a->number < b->number);
}

static int by_number(const void *left, const void *right)
{
  const PlacedPoint *a = left, *b = right;
  return (a->number > b->number) - (a->number < b->number);
}

/* Rows of four: patch and three points, or four points. */
static int by_row(const void *left, const void *right)
{
  const int32_t *a = left, *b = right;
  for (int k = 0; k < 4; k++)
    if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
  return 0;
}

static int32_t find_point(const PlacedPoint *points, size_t n, PetscInt number)
{
  const PlacedPoint key = {.number = number};
  const PlacedPoint *found = bsearch(&key, points, n, sizeof key, by_number);
  return found ? found->to : -1;
}

/* Points and basis in their new order; on return `placed` is sorted by global number. */
static CastStatus sort_points(WallGeometry *geometry, const PetscInt *number, PlacedPoint *placed, CastError *err)
{
  const size_t n = geometry->n_points, r = (size_t)geometry->r;
  float *basis = malloc((n * r + 1) * sizeof *basis);
  CAST_CHECK(basis, err, CAST_ERR_MEMORY, "no memory for the basis at the mould's wall");
  for (size_t i = 0; i < n; i++) {
    memcpy(placed[i].x, geometry->points + 3 * i, sizeof placed[i].x);
    placed[i].number = number[i];
    placed[i].from = i;
  }
  qsort(placed, n, sizeof *placed, by_place);
  for (size_t i = 0; i < n; i++) {
    placed[i].to = (int32_t)i;
    memcpy(geometry->points + 3 * i, placed[i].x, sizeof placed[i].x);
    memcpy(basis + i * r, geometry->basis + placed[i].from * r, r * sizeof *basis);
  }
  free(geometry->basis);
  geometry->basis = basis;
  qsort(placed, n, sizeof *placed, by_number);
  return CAST_OK;
}

/* Bring the least point to the front without changing the sense of rotation. */
static void rotate(int32_t p[3])
{
  while (p[0] > p[1] || p[0] > p[2]) {
    const int32_t first = p[0];
    p[0] = p[1];
    p[1] = p[2];
    p[2] = first;
  }
}

static void sort_triangles(WallGeometry *geometry, const PetscInt *triangle, const PlacedPoint *placed, int32_t *row)
{
  const size_t n = geometry->n_triangles;
  for (size_t t = 0; t < n; t++) {
    row[4 * t] = (int32_t)triangle[4 * t + 3];
    for (size_t k = 0; k < 3; k++) row[4 * t + 1 + k] = find_point(placed, geometry->n_points, triangle[4 * t + k]);
    rotate(row + 4 * t + 1);
  }
  qsort(row, n, 4 * sizeof *row, by_row);
  for (size_t t = 0; t < n; t++) {
    geometry->triangle_patch[t] = row[4 * t];
    memcpy(geometry->triangles + 3 * t, row + 4 * t + 1, 3 * sizeof *row);
  }
}

static void sort_tetrahedra(WallGeometry *geometry, const PetscInt *tetrahedron, const PlacedPoint *placed)
{
  const size_t n = geometry->n_tetrahedra;
  for (size_t i = 0; i < 4 * n; i++) geometry->tetrahedra[i] = find_point(placed, geometry->n_points, tetrahedron[i]);
  qsort(geometry->tetrahedra, n, 4 * sizeof *geometry->tetrahedra, by_row);
}

CastStatus wall_geometry_sort(WallGeometry *geometry, const PetscInt *number, const PetscInt *triangle,
                              const PetscInt *tetrahedron, CastError *err)
{
  PlacedPoint *placed = malloc((geometry->n_points + 1) * sizeof *placed);
  int32_t *row = malloc((4 * geometry->n_triangles + 1) * sizeof *row);
  geometry->triangles = malloc((3 * geometry->n_triangles + 1) * sizeof *geometry->triangles);
  geometry->triangle_patch = malloc((geometry->n_triangles + 1) * sizeof *geometry->triangle_patch);
  geometry->tetrahedra = malloc((4 * geometry->n_tetrahedra + 1) * sizeof *geometry->tetrahedra);
  CastStatus status = CAST_ERR_MEMORY;
  if (placed && row && geometry->triangles && geometry->triangle_patch && geometry->tetrahedra) {
    status = sort_points(geometry, number, placed, err);
    if (status == CAST_OK) {
      sort_triangles(geometry, triangle, placed, row);
      sort_tetrahedra(geometry, tetrahedron, placed);
    }
  } else {
    cast_error_set(err, CAST_ERR_MEMORY, "no memory for the mould's wall");
  }
  free(placed);
  free(row);
  return status;
}
