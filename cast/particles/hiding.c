#include "cast/particles/hiding.h"

#include "cast/geometry/sight.h"

/* A particle that is known to be clear of the mould: quick answers hold for it. */
static bool is_clear(const Particles *p, ptrdiff_t i)
{
  return p->clearance[i] > 0.0;
}

/* sight (may be NULL): from particle i. Always asked with the lower index first, so that both particles of a pair hear
 * the same. */
static bool fluid_separated(const Hiding *h, const Sight *sight, ptrdiff_t i, ptrdiff_t j)
{
  const Particles *p = h->p;
  if (!h->thin[i] || !h->thin[j]) return false;
  const double y[3] = {p->x[0][j], p->x[1][j], p->x[2][j]};
  if (sight && is_clear(p, j) && sight_is_free(sight, y)) return false;
  const ptrdiff_t a = i < j ? i : j, b = i < j ? j : i;
  const double xa[3] = {p->x[0][a], p->x[1][a], p->x[2][a]}, xb[3] = {p->x[0][b], p->x[1][b], p->x[2][b]};
  return surface_separates(h->surface, xa, xb);
}

static bool wall_separated(const Hiding *h, const Sight *sight, ptrdiff_t i, ptrdiff_t j)
{
  const Particles *p = h->p;
  if (!h->thin[i]) return false;
  const ptrdiff_t k = j - p->n_fluid;
  const double x[3] = {p->x[0][i], p->x[1][i], p->x[2][i]}, place[3] = {p->x[0][j], p->x[1][j], p->x[2][j]};
  const double foot[3] = {p->foot[0][k], p->foot[1][k], p->foot[2][k]};
  const double normal[3] = {p->normal[0][k], p->normal[1][k], p->normal[2][k]};
  if (sight && p->echo[k] && sight_enters_nothing(sight, place)) return true;
  if (sight && !p->echo[k] && sight_meets_wall(sight, place, normal)) return false;
  return !walls_seen(h->surface, x, place, foot, normal, p->echo[k]);
}

typedef bool (*Separated)(const Hiding *h, const Sight *sight, ptrdiff_t i, ptrdiff_t j);

static ptrdiff_t drop(const Hiding *h, Separated separated, ptrdiff_t row, ptrdiff_t n, int32_t *index)
{
  const double x[3] = {h->p->x[0][row], h->p->x[1][row], h->p->x[2][row]};
  Sight around, *sight = n > 0 && is_clear(h->p, row) ? &around : NULL;
  if (sight) sight_from(h->surface, x, h->range, sight);
  ptrdiff_t kept = 0;
  for (ptrdiff_t k = 0; k < n; k++) {
    const int32_t j = index[k];
    const bool hidden = separated(h, sight, row, j);
    index[kept] = j;
    kept += !hidden;
  }
  return kept;
}

ptrdiff_t hiding_drop_fluid(const Hiding *hiding, ptrdiff_t row, ptrdiff_t n, int32_t *index)
{
  return drop(hiding, fluid_separated, row, n, index);
}

ptrdiff_t hiding_drop_walls(const Hiding *hiding, ptrdiff_t row, ptrdiff_t n, int32_t *index)
{
  return drop(hiding, wall_separated, row, n, index);
}
