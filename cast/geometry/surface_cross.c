/* surface_cross.c - where straight lines pass through the surface, and what the mould hides from what.
 * Method: the line is sheared onto the z axis and a triangle is crossed if the origin lies in its projection, that is
 * if three edge functions have one sign (S. Woop, C. Benthin, I. Wald, JCGT 2 (2013) 65). Their signs are exact for the
 * projected points, and zeros are decided by moving the line by (e, e^2), e -> 0 (H. Edelsbrunner, E. P. Muecke, ACM
 * Trans. Graph. 9 (1990) 66). Triangles that share an edge or a point decide alike, so nothing passes between them and
 * nothing is counted twice.
 *
 * What hides. A way from a to b that enters the mould and leaves it again is blocked, but for one case: at a convex
 * edge of a thick mould (the lip of a feeder, the mouth of a pin) the way only clips the edge, and melt on both sides
 * is one body of melt that meets round the edge. There the sheets do not face away from each other and the point just
 * above the edge is void; between two pins it is mould. */
#include "cast/geometry/surface_internal.h"

enum { MAX_CROSSINGS = 64 };
static const double FACING_AWAY = -0.5; // cosine of the normals: an edge sharper than 60 degrees is a fin, not an edge
static const double FACING_ALIKE = 0.5;
static const double OVERHANG = 0.1; // of the reach: ends that dip into the mould by less are seen as outside

void line_create(const double a[3], const double b[3], SheetLine *line)
{
  vec_copy(a, line->origin);
  vec_sub(b, a, line->direction);
  int z = 0;
  for (int k = 1; k < 3; k++)
    if (fabs(line->direction[k]) > fabs(line->direction[z])) z = k;
  int x = (z + 1) % 3, y = (z + 2) % 3;
  if (line->direction[z] < 0.0) { // keeps the winding as seen along the line
    const int swap = x;
    x = y;
    y = swap;
  }
  line->axis[0] = x;
  line->axis[1] = y;
  line->axis[2] = z;
  line->shear[0] = line->direction[x] / line->direction[z];
  line->shear[1] = line->direction[y] / line->direction[z];
  line->shear[2] = 1.0 / line->direction[z];
}

/* Sign of px qy - py qx; exact also where the difference cancels (Kahan; Jeannerod, Louvet, Muller, Math. Comp. 82
 * (2013) 2245). */
static int edge_sign(const double p[2], const double q[2])
{
  const double left = p[0] * q[1], right = p[1] * q[0], plain = left - right;
  if (fabs(plain) > 1.0e-15 * (fabs(left) + fabs(right))) return plain > 0.0 ? 1 : -1;
  const double product = p[1] * q[0];
  const double exact = fma(p[0], q[1], -product) + fma(-p[1], q[0], product);
  if (exact != 0.0) return exact > 0.0 ? 1 : -1;
  if (p[1] != q[1]) return p[1] > q[1] ? 1 : -1;
  return p[0] < q[0] ? 1 : -1;
}

bool line_crosses(const SheetLine *line, const Facet *facet, double *t, bool *leaving)
{
  double flat[3][2], height[3];
  for (int k = 0; k < 3; k++) {
    double to[3];
    vec_sub(facet->corner[k], line->origin, to);
    const double z = to[line->axis[2]];
    flat[k][0] = to[line->axis[0]] - line->shear[0] * z;
    flat[k][1] = to[line->axis[1]] - line->shear[1] * z;
    height[k] = z * line->shear[2];
  }
  const int sign = edge_sign(flat[1], flat[2]);
  if (edge_sign(flat[2], flat[0]) != sign || edge_sign(flat[0], flat[1]) != sign) return false;
  double weight[3], sum = 0.0;
  for (int k = 0; k < 3; k++) {
    const double *p = flat[(k + 1) % 3], *q = flat[(k + 2) % 3];
    weight[k] = fabs(p[0] * q[1] - p[1] * q[0]);
    sum += weight[k];
  }
  *t = sum > 0.0 ? (weight[0] * height[0] + weight[1] * height[1] + weight[2] * height[2]) / sum
                 : (height[0] + height[1] + height[2]) / 3.0;
  *leaving = sign > 0;
  return true;
}

/* The wedge of the tangent planes at p and q, seen from the middle of the way between them. */
typedef struct Wedge {
  double middle[3], length;  // m
  double behind_p, behind_q; // m, how far the middle lies behind the planes
  double facing;             // n . m
} Wedge;

/* The point of the wedge's edge that is nearest to the middle, a little above both planes. */
static void point_over_edge(const Wedge *wedge, const double n[3], const double m[3], double out[3])
{
  const double share = 1.0 / (1.0 - wedge->facing * wedge->facing);
  const double lift = 0.05 * wedge->length / sqrt(2.0 + 2.0 * wedge->facing);
  const double along_n = share * (wedge->behind_p - wedge->facing * wedge->behind_q) + lift;
  const double along_m = share * (wedge->behind_q - wedge->facing * wedge->behind_p) + lift;
  for (int k = 0; k < 3; k++) out[k] = wedge->middle[k] + along_n * n[k] + along_m * m[k];
}

/* The point a little outside the wedge, square to the way from its middle; false if that is far off. */
static bool point_over_way(const Wedge *wedge, const double along[3], const double n[3], const double m[3],
                           double out[3])
{
  double up[3], rise = INFINITY;
  for (int k = 0; k < 3; k++) up[k] = n[k] + m[k];
  vec_axpy(-vec_dot(up, along), along, up, up);
  if (vec_normalise(up) < 0.1) return false;
  if (vec_dot(up, n) > 1.0e-3) rise = fmin(rise, wedge->behind_p / vec_dot(up, n));
  if (vec_dot(up, m) > 1.0e-3) rise = fmin(rise, wedge->behind_q / vec_dot(up, m));
  vec_axpy(rise + 0.05 * wedge->length, up, wedge->middle, out);
  return rise < 2.0 * wedge->length;
}

bool surface_clips(const Surface *surface, const double p[3], const double n[3], const double q[3], const double m[3])
{
  Wedge wedge = {.facing = vec_dot(n, m)};
  if (wedge.facing < FACING_AWAY) return false;
  if (wedge.facing >= FACING_ALIKE) return true;
  double along[3], to_p[3], to_q[3], above[3];
  vec_sub(q, p, along);
  wedge.length = vec_normalise(along);
  if (wedge.length <= surface->tiny) return true;
  for (int k = 0; k < 3; k++) wedge.middle[k] = 0.5 * (p[k] + q[k]);
  vec_sub(p, wedge.middle, to_p);
  vec_sub(q, wedge.middle, to_q);
  wedge.behind_p = vec_dot(to_p, n);
  wedge.behind_q = vec_dot(to_q, m);
  point_over_edge(&wedge, n, m, above); // where the edge is curved in plan the second point may miss it
  if (!surface_inside_mould(surface, above)) return true;
  return point_over_way(&wedge, along, n, m, above) && !surface_inside_mould(surface, above);
}

/* Steps through the grid along origin + t direction, t in [t, t_end] (J. Amanatides, A. Woo, Eurographics 1987). */
typedef struct GridWalk {
  int32_t at[3], step[3];
  double next[3], delta[3], t, t_end;
} GridWalk;

/* Cut the line to the grid and find its first cell; false if it misses the grid. */
static bool walk_start(const SearchGrid *grid, const SheetLine *line, double t_start, double t_end, GridWalk *walk)
{
  for (int k = 0; k < 3; k++) {
    const double low = grid->low[k] - line->origin[k], high = low + grid->n[k] * grid->cell;
    if (line->direction[k] == 0.0) {
      if (low > 0.0 || high < 0.0) return false;
      continue;
    }
    const double in = (line->direction[k] > 0.0 ? low : high) / line->direction[k];
    const double out = (line->direction[k] > 0.0 ? high : low) / line->direction[k];
    t_start = fmax(t_start, in);
    t_end = fmin(t_end, out);
  }
  if (!(t_start <= t_end)) return false;
  double x[3];
  vec_axpy(t_start, line->direction, line->origin, x);
  grid_locate(grid, x, walk->at);
  for (int k = 0; k < 3; k++) {
    walk->at[k] = walk->at[k] < 0 ? 0 : (walk->at[k] < grid->n[k] ? walk->at[k] : grid->n[k] - 1);
    const double d = line->direction[k];
    walk->step[k] = d > 0.0 ? 1 : -1;
    const double wall = grid->low[k] + (walk->at[k] + (d > 0.0 ? 1 : 0)) * grid->cell;
    walk->next[k] = d == 0.0 ? (double)INFINITY : (wall - line->origin[k]) / d;
    walk->delta[k] = d == 0.0 ? (double)INFINITY : grid->cell / fabs(d);
  }
  walk->t = t_start;
  walk->t_end = t_end;
  return true;
}

static bool walk_on(const SearchGrid *grid, GridWalk *walk)
{
  int k = walk->next[1] < walk->next[0] ? 1 : 0;
  if (walk->next[2] < walk->next[k]) k = 2;
  if (walk->next[k] > walk->t_end) return false;
  walk->t = walk->next[k];
  walk->next[k] += walk->delta[k];
  walk->at[k] += walk->step[k];
  return walk->at[k] >= 0 && walk->at[k] < grid->n[k];
}

static void add_crossing(Crossing *found, int *count, const Crossing *crossing)
{
  for (int k = 0; k < *count; k++)
    if (found[k].triangle == crossing->triangle) return;
  if (*count == MAX_CROSSINGS) return;
  int at = (*count)++;
  for (; at > 0 && (found[at - 1].t > crossing->t ||
                    (found[at - 1].t == crossing->t && found[at - 1].triangle > crossing->triangle));
       at--)
    found[at] = found[at - 1];
  found[at] = *crossing;
}

/* A line with its ends, to tell cheaply that a triangle's plane does not come between them. */
typedef struct Span {
  double from[3], to[3]; // m, the ends, overhang included
  double margin;         // m, for rounding
} Span;

static bool on_one_side(const Span *span, const Facet *facet)
{
  double u[3], v[3];
  vec_sub(span->from, facet->corner[0], u);
  vec_sub(span->to, facet->corner[0], v);
  const double at_from = vec_dot(u, facet->normal), at_to = vec_dot(v, facet->normal);
  return (at_from > span->margin && at_to > span->margin) || (at_from < -span->margin && at_to < -span->margin);
}

/* All crossings from -overhang to 1 + overhang, by t; none is reported if the line meets no cell with a thin wall. */
static int find_crossings(const Surface *s, const SheetLine *line, double overhang, Crossing found[MAX_CROSSINGS])
{
  const SearchGrid *grid = &s->grid;
  Span span = {.margin = 1.0e3 * s->tiny};
  vec_axpy(-overhang, line->direction, line->origin, span.from);
  vec_axpy(1.0 + overhang, line->direction, line->origin, span.to);
  GridWalk walk;
  int count = 0;
  bool thin = false;
  if (!walk_start(grid, line, -overhang, 1.0 + overhang, &walk)) return 0;
  do {
    const ptrdiff_t cell = grid_index(grid, walk.at);
    thin = thin || (grid->flags[cell] & CELL_HOLDS_THIN);
    for (int32_t k = grid->start[cell]; k < grid->start[cell + 1]; k++) {
      Crossing crossing = {.triangle = grid->item[k]};
      const Facet *facet = &s->facet[crossing.triangle];
      if (!on_one_side(&span, facet) && line_crosses(line, facet, &crossing.t, &crossing.leaving) &&
          crossing.t >= -overhang && crossing.t <= 1.0 + overhang)
        add_crossing(found, &count, &crossing);
    }
  } while (walk_on(grid, &walk));
  return thin ? count : 0;
}

/* One stretch of the line inside the mould, from p to q; the normals stand there. */
typedef struct Stretch {
  double p[3], q[3];
  const double *n, *m;
} Stretch;

static bool stretch_hides(const Surface *s, const Stretch *stretch)
{
  return !surface_clips(s, stretch->p, stretch->n, stretch->q, stretch->m);
}

/* Where the line's end x lies in the mould, the surface nearest to it stands for the missing crossing. */
static bool end_under(const Surface *s, const double x[3], const SurfaceHit *known, SurfaceHit *hit)
{
  if (known) {
    *hit = *known;
    return true;
  }
  return surface_nearest(s, x, INFINITY, hit);
}

static bool line_is_hidden(const Surface *s, const SheetLine *line, const Crossing *found, int count,
                           const SurfaceHit *end)
{
  double a[3], b[3];
  vec_copy(line->origin, a);
  vec_axpy(1.0, line->direction, a, b);
  const Crossing *entry = NULL;
  bool first = true;
  for (int k = 0; k < count; first = false, k++) {
    if (!found[k].leaving) {
      if (!entry) entry = &found[k];
      continue;
    }
    SurfaceHit under;
    Stretch stretch = {.m = s->facet[found[k].triangle].normal};
    vec_axpy(found[k].t, line->direction, a, stretch.q);
    if (entry && entry->t < 1.0 && found[k].t > 0.0) {
      stretch.n = s->facet[entry->triangle].normal;
      vec_axpy(entry->t, line->direction, a, stretch.p);
      if (stretch_hides(s, &stretch)) return true;
    } else if (!entry && first && found[k].t > 0.0 && found[k].t < 1.0 && end_under(s, a, NULL, &under)) {
      stretch.n = under.normal;
      vec_copy(under.foot, stretch.p);
      if (stretch_hides(s, &stretch)) return true;
    }
    entry = NULL;
  }
  if (!entry || !(entry->t > 0.0 && entry->t < 1.0)) return false;
  SurfaceHit under;
  if (!end_under(s, b, end, &under)) return false;
  Stretch stretch = {.n = s->facet[entry->triangle].normal, .m = under.normal};
  vec_axpy(entry->t, line->direction, a, stretch.p);
  vec_copy(under.foot, stretch.q);
  return stretch_hides(s, &stretch);
}

double surface_overhang(const Surface *surface)
{
  return OVERHANG * surface->reach;
}

double surface_facing_alike(void)
{
  return FACING_ALIKE;
}

bool surface_thin_near(const Surface *surface, const double x[3])
{
  int32_t at[3];
  grid_locate(&surface->grid, x, at);
  return grid_holds(&surface->grid, at) && (surface->grid.flags[grid_index(&surface->grid, at)] & CELL_NEAR_THIN);
}

bool surface_hides(const Surface *surface, const double a[3], const double b[3], const SurfaceHit *end)
{
  const SearchGrid *grid = &surface->grid;
  int32_t at[3];
  grid_locate(grid, a, at);
  if (!surface->any_thin || !grid_holds(grid, at)) return false;
  const ptrdiff_t cell = grid_index(grid, at);
  if (!(grid->flags[cell] & CELL_NEAR_THIN)) return false;
  const double length = sqrt(vec_distance2(a, b));
  if (!(length > 0.0) || (grid->steps[cell] - 1) * grid->cell > length) return false;
  SheetLine line;
  Crossing found[MAX_CROSSINGS];
  line_create(a, b, &line);
  const int count = find_crossings(surface, &line, surface_overhang(surface) / length, found);
  return count > 0 && line_is_hidden(surface, &line, found, count, end);
}

bool surface_separates(const Surface *surface, const double a[3], const double b[3])
{
  return surface_hides(surface, a, b, NULL);
}

bool surface_first_crossing(const Surface *surface, const double a[3], const double d[3], double length,
                            double *distance, int32_t *triangle)
{
  double b[3];
  vec_axpy(length, d, a, b);
  SheetLine line;
  line_create(a, b, &line);
  GridWalk walk;
  if (!walk_start(&surface->grid, &line, 0.0, 1.0, &walk)) return false;
  double best = INFINITY;
  do {
    if (walk.t > best) break;
    const ptrdiff_t cell = grid_index(&surface->grid, walk.at);
    for (int32_t k = surface->grid.start[cell]; k < surface->grid.start[cell + 1]; k++) {
      const int32_t t_index = surface->grid.item[k];
      double t;
      bool leaving;
      if (!line_crosses(&line, &surface->facet[t_index], &t, &leaving) || t <= 0.0 || t > 1.0) continue;
      if (t < best || (t == best && t_index < *triangle)) {
        best = t;
        *triangle = t_index;
      }
    }
  } while (walk_on(&surface->grid, &walk));
  *distance = best * length;
  return isfinite(best);
}
