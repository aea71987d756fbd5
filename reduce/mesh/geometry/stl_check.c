/* stl_check.c - is an STL surface the boundary of a body? */
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "common/vector.h"
#include "reduce/mesh/geometry/stl_file.h"
#include "reduce/mesh/tets/faults.h"

enum { MOST_REPORTED = 5 }; // of each kind, by place

typedef struct Checker {
  const StlSurface *surface;
  double to_mm, size; // of the whole, in the file's unit
  Faults faults;
} Checker;

typedef struct Edge {
  int32_t low, high;
  int32_t triangle;
  bool forwards; // the triangle runs from low to high
} Edge;

static const double *corner_of(const StlSurface *surface, size_t triangle, size_t k)
{
  return surface->x + 3 * (size_t)surface->triangle[3 * triangle + k];
}

static int by_ends(const void *left, const void *right)
{
  const Edge *a = left, *b = right;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  if (a->high != b->high) return a->high < b->high ? -1 : 1;
  return (a->triangle > b->triangle) - (a->triangle < b->triangle);
}

static void place_of(const Checker *checker, const Edge *edge, double mm[3])
{
  const double *a = checker->surface->x + 3 * (size_t)edge->low, *b = checker->surface->x + 3 * (size_t)edge->high;
  for (int d = 0; d < 3; d++) mm[d] = 0.5 * (a[d] + b[d]) * checker->to_mm;
}

static void check_edge(Checker *checker, const Edge *edge, size_t n, size_t counts[2])
{
  double at[3];
  place_of(checker, edge, at);
  if (n == 2 && edge[0].forwards != edge[1].forwards) return;
  if (n == 2 && counts[1]++ < MOST_REPORTED)
    faults_add(&checker->faults,
               "the triangles %d and %d, which share an edge at (%.6g, %.6g, %.6g) mm, are wound against each other: "
               "the normal of one of them points to the wrong side",
               edge[0].triangle + 1, edge[1].triangle + 1, at[0], at[1], at[2]);
  if (n == 1 && counts[0]++ < MOST_REPORTED)
    faults_add(&checker->faults, "the surface is open: triangle %d has no neighbour at (%.6g, %.6g, %.6g) mm",
               edge->triangle + 1, at[0], at[1], at[2]);
  if (n > 2 && counts[0]++ < MOST_REPORTED)
    faults_add(&checker->faults, "%zu triangles share an edge at (%.6g, %.6g, %.6g) mm: two are expected", n, at[0],
               at[1], at[2]);
}

static CastStatus check_edges(Checker *checker, CastError *err)
{
  const StlSurface *surface = checker->surface;
  const size_t n = 3 * surface->n_triangles;
  size_t counts[2] = {0, 0};
  Edge *edge = malloc(n * sizeof *edge);
  CAST_CHECK(edge, err, CAST_ERR_MEMORY, "no memory to check the STL file");
  for (size_t i = 0; i < n; i++) {
    const int32_t a = surface->triangle[i], b = surface->triangle[i - i % 3 + (i + 1) % 3];
    edge[i] = (Edge){a < b ? a : b, a < b ? b : a, (int32_t)(i / 3), a < b};
  }
  qsort(edge, n, sizeof *edge, by_ends);
  for (size_t i = 0, next; i < n; i = next) {
    for (next = i + 1; next < n && edge[next].low == edge[i].low && edge[next].high == edge[i].high;) next++;
    check_edge(checker, edge + i, next - i, counts);
  }
  free(edge);
  if (counts[0] > MOST_REPORTED)
    faults_add(&checker->faults, "%zu edges in all do not belong to two triangles", counts[0]);
  if (counts[1] > MOST_REPORTED)
    faults_add(&checker->faults, "%zu edges in all are between triangles wound against each other", counts[1]);
  return CAST_OK;
}

static void check_triangles(Checker *checker)
{
  const StlSurface *surface = checker->surface;
  size_t count = 0;
  for (size_t t = 0; t < surface->n_triangles; t++) {
    double u[3], v[3], normal[3];
    const double *a = corner_of(surface, t, 0);
    vec_between(a, corner_of(surface, t, 1), u);
    vec_between(a, corner_of(surface, t, 2), v);
    vec_cross(u, v, normal);
    if (vec_norm(normal) > 1e-12 * checker->size * checker->size || count++ >= MOST_REPORTED) continue;
    faults_add(&checker->faults, "triangle %zu at (%.6g, %.6g, %.6g) mm has no area", t + 1, a[0] * checker->to_mm,
               a[1] * checker->to_mm, a[2] * checker->to_mm);
  }
}

/* --- does it go through itself? --- */

typedef struct Box {
  double low[3], high[3];
  size_t triangle;
} Box;

static int by_low_x(const void *left, const void *right)
{
  const Box *a = left, *b = right;
  if (a->low[0] != b->low[0]) return a->low[0] < b->low[0] ? -1 : 1;
  return (a->triangle > b->triangle) - (a->triangle < b->triangle);
}

static double volume_of(const double *a, const double *b, const double *c, const double *d)
{
  double u[3], v[3], w[3], cross[3];
  vec_between(a, b, u);
  vec_between(a, c, v);
  vec_between(a, d, w);
  vec_cross(u, v, cross);
  return vec_dot(cross, w);
}

/* Does the segment pq go through the inside of the triangle? To touch it is not enough. */
static bool pierces(const Checker *checker, const double *p, const double *q, size_t t)
{
  const double *a = corner_of(checker->surface, t, 0), *b = corner_of(checker->surface, t, 1);
  const double *c = corner_of(checker->surface, t, 2);
  const double none = 1e-14 * checker->size * checker->size * checker->size;
  const double side_p = volume_of(a, b, c, p), side_q = volume_of(a, b, c, q);
  if (!((side_p > none && side_q < -none) || (side_p < -none && side_q > none))) return false;
  const double ab = volume_of(p, q, a, b), bc = volume_of(p, q, b, c), ca = volume_of(p, q, c, a);
  return (ab > none && bc > none && ca > none) || (ab < -none && bc < -none && ca < -none);
}

static bool go_through(const Checker *checker, size_t s, size_t t)
{
  const int32_t *p = checker->surface->triangle + 3 * s, *q = checker->surface->triangle + 3 * t;
  for (size_t k = 0; k < 3; k++) {
    const size_t next = (k + 1) % 3;
    const bool p_shared =
        p[k] == q[0] || p[k] == q[1] || p[k] == q[2] || p[next] == q[0] || p[next] == q[1] || p[next] == q[2];
    const bool q_shared =
        q[k] == p[0] || q[k] == p[1] || q[k] == p[2] || q[next] == p[0] || q[next] == p[1] || q[next] == p[2];
    if (!p_shared && pierces(checker, corner_of(checker->surface, s, k), corner_of(checker->surface, s, next), t))
      return true;
    if (!q_shared && pierces(checker, corner_of(checker->surface, t, k), corner_of(checker->surface, t, next), s))
      return true;
  }
  return false;
}

static bool boxes_meet(const Box *a, const Box *b)
{
  return a->low[1] <= b->high[1] && b->low[1] <= a->high[1] && a->low[2] <= b->high[2] && b->low[2] <= a->high[2];
}

static void report_pair(Checker *checker, const Box *a, const Box *b)
{
  double at[3];
  for (int d = 0; d < 3; d++)
    at[d] = 0.5 * (fmax(a->low[d], b->low[d]) + fmin(a->high[d], b->high[d])) * checker->to_mm;
  faults_add(&checker->faults, "the surface goes through itself: triangles %zu and %zu at (%.4g, %.4g, %.4g) mm",
             a->triangle + 1, b->triangle + 1, at[0], at[1], at[2]);
}

static CastStatus check_crossings(Checker *checker, CastError *err)
{
  const StlSurface *surface = checker->surface;
  const size_t n = surface->n_triangles;
  size_t count = 0;
  Box *box = malloc(n * sizeof *box);
  CAST_CHECK(box, err, CAST_ERR_MEMORY, "no memory to check the STL file");
  for (size_t t = 0; t < n; t++) {
    box[t] = (Box){{DBL_MAX, DBL_MAX, DBL_MAX}, {-DBL_MAX, -DBL_MAX, -DBL_MAX}, t};
    for (size_t k = 0; k < 3; k++)
      for (int d = 0; d < 3; d++) {
        box[t].low[d] = fmin(box[t].low[d], corner_of(surface, t, k)[d]);
        box[t].high[d] = fmax(box[t].high[d], corner_of(surface, t, k)[d]);
      }
  }
  qsort(box, n, sizeof *box, by_low_x);
  for (size_t i = 0; i < n && count < MOST_REPORTED; i++)
    for (size_t k = i + 1; k < n && box[k].low[0] <= box[i].high[0] && count < MOST_REPORTED; k++)
      if (boxes_meet(&box[i], &box[k]) && go_through(checker, box[i].triangle, box[k].triangle)) {
        report_pair(checker, &box[i], &box[k]);
        count++;
      }
  free(box);
  return CAST_OK;
}

double stl_volume(const StlSurface *surface)
{
  double volume = 0.0;
  for (size_t t = 0; t < surface->n_triangles; t++)
    volume += volume_of(surface->x, corner_of(surface, t, 0), corner_of(surface, t, 1), corner_of(surface, t, 2)) / 6.0;
  return volume;
}

CastStatus stl_check(const StlSurface *surface, const char *path, double unit, CastError *err)
{
  Checker checker = {.surface = surface, .to_mm = 1e3 * unit, .faults = {err, 0}};
  char heading[512];
  snprintf(heading, sizeof heading, "'%.400s'", path);
  for (size_t i = 0; i < surface->n_points; i++)
    checker.size = fmax(checker.size, vec_distance(surface->x, surface->x + 3 * i));
  check_triangles(&checker);
  CAST_CALL(faults_finish(&checker.faults, heading));
  CAST_CALL(check_edges(&checker, err));
  CAST_CALL(faults_finish(&checker.faults, heading));
  if (stl_volume(surface) <= 0.0)
    faults_add(&checker.faults,
               "all normals point inwards: the body's volume comes out as %.4g mm3; turn the triangles",
               stl_volume(surface) * pow(checker.to_mm, 3));
  CAST_CALL(check_crossings(&checker, err));
  return faults_finish(&checker.faults, heading);
}
