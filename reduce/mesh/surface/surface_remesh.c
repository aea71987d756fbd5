#include "reduce/mesh/surface/surface_remesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "common/vector.h"

void remesh_normal(const double *x, const int32_t *triangle, double normal[3])
{
  double u[3], v[3];
  vec_between(x + 3 * (size_t)triangle[0], x + 3 * (size_t)triangle[1], u);
  vec_between(x + 3 * (size_t)triangle[0], x + 3 * (size_t)triangle[2], v);
  vec_cross(u, v, normal);
}

static int by_ends(const void *left, const void *right)
{
  const RemeshEdge *a = left, *b = right;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  if (a->high != b->high) return a->high < b->high ? -1 : 1;
  return (a->triangle[0] > b->triangle[0]) - (a->triangle[0] < b->triangle[0]);
}

static bool is_sharp(const RemeshSurface *surface, int32_t s, int32_t t, double split_angle)
{
  double a[3], b[3];
  if (surface->tag[s] != surface->tag[t]) return true;
  remesh_normal(surface->x, surface->triangle + 3 * s, a);
  remesh_normal(surface->x, surface->triangle + 3 * t, b);
  return vec_dot(a, b) < cos(split_angle) * vec_norm(a) * vec_norm(b);
}

CastStatus remesh_list_edges(const RemeshSurface *surface, double split_angle, RemeshEdge **edges, size_t *n,
                             CastError *err)
{
  const size_t all = 3 * surface->n_triangles;
  RemeshEdge *list = malloc((all + 1) * sizeof *list);
  CAST_CHECK(list, err, CAST_ERR_MEMORY, "no memory for the surface");
  for (size_t i = 0; i < all; i++) {
    const int32_t a = surface->triangle[i], b = surface->triangle[i - i % 3 + (i + 1) % 3];
    list[i] = (RemeshEdge){a < b ? a : b, a < b ? b : a, {(int32_t)(i / 3), -1}, false};
  }
  qsort(list, all, sizeof *list, by_ends);
  *n = 0;
  for (size_t i = 0; i + 1 < all; i += 2) { // closed: they come in pairs
    RemeshEdge edge = list[i];
    edge.triangle[1] = list[i + 1].triangle[0];
    edge.sharp = is_sharp(surface, edge.triangle[0], edge.triangle[1], split_angle);
    list[(*n)++] = edge;
  }
  *edges = list;
  return CAST_OK;
}

const RemeshEdge *remesh_find_edge(const RemeshEdge *edges, size_t n, int32_t a, int32_t b)
{
  const int32_t low = a < b ? a : b, high = a < b ? b : a;
  size_t first = 0, last = n;
  while (first < last) {
    const size_t middle = (first + last) / 2;
    if (edges[middle].low < low || (edges[middle].low == low && edges[middle].high < high))
      first = middle + 1;
    else
      last = middle;
  }
  return first < n && edges[first].low == low && edges[first].high == high ? &edges[first] : NULL;
}

static int32_t find_root(int32_t *parent, int32_t t)
{
  while (parent[t] != t) t = parent[t] = parent[parent[t]];
  return t;
}

CastStatus surface_faces(const RemeshSurface *surface, double split_angle, int32_t *face, size_t *n_faces,
                         CastError *err)
{
  RemeshEdge *edges = NULL;
  size_t n = 0;
  CAST_CALL(remesh_list_edges(surface, split_angle, &edges, &n, err));
  for (size_t t = 0; t < surface->n_triangles; t++) face[t] = (int32_t)t;
  for (size_t i = 0; i < n; i++) {
    if (edges[i].sharp) continue;
    const int32_t a = find_root(face, edges[i].triangle[0]), b = find_root(face, edges[i].triangle[1]);
    face[a > b ? a : b] = a > b ? b : a;
  }
  free(edges);
  for (size_t t = 0; t < surface->n_triangles; t++) face[t] = find_root(face, (int32_t)t);
  *n_faces = 0; // a root is the least of its part, so that its number stands before it is asked for
  for (size_t t = 0; t < surface->n_triangles; t++)
    face[t] = face[t] == (int32_t)t ? (int32_t)(*n_faces)++ : face[face[t]];
  return CAST_OK;
}

/* Collapses, then turned edges, each until there are none. */
static CastStatus tidy(RemeshSurface *surface, double split_angle, const RemeshSize *size, CastError *err)
{
  enum { PASSES = 60 };
  size_t n_done = 1;
  for (int pass = 0; pass < PASSES && n_done > 0; pass++)
    CAST_CALL(remesh_collapse(surface, split_angle, size, &n_done, err));
  n_done = 1;
  for (int pass = 0; pass < PASSES && n_done > 0; pass++) CAST_CALL(remesh_flip(surface, split_angle, &n_done, err));
  return CAST_OK;
}

CastStatus surface_remesh(RemeshSurface *surface, double split_angle, const RemeshSize *size, CastError *err)
{
  enum { ROUNDS = 5 };
  CAST_CALL(tidy(surface, split_angle, size, err));
  for (int round = 0; round < ROUNDS; round++) {
    CAST_CALL(remesh_split(surface, split_angle, size, err));
    CAST_CALL(tidy(surface, split_angle, size, err));
  }
  return CAST_OK;
}
