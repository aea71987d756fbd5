#include "cast/cool/graph.h"

#include <math.h>
#include <stdlib.h>

#include "cast/kernel/dispatch.h"
#include "cast/kernel/pair.h"

enum { ROWS_PER_TASK = 256 };

typedef struct Shape { // of the kernel, and the domain's periods
  KernelKind kernel;
  double h, slope;
  const double *period;
} Shape;

static double weight_of(const Shape *shape, const Particles *p, ptrdiff_t i, ptrdiff_t j)
{
  double way[3];
  const double r2 = particles_offset(p, i, j, shape->period, way);
  return (p->volume[i] * p->volume[j]) * (shape->slope * shape_slope(shape->kernel, sqrt(r2) / shape->h));
}

static void fill_row(const Shape *shape, const Particles *p, const PairList *list, ptrdiff_t i, CoolGraph *graph)
{
  ptrdiff_t at = graph->start[i];
  for (ptrdiff_t l = list->start[i]; l < list->start[i + 1]; l++) {
    const double weight = weight_of(shape, p, i, list->index[l]);
    if (weight <= 0.0) continue; // beyond the kernel's reach, within the list's skin
    graph->index[at] = list->index[l];
    graph->weight[at++] = (float)weight;
  }
}

static ptrdiff_t count_row(const Shape *shape, const Particles *p, const PairList *list, ptrdiff_t i)
{
  ptrdiff_t count = 0;
  for (ptrdiff_t l = list->start[i]; l < list->start[i + 1]; l++) count += weight_of(shape, p, i, list->index[l]) > 0.0;
  return count;
}

CastStatus cool_graph_create(const SphParameters *sph, const Particles *p, const Neighbours *neighbours,
                             CoolGraph *graph, CastError *err)
{
  const double h = sph->h;
  const Shape shape = {sph->kernel, h, shape_norm(sph->kernel) / (h * h * h * h * h), neighbours_period(neighbours)};
  const PairList *list = neighbours_fluid_fluid(neighbours);
  *graph = (CoolGraph){.n = p->n_fluid};
  graph->start = calloc((size_t)graph->n + 1, sizeof *graph->start);
  CAST_CHECK(graph->start, err, CAST_ERR_MEMORY, "cooling: no memory for %td particles", graph->n);
#pragma omp parallel for schedule(static, ROWS_PER_TASK)
  for (ptrdiff_t i = 0; i < graph->n; i++) graph->start[i + 1] = count_row(&shape, p, list, i);
  for (ptrdiff_t i = 0; i < graph->n; i++) graph->start[i + 1] += graph->start[i];
  const size_t entries = (size_t)graph->start[graph->n] + 1;
  graph->index = malloc(entries * sizeof *graph->index);
  graph->weight = malloc(entries * sizeof *graph->weight);
  graph->conductance = malloc(entries * sizeof *graph->conductance);
  if (!graph->index || !graph->weight || !graph->conductance) {
    cool_graph_destroy(graph);
    return cast_error_set(err, CAST_ERR_MEMORY, "cooling: no memory for %zu pairs", entries - 1);
  }
#pragma omp parallel for schedule(static, ROWS_PER_TASK)
  for (ptrdiff_t i = 0; i < graph->n; i++) fill_row(&shape, p, list, i, graph);
  return CAST_OK;
}

void cool_graph_destroy(CoolGraph *graph)
{
  free(graph->start);
  free(graph->index);
  free(graph->weight);
  free(graph->conductance);
  *graph = (CoolGraph){0};
}

void cool_graph_set_conductances(CoolGraph *graph, const double *kappa)
{
#pragma omp parallel for schedule(static, ROWS_PER_TASK)
  for (ptrdiff_t i = 0; i < graph->n; i++)
    for (ptrdiff_t l = graph->start[i]; l < graph->start[i + 1]; l++) {
      const double other = kappa[graph->index[l]]; // product and sum are symmetric to the last bit
      graph->conductance[l] = (float)((double)graph->weight[l] * (4.0 * (kappa[i] * other) / (kappa[i] + other)));
    }
}

SIMD_CLONES static void apply_rows(const CoolGraph *graph, const double *x, double *y, ptrdiff_t first, ptrdiff_t end)
{
  for (ptrdiff_t i = first; i < end; i++) {
    const double own = x[i];
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (ptrdiff_t l = graph->start[i]; l < graph->start[i + 1]; l++)
      sum += (double)graph->conductance[l] * (own - x[graph->index[l]]);
    y[i] = sum;
  }
}

void cool_graph_apply(const CoolGraph *graph, const double *x, double *y)
{
#pragma omp parallel for schedule(dynamic)
  for (ptrdiff_t first = 0; first < graph->n; first += ROWS_PER_TASK)
    apply_rows(graph, x, y, first, first + ROWS_PER_TASK < graph->n ? first + ROWS_PER_TASK : graph->n);
}

void cool_graph_diagonal(const CoolGraph *graph, double *diagonal)
{
#pragma omp parallel for schedule(static, ROWS_PER_TASK)
  for (ptrdiff_t i = 0; i < graph->n; i++) {
    double sum = 0.0;
    for (ptrdiff_t l = graph->start[i]; l < graph->start[i + 1]; l++) sum += (double)graph->conductance[l];
    diagonal[i] = sum;
  }
}
