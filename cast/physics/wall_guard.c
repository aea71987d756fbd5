#include "cast/physics/wall_guard.h"

#include <math.h>

static const double guard_depth = 0.1, film = 0.2; // spacings

/* Unit, away from the wall at hit: the way that the distance grows, at an edge or a corner not the face's normal. */
static void away_from(const double x[3], const SurfaceHit *hit, double tiny, double away[3])
{
  const bool off = fabs(hit->distance) > tiny;
  for (int axis = 0; axis < 3; axis++)
    away[axis] = off ? (x[axis] - hit->foot[axis]) / hit->distance : hit->normal[axis];
}

static void take_speed(Particles *p, ptrdiff_t i, const double away[3], double keep)
{
  double out = 0.0;
  for (int axis = 0; axis < 3; axis++) out += p->v[axis][i] * away[axis];
  if (out >= 0.0) return;
  for (int axis = 0; axis < 3; axis++) p->v[axis][i] -= (1.0 - keep) * out * away[axis];
}

/* Look where particle i stands once it has moved as far as it was known to be clear; returns whether it was set back.
 */
static bool guard_particle(const WallGuard *g, Particles *p, ptrdiff_t i)
{
  const double reach = surface_reach(g->surface), dx = g->sph->spacing, x[3] = {p->x[0][i], p->x[1][i], p->x[2][i]};
  SurfaceHit hit;
  if (!surface_nearest(g->surface, x, reach, &hit)) {
    p->clearance[i] = reach;
    return false;
  }
  p->clearance[i] = hit.distance;
  if (hit.distance >= film * dx) return false;
  if (hit.distance >= -guard_depth * dx) {
    double away[3];
    away_from(x, &hit, 1e-6 * dx, away);
    const double rate = g->sph->c0 / (film * dx) * (1.0 - fmax(hit.distance, 0.0) / (film * dx));
    take_speed(p, i, away, 1.0 / (1.0 + g->dt * rate)); // implicit: never more than all of it
    return false;
  }
  for (int axis = 0; axis < 3; axis++) p->x[axis][i] = hit.foot[axis];
  take_speed(p, i, hit.normal, 0.0);
  p->clearance[i] = 0.0;
  return true;
}

long wall_guard_rows(const WallGuard *g, Particles *p, ptrdiff_t first, ptrdiff_t end)
{
  const double look = film * g->sph->spacing;
  long set_back = 0;
  for (ptrdiff_t i = first; i < end; i++) {
    if (p->clearance[i] > look) continue;
    if (!isfinite(p->x[0][i] + p->x[1][i] + p->x[2][i])) continue; // reported by the caller
    set_back += guard_particle(g, p, i);
  }
  return set_back;
}
