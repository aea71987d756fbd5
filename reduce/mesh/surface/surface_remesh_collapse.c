/* surface_remesh_collapse.c - take out points whose edges are too short. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "common/vector.h"
#include "reduce/mesh/surface/surface_remesh.h"

static const double TOO_SHORT = 0.6, TOO_LONG = 1.5; // of the length wanted
static const double LARGEST_BEND = 0.98;             // cosine between a triangle's normal before and after: 11 degrees
static const double NEEDLE = 0.05;                   // of what fullness_of gives
static const double STRAIGHT = 0.97;                 // cosine: a sharp edge goes on

typedef struct Stars { // triangles at each point
  size_t *start;       // [n_points + 1]
  int32_t *triangle;
} Stars;

typedef struct Collapser {
  RemeshSurface *surface;
  const RemeshEdge *edges;
  size_t n_edges;
  const RemeshSize *size;
  Stars stars;
  int32_t (*sharp)[2]; // [n_points] the other ends of its first two sharp edges
  int32_t *n_sharp;    // [n_points]
  bool *touched;       // [n_points] in this pass
} Collapser;

static bool allocate(Collapser *c)
{
  const size_t n = c->surface->n_points;
  c->stars.start = calloc(n + 2, sizeof *c->stars.start);
  c->stars.triangle = malloc((3 * c->surface->n_triangles + 1) * sizeof *c->stars.triangle);
  c->sharp = malloc((n + 1) * sizeof *c->sharp);
  c->n_sharp = calloc(n + 1, sizeof *c->n_sharp);
  c->touched = calloc(n + 1, sizeof *c->touched);
  return c->stars.start && c->stars.triangle && c->sharp && c->n_sharp && c->touched;
}

static void fill(Collapser *c)
{
  const RemeshSurface *surface = c->surface;
  size_t *start = c->stars.start;
  for (size_t i = 0; i < 3 * surface->n_triangles; i++) start[surface->triangle[i] + 2]++;
  for (size_t p = 1; p <= surface->n_points; p++) start[p + 1] += start[p];
  for (size_t i = 0; i < 3 * surface->n_triangles; i++)
    c->stars.triangle[start[surface->triangle[i] + 1]++] = (int32_t)(i / 3);
  for (size_t i = 0; i < c->n_edges; i++) {
    const int32_t ends[2] = {c->edges[i].low, c->edges[i].high};
    for (int k = 0; c->edges[i].sharp && k < 2; k++) {
      if (c->n_sharp[ends[k]] < 2) c->sharp[ends[k]][c->n_sharp[ends[k]]] = ends[1 - k];
      c->n_sharp[ends[k]]++;
    }
  }
}

/* A point inside a face may go; one on a sharp edge may go along it where it is straight; a corner may not. */
static bool may_go(const Collapser *c, int32_t from, int32_t to, bool sharp)
{
  if (c->n_sharp[from] == 0) return true;
  if (c->n_sharp[from] != 2 || !sharp) return false;
  double u[3], v[3];
  const double *x = c->surface->x;
  const int32_t back = c->sharp[from][0] == to ? c->sharp[from][1] : c->sharp[from][0];
  vec_between(x + 3 * (size_t)back, x + 3 * (size_t)from, u);
  vec_between(x + 3 * (size_t)from, x + 3 * (size_t)to, v);
  return vec_dot(u, v) > STRAIGHT * vec_norm(u) * vec_norm(v);
}

static bool holds(const int32_t *triangle, int32_t point)
{
  return triangle[0] == point || triangle[1] == point || triangle[2] == point;
}

/* Twice the area over the square of the longest side: 0.87 for equal sides. */
static double fullness_of(const double *x, const int32_t *triangle)
{
  double normal[3], longest = 0.0;
  remesh_normal(x, triangle, normal);
  for (int k = 0; k < 3; k++)
    longest = fmax(longest, vec_distance(x + 3 * (size_t)triangle[k], x + 3 * (size_t)triangle[(k + 1) % 3]));
  return vec_norm(normal) / (longest * longest);
}

/* What is left of the star of `from` when it has gone to `to`: no triangle may turn, and no edge become too long.
 * The least cosine between a triangle's normal before and after; 0 if it must not be. */
static double judge_star(const Collapser *c, int32_t from, int32_t to)
{
  const RemeshSurface *surface = c->surface;
  int common = 0;
  double least = 1.0;
  for (size_t i = c->stars.start[from]; i < c->stars.start[from + 1]; i++) {
    const int32_t *triangle = surface->triangle + 3 * c->stars.triangle[i];
    double before[3], after[3];
    int32_t moved[3];
    for (int k = 0; k < 3; k++) {
      if (c->touched[triangle[k]]) return 0.0;
      moved[k] = triangle[k] == from ? to : triangle[k];
      if (triangle[k] == from || triangle[k] == to) continue;
      common += remesh_find_edge(c->edges, c->n_edges, triangle[k], to) != NULL; // each neighbour stands in two
      const double *x = surface->x + 3 * (size_t)triangle[k], *y = surface->x + 3 * (size_t)to;
      if (vec_distance(x, y) > TOO_LONG * c->size->at(c->size->context, x)) return 0.0;
    }
    if (holds(triangle, to)) continue;
    remesh_normal(surface->x, triangle, before);
    remesh_normal(surface->x, moved, after);
    least = fmin(least, vec_dot(before, after) / (vec_norm(before) * vec_norm(after) + 1e-300));
    if (!(least > LARGEST_BEND)) return 0.0;
    const double fullness = fullness_of(surface->x, moved);
    if (fullness < NEEDLE && fullness < fullness_of(surface->x, triangle)) return 0.0;
  }
  return common == 4 ? least : 0.0; // two common neighbours: the link condition
}

static void take_out(Collapser *c, int32_t from, int32_t to)
{
  RemeshSurface *surface = c->surface;
  for (size_t i = c->stars.start[from]; i < c->stars.start[from + 1]; i++) {
    int32_t *triangle = surface->triangle + 3 * c->stars.triangle[i];
    const bool gone = holds(triangle, to);
    for (int k = 0; k < 3; k++) {
      c->touched[triangle[k]] = true;
      if (triangle[k] == from) triangle[k] = to;
    }
    if (gone) triangle[0] = triangle[1] = triangle[2] = -1; // swept out at the end
  }
}

static void sweep(RemeshSurface *surface)
{
  size_t n = 0;
  for (size_t t = 0; t < surface->n_triangles; t++) {
    if (surface->triangle[3 * t] < 0) continue;
    memmove(surface->triangle + 3 * n, surface->triangle + 3 * t, 3 * sizeof(int32_t));
    surface->tag[n++] = surface->tag[t];
  }
  surface->n_triangles = n;
}

static bool try_edge(Collapser *c, const RemeshEdge *edge)
{
  const double *a = c->surface->x + 3 * (size_t)edge->low, *b = c->surface->x + 3 * (size_t)edge->high;
  if (vec_distance(a, b) >= TOO_SHORT * c->size->at(c->size->context, a)) return false;
  const int32_t ends[2] = {edge->low, edge->high};
  double best = 0.0;
  int which = -1; // of the two the one whose going bends the surface less: on a facet rather than between two
  for (int k = 0; k < 2; k++) {
    const double cosine = may_go(c, ends[k], ends[1 - k], edge->sharp) ? judge_star(c, ends[k], ends[1 - k]) : 0.0;
    if (cosine <= best) continue;
    best = cosine;
    which = k;
  }
  if (which >= 0) take_out(c, ends[which], ends[1 - which]);
  return which >= 0;
}

CastStatus remesh_collapse(RemeshSurface *surface, double split_angle, const RemeshSize *size, size_t *n_done,
                           CastError *err)
{
  RemeshEdge *edges = NULL;
  Collapser c = {.surface = surface, .size = size};
  CAST_CALL(remesh_list_edges(surface, split_angle, &edges, &c.n_edges, err));
  c.edges = edges;
  const bool room = allocate(&c);
  *n_done = 0;
  if (room) {
    fill(&c);
    for (size_t i = 0; i < c.n_edges; i++)
      if (!c.touched[edges[i].low] && !c.touched[edges[i].high]) *n_done += try_edge(&c, &edges[i]);
    sweep(surface);
  }
  free(edges);
  free(c.stars.start);
  free(c.stars.triangle);
  free(c.sharp);
  free(c.n_sharp);
  free(c.touched);
  CAST_CHECK(room, err, CAST_ERR_MEMORY, "no memory for the surface");
  return CAST_OK;
}
