/* flow.h - from the sums over a particle's pairs to its rates. Internal to physics/. */
#ifndef CAST_PHYSICS_FLOW_H
#define CAST_PHYSICS_FLOW_H

#include "cast/kernel/pair.h"
#include "cast/physics/sweep.h"

/* A torn particle that flies into a wall (at rest) is stopped. */
PAIR_INLINE void stop_torn(const Sweep *s, ptrdiff_t i, const Rates *sum)
{
  Particles *p = s->p;
  const double torn = torn_fraction(p->rho[i], s->sph->rho0), *away = sum->away;
  const double size2 = away[0] * away[0] + away[1] * away[1] + away[2] * away[2];
  if (torn <= 0.0 || size2 <= 0.0) return;
  const double along = p->v[0][i] * away[0] + p->v[1][i] * away[1] + p->v[2][i] * away[2];
  const double push = impact_push(torn, s->sph->c0, -along / sqrt(size2));
  for (int d = 0; d < 3; d++) p->a[d][i] += push * away[d];
}

/* drho and a of particle i; body forces are added, but Coriolis', which step.c takes with the velocity. */
PAIR_INLINE void set_flow(const Sweep *s, ptrdiff_t i, const Rates *sum)
{
  Particles *p = s->p;
  p->drho[i] = s->sph->density == SPH_CONTINUITY ? sum->drho : 0.0;
  const double x[3] = {p->x[0][i], p->x[1][i], p->x[2][i]};
  double body[3] = {s->scale.body[0], s->scale.body[1], s->scale.body[2]};
  if (s->spins) spin_add_acceleration(&s->sph->spin, x, body);
  for (int d = 0; d < 3; d++) p->a[d][i] = sum->a[d] + body[d];
  stop_torn(s, i, sum);
}

#endif
