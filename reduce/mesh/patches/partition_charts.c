/* partition_charts.c - where a surface turns sharply, a patch ends. */
#include "reduce/mesh/patches/partition.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "common/vector.h"
#include "reduce/mesh/surface/union_find.h"

/* Between two faces of the geometry a turn of 40 degrees is an edge; within one, a coarse mesh of a round pin turns by
 * up to 60 degrees from triangle to triangle, and only more than that is one (surfaces without faces, such as STL). */
static const double COS_EDGE = 0.76604444311897803, COS_EDGE_WITHIN = 0.42261826174069944; // 40, 65 degrees
static const double SMALL = 0.25; // of a part's area: a chart below it joins a neighbour

static bool is_sharp(const SurfaceGraph *graph, size_t s, size_t t)
{
  const double cosine = vec_dot(graph->normal + 3 * s, graph->normal + 3 * t);
  return cosine < (graph->entity[s] == graph->entity[t] ? COS_EDGE_WITHIN : COS_EDGE);
}

/* The smallest chart below `limit` that touches another one; -1 if there is none. `area` [n] is kept at the roots. */
static int32_t find_small_chart(const SurfaceGraph *graph, int32_t *parent, const double *area, double limit)
{
  int32_t smallest = -1;
  for (size_t i = 0; i < 3 * graph->n; i++) {
    if (graph->neighbour[i] < 0) continue;
    const int32_t chart = union_find_root(parent, (int32_t)(i / 3));
    if (union_find_root(parent, graph->neighbour[i]) == chart || area[chart] >= limit) continue;
    if (smallest < 0 || area[chart] < area[smallest] || (area[chart] == area[smallest] && chart < smallest))
      smallest = chart;
  }
  return smallest;
}

/* The neighbour with the longest common border. `shared` [n] is zero on entry and on return. */
static int32_t find_best_neighbour(const SurfaceGraph *graph, int32_t *parent, int32_t chart, double *shared)
{
  int32_t best = -1;
  for (size_t i = 0; i < 3 * graph->n; i++) {
    if (graph->neighbour[i] < 0 || union_find_root(parent, (int32_t)(i / 3)) != chart) continue;
    const int32_t other = union_find_root(parent, graph->neighbour[i]);
    if (other == chart) continue;
    shared[other] += graph->border[i];
    if (best < 0 || shared[other] > shared[best] || (shared[other] == shared[best] && other < best)) best = other;
  }
  for (size_t i = 0; i < 3 * graph->n; i++)
    if (graph->neighbour[i] >= 0) shared[union_find_root(parent, graph->neighbour[i])] = 0.0;
  return best;
}

static void merge_small_charts(const SurfaceGraph *graph, double limit, int32_t *parent, double *area, double *shared)
{
  for (int32_t chart; (chart = find_small_chart(graph, parent, area, limit)) >= 0;) {
    const int32_t other = find_best_neighbour(graph, parent, chart, shared);
    const double sum = area[chart] + area[other];
    union_find_join(parent, chart, other);
    area[union_find_root(parent, chart)] = sum;
  }
}

static size_t number_charts(size_t n, int32_t *parent, int32_t *chart)
{
  int32_t next = 0;
  for (size_t t = 0; t < n; t++) { // a root is the least of its chart, hence met first
    const int32_t root = union_find_root(parent, (int32_t)t);
    chart[t] = root == (int32_t)t ? next++ : chart[root];
  }
  return (size_t)next;
}

CastStatus partition_charts(const SurfaceGraph *graph, double target_area, int32_t *chart, size_t *n_charts,
                            CastError *err)
{
  int32_t *parent = malloc((graph->n + 1) * sizeof *parent);
  double *area = calloc(graph->n + 1, sizeof *area), *shared = calloc(graph->n + 1, sizeof *shared);
  CastStatus status = CAST_OK;
  if (!parent || !area || !shared) {
    status = cast_error_set(err, CAST_ERR_MEMORY, "no memory for the patches");
  } else {
    for (size_t t = 0; t < graph->n; t++) parent[t] = (int32_t)t;
    for (size_t i = 0; i < 3 * graph->n; i++)
      if (graph->neighbour[i] >= 0 && !is_sharp(graph, i / 3, (size_t)graph->neighbour[i]))
        union_find_join(parent, (int32_t)(i / 3), graph->neighbour[i]);
    for (size_t t = 0; t < graph->n; t++) area[union_find_root(parent, (int32_t)t)] += graph->area[t];
    merge_small_charts(graph, SMALL * target_area, parent, area, shared);
    *n_charts = number_charts(graph->n, parent, chart);
  }
  free(parent);
  free(area);
  free(shared);
  return status;
}
