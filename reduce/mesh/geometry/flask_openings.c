/* flask_openings.c - where the cavity comes out at the flask's top. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "reduce/mesh/geometry/flask.h"

typedef struct HalfEdge {
  int32_t from, to;
} HalfEdge;

static int by_undirected(const void *left, const void *right)
{
  const HalfEdge *a = left, *b = right;
  const int32_t a_low = a->from < a->to ? a->from : a->to, b_low = b->from < b->to ? b->from : b->to;
  const int32_t a_high = a->from + a->to - a_low, b_high = b->from + b->to - b_low;
  if (a_low != b_low) return a_low < b_low ? -1 : 1;
  if (a_high != b_high) return a_high < b_high ? -1 : 1;
  return (a->from > b->from) - (a->from < b->from);
}

static int by_from(const void *left, const void *right)
{
  const HalfEdge *a = left, *b = right;
  if (a->from != b->from) return a->from < b->from ? -1 : 1;
  return (a->to > b->to) - (a->to < b->to);
}

static void mark_left_out(const StlSurface *body, double top, double slack, bool *left_out)
{
  for (size_t t = 0; t < body->n_triangles; t++) {
    left_out[t] = true;
    for (size_t k = 0; k < 3; k++)
      if (fabs(body->x[3 * (size_t)body->triangle[3 * t + k] + 2] - top) > slack) left_out[t] = false;
  }
}

/* Edges of the triangles that stay whose neighbour is left out, from start to end, by start. */
static CastStatus list_rim(const StlSurface *body, const bool *left_out, HalfEdge **rim, size_t *n, CastError *err)
{
  size_t all = 0;
  *n = 0;
  *rim = malloc((3 * body->n_triangles + 1) * sizeof **rim);
  CAST_CHECK(*rim, err, CAST_ERR_MEMORY, "no memory for the flask");
  HalfEdge *edge = *rim;
  for (size_t i = 0; i < 3 * body->n_triangles; i++)
    if (!left_out[i / 3]) edge[all++] = (HalfEdge){body->triangle[i], body->triangle[i - i % 3 + (i + 1) % 3]};
  qsort(edge, all, sizeof *edge, by_undirected);
  for (size_t i = 0; i < all;) {
    const bool pair = i + 1 < all && edge[i].from == edge[i + 1].to && edge[i].to == edge[i + 1].from;
    if (!pair) edge[(*n)++] = edge[i];
    i += pair ? 2 : 1;
  }
  qsort(edge, *n, sizeof *edge, by_from);
  return CAST_OK;
}

static double area_of(const StlSurface *body, const int32_t *point, size_t n)
{
  double twice = 0.0;
  for (size_t i = 0; i < n; i++) {
    const double *a = body->x + 3 * (size_t)point[i], *b = body->x + 3 * (size_t)point[(i + 1) % n];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return 0.5 * twice;
}

static size_t find_edge(const HalfEdge *rim, size_t n, int32_t from)
{
  size_t low = 0, high = n;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (rim[middle].from < from)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static CastStatus check_rim(const StlSurface *body, const HalfEdge *rim, size_t n, double unit, CastError *err)
{
  for (size_t i = 1; i < n; i++) {
    const double *x = body->x + 3 * (size_t)rim[i].from;
    CAST_CHECK(rim[i].from != rim[i - 1].from, err, CAST_ERR_INPUT,
               "two openings of the cavity in the flask's top touch at (%.6g, %.6g, %.6g) mm", x[0] * 1e3 * unit,
               x[1] * 1e3 * unit, x[2] * 1e3 * unit);
  }
  return CAST_OK;
}

/* What stays is wound out of the body: seen from above, the rim of an opening runs against the clock where it encloses
 * the opening and with it where it encloses a piece of the top. */
static void chain(const StlSurface *body, const HalfEdge *rim, size_t n, bool *used, FlaskOpenings *openings)
{
  size_t filled = 0;
  for (size_t first = 0; first < n; first++) {
    if (used[first]) continue;
    const size_t begin = filled;
    for (size_t i = first; i < n && !used[i]; i = find_edge(rim, n, rim[i].to)) {
      used[i] = true;
      openings->point[filled++] = rim[i].from;
    }
    openings->island[openings->n] = area_of(body, openings->point + begin, filled - begin) > 0.0;
    openings->start[openings->n++] = begin;
  }
  openings->start[openings->n] = filled;
}

CastStatus flask_find_openings(const StlSurface *body, double top, double unit, bool *left_out, FlaskOpenings *openings,
                               CastError *err)
{
  HalfEdge *rim = NULL;
  size_t n = 0;
  double size = 0.0;
  for (size_t i = 0; i < 3 * body->n_points; i++) size = fmax(size, fabs(body->x[i]));
  mark_left_out(body, top, 1e-6 * size, left_out);
  *openings = (FlaskOpenings){0};
  CastStatus status = list_rim(body, left_out, &rim, &n, err);
  if (status == CAST_OK) status = check_rim(body, rim, n, unit, err);
  bool *used = calloc(n + 1, sizeof *used);
  openings->start = malloc((n + 2) * sizeof *openings->start);
  openings->point = malloc((n + 1) * sizeof *openings->point);
  openings->island = malloc((n + 1) * sizeof *openings->island);
  if (status == CAST_OK && !(used && openings->start && openings->point && openings->island))
    status = cast_error_set(err, CAST_ERR_MEMORY, "no memory for the flask");
  if (status == CAST_OK) chain(body, rim, n, used, openings);
  free(rim);
  free(used);
  return status;
}

void flask_free_openings(FlaskOpenings *openings)
{
  free(openings->start);
  free(openings->point);
  free(openings->island);
  *openings = (FlaskOpenings){0};
}
