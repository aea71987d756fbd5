/* surface_remesh_flip.c - turn edges inside smooth faces where that makes the two triangles Delaunay. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "common/vector.h"
#include "reduce/mesh/surface/surface_remesh.h"

static const double LARGEST_BEND = 0.98; // cosine: the surface would leave the file's facets

typedef struct Quad { // triangles (a b c) and (b a d)
  int32_t a, b, c, d;
} Quad;

static Quad quad_of(const RemeshSurface *surface, const RemeshEdge *edge)
{
  const int32_t *s = surface->triangle + 3 * edge->triangle[0], *t = surface->triangle + 3 * edge->triangle[1];
  Quad quad = {0};
  for (int k = 0; k < 3; k++) {
    if (s[k] != edge->low && s[k] != edge->high) quad = (Quad){s[(k + 1) % 3], s[(k + 2) % 3], s[k], quad.d};
    if (t[k] != edge->low && t[k] != edge->high) quad.d = t[k];
  }
  return quad;
}

static double cotangent(const double *at, const double *p, const double *q)
{
  double u[3], v[3], cross[3];
  vec_between(at, p, u);
  vec_between(at, q, v);
  vec_cross(u, v, cross);
  return vec_dot(u, v) / fmax(vec_norm(cross), 1e-300);
}

static bool improves(const RemeshSurface *surface, const Quad *quad)
{
  const double *x = surface->x, *a = x + 3 * (size_t)quad->a, *b = x + 3 * (size_t)quad->b;
  const double *c = x + 3 * (size_t)quad->c, *d = x + 3 * (size_t)quad->d;
  if (!(cotangent(c, a, b) + cotangent(d, a, b) < -1e-6))
    return false; // the two angles sum up to more than half a turn
  double old[2][3], new[2][3];
  remesh_normal(x, (int32_t[]){quad->a, quad->b, quad->c}, old[0]);
  remesh_normal(x, (int32_t[]){quad->b, quad->a, quad->d}, old[1]);
  remesh_normal(x, (int32_t[]){quad->c, quad->d, quad->b}, new[0]);
  remesh_normal(x, (int32_t[]){quad->d, quad->c, quad->a}, new[1]);
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 2; k++)
      if (!(vec_dot(old[i], new[k]) > LARGEST_BEND * vec_norm(old[i]) * vec_norm(new[k]))) return false;
  return true;
}

CastStatus remesh_flip(RemeshSurface *surface, double split_angle, size_t *n_done, CastError *err)
{
  RemeshEdge *edges = NULL;
  size_t n = 0;
  CAST_CALL(remesh_list_edges(surface, split_angle, &edges, &n, err));
  bool *touched = calloc(surface->n_points + 1, sizeof *touched); // points of this pass: the edges' list is of before
  *n_done = 0;
  for (size_t i = 0; touched && i < n; i++) {
    const Quad quad = quad_of(surface, &edges[i]);
    if (edges[i].sharp || touched[quad.a] || touched[quad.b] || touched[quad.c] || touched[quad.d]) continue;
    if (quad.c == quad.d || remesh_find_edge(edges, n, quad.c, quad.d) || !improves(surface, &quad)) continue;
    memcpy(surface->triangle + 3 * edges[i].triangle[0], (int32_t[]){quad.c, quad.d, quad.b}, 3 * sizeof(int32_t));
    memcpy(surface->triangle + 3 * edges[i].triangle[1], (int32_t[]){quad.d, quad.c, quad.a}, 3 * sizeof(int32_t));
    touched[quad.a] = touched[quad.b] = touched[quad.c] = touched[quad.d] = true;
    (*n_done)++;
  }
  const bool room = touched;
  free(touched);
  free(edges);
  CAST_CHECK(room, err, CAST_ERR_MEMORY, "no memory for the surface");
  return CAST_OK;
}
