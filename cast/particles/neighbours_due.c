/* How long neighbour lists last: skins chosen by the melt's speed, and whether a pair that is not listed may have come
 * within reach. */
#include <float.h>
#include <math.h>

#include "cast/particles/neighbours_private.h"

/* ---- is a rebuild due? ---- */

/* In single precision: whether lists hold is a question of a tenth of a spacing. */
void neighbours_remember_positions(Neighbours *nb, const Particles *p)
{
  const Cells *c = &nb->fluid_cells;
  double far = 0.0;
  for (int d = 0; d < 3; d++) {
    far = fmax(far, fmax(fabs(c->low[d]), fabs(c->low[d] + c->size[d] * c->count[d])));
#pragma omp parallel for simd
    for (ptrdiff_t i = 0; i < p->n_fluid; i++) nb->built_at[d][i] = (float)p->x[d][i];
  }
  nb->rounding = sqrt(3.0) * 0.5 * (double)FLT_EPSILON * far;
}

static double longest_way(const Neighbours *nb, const Particles *p)
{
  double longest2 = 0.0;
#pragma omp parallel for simd reduction(max : longest2)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const double dx = p->x[0][i] - (double)nb->built_at[0][i], dy = p->x[1][i] - (double)nb->built_at[1][i],
                 dz = p->x[2][i] - (double)nb->built_at[2][i], way2 = dx * dx + dy * dy + dz * dz;
    longest2 = way2 > longest2 ? way2 : longest2;
  }
  return sqrt(longest2);
}

/* Lists hold while no pair that they lack can have come within reach, near parts likewise. Walls stand still. */
CastStatus neighbours_find_due(Neighbours *nb, const Particles *p, Due *due, CastError *err)
{
  *due = nb->builds == 0 || nb->n_fluid != p->n_fluid ? LISTS_DUE : NOTHING_DUE;
  if (*due != NOTHING_DUE) return CAST_OK;
  Skins way = {.wall = longest_way(nb, p) + nb->rounding};
  if (way.wall <= nb->near.wall && way.wall <= 0.5 * nb->near.fluid) return CAST_OK;
  *due = LISTS_DUE;
  if (!(nb->used.wall + way.wall <= fmin(nb->listed.wall, 0.5 * nb->reach)))
    return CAST_OK; // beyond: particles of distant blocks might meet
  CAST_CALL(approach_bound(&nb->approach, &nb->fluid_cells, p->x, nb->built_at, &way.fluid, err));
  way.fluid += 2.0 * nb->rounding;
  if (way.wall <= nb->near.wall && way.fluid <= nb->near.fluid) {
    *due = NOTHING_DUE;
    return CAST_OK;
  }
  nb->used.fluid += way.fluid;
  nb->used.wall += way.wall;
  const Skins left = {nb->listed.fluid - nb->used.fluid, fmin(nb->listed.wall, 0.5 * nb->reach) - nb->used.wall};
  // what would hold for a step or two is not worth telling apart
  if (left.fluid >= 0.5 * nb->wanted.fluid && left.wall >= 0.5 * nb->wanted.wall) *due = ROWS_DUE;
  return CAST_OK;
}

/* ---- skins ---- */

/* Sums over pairs cost A (1 + near/reach)^3 a step, each telling of near parts C, each making of lists B, both times (1
 * + listed/reach)^3. With C/A near 0.3 and B/C near 10 the least lies near these square roots of the fastest particle's
 * way in a step, and is flat there (docs/performance). */
void neighbours_choose_skins(Neighbours *nb, const Particles *p)
{
  if (!(nb->step > 0.0)) return;
  double v2 = 0.0;
#pragma omp parallel for simd reduction(max : v2)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const double v2_i = p->v[0][i] * p->v[0][i] + p->v[1][i] * p->v[1][i] + p->v[2][i] * p->v[2][i];
    v2 = v2_i > v2 ? v2_i : v2;
  }
  const double way = sqrt(sqrt(v2) * nb->step / nb->spacing), least_near = 0.06, least_listed = 0.15;
  const double near = 0.9 * way, listed = 3.0 * way, most = neighbours_range(nb->reach, nb->most_skin) - nb->reach;
  nb->wanted.fluid = (near > least_near ? near : least_near) * nb->spacing;
  nb->wanted.wall = 1.5 * nb->wanted.fluid; // melt moves faster past a wall than past melt nearby
  nb->listed.fluid = fmin((listed > least_listed ? listed : least_listed) * nb->spacing, most);
  nb->listed.wall = nb->listed.fluid;
}
