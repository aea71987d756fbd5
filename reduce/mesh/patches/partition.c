#include "reduce/mesh/patches/partition.h"

#include <math.h>
#include <stdlib.h>

typedef struct Chart {
  size_t n;
  int32_t *triangles;
  double area;
} Chart;

/* Triangles by chart, in ascending order: one array for all, sliced. */
static CastStatus list_charts(const SurfaceGraph *graph, const int32_t *chart, size_t n_charts, Chart **charts,
                              int32_t **triangles, CastError *err)
{
  *charts = calloc(n_charts + 1, sizeof **charts);
  *triangles = malloc((graph->n + 1) * sizeof **triangles);
  CAST_CHECK(*charts && *triangles, err, CAST_ERR_MEMORY, "no memory for the patches");
  for (size_t t = 0; t < graph->n; t++) {
    (*charts)[chart[t]].n++;
    (*charts)[chart[t]].area += graph->area[t];
  }
  int32_t *next = *triangles;
  for (size_t c = 0; c < n_charts; c++) {
    (*charts)[c].triangles = next;
    next += (*charts)[c].n;
    (*charts)[c].n = 0;
  }
  for (size_t t = 0; t < graph->n; t++) {
    Chart *of = &(*charts)[chart[t]];
    of->triangles[of->n++] = (int32_t)t;
  }
  return CAST_OK;
}

static CastStatus cut_charts(const SurfaceGraph *graph, double target_area, const Chart *charts, size_t n_charts,
                             int32_t *part, size_t *n_parts, CastError *err)
{
  *n_parts = 0;
  for (size_t c = 0; c < n_charts; c++) {
    const Chart *chart = &charts[c];
    size_t n = (size_t)fmax(1.0, round(chart->area / target_area));
    if (n > chart->n) n = chart->n;
    const int32_t first = (int32_t)*n_parts;
    CAST_CALL(partition_grow(graph, chart->n, chart->triangles, n, first, part, err));
    CAST_CALL(partition_balance(graph, chart->n, chart->triangles, n, first, part, err));
    *n_parts += n;
  }
  return CAST_OK;
}

/* Number the parts in the order of their first triangles. */
static CastStatus renumber(size_t n, int32_t *part, size_t n_parts, CastError *err)
{
  int32_t *number = malloc((n_parts + 1) * sizeof *number), next = 0;
  CAST_CHECK(number, err, CAST_ERR_MEMORY, "no memory for the patches");
  for (size_t l = 0; l < n_parts; l++) number[l] = -1;
  for (size_t t = 0; t < n; t++) {
    if (number[part[t]] < 0) number[part[t]] = next++;
    part[t] = number[part[t]];
  }
  free(number);
  return CAST_OK;
}

CastStatus partition_surface(const SurfaceGraph *graph, double target_area, int32_t *part, size_t *n_parts,
                             CastError *err)
{
  *n_parts = 1;
  for (size_t t = 0; t < graph->n; t++) part[t] = target_area > 0.0 ? -1 : 0; // -1: of a chart not yet cut
  if (!(target_area > 0.0)) return CAST_OK;
  int32_t *chart = malloc((graph->n + 1) * sizeof *chart), *triangles = NULL;
  CAST_CHECK(chart, err, CAST_ERR_MEMORY, "no memory for the patches");
  Chart *charts = NULL;
  size_t n_charts = 0;
  CastStatus status = partition_charts(graph, target_area, chart, &n_charts, err);
  if (status == CAST_OK) status = list_charts(graph, chart, n_charts, &charts, &triangles, err);
  if (status == CAST_OK) status = cut_charts(graph, target_area, charts, n_charts, part, n_parts, err);
  if (status == CAST_OK) status = renumber(graph->n, part, *n_parts, err);
  free(chart);
  free(charts);
  free(triangles);
  return status;
}
