/* surface_remesh_split.c - halve the edges that are too long. A triangle is cut by its marked edges, the longest first,
 * so that its neighbours need not be known. */
#include <stdlib.h>
#include <string.h>
#include "common/vector.h"
#include "reduce/mesh/surface/surface_remesh.h"

static const double TOO_LONG = 1.4; // of the length wanted

typedef struct Splitter {
  RemeshSurface *surface;
  const RemeshEdge *edges;
  const int32_t *middle; // [edges] new point; -1: none
  size_t n_edges, n_out;
  int32_t *out, *tag; // new triangles
} Splitter;

static double length_of(const RemeshSurface *surface, const RemeshEdge *edge)
{
  return vec_distance(surface->x + 3 * (size_t)edge->low, surface->x + 3 * (size_t)edge->high);
}

/* At most 3 marked edges: at most 4 triangles. */
static void cut(Splitter *splitter, const int32_t p[3], int32_t tag)
{
  int longest = -1;
  double most = 0.0;
  int32_t middle = -1;
  for (int k = 0; k < 3; k++) {
    const RemeshEdge *edge = remesh_find_edge(splitter->edges, splitter->n_edges, p[k], p[(k + 1) % 3]);
    if (!edge || splitter->middle[edge - splitter->edges] < 0) continue;
    const double length = length_of(splitter->surface, edge);
    if (length < most || (length == most && longest >= 0)) continue;
    longest = k;
    most = length;
    middle = splitter->middle[edge - splitter->edges];
  }
  if (longest < 0) {
    memcpy(splitter->out + 3 * splitter->n_out, p, 3 * sizeof *p);
    splitter->tag[splitter->n_out++] = tag;
    return;
  }
  const int32_t a = p[longest], b = p[(longest + 1) % 3], c = p[(longest + 2) % 3];
  cut(splitter, (int32_t[]){a, middle, c}, tag);
  cut(splitter, (int32_t[]){middle, b, c}, tag);
}

static CastStatus mark(RemeshSurface *surface, const RemeshEdge *edges, size_t n, const RemeshSize *size,
                       int32_t *middle, size_t *n_marked, CastError *err)
{
  double *x = realloc(surface->x, 3 * (surface->n_points + n + 1) * sizeof *x);
  CAST_CHECK(x, err, CAST_ERR_MEMORY, "no memory for the surface");
  surface->x = x;
  *n_marked = 0;
  for (size_t i = 0; i < n; i++) {
    double centre[3];
    for (size_t d = 0; d < 3; d++)
      centre[d] = 0.5 * (x[3 * (size_t)edges[i].low + d] + x[3 * (size_t)edges[i].high + d]);
    middle[i] = -1;
    if (length_of(surface, &edges[i]) <= TOO_LONG * size->at(size->context, centre)) continue;
    memcpy(x + 3 * surface->n_points, centre, sizeof centre);
    middle[i] = (int32_t)surface->n_points++;
    (*n_marked)++;
  }
  return CAST_OK;
}

static CastStatus split_once(RemeshSurface *surface, double split_angle, const RemeshSize *size, size_t *n_marked,
                             CastError *err)
{
  RemeshEdge *edges = NULL;
  size_t n = 0;
  CAST_CALL(remesh_list_edges(surface, split_angle, &edges, &n, err));
  int32_t *middle = malloc((n + 1) * sizeof *middle);
  CastStatus status = middle ? mark(surface, edges, n, size, middle, n_marked, err)
                             : cast_error_set(err, CAST_ERR_MEMORY, "no memory for the surface");
  const size_t room = surface->n_triangles + 2 * (status == CAST_OK ? *n_marked : 0);
  Splitter splitter = {.surface = surface, .edges = edges, .middle = middle, .n_edges = n};
  splitter.out = malloc((3 * room + 1) * sizeof *splitter.out);
  splitter.tag = malloc((room + 1) * sizeof *splitter.tag);
  if (status == CAST_OK && !(splitter.out && splitter.tag))
    status = cast_error_set(err, CAST_ERR_MEMORY, "no memory for the surface");
  if (status == CAST_OK) {
    for (size_t t = 0; t < surface->n_triangles; t++) cut(&splitter, surface->triangle + 3 * t, surface->tag[t]);
    free(surface->triangle);
    free(surface->tag);
    surface->triangle = splitter.out;
    surface->tag = splitter.tag;
    surface->n_triangles = splitter.n_out;
  } else {
    free(splitter.out);
    free(splitter.tag);
  }
  free(edges);
  free(middle);
  return status;
}

CastStatus remesh_split(RemeshSurface *surface, double split_angle, const RemeshSize *size, CastError *err)
{
  enum { HALVINGS = 24 };
  size_t n_marked = 1;
  for (int i = 0; i < HALVINGS && n_marked > 0; i++) CAST_CALL(split_once(surface, split_angle, size, &n_marked, err));
  return CAST_OK;
}
