/* surface.c - storage, topology and pseudo-normals of the mould's boundary.
 * Reference: J. A. Baerentzen, H. Aanaes, Signed distance computation using the angle weighted pseudonormal,
 * IEEE Trans. Vis. Comput. Graph. 11 (2005) 243-253: the sign of (x - foot) . n is right everywhere if n is the face's
 * normal, at an edge the sum of its two faces' normals, at a vertex the sum weighted by the angles met there. */
#include "cast/geometry/surface_internal.h"

#include <stdlib.h>
#include <string.h>

typedef struct HalfEdge {
  int32_t low, high; // the edge's points, low < high
  int32_t side;      // 3 triangle + edge
  int32_t forward;   // 1: the triangle runs from low to high
} HalfEdge;

static int compare_half_edges(const void *left, const void *right)
{
  const HalfEdge *a = left, *b = right;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  if (a->high != b->high) return a->high < b->high ? -1 : 1;
  return (a->side > b->side) - (a->side < b->side);
}

static CastStatus copy_points(Surface *s, const RomData *rom, int32_t *renumber, CastError *err)
{
  for (size_t p = 0; p < rom->n_points; p++) renumber[p] = -1;
  int32_t count = 0;
  for (ptrdiff_t t = 0; t < s->n_triangles; t++)
    for (int k = 0; k < 3; k++) {
      const int32_t p = rom->triangles[3 * t + k];
      CAST_CHECK(p >= 0 && (size_t)p < rom->n_points, err, CAST_ERR_FORMAT,
                 "boundary triangle %td: point %d, but there are %zu points", t, p, rom->n_points);
      if (renumber[p] < 0) renumber[p] = count++;
      s->triangle[t][k] = renumber[p];
    }
  s->n_points = count;
  s->point = malloc((size_t)count * sizeof *s->point);
  s->vertex_normal = calloc((size_t)count, sizeof *s->vertex_normal);
  CAST_CHECK(s->point && s->vertex_normal, err, CAST_ERR_MEMORY, "no memory for %d boundary points", count);
  for (size_t p = 0; p < rom->n_points; p++)
    if (renumber[p] >= 0) vec_copy(rom->points + 3 * p, s->point[renumber[p]]);
  return CAST_OK;
}

static void add_bounds(const double x[3], double low[3], double high[3])
{
  for (int k = 0; k < 3; k++) {
    low[k] = fmin(low[k], x[k]);
    high[k] = fmax(high[k], x[k]);
  }
}

/* About the centre of mass; a little too large, so that rounding in its use does no harm. */
static void make_sphere(Facet *facet)
{
  double most = 0.0;
  for (int k = 0; k < 3; k++)
    facet->centre[k] = (facet->corner[0][k] + facet->corner[1][k] + facet->corner[2][k]) / 3.0;
  for (int k = 0; k < 3; k++) most = fmax(most, vec_distance2(facet->corner[k], facet->centre));
  facet->radius = sqrt(most) * (1.0 + 1.0e-9);
}

static CastStatus make_facets(Surface *s, const RomData *rom, CastError *err)
{
  for (int k = 0; k < 3; k++) {
    s->low[k] = s->cavity_low[k] = INFINITY;
    s->high[k] = s->cavity_high[k] = -INFINITY;
  }
  for (ptrdiff_t t = 0; t < s->n_triangles; t++) {
    const int32_t patch = rom->triangle_patch[t];
    CAST_CHECK(patch >= 0 && (size_t)patch < rom->m, err, CAST_ERR_FORMAT,
               "boundary triangle %td: patch %d, but there are %zu patches", t, patch, rom->m);
    s->patch[t] = patch;
    s->outer[t] = rom->patch[patch].outer ? 1 : 0;
    Facet *facet = &s->facet[t];
    for (int k = 0; k < 3; k++) {
      vec_copy(s->point[s->triangle[t][k]], facet->corner[k]);
      add_bounds(facet->corner[k], s->low, s->high);
      if (!s->outer[t]) add_bounds(facet->corner[k], s->cavity_low, s->cavity_high);
    }
    make_sphere(facet);
    double u[3], v[3];
    vec_sub(facet->corner[1], facet->corner[0], u);
    vec_sub(facet->corner[2], facet->corner[0], v);
    vec_cross(u, v, facet->normal);
    const double twice_area = vec_normalise(facet->normal);
    CAST_CHECK(isfinite(twice_area) && twice_area > 0.0, err, CAST_ERR_FORMAT,
               "boundary triangle %td at (%g, %g, %g) m has no area", t, facet->corner[0][0], facet->corner[0][1],
               facet->corner[0][2]);
  }
  double size[3];
  vec_sub(s->high, s->low, size);
  s->tiny = 1.0e-12 * vec_norm(size);
  return CAST_OK;
}

/* Each edge must be run through as often one way as the other: then the boundary is closed and wound one way. Where
 * more than two triangles meet at an edge (two voids that touch there) all of them are weighed. */
static CastStatus finish_edge(Surface *s, const HalfEdge *edge, ptrdiff_t count, CastError *err)
{
  ptrdiff_t balance = 0;
  double normal[3] = {0.0, 0.0, 0.0};
  for (ptrdiff_t k = 0; k < count; k++) {
    balance += edge[k].forward ? 1 : -1;
    vec_axpy(1.0, s->facet[edge[k].side / 3].normal, normal, normal);
  }
  const double *at = s->point[edge->low];
  CAST_CHECK(
      balance == 0, err, CAST_ERR_FORMAT,
      "the mould's boundary is not closed, or not wound one way, at the edge from (%g, %g, %g) m: %td of its %td "
      "triangles have no partner",
      at[0], at[1], at[2], balance > 0 ? balance : -balance, count);
  if (vec_normalise(normal) == 0.0) vec_copy(s->facet[edge->side / 3].normal, normal); // folded flat on itself
  for (ptrdiff_t k = 0; k < count; k++) vec_copy(normal, s->edge_normal[edge[k].side]);
  return CAST_OK;
}

static CastStatus make_edges(Surface *s, HalfEdge *edges, CastError *err)
{
  const ptrdiff_t n = 3 * s->n_triangles;
  for (ptrdiff_t side = 0; side < n; side++) {
    const int32_t from = s->triangle[side / 3][side % 3], to = s->triangle[side / 3][(side + 1) % 3];
    CAST_CHECK(from != to, err, CAST_ERR_FORMAT, "boundary triangle %td names the same point twice", side / 3);
    edges[side] = (HalfEdge){from < to ? from : to, from < to ? to : from, (int32_t)side, from < to};
  }
  qsort(edges, (size_t)n, sizeof *edges, compare_half_edges);
  for (ptrdiff_t first = 0, next; first < n; first = next) {
    for (next = first + 1; next < n; next++)
      if (edges[next].low != edges[first].low || edges[next].high != edges[first].high) break;
    CAST_CALL(finish_edge(s, edges + first, next - first, err));
  }
  return CAST_OK;
}

static double corner_angle(const Facet *facet, int k)
{
  double u[3], v[3], normal[3];
  vec_sub(facet->corner[(k + 1) % 3], facet->corner[k], u);
  vec_sub(facet->corner[(k + 2) % 3], facet->corner[k], v);
  vec_cross(u, v, normal);
  return atan2(vec_norm(normal), vec_dot(u, v));
}

static CastStatus make_vertices(Surface *s, CastError *err)
{
  s->fan_start = calloc((size_t)s->n_points + 1, sizeof *s->fan_start);
  s->fan = malloc((size_t)s->n_triangles * 3 * sizeof *s->fan);
  CAST_CHECK(s->fan_start && s->fan, err, CAST_ERR_MEMORY, "no memory for the fans of %td points", s->n_points);
  for (ptrdiff_t t = 0; t < s->n_triangles; t++)
    for (int k = 0; k < 3; k++) s->fan_start[s->triangle[t][k] + 1]++;
  for (ptrdiff_t p = 0; p < s->n_points; p++) s->fan_start[p + 1] += s->fan_start[p];
  for (ptrdiff_t t = 0; t < s->n_triangles; t++)
    for (int k = 0; k < 3; k++) {
      const int32_t p = s->triangle[t][k];
      s->fan[s->fan_start[p]++] = (int32_t)t;
      vec_axpy(corner_angle(&s->facet[t], k), s->facet[t].normal, s->vertex_normal[p], s->vertex_normal[p]);
    }
  for (ptrdiff_t p = s->n_points; p > 0; p--)
    s->fan_start[p] = s->fan_start[p - 1]; // filling moved each start on by one
  s->fan_start[0] = 0;
  for (ptrdiff_t p = 0; p < s->n_points; p++)
    if (vec_normalise(s->vertex_normal[p]) == 0.0)
      vec_copy(s->facet[s->fan[s->fan_start[p]]].normal, s->vertex_normal[p]);
  return CAST_OK;
}

static CastStatus allocate_triangles(Surface *s, CastError *err)
{
  const size_t n = (size_t)s->n_triangles;
  s->triangle = malloc(n * sizeof *s->triangle);
  s->facet = malloc(n * sizeof *s->facet);
  s->edge_normal = malloc(3 * n * sizeof *s->edge_normal);
  s->patch = malloc(n * sizeof *s->patch);
  s->outer = malloc(n);
  s->thin = calloc(n, 1);
  CAST_CHECK(s->triangle && s->facet && s->edge_normal && s->patch && s->outer && s->thin, err, CAST_ERR_MEMORY,
             "no memory for %zu boundary triangles", n);
  return CAST_OK;
}

static CastStatus build(Surface *s, const RomData *rom, int32_t *renumber, HalfEdge *edges, CastError *err)
{
  CAST_CALL(allocate_triangles(s, err));
  CAST_CALL(copy_points(s, rom, renumber, err));
  CAST_CALL(make_facets(s, rom, err));
  CAST_CALL(make_edges(s, edges, err));
  CAST_CALL(make_vertices(s, err));
  CAST_CALL(surface_grid_create(s, err));
  CAST_CALL(surface_grid_classify(s, err));
  return surface_thin_mark(s, err);
}

CastStatus surface_create(const RomData *rom, double reach, Surface **surface, CastError *err)
{
  *surface = NULL;
  CAST_CHECK(reach > 0.0 && isfinite(reach), err, CAST_ERR_ARGUMENT, "surface: the reach is %g m, it must be positive",
             reach);
  CAST_CHECK(rom->n_triangles > 0 && rom->n_triangles < INT32_MAX / 3 && rom->n_points < INT32_MAX, err,
             CAST_ERR_FORMAT, "the mould's boundary has %zu triangles and %zu points", rom->n_triangles, rom->n_points);
  Surface *s = calloc(1, sizeof *s);
  int32_t *renumber = malloc(rom->n_points * sizeof *renumber);
  HalfEdge *edges = malloc(3 * rom->n_triangles * sizeof *edges);
  CastStatus status = CAST_ERR_MEMORY;
  if (s && renumber && edges) {
    s->n_triangles = (ptrdiff_t)rom->n_triangles;
    s->reach = reach;
    status = build(s, rom, renumber, edges, err);
  } else {
    cast_error_set(err, status, "no memory for a boundary of %zu triangles", rom->n_triangles);
  }
  free(renumber);
  free(edges);
  if (status == CAST_OK)
    *surface = s;
  else
    surface_destroy(&s);
  return status;
}

void surface_destroy(Surface **surface)
{
  Surface *s = *surface;
  if (!s) return;
  void *const owned[] = {s->point,      s->triangle,  s->facet,      s->edge_normal, s->vertex_normal,
                         s->fan_start,  s->fan,       s->patch,      s->outer,       s->thin,
                         s->grid.start, s->grid.item, s->grid.flags, s->grid.steps};
  for (size_t k = 0; k < sizeof owned / sizeof *owned; k++) free(owned[k]);
  free(s);
  *surface = NULL;
}

void surface_bounds(const Surface *surface, double low[3], double high[3])
{
  vec_copy(surface->low, low);
  vec_copy(surface->high, high);
}

double surface_reach(const Surface *surface)
{
  return surface->reach;
}
