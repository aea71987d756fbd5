/* rom_check_closed.c - does the boundary close, and is it wound one way?
 * Sorted by its two ends, each edge must appear exactly twice, once in each direction. */
#include "common/rom/rom_check.h"

#include <stdlib.h>

typedef struct Edge {
  int32_t low, high;
  int32_t triangle;
  bool upwards; // runs from low to high in its triangle
} Edge;

static int compare_edges(const void *left, const void *right)
{
  const Edge *a = left, *b = right;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  if (a->high != b->high) return a->high < b->high ? -1 : 1;
  if (a->upwards != b->upwards) return a->upwards ? -1 : 1;
  return (a->triangle > b->triangle) - (a->triangle < b->triangle);
}

static void list_edges(const RomData *rom, Edge *edges)
{
  for (size_t t = 0; t < rom->n_triangles; t++)
    for (size_t k = 0; k < 3; k++) {
      const int32_t a = rom->triangles[3 * t + k], b = rom->triangles[3 * t + (k + 1) % 3];
      edges[3 * t + k] = (Edge){a < b ? a : b, a < b ? b : a, (int32_t)t, a < b};
    }
}

static CastStatus report_edge(const RomData *rom, const Edge *edge, size_t uses, CastError *err)
{
  const double *a = rom->points + 3 * (size_t)edge->low, *b = rom->points + 3 * (size_t)edge->high;
  const char *fault = uses == 1   ? "belongs to one triangle only: the boundary is not closed"
                      : uses == 2 ? "is wound the same way by both its triangles"
                                  : "belongs to more than two triangles: the boundary touches itself";
  return cast_error_set(err, CAST_ERR_FORMAT,
                        "geometry/triangles: the edge from (%g, %g, %g) to (%g, %g, %g) m of triangle %d (patch %s) %s",
                        a[0], a[1], a[2], b[0], b[1], b[2], (int)edge->triangle,
                        rom->patch[rom->triangle_patch[edge->triangle]].name, fault);
}

static CastStatus check_edges(const RomData *rom, const Edge *edges, size_t n, CastError *err)
{
  for (size_t i = 0, next; i < n; i = next) {
    ROM_CHECK(edges[i].low != edges[i].high, err, "geometry/triangles: triangle %d uses point %d twice",
              (int)edges[i].triangle, (int)edges[i].low);
    for (next = i + 1; next < n && edges[next].low == edges[i].low && edges[next].high == edges[i].high;) next++;
    if (next - i != 2 || edges[i].upwards == edges[i + 1].upwards) return report_edge(rom, &edges[i], next - i, err);
  }
  return CAST_OK;
}

CastStatus rom_check_closed(const RomData *rom, CastError *err)
{
  const size_t n = 3 * rom->n_triangles;
  Edge *edges = malloc(n * sizeof *edges);
  CAST_CHECK(edges, err, CAST_ERR_MEMORY, "no memory to check %zu triangles", rom->n_triangles);
  list_edges(rom, edges);
  qsort(edges, n, sizeof *edges, compare_edges);
  const CastStatus status = check_edges(rom, edges, n, err);
  free(edges);
  return status;
}
