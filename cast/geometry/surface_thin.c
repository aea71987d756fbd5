/* surface_thin.c - where the mould's wall is thinner than the kernel's reach, found once when the surface is made.
 * A triangle is thin if another lies behind it within reach, it behind the other, and a straight way through both would
 * be hidden (surface_clips). Cells within reach of a thin triangle carry CELL_NEAR_THIN: elsewhere nothing hides. */
#include "cast/geometry/surface_internal.h"

#include <stdlib.h>

/* Does some corner of `other` lie behind the plane of `facet`? */
static bool lies_behind(const Facet *facet, const Facet *other, double tiny)
{
  for (int k = 0; k < 3; k++) {
    double to[3];
    vec_sub(other->corner[k], facet->corner[0], to);
    if (vec_dot(to, facet->normal) < -tiny) return true;
  }
  return false;
}

/* Nearest points of two segments a0 a1 and b0 b1; returns their squared distance (Ericson 2005, section 5.1.9). */
static double segments_closest(const double a0[3], const double a1[3], const double b0[3], const double b1[3],
                               double p[3], double q[3])
{
  double d1[3], d2[3], r[3];
  vec_sub(a1, a0, d1);
  vec_sub(b1, b0, d2);
  vec_sub(a0, b0, r);
  const double a = vec_dot(d1, d1), e = vec_dot(d2, d2), f = vec_dot(d2, r), b = vec_dot(d1, d2), c = vec_dot(d1, r);
  const double denominator = a * e - b * b;
  double s = denominator > 1.0e-14 * a * e ? fmin(fmax((b * f - c * e) / denominator, 0.0), 1.0) : 0.0;
  double t = (b * s + f) / e;
  if (t < 0.0) {
    t = 0.0;
    s = fmin(fmax(-c / a, 0.0), 1.0);
  } else if (t > 1.0) {
    t = 1.0;
    s = fmin(fmax((b - c) / a, 0.0), 1.0);
  }
  vec_axpy(s, d1, a0, p);
  vec_axpy(t, d2, b0, q);
  return vec_distance2(p, q);
}

/* Nearest points of two triangles that do not cut each other: at a corner of one, or on two edges. */
static double facets_closest(const Facet *one, const Facet *two, double p[3], double q[3])
{
  double best = INFINITY, foot[3], other[3];
  FacetFeature feature;
  for (int k = 0; k < 3; k++) {
    double d2 = facet_closest(two, one->corner[k], foot, &feature);
    if (d2 < best) {
      best = d2;
      vec_copy(one->corner[k], p);
      vec_copy(foot, q);
    }
    d2 = facet_closest(one, two->corner[k], foot, &feature);
    if (d2 < best) {
      best = d2;
      vec_copy(foot, p);
      vec_copy(two->corner[k], q);
    }
  }
  for (int k = 0; k < 9; k++) {
    const double d2 = segments_closest(one->corner[k / 3], one->corner[(k / 3 + 1) % 3], two->corner[k % 3],
                                       two->corner[(k % 3 + 1) % 3], foot, other);
    if (d2 < best) {
      best = d2;
      vec_copy(foot, p);
      vec_copy(other, q);
    }
  }
  return best;
}

/* Is triangle `other` a reason to call t thin? */
static bool makes_thin(const Surface *s, int32_t t, int32_t other)
{
  const Facet *one = &s->facet[t], *two = &s->facet[other];
  const double facing = vec_dot(one->normal, two->normal);
  if (facing >= 0.5 || other == t || (s->outer[t] && s->outer[other])) return false;
  if (!lies_behind(one, two, 1.0e3 * s->tiny) || !lies_behind(two, one, 1.0e3 * s->tiny)) return false;
  const double apart = sqrt(vec_distance2(one->centre, two->centre));
  if (apart - one->radius - two->radius >= s->reach) return false;
  if (facing >= -0.5 && apart < s->reach && !surface_clips(s, one->centre, one->normal, two->centre, two->normal))
    return true;
  if (facing >= -0.5 && one->radius + two->radius < s->reach) return false; // the centres speak for small triangles
  double p[3], q[3];
  const double distance2 = facets_closest(one, two, p, q);
  if (distance2 >= s->reach * s->reach) return false;
  if (facing < -0.5) return true;
  return distance2 > 1.0e6 * s->tiny * s->tiny && !surface_clips(s, p, one->normal, q, two->normal);
}

/* seen: the last t for which a triangle was looked at, as it stands in several cells. */
static bool is_thin(const Surface *s, int32_t t, int32_t *seen)
{
  const SearchGrid *grid = &s->grid;
  double low[3], high[3];
  for (int k = 0; k < 3; k++) {
    const double *a = s->facet[t].corner[0], *b = s->facet[t].corner[1], *c = s->facet[t].corner[2];
    low[k] = fmin(fmin(a[k], b[k]), c[k]) - s->reach;
    high[k] = fmax(fmax(a[k], b[k]), c[k]) + s->reach;
  }
  int32_t first[3], last[3], at[3];
  if (!grid_range(grid, low, high, first, last)) return false;
  for (at[2] = first[2]; at[2] <= last[2]; at[2]++)
    for (at[1] = first[1]; at[1] <= last[1]; at[1]++)
      for (at[0] = first[0]; at[0] <= last[0]; at[0]++) {
        const ptrdiff_t cell = grid_index(grid, at);
        for (int32_t k = grid->start[cell]; k < grid->start[cell + 1]; k++) {
          const int32_t other = grid->item[k];
          if (seen[other] == t) continue;
          seen[other] = t;
          if (makes_thin(s, t, other)) return true;
        }
      }
  return false;
}

/* Spread a mark to all cells up to `range` cells away along one axis: mark[c] = `to` where a `from` lies that near. */
static void spread_along(const SearchGrid *grid, uint8_t *mark, int axis, int32_t range)
{
  const ptrdiff_t stride = axis == 0 ? 1 : axis == 1 ? grid->n[0] : (ptrdiff_t)grid->n[0] * grid->n[1];
  const ptrdiff_t cells = grid_cells(grid);
  const uint8_t from = (uint8_t)(1 << axis), to = (uint8_t)(2 << axis);
  for (ptrdiff_t c = 0; c < cells; c++) {
    if (!(mark[c] & from)) continue;
    const int32_t at = (int32_t)(c / stride % grid->n[axis]);
    for (int32_t k = at - range > 0 ? at - range : 0; k <= at + range && k < grid->n[axis]; k++)
      mark[c + (k - at) * stride] |= to;
  }
}

static CastStatus flag_cells(Surface *s, CastError *err)
{
  SearchGrid *grid = &s->grid;
  const ptrdiff_t cells = grid_cells(grid);
  uint8_t *mark = calloc((size_t)cells, 1);
  CAST_CHECK(mark, err, CAST_ERR_MEMORY, "no memory to mark %td cells of thin mould wall", cells);
  for (ptrdiff_t c = 0; c < cells; c++)
    for (int32_t k = grid->start[c]; k < grid->start[c + 1]; k++)
      if (s->thin[grid->item[k]]) {
        grid->flags[c] |= CELL_HOLDS_THIN;
        mark[c] = 1;
      }
  const int32_t range = (int32_t)ceil(s->reach * grid->per_cell * (1.0 + 1.0e-6));
  for (int axis = 0; axis < 3; axis++) spread_along(grid, mark, axis, range);
  for (ptrdiff_t c = 0; c < cells; c++)
    if (mark[c] & 8) grid->flags[c] |= CELL_NEAR_THIN;
  free(mark);
  return CAST_OK;
}

CastStatus surface_thin_mark(Surface *s, CastError *err)
{
  bool any = false, memory = true;
#pragma omp parallel reduction(|| : any) reduction(&& : memory)
  {
    int32_t *seen = malloc((size_t)s->n_triangles * sizeof *seen);
    memory = seen != NULL;
    for (ptrdiff_t t = 0; seen && t < s->n_triangles; t++) seen[t] = -1;
#pragma omp for schedule(dynamic, 256)
    for (ptrdiff_t t = 0; t < s->n_triangles; t++) {
      s->thin[t] = seen && is_thin(s, (int32_t)t, seen) ? 1 : 0;
      any = any || s->thin[t];
    }
    free(seen);
  }
  CAST_CHECK(memory, err, CAST_ERR_MEMORY, "no memory to look for thin walls among %td triangles", s->n_triangles);
  s->any_thin = any;
  return any ? flag_cells(s, err) : CAST_OK;
}
