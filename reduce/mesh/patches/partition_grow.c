/* partition_grow.c - parts of one chart, grown from seeds along the surface (see partition.h, step 2). */
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "common/vector.h"
#include "reduce/mesh/patches/partition.h"

enum { LLOYD_STEPS = 40, WEIGHT_STEPS = 20 }; // the last ones only balance areas

typedef struct HeapEntry {
  double distance;
  int32_t triangle, part;
} HeapEntry;

typedef struct Grower {
  const SurfaceGraph *graph;
  size_t n, n_parts;
  const int32_t *triangle; // [n] the chart
  int32_t *label;        // [graph->n] part of the triangle, 0..n_parts-1; -1: in the chart, free; -2: not in the chart
  double *distance;      // [graph->n] m, less the seed's weight
  int32_t *seed;         // [n_parts]
  double *weight;        // [n_parts] m
  double *area, *centre; // [n_parts], [n_parts*3]
  HeapEntry *heap;
  size_t heap_n;
} Grower;

/* Total order: equal distances go to the lower part, then to the lower triangle. */
static bool is_before(const HeapEntry *a, const HeapEntry *b)
{
  if (a->distance != b->distance) return a->distance < b->distance;
  if (a->part != b->part) return a->part < b->part;
  return a->triangle < b->triangle;
}

static void heap_push(Grower *grower, HeapEntry entry)
{
  size_t i = grower->heap_n++;
  while (i > 0 && is_before(&entry, &grower->heap[(i - 1) / 2])) {
    grower->heap[i] = grower->heap[(i - 1) / 2];
    i = (i - 1) / 2;
  }
  grower->heap[i] = entry;
}

static HeapEntry heap_pop(Grower *grower)
{
  const HeapEntry top = grower->heap[0], last = grower->heap[--grower->heap_n];
  size_t i = 0;
  for (size_t child = 1; child < grower->heap_n; child = 2 * i + 1) {
    if (child + 1 < grower->heap_n && is_before(&grower->heap[child + 1], &grower->heap[child])) child++;
    if (!is_before(&grower->heap[child], &last)) break;
    grower->heap[i] = grower->heap[child];
    i = child;
  }
  grower->heap[i] = last;
  return top;
}

/* Dijkstra from what is in the heap. A triangle's shortest path runs through triangles of the same part, so that parts
 * are connected. Each directed edge pushes at most once for each improvement; the heap is sized for that. */
static void spread(Grower *grower)
{
  const SurfaceGraph *graph = grower->graph;
  while (grower->heap_n > 0) {
    const HeapEntry here = heap_pop(grower);
    const size_t t = (size_t)here.triangle;
    if (here.distance != grower->distance[t] || here.part != grower->label[t]) continue;
    for (size_t k = 3 * t; k < 3 * t + 3; k++) {
      const int32_t to = graph->neighbour[k];
      if (to < 0 || grower->label[to] == -2) continue;
      const HeapEntry entry = {here.distance + graph->step[k], to, here.part};
      if (!(entry.distance < grower->distance[to])) continue;
      grower->distance[to] = entry.distance;
      grower->label[to] = here.part;
      heap_push(grower, entry);
    }
  }
}

static void start_from(Grower *grower, int32_t seed, int32_t part, double distance)
{
  if (!(distance < grower->distance[seed])) return;
  grower->distance[seed] = distance;
  grower->label[seed] = part;
  heap_push(grower, (HeapEntry){distance, seed, part});
}

static void forget(Grower *grower)
{
  for (size_t i = 0; i < grower->n; i++) {
    grower->distance[grower->triangle[i]] = DBL_MAX;
    grower->label[grower->triangle[i]] = -1;
  }
}

static int32_t find_farthest(const Grower *grower)
{
  int32_t farthest = grower->triangle[0];
  for (size_t i = 1; i < grower->n; i++)
    if (grower->distance[grower->triangle[i]] > grower->distance[farthest]) farthest = grower->triangle[i];
  return farthest;
}

/* Each next seed is the triangle farthest from those before; the first is the one farthest from the first triangle. */
static void place_seeds(Grower *grower)
{
  forget(grower);
  start_from(grower, grower->triangle[0], 0, 0.0);
  spread(grower);
  grower->seed[0] = find_farthest(grower);
  forget(grower);
  for (size_t l = 0; l < grower->n_parts; l++) {
    if (l > 0) grower->seed[l] = find_farthest(grower);
    start_from(grower, grower->seed[l], (int32_t)l, 0.0);
    spread(grower);
  }
}

static void assign(Grower *grower)
{
  forget(grower);
  for (size_t l = 0; l < grower->n_parts; l++) start_from(grower, grower->seed[l], (int32_t)l, -grower->weight[l]);
  spread(grower);
}

static void measure_parts(Grower *grower)
{
  memset(grower->area, 0, grower->n_parts * sizeof *grower->area);
  memset(grower->centre, 0, 3 * grower->n_parts * sizeof *grower->centre);
  for (size_t i = 0; i < grower->n; i++) {
    const size_t t = (size_t)grower->triangle[i], l = (size_t)grower->label[t];
    grower->area[l] += grower->graph->area[t];
    for (size_t d = 0; d < 3; d++)
      grower->centre[3 * l + d] += grower->graph->area[t] * grower->graph->centre[3 * t + d];
  }
  for (size_t l = 0; l < grower->n_parts; l++)
    for (size_t d = 0; d < 3; d++)
      if (grower->area[l] > 0.0) grower->centre[3 * l + d] /= grower->area[l];
}

/* The seed goes to the part's triangle nearest to the part's centroid. */
static void move_seeds(Grower *grower)
{
  double *nearest = grower->distance; // free here; indexed by part, n_parts <= n
  for (size_t l = 0; l < grower->n_parts; l++) nearest[l] = DBL_MAX;
  for (size_t i = 0; i < grower->n; i++) {
    const size_t t = (size_t)grower->triangle[i], l = (size_t)grower->label[t];
    const double distance = vec_distance(grower->graph->centre + 3 * t, grower->centre + 3 * l);
    if (distance >= nearest[l]) continue;
    nearest[l] = distance;
    grower->seed[l] = (int32_t)t;
  }
}

/* A part is about a disc: its radius should change by sqrt(S/n/pi) - sqrt(A/pi), and its border moves by half of what
 * its weight gains on a neighbour's. A weight must not swallow the next seed. */
static void change_weights(Grower *grower, double mean_area)
{
  const double radius = sqrt(mean_area / 3.14159265358979323846);
  for (size_t l = 0; l < grower->n_parts; l++) {
    grower->weight[l] += 0.7 * radius * (1.0 - sqrt(grower->area[l] / mean_area));
    grower->weight[l] = fmin(fmax(grower->weight[l], -0.9 * radius), 0.9 * radius);
  }
}

/* Where a heavy neighbour swallowed a seed, the part has gone: then all weights are too large. */
static bool restore_lost_parts(Grower *grower)
{
  bool lost = false;
  for (size_t l = 0; l < grower->n_parts; l++) lost = lost || grower->label[grower->seed[l]] != (int32_t)l;
  for (size_t l = 0; lost && l < grower->n_parts; l++) grower->weight[l] *= 0.5;
  return lost;
}

static void run_lloyd(Grower *grower)
{
  double mean_area = 0.0;
  for (size_t i = 0; i < grower->n; i++)
    mean_area += grower->graph->area[grower->triangle[i]] / (double)grower->n_parts;
  place_seeds(grower);
  for (int step = 0; step < LLOYD_STEPS + WEIGHT_STEPS; step++) {
    assign(grower);
    // weights of zero keep every seed, so this ends
    for (int again = 0; again < 60 && restore_lost_parts(grower); again++) assign(grower);
    if (step == LLOYD_STEPS + WEIGHT_STEPS - 1) break;
    measure_parts(grower);
    if (step < LLOYD_STEPS) move_seeds(grower);
    change_weights(grower, mean_area);
  }
}

static bool allocate(Grower *grower)
{
  const size_t n = grower->graph->n;
  grower->label = calloc(n + 1, sizeof *grower->label);
  grower->distance = calloc(n + 1, sizeof *grower->distance);
  grower->seed = calloc(grower->n_parts + 1, sizeof *grower->seed);
  grower->weight = calloc(grower->n_parts + 1, sizeof *grower->weight);
  grower->area = malloc((grower->n_parts + 1) * sizeof *grower->area);
  grower->centre = malloc((3 * grower->n_parts + 1) * sizeof *grower->centre);
  // a settled triangle pushes each of its edges once at most: 3 n, and a seed for each part
  grower->heap = malloc((3 * grower->n + grower->n_parts + 1) * sizeof *grower->heap);
  return grower->label && grower->distance && grower->seed && grower->weight && grower->area && grower->centre &&
         grower->heap;
}

CastStatus partition_grow(const SurfaceGraph *graph, size_t n, const int32_t *triangles, size_t n_parts, int32_t first,
                          int32_t *part, CastError *err)
{
  Grower grower = {.graph = graph, .n = n, .n_parts = n_parts, .triangle = triangles};
  const bool allocated = allocate(&grower);
  if (allocated) {
    for (size_t t = 0; t < graph->n; t++) grower.label[t] = -2;
    run_lloyd(&grower);
    for (size_t i = 0; i < n; i++) part[triangles[i]] = first + grower.label[triangles[i]];
  }
  free(grower.label);
  free(grower.distance);
  free(grower.seed);
  free(grower.weight);
  free(grower.area);
  free(grower.centre);
  free(grower.heap);
  CAST_CHECK(allocated, err, CAST_ERR_MEMORY, "no memory for the patches");
  return CAST_OK;
}
