#include "reduce/mesh/surface/surface_graph.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include "common/vector.h"

typedef struct Edge {
  int32_t low, high; // points
  int32_t place;     // 3 * triangle + side
} Edge;

static int by_ends(const void *left, const void *right)
{
  const Edge *a = left, *b = right;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  if (a->high != b->high) return a->high < b->high ? -1 : 1;
  return (a->place > b->place) - (a->place < b->place);
}

static bool allocate(SurfaceGraph *graph, size_t n)
{
  graph->n = n;
  graph->area = malloc((n + 1) * sizeof *graph->area);
  graph->centre = malloc((3 * n + 1) * sizeof *graph->centre);
  graph->normal = malloc((3 * n + 1) * sizeof *graph->normal);
  graph->neighbour = malloc((3 * n + 1) * sizeof *graph->neighbour);
  graph->border = malloc((3 * n + 1) * sizeof *graph->border);
  graph->step = calloc(3 * n + 1, sizeof *graph->step);
  graph->entity = malloc((n + 1) * sizeof *graph->entity);
  return graph->area && graph->centre && graph->normal && graph->neighbour && graph->border && graph->step &&
         graph->entity;
}

static void measure_triangle(SurfaceGraph *graph, const double *x, const int32_t *triangle, size_t t)
{
  const double *corner[3];
  double u[3], v[3], *normal = graph->normal + 3 * t;
  for (size_t k = 0; k < 3; k++) corner[k] = x + 3 * (size_t)triangle[3 * t + k];
  vec_between(corner[0], corner[1], u);
  vec_between(corner[0], corner[2], v);
  vec_cross(u, v, normal);
  const double size = vec_norm(normal);
  graph->area[t] = 0.5 * size;
  for (size_t d = 0; d < 3; d++) {
    normal[d] = size > 0.0 ? normal[d] / size : 0.0;
    graph->centre[3 * t + d] = (corner[0][d] + corner[1][d] + corner[2][d]) / 3.0;
  }
  for (size_t k = 0; k < 3; k++) graph->border[3 * t + k] = vec_distance(corner[k], corner[(k + 1) % 3]);
}

static void link_neighbours(SurfaceGraph *graph, const double *x, const Edge *a, const Edge *b)
{
  double middle[3];
  for (size_t d = 0; d < 3; d++) middle[d] = 0.5 * (x[3 * (size_t)a->low + d] + x[3 * (size_t)a->high + d]);
  const size_t s = (size_t)a->place / 3, t = (size_t)b->place / 3;
  const double step = vec_distance(graph->centre + 3 * s, middle) + vec_distance(middle, graph->centre + 3 * t);
  graph->neighbour[a->place] = (int32_t)t;
  graph->neighbour[b->place] = (int32_t)s;
  graph->step[a->place] = graph->step[b->place] = step;
}

static CastStatus find_neighbours(SurfaceGraph *graph, const double *x, const int32_t *triangle, CastError *err)
{
  const size_t n = 3 * graph->n;
  Edge *edges = malloc((n + 1) * sizeof *edges);
  CAST_CHECK(edges, err, CAST_ERR_MEMORY, "no memory for the patches");
  for (size_t i = 0; i < n; i++) {
    const int32_t a = triangle[i], b = triangle[i - i % 3 + (i + 1) % 3];
    edges[i] = (Edge){a < b ? a : b, a < b ? b : a, (int32_t)i};
    graph->neighbour[i] = -1;
  }
  qsort(edges, n, sizeof *edges, by_ends);
  CastStatus status = CAST_OK;
  for (size_t i = 0, next; i < n && status == CAST_OK; i = next) {
    for (next = i + 1; next < n && edges[next].low == edges[i].low && edges[next].high == edges[i].high;) next++;
    if (next - i == 2) link_neighbours(graph, x, &edges[i], &edges[i + 1]);
    if (next - i > 2) status = cast_error_set(err, CAST_ERR_ARGUMENT, "an edge belongs to %zu triangles", next - i);
  }
  free(edges);
  return status;
}

CastStatus surface_graph_create(const double *x, size_t n, const int32_t *triangle, const int32_t *entity,
                                SurfaceGraph **graph, CastError *err)
{
  *graph = NULL;
  SurfaceGraph *made = calloc(1, sizeof *made);
  CAST_CHECK(made, err, CAST_ERR_MEMORY, "no memory for the patches");
  CastStatus status = CAST_OK;
  if (!allocate(made, n)) {
    status = cast_error_set(err, CAST_ERR_MEMORY, "no memory for the patches");
  } else {
    for (size_t t = 0; t < n; t++) measure_triangle(made, x, triangle, t);
    memcpy(made->entity, entity, n * sizeof *entity);
    status = find_neighbours(made, x, triangle, err);
  }
  if (status != CAST_OK) surface_graph_destroy(&made);
  *graph = made;
  return status;
}

void surface_graph_destroy(SurfaceGraph **graph)
{
  if (!graph || !*graph) return;
  SurfaceGraph *old = *graph;
  free(old->area);
  free(old->centre);
  free(old->normal);
  free(old->neighbour);
  free(old->border);
  free(old->step);
  free(old->entity);
  free(old);
  *graph = NULL;
}
