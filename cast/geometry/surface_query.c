/* surface_query.c - nearest point of the surface and the side of it.
 * Method: cells of the search grid are visited ring by ring round the point until the next ring must be farther than
 * what was found. Ties go to the triangle with the lowest number, so the answer depends on nothing but the point.
 * Reference for the closest point of a triangle: C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5. */
#include "cast/geometry/surface_internal.h"

typedef struct Nearest {
  double distance2, distance; // m2, m
  int32_t triangle;
} Nearest;

static double between(const double from[3], const double to[3], double share, const double x[3], double foot[3])
{
  for (int k = 0; k < 3; k++) foot[k] = from[k] + share * (to[k] - from[k]);
  return vec_distance2(x, foot);
}

static double at_corner(const Facet *facet, int k, const double x[3], double foot[3], FacetFeature *feature)
{
  vec_copy(facet->corner[k], foot);
  *feature = (FacetFeature)(FEATURE_CORNER_0 + k);
  return vec_distance2(x, foot);
}

double facet_closest(const Facet *facet, const double x[3], double foot[3], FacetFeature *feature)
{
  const double *a = facet->corner[0], *b = facet->corner[1], *c = facet->corner[2];
  double ab[3], ac[3], ax[3], bx[3], cx[3];
  vec_sub(b, a, ab);
  vec_sub(c, a, ac);
  vec_sub(x, a, ax);
  const double d1 = vec_dot(ab, ax), d2 = vec_dot(ac, ax);
  if (d1 <= 0.0 && d2 <= 0.0) return at_corner(facet, 0, x, foot, feature);
  vec_sub(x, b, bx);
  const double d3 = vec_dot(ab, bx), d4 = vec_dot(ac, bx);
  if (d3 >= 0.0 && d4 <= d3) return at_corner(facet, 1, x, foot, feature);
  vec_sub(x, c, cx);
  const double d5 = vec_dot(ab, cx), d6 = vec_dot(ac, cx);
  if (d6 >= 0.0 && d5 <= d6) return at_corner(facet, 2, x, foot, feature);
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    *feature = FEATURE_EDGE_0;
    return between(a, b, d1 / (d1 - d3), x, foot);
  }
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    *feature = FEATURE_EDGE_2;
    return between(a, c, d2 / (d2 - d6), x, foot);
  }
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    *feature = FEATURE_EDGE_1;
    return between(b, c, (d4 - d3) / ((d4 - d3) + (d5 - d6)), x, foot);
  }
  *feature = FEATURE_FACE;
  // the height over the plane is better conditioned than barycentric weights
  const double height = vec_dot(ax, facet->normal);
  vec_axpy(-height, facet->normal, x, foot);
  return height * height;
}

static void try_facet(const Surface *s, const double x[3], int32_t t, Nearest *best)
{
  if (t == best->triangle) return; // it stands in several cells
  const Facet *facet = &s->facet[t];
  double to[3], foot[3];
  vec_sub(x, facet->centre, to);
  const double height = vec_dot(to, facet->normal), far = (best->distance + facet->radius) * (1.0 + 1.0e-9);
  if (height * height > best->distance2 * (1.0 + 1.0e-9) || vec_dot(to, to) > far * far) return;
  FacetFeature feature;
  const double distance2 = facet_closest(facet, x, foot, &feature);
  if (distance2 < best->distance2 || (distance2 == best->distance2 && t < best->triangle))
    *best = (Nearest){distance2, sqrt(distance2), t};
}

static double cell_distance2(const SearchGrid *grid, const double x[3], const int32_t at[3])
{
  double sum = 0.0;
  for (int k = 0; k < 3; k++) {
    const double low = grid->low[k] + at[k] * grid->cell - x[k],
                 high = x[k] - (grid->low[k] + (at[k] + 1) * grid->cell);
    const double gap = (low > high ? low : high) - 1.0e-6 * grid->cell;
    sum += gap > 0.0 ? gap * gap : 0.0;
  }
  return sum;
}

static void search_cell(const Surface *s, const double x[3], const int32_t at[3], const NearestQuery *query,
                        Nearest *best)
{
  const SearchGrid *grid = &s->grid;
  const ptrdiff_t cell = grid_index(grid, at);
  if (grid->start[cell] == grid->start[cell + 1]) return;
  if (cell_distance2(grid, x, at) > best->distance2 * (1.0 + 1.0e-9)) return;
  for (int32_t k = grid->start[cell]; k < grid->start[cell + 1]; k++)
    if (!query->cavity_only || !s->outer[grid->item[k]]) try_facet(s, x, grid->item[k], best);
}

/* The cells at `ring` king's moves from `home`, as far as they are in the grid and not farther along an axis than what
 * was found. */
static void search_ring(const Surface *s, const double x[3], const int32_t home[3], int32_t ring,
                        const NearestQuery *query, Nearest *best)
{
  const SearchGrid *grid = &s->grid;
  const double far = best->distance * (1.0 + 1.0e-9) + 1.0e-6 * grid->cell;
  int32_t first[3], last[3], at[3];
  for (int k = 0; k < 3; k++) {
    const int32_t low = grid_floor((x[k] - far - grid->low[k]) * grid->per_cell),
                  high = grid_floor((x[k] + far - grid->low[k]) * grid->per_cell);
    first[k] = home[k] - ring > 0 ? home[k] - ring : 0;
    last[k] = home[k] + ring < grid->n[k] - 1 ? home[k] + ring : grid->n[k] - 1;
    first[k] = low > first[k] ? low : first[k];
    last[k] = high < last[k] ? high : last[k];
  }
  for (at[2] = first[2]; at[2] <= last[2]; at[2]++)
    for (at[1] = first[1]; at[1] <= last[1]; at[1]++) {
      const bool whole_row =
          at[2] == home[2] - ring || at[2] == home[2] + ring || at[1] == home[1] - ring || at[1] == home[1] + ring;
      const int32_t stride = whole_row || ring == 0 ? 1 : 2 * ring;
      for (at[0] = whole_row ? first[0] : home[0] - ring; at[0] <= last[0]; at[0] += stride)
        if (at[0] >= first[0]) search_cell(s, x, at, query, best);
    }
}

static void search(const Surface *s, const double x[3], const NearestQuery *query, Nearest *best)
{
  const SearchGrid *grid = &s->grid;
  int32_t home[3], ring = 0, most = 0;
  grid_locate(grid, x, home);
  double margin = INFINITY; // from x to the nearest wall of its cell
  for (int k = 0; k < 3; k++) {
    const double offset = x[k] - (grid->low[k] + home[k] * grid->cell);
    margin = fmin(margin, fmin(offset, grid->cell - offset));
    if (home[k] < 0 && -home[k] > ring) ring = -home[k];
    if (home[k] >= grid->n[k] && home[k] - grid->n[k] + 1 > ring) ring = home[k] - grid->n[k] + 1;
    most = home[k] > most ? home[k] : most;
    most = grid->n[k] - 1 - home[k] > most ? grid->n[k] - 1 - home[k] : most;
  }
  if (grid_holds(grid, home)) ring = grid->steps[grid_index(grid, home)];
  for (; ring <= most; ring++) {
    const double least = (ring - 1) * grid->cell + margin - 1.0e-6 * grid->cell;
    if (least > 0.0 && least * least > best->distance2 * (1.0 + 1.0e-9)) break;
    search_ring(s, x, home, ring, query, best);
  }
}

static void try_candidates(const Surface *s, const double x[3], const NearestQuery *query, Nearest *best)
{
  for (int k = 0; k < query->n_candidates; k++)
    if (!query->cavity_only || !s->outer[query->candidate[k]]) try_facet(s, x, query->candidate[k], best);
}

static bool is_listed(const int32_t *list, int n, int32_t t)
{
  for (int k = 0; k < n; k++)
    if (list[k] == t) return true;
  return false;
}

/* A triangle nearest to x, |x - c| <= r, is at most d(x) + r <= d(c) + 2 r from c. */
int surface_candidates(const Surface *s, const double centre[3], double radius, double distance, int32_t *candidate,
                       int most)
{
  const SearchGrid *grid = &s->grid;
  const double far = (distance + 2.0 * radius) * (1.0 + 1.0e-9) + s->tiny;
  double low[3], high[3];
  int32_t first[3], last[3], at[3];
  for (int k = 0; k < 3; k++) {
    low[k] = centre[k] - far;
    high[k] = centre[k] + far;
  }
  int n = 0;
  if (!grid_range(grid, low, high, first, last)) return 0;
  for (at[2] = first[2]; at[2] <= last[2]; at[2]++)
    for (at[1] = first[1]; at[1] <= last[1]; at[1]++)
      for (at[0] = first[0]; at[0] <= last[0]; at[0]++) {
        const ptrdiff_t cell = grid_index(grid, at);
        for (int32_t k = grid->start[cell]; k < grid->start[cell + 1]; k++) {
          const int32_t t = grid->item[k];
          if (is_listed(candidate, n, t)) continue; // it stands in several cells
          Nearest near = {far * far, far, INT32_MAX};
          try_facet(s, centre, t, &near);
          if (near.triangle == INT32_MAX) continue;
          if (n == most) return -1;
          candidate[n++] = t;
        }
      }
  return n;
}

static const double *feature_normal(const Surface *s, int32_t t, FacetFeature feature)
{
  if (feature <= FEATURE_CORNER_2) return s->vertex_normal[s->triangle[t][(int)feature - (int)FEATURE_CORNER_0]];
  if (feature <= FEATURE_EDGE_2) return s->edge_normal[3 * t + (int32_t)(feature - FEATURE_EDGE_0)];
  return s->facet[t].normal;
}

static void fill_hit(const Surface *s, const double x[3], int32_t t, SurfaceHit *hit)
{
  FacetFeature feature;
  const double distance2 = facet_closest(&s->facet[t], x, hit->foot, &feature);
  const double *normal = feature_normal(s, t, feature);
  double to[3];
  vec_sub(x, hit->foot, to);
  hit->triangle = t;
  hit->patch = s->patch[t];
  hit->distance = vec_dot(to, normal) < 0.0 ? -sqrt(distance2) : sqrt(distance2);
  vec_copy(normal, hit->normal);
}

bool surface_nearest_query(const Surface *surface, const double x[3], const NearestQuery *query, SurfaceHit *hit)
{
  Nearest best = {query->reach * query->reach, query->reach, INT32_MAX};
  if (query->guess >= 0 && (!query->cavity_only || !surface->outer[query->guess]))
    try_facet(surface, x, query->guess, &best);
  if (query->candidate)
    try_candidates(surface, x, query, &best);
  else
    search(surface, x, query, &best);
  if (best.triangle == INT32_MAX) return false;
  fill_hit(surface, x, best.triangle, hit);
  return true;
}

bool surface_nearest(const Surface *surface, const double x[3], double reach, SurfaceHit *hit)
{
  const NearestQuery query = {.reach = reach, .guess = -1};
  return surface_nearest_query(surface, x, &query, hit);
}

double surface_triangle_distance(const Surface *surface, int32_t triangle, const double x[3], double foot[3])
{
  FacetFeature feature;
  return sqrt(facet_closest(&surface->facet[triangle], x, foot, &feature));
}

bool surface_inside_mould(const Surface *surface, const double x[3])
{
  const SearchGrid *grid = &surface->grid;
  int32_t at[3];
  grid_locate(grid, x, at);
  if (!grid_holds(grid, at)) return false;
  const uint8_t flags = grid->flags[grid_index(grid, at)];
  if (flags & CELL_INSIDE) return true;
  if (flags & CELL_OPEN) return false;
  SurfaceHit hit;
  const NearestQuery query = {.reach = INFINITY, .guess = -1};
  return surface_nearest_query(surface, x, &query, &hit) && hit.distance < 0.0;
}

static bool shares_points(const Surface *s, int32_t t, int32_t p, int32_t q)
{
  bool has_p = false, has_q = q < 0;
  for (int k = 0; k < 3; k++) {
    has_p = has_p || s->triangle[t][k] == p;
    has_q = has_q || s->triangle[t][k] == q;
  }
  return has_p && has_q;
}

/* Is the closest point of facet t, on `feature`, also the closest of every triangle that shares the feature? Then x
 * lies in the cone of the normals there, which a look at the angles denies to most. */
static bool is_local_foot(const Surface *s, int32_t t, const double x[3], const double foot[3], double distance2,
                          FacetFeature feature)
{
  if (feature == FEATURE_FACE) return true;
  const bool at_point = feature <= FEATURE_CORNER_2;
  const int k = (int)feature - (int)(at_point ? FEATURE_CORNER_0 : FEATURE_EDGE_0);
  const int32_t p = s->triangle[t][k], q = at_point ? -1 : s->triangle[t][(k + 1) % 3];
  const double *normal = feature_normal(s, t, feature);
  double to[3], least = 1.0;
  vec_sub(foot, x, to);
  for (int32_t f = s->fan_start[p]; f < s->fan_start[p + 1]; f++)
    if (shares_points(s, s->fan[f], p, q)) least = fmin(least, vec_dot(s->facet[s->fan[f]].normal, normal));
  if (vec_dot(to, normal) < (least - 1.0e-6) * sqrt(distance2)) return false;
  for (int32_t f = s->fan_start[p]; f < s->fan_start[p + 1]; f++) {
    if (!shares_points(s, s->fan[f], p, q)) continue;
    double other_foot[3];
    FacetFeature other;
    if (facet_closest(&s->facet[s->fan[f]], x, other_foot, &other) < distance2 - s->tiny * sqrt(distance2))
      return false;
  }
  return true;
}

/* Might x have a foot on the facet from behind, within reach? */
static bool may_be_behind(const Facet *facet, const double x[3], double reach)
{
  double to[3];
  vec_sub(x, facet->centre, to);
  const double height = vec_dot(to, facet->normal), far = reach + facet->radius;
  return height < 0.0 && height >= -reach && vec_dot(to, to) <= far * far;
}

/* Keep the nearest, sorted; equal distances in the order of the triangles. A foot on an edge is found once a triangle.
 */
static int insert_foot(SurfaceHit *feet, int count, int most, const SurfaceHit *hit, double tiny)
{
  for (int k = 0; k < count; k++)
    if (vec_distance2(feet[k].foot, hit->foot) <= tiny * tiny) {
      if (hit->triangle < feet[k].triangle) feet[k] = *hit;
      return count;
    }
  int at = count;
  while (at > 0 && (hit->distance > feet[at - 1].distance ||
                    (hit->distance == feet[at - 1].distance && hit->triangle < feet[at - 1].triangle)))
    at--;
  if (at >= most) return count;
  const int last = count < most ? count : most - 1;
  for (int k = last; k > at; k--) feet[k] = feet[k - 1];
  feet[at] = *hit;
  return last + 1;
}

int surface_thin_feet(const Surface *surface, const double x[3], double reach, SurfaceHit *feet, int most)
{
  const SearchGrid *grid = &surface->grid;
  double low[3], high[3];
  for (int k = 0; k < 3; k++) {
    low[k] = x[k] - reach;
    high[k] = x[k] + reach;
  }
  int32_t first[3], last[3], at[3];
  int count = 0;
  if (!surface->any_thin || !grid_range(grid, low, high, first, last)) return 0;
  for (at[2] = first[2]; at[2] <= last[2]; at[2]++)
    for (at[1] = first[1]; at[1] <= last[1]; at[1]++)
      for (at[0] = first[0]; at[0] <= last[0]; at[0]++) {
        const ptrdiff_t cell = grid_index(grid, at);
        if (!(grid->flags[cell] & CELL_HOLDS_THIN)) continue;
        for (int32_t k = grid->start[cell]; k < grid->start[cell + 1]; k++) {
          const int32_t t = grid->item[k];
          if (!surface->thin[t] || !may_be_behind(&surface->facet[t], x, reach)) continue;
          double foot[3];
          FacetFeature feature;
          const double distance2 = facet_closest(&surface->facet[t], x, foot, &feature);
          if (distance2 > reach * reach || !is_local_foot(surface, t, x, foot, distance2, feature)) continue;
          SurfaceHit hit;
          fill_hit(surface, x, t, &hit);
          if (hit.distance < 0.0) count = insert_foot(feet, count, most, &hit, 1.0e3 * surface->tiny);
        }
      }
  return count;
}
