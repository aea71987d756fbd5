/* surface_sight.c - what a place in the void sees for certain, told without a walk through the grid.
 * Method   surface_hides(x, y) is true only if the line from x to y, or on beyond y by the overhang, passes a triangle
 *          outwards that x lies behind (the far side of a mould wall), or, where y is in the mould, if the triangle it
 *          enters by does not face like the one over y (surface_cross.c). So nothing hides y if y lies behind all
 *          planes that x lies behind, and not behind those in front of x; the planes of the triangles around x are
 *          gathered once for all y. In a pin, the walls of the pins beside it are behind all of it. */
#include "cast/geometry/surface_internal.h"
#include "cast/kernel/dispatch.h"

#include <string.h>

static void keep(SightPlanes *planes, const Facet *facet)
{
  const int32_t k = planes->n++;
  for (int d = 0; d < 3; d++) planes->normal[d][k] = facet->normal[d];
  planes->offset[k] = vec_dot(facet->normal, facet->corner[0]);
}

/* Has the triangle been met before? It stands in several cells. */
static bool met_before(Sight *sight, int32_t t)
{
  uint32_t at = (uint32_t)t * 2654435761U >> 21;
  for (; sight->met[at] != -1; at = (at + 1) % SIGHT_MET)
    if (sight->met[at] == t) return true;
  sight->met[at] = t;
  sight->n_met++;
  return false;
}

/* Rounding may put what is nearly on a plane on either side: it counts as both. */
static bool sort_facet(Sight *sight, int32_t t)
{
  const Facet *facet = &sight->surface->facet[t];
  double to[3];
  vec_sub(sight->from, facet->centre, to);
  const double far = sight->range + facet->radius;
  if (vec_dot(to, to) > far * far) return true;
  const double height = vec_dot(to, facet->normal);
  if (height > far || met_before(sight, t)) return true;
  if (2 * sight->n_met > SIGHT_MET) return false;
  if (!(height > sight->margin)) {
    if (sight->behind.n == SIGHT_MOST) return false;
    keep(&sight->behind, facet);
  }
  if (!(height < -sight->margin)) {
    if (sight->front.n == SIGHT_MOST) return false;
    keep(&sight->front, facet);
  }
  return true;
}

void sight_from(const Surface *s, const double x[3], double length, Sight *sight)
{
  const SearchGrid *grid = &s->grid;
  double low[3], high[3];
  int32_t first[3], last[3], at[3];
  sight->surface = s;
  sight->overhang = surface_overhang(s);
  sight->range = (length + sight->overhang) * (1.0 + 1e-9);
  sight->margin = 1.0e3 * s->tiny;
  sight->behind.n = sight->front.n = sight->n_met = 0;
  memset(sight->met, -1, sizeof sight->met);
  sight->usable = true;
  for (int k = 0; k < 3; k++) {
    sight->from[k] = x[k];
    low[k] = x[k] - sight->range;
    high[k] = x[k] + sight->range;
  }
  if (!grid_range(grid, low, high, first, last)) return;
  for (at[2] = first[2]; at[2] <= last[2]; at[2]++)
    for (at[1] = first[1]; at[1] <= last[1]; at[1]++) {
      at[0] = first[0];
      const ptrdiff_t cell = grid_index(grid, at), end = cell + last[0] - first[0] + 1;
      for (int32_t k = grid->start[cell]; k < grid->start[end] && sight->usable; k++)
        sight->usable = sort_facet(sight, grid->item[k]);
    }
}

/* Does y lie behind all the planes, by more than the margin? */
SIMD_CLONES static bool behind_all(const SightPlanes *planes, const double y[3], double margin)
{
  int out = 0;
#pragma omp simd reduction(+ : out)
  for (int32_t k = 0; k < planes->n; k++) {
    const double height =
        planes->normal[0][k] * y[0] + planes->normal[1][k] * y[1] + planes->normal[2][k] * y[2] - planes->offset[k];
    out += !(height < -margin);
  }
  return out == 0;
}

/* Do all planes that y lies behind face within 60 degrees of `alike`? */
SIMD_CLONES static bool entered_alike(const SightPlanes *planes, const double y[3], double margin, const double alike[3],
                                      double least)
{
  int other = 0;
#pragma omp simd reduction(+ : other)
  for (int32_t k = 0; k < planes->n; k++) {
    const double *n0 = planes->normal[0], *n1 = planes->normal[1], *n2 = planes->normal[2];
    const double height = n0[k] * y[0] + n1[k] * y[1] + n2[k] * y[2] - planes->offset[k];
    const double facing = n0[k] * alike[0] + n1[k] * alike[1] + n2[k] * alike[2];
    other += !(height > margin) & !(facing > least);
  }
  return other == 0;
}

static bool leaves_nowhere(const Sight *sight, const double y[3])
{
  if (!sight->usable) return false;
  if (sight->behind.n == 0) return true;
  double way[3], beyond[3];
  vec_sub(y, sight->from, way);
  const double length = sqrt(vec_dot(way, way));
  if (!(length > 0.0)) return false;
  vec_axpy(sight->overhang / length, way, y, beyond);
  return behind_all(&sight->behind, beyond, sight->margin);
}

bool sight_is_free(const Sight *sight, const double y[3])
{
  return leaves_nowhere(sight, y);
}

bool sight_meets_wall(const Sight *sight, const double place[3], const double normal[3])
{
  return leaves_nowhere(sight, place) &&
         entered_alike(&sight->front, place, sight->margin, normal, surface_facing_alike() + 1e-9);
}

bool sight_enters_nothing(const Sight *sight, const double place[3])
{
  const double none[3] = {0.0, 0.0, 0.0};
  return leaves_nowhere(sight, place) && entered_alike(&sight->front, place, sight->margin, none, 0.0);
}
