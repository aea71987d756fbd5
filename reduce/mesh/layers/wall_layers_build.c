/* wall_layers_build.c - the mesh with its layers, as new arrays. */
#include <stdlib.h>
#include <string.h>
#include "reduce/mesh/layers/wall_layers_private.h"

static int32_t top_of(const Layers *layers, int32_t point)
{
  const int32_t c = layers->column_of[point];
  return c >= 0 && layers->column[c].n > 0 ? layers->column[c].above + layers->column[c].n - 1 : point;
}

static int32_t point_at(const Layers *layers, int32_t point, int level)
{
  const Column *column = &layers->column[layers->column_of[point]];
  const int k = level < column->n ? level : column->n;
  return k == 0 ? point : column->above + k - 1;
}

/* Triangles of the outside that have a side on the wall get new ones below it: the side's prism faces. */
typedef struct Side {
  int32_t low, high; // wall points, by number
  int32_t triangle;
} Side;

static int by_ends(const void *left, const void *right)
{
  const Side *a = left, *b = right;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  if (a->high != b->high) return a->high < b->high ? -1 : 1;
  return (a->triangle > b->triangle) - (a->triangle < b->triangle);
}

/* Sides with a growing triangle on one hand and another one on the other; each with that other triangle. */
static CastStatus list_sides(const Layers *layers, Side **sides, size_t *n, CastError *err)
{
  const TetMesh *mesh = layers->mesh;
  size_t all = 0;
  Side *list = malloc((3 * mesh->n_triangles + 1) * sizeof *list);
  CAST_CHECK(list, err, CAST_ERR_MEMORY, "no memory for the layers");
  for (size_t i = 0; i < 3 * mesh->n_triangles; i++) {
    const int32_t a = mesh->triangle[i], b = mesh->triangle[i - i % 3 + (i + 1) % 3];
    if (layers->column_of[a] < 0 || layers->column_of[b] < 0) continue;
    list[all++] = (Side){a < b ? a : b, a < b ? b : a, (int32_t)(i / 3)};
  }
  qsort(list, all, sizeof *list, by_ends);
  *n = 0;
  for (size_t i = 0; i + 1 < all; i++) {
    if (list[i].low != list[i + 1].low || list[i].high != list[i + 1].high) continue;
    const Side *with = &list[i], *without = &list[i + 1];
    if (layers->grows[with->triangle] == layers->grows[without->triangle]) continue;
    list[*n] = layers->grows[with->triangle] ? *without : *with; // never ahead of what is still to be read
    (*n)++;
  }
  *sides = list;
  return CAST_OK;
}

static size_t count_side_triangles(const Layers *layers, size_t n, const Side *sides)
{
  size_t count = 0;
  for (size_t i = 0; i < n; i++)
    count += (size_t)(layers->column[layers->column_of[sides[i].low]].n +
                      layers->column[layers->column_of[sides[i].high]].n);
  return count;
}

static size_t count_layer_tets(const Layers *layers)
{
  size_t count = 0; // each step up of a column under a triangle is a tetrahedron
  for (size_t i = 0; i < layers->n_faces; i++)
    for (size_t k = 0; k < 3; k++)
      count += (size_t)layers->column[layers->column_of[layers->mesh->triangle[3 * layers->face[i] + (int)k]]].n;
  return count;
}

static void fill_points(const Layers *layers, TetMesh *made)
{
  memcpy(made->x, layers->mesh->x, 3 * layers->mesh->n_points * sizeof *made->x);
  for (size_t c = 0; c < layers->n_columns; c++)
    for (int k = 1; k <= layers->column[c].n; k++)
      layers_point(layers, &layers->column[c], k, made->x + 3 * (size_t)(layers->column[c].above + k - 1));
}

static void fill_tets(const Layers *layers, TetMesh *made)
{
  const TetMesh *mesh = layers->mesh;
  size_t largest_tag = 0, t = mesh->n_tets;
  for (size_t i = 0; i < 4 * mesh->n_tets; i++) made->tet[i] = top_of(layers, mesh->tet[i]);
  memcpy(made->tet_region, mesh->tet_region, mesh->n_tets * sizeof *made->tet_region);
  memcpy(made->tet_tag, mesh->tet_tag, mesh->n_tets * sizeof *made->tet_tag);
  for (size_t i = 0; i < mesh->n_tets; i++)
    largest_tag = mesh->tet_tag[i] > largest_tag ? mesh->tet_tag[i] : largest_tag;
  for (size_t i = 0; i < layers->n_faces; i++) {
    const int32_t *triangle = mesh->triangle + 3 * layers->face[i];
    for (int k = 0; k < layers_count(layers, triangle); k++) {
      int32_t corner[3][4];
      int level[3][4];
      const int n = layers_cut_prism(layers, triangle, k, corner, level);
      for (int p = 0; p < n; p++, t++) {
        for (size_t c = 0; c < 4; c++) made->tet[4 * t + c] = point_at(layers, corner[p][c], level[p][c]);
        made->tet_region[t] = mesh->tet_region[mesh->triangle_tet[layers->face[i]]];
        made->tet_tag[t] = ++largest_tag;
      }
    }
  }
  made->n_layer_tets = made->n_tets - mesh->n_tets;
}

static void add_triangle(TetMesh *made, size_t *t, const TetMesh *mesh, int32_t like, const int32_t points[3])
{
  memcpy(made->triangle + 3 * *t, points, 3 * sizeof *points);
  made->triangle_surface[*t] = mesh->triangle_surface[like];
  made->triangle_entity[*t] = mesh->triangle_entity[like];
  (*t)++;
}

/* As the prisms' faces are cut: from the lower number up to the higher. Winding is the check's business. */
static void fill_triangles(const Layers *layers, size_t n_sides, const Side *sides, TetMesh *made)
{
  const TetMesh *mesh = layers->mesh;
  size_t t = 0;
  for (size_t i = 0; i < mesh->n_triangles; i++) {
    int32_t points[3];
    for (size_t k = 0; k < 3; k++)
      points[k] = layers->grows[i] ? mesh->triangle[3 * i + k] : top_of(layers, mesh->triangle[3 * i + k]);
    add_triangle(made, &t, mesh, (int32_t)i, points);
  }
  for (size_t i = 0; i < n_sides; i++) {
    const int32_t low = sides[i].low, high = sides[i].high;
    const int n_low = layers->column[layers->column_of[low]].n, n_high = layers->column[layers->column_of[high]].n;
    for (int k = 0; k < n_low || k < n_high; k++) {
      const int32_t up = point_at(layers, high, k + 1), at = point_at(layers, low, k);
      if (k < n_high) add_triangle(made, &t, mesh, sides[i].triangle, (int32_t[]){at, point_at(layers, high, k), up});
      if (k < n_low) add_triangle(made, &t, mesh, sides[i].triangle, (int32_t[]){at, up, point_at(layers, low, k + 1)});
    }
  }
}

static CastStatus number_points(const Layers *layers, size_t *n_points, CastError *err)
{
  *n_points = layers->mesh->n_points;
  for (size_t c = 0; c < layers->n_columns; c++) {
    layers->column[c].above = (int32_t)*n_points;
    *n_points += (size_t)layers->column[c].n;
    CAST_CHECK(*n_points < INT32_MAX, err, CAST_ERR_INPUT, "the layers at the cavity wall make the mesh too large");
  }
  return CAST_OK;
}

CastStatus layers_build(const Layers *layers, CastError *err)
{
  TetMesh *mesh = layers->mesh, *made = NULL;
  Side *sides = NULL;
  size_t n_points = 0, n_sides = 0;
  CAST_CALL(number_points(layers, &n_points, err));
  CAST_CALL(list_sides(layers, &sides, &n_sides, err));
  const CastStatus status =
      tet_mesh_create(n_points, mesh->n_tets + count_layer_tets(layers),
                      mesh->n_triangles + count_side_triangles(layers, n_sides, sides), &made, err);
  if (status == CAST_OK) {
    fill_points(layers, made);
    fill_tets(layers, made);
    fill_triangles(layers, n_sides, sides, made);
    const TetMesh old = *mesh;
    *mesh = *made;
    *made = old;
    tet_mesh_destroy(&made);
  }
  free(sides);
  return status;
}
