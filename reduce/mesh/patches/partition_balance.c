/* partition_balance.c - triangles change sides along borders (see partition.h, step 3). */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "reduce/mesh/patches/partition.h"

/* Price c of border against inequality. With k triangles a part, an edge is about 1.5/sqrt(k) of sqrt(A): a triangle
 * that lengthens the border by its edge moves only between parts whose areas differ by more than about c sqrt(k). */
static const double BORDER_PRICE = 0.005;
enum { MOST_SWEEPS = 200 };

typedef struct Balancer {
  const SurfaceGraph *graph;
  size_t n, n_parts;
  const int32_t *triangle; // [n] the chart
  int32_t first;           // number of its first part
  int32_t *part;           // [graph->n] in and out
  double mean_area;
  double *area;   // [n_parts]
  size_t *count;  // [n_parts] triangles
  int32_t *stamp; // [graph->n] of the last search that met the triangle
  int32_t *queue; // [n]
  int32_t search;
} Balancer;

/* Does the part stay in one piece without triangle t? Search from one of t's neighbours in it; all others must be met.
 */
static bool stays_connected(Balancer *balancer, size_t t)
{
  const SurfaceGraph *graph = balancer->graph;
  int32_t kin[3];
  size_t n_kin = 0;
  for (size_t k = 3 * t; k < 3 * t + 3; k++)
    if (graph->neighbour[k] >= 0 && balancer->part[graph->neighbour[k]] == balancer->part[t])
      kin[n_kin++] = graph->neighbour[k];
  if (n_kin <= 1) return n_kin == 1;
  size_t head = 0, tail = 0;
  balancer->search++;
  balancer->stamp[t] = balancer->stamp[kin[0]] = balancer->search;
  balancer->queue[tail++] = kin[0];
  while (head < tail) {
    const size_t here = (size_t)balancer->queue[head++];
    for (size_t k = 3 * here; k < 3 * here + 3; k++) {
      const int32_t to = graph->neighbour[k];
      if (to < 0 || balancer->part[to] != balancer->part[t] || balancer->stamp[to] == balancer->search) continue;
      balancer->stamp[to] = balancer->search;
      balancer->queue[tail++] = to;
    }
  }
  for (size_t i = 1; i < n_kin; i++)
    if (balancer->stamp[kin[i]] != balancer->search) return false;
  return true;
}

/* What the objective changes by when triangle t goes from its part to part b. */
static double gain_of(const Balancer *balancer, size_t t, int32_t b)
{
  const SurfaceGraph *graph = balancer->graph;
  const int32_t a = balancer->part[t];
  const double mean = balancer->mean_area, moved = graph->area[t] / mean;
  const double excess_a = balancer->area[a - balancer->first] / mean - 1.0;
  const double excess_b = balancer->area[b - balancer->first] / mean - 1.0;
  double border = 0.0;
  for (size_t k = 3 * t; k < 3 * t + 3; k++) {
    if (graph->neighbour[k] < 0) continue;
    const int32_t other = balancer->part[graph->neighbour[k]];
    border += other == a ? graph->border[k] : other == b ? -graph->border[k] : 0.0;
  }
  return 2.0 * moved * (excess_b - excess_a + moved) + BORDER_PRICE * border / sqrt(mean);
}

static bool is_own(const Balancer *balancer, int32_t part)
{
  return part >= balancer->first && (size_t)(part - balancer->first) < balancer->n_parts;
}

/* Move triangle t to the neighbouring part that lowers the objective most, if any does. */
static bool improve(Balancer *balancer, size_t t)
{
  const SurfaceGraph *graph = balancer->graph;
  const int32_t a = balancer->part[t];
  int32_t best = -1;
  double least = -1e-12; // of an objective of order one: smaller changes are rounding
  for (size_t k = 3 * t; k < 3 * t + 3; k++) {
    const int32_t b = graph->neighbour[k] < 0 ? -1 : balancer->part[graph->neighbour[k]];
    if (!is_own(balancer, b) || b == a) continue;
    const double gain = gain_of(balancer, t, b);
    if (gain > least || (gain == least && b > best)) continue;
    least = gain;
    best = b;
  }
  if (best < 0 || balancer->count[a - balancer->first] == 1 || !stays_connected(balancer, t)) return false;
  balancer->part[t] = best;
  balancer->area[a - balancer->first] -= graph->area[t];
  balancer->area[best - balancer->first] += graph->area[t];
  balancer->count[a - balancer->first]--;
  balancer->count[best - balancer->first]++;
  return true;
}

static void balance(Balancer *balancer)
{
  double total = 0.0;
  for (size_t i = 0; i < balancer->n; i++) {
    const size_t t = (size_t)balancer->triangle[i], l = (size_t)(balancer->part[t] - balancer->first);
    balancer->area[l] += balancer->graph->area[t];
    balancer->count[l]++;
    total += balancer->graph->area[t];
  }
  balancer->mean_area = total / (double)balancer->n_parts;
  for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
    size_t moved = 0;
    for (size_t i = 0; i < balancer->n; i++) moved += improve(balancer, (size_t)balancer->triangle[i]);
    if (moved == 0) return;
  }
}

CastStatus partition_balance(const SurfaceGraph *graph, size_t n, const int32_t *triangles, size_t n_parts,
                             int32_t first, int32_t *part, CastError *err)
{
  Balancer balancer = {.graph = graph, .n = n, .n_parts = n_parts, .triangle = triangles, .first = first, .part = part};
  balancer.area = calloc(n_parts + 1, sizeof *balancer.area);
  balancer.count = calloc(n_parts + 1, sizeof *balancer.count);
  balancer.stamp = calloc(graph->n + 1, sizeof *balancer.stamp);
  balancer.queue = malloc((n + 1) * sizeof *balancer.queue);
  const bool allocated = balancer.area && balancer.count && balancer.stamp && balancer.queue;
  if (allocated) balance(&balancer);
  free(balancer.area);
  free(balancer.count);
  free(balancer.stamp);
  free(balancer.queue);
  CAST_CHECK(allocated, err, CAST_ERR_MEMORY, "no memory for the patches");
  return CAST_OK;
}
