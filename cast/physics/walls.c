/* Wall particles take the pressure that holds the melt off, and the velocity that makes it stick.
 * References  Adami, Hu & Adams 2012, J. Comput. Phys. 231; docs/theory, eq. 17 */
#include "cast/physics/block.h"
#include "cast/kernel/dispatch.h"
#include "cast/physics/sweep.h"

enum { WALLS_PER_TASK = 256 };

typedef struct WallSums {
  double weight, p, v[3];
} WallSums;

/* sum_f W, sum_f (p_f + rho_f g.(x_w - x_f)) W and sum_f v_f W over the n fluid neighbours in the block. */
PAIR_INLINE void extrapolate(const Sweep *s, KernelKind kernel, bool periodic, const double x[3], const Block *b,
                             ptrdiff_t n, WallSums *sum)
{
  const SweepScales *c = &s->scale;
  const double mass = s->p->mass[0];
  double weight = 0.0, p = 0.0, vx = 0.0, vy = 0.0, vz = 0.0;
#pragma omp simd reduction(+ : weight, p, vx, vy, vz)
  for (ptrdiff_t k = 0; k < n; k++) {
    double dx = x[0] - b->field[REC_X][k], dy = x[1] - b->field[REC_Y][k], dz = x[2] - b->field[REC_Z][k];
    if (periodic) {
      dx -= c->period[0] * floor(dx * c->per_period[0] + 0.5);
      dy -= c->period[1] * floor(dy * c->per_period[1] + 0.5);
      dz -= c->period[2] * floor(dz * c->per_period[2] + 0.5);
    }
    const double W = shape_value(kernel, sqrt(dx * dx + dy * dy + dz * dz) * c->per_h);
    const double rho = mass / b->field[REC_VOLUME][k];
    const double head = c->held[0] * dx + c->held[1] * dy + c->held[2] * dz;
    weight += W;
    p += W * rho * (rho * b->field[REC_P][k] + head);
    vx += W * b->field[REC_VX][k];
    vy += W * b->field[REC_VY][k];
    vz += W * b->field[REC_VZ][k];
  }
  sum->weight += weight;
  sum->p += p;
  sum->v[0] += vx;
  sum->v[1] += vy;
  sum->v[2] += vz;
}

/* p, v, rho and record of wall k from its sums; a wall that nothing is within reach of has neither pressure nor pull.
 */
PAIR_INLINE void set_wall(const Sweep *s, ptrdiff_t k, const WallSums *sum)
{
  Particles *p = s->p;
  const SphParameters *sph = s->sph;
  const ptrdiff_t i = p->n_fluid + k;
  const double per_weight = sum->weight > 0.0 ? 1.0 / sum->weight : 0.0;
  p->p[i] = sum->p * per_weight;
  p->rho[i] = tait_density(p->p[i], sph->rho0, sph->c0, sph->gamma);
  double *record = p->record + i * RECORD_SIZE;
  for (int d = 0; d < 3; d++) {
    p->v[d][i] = 2.0 * p->wall_v[d][k] - sum->v[d] * per_weight;
    record[REC_X + d] = p->x[d][i];
    record[REC_VX + d] = p->v[d][i];
    record[REC_WALL_VX + d] = p->wall_v[d][k];
  }
  record[REC_VOLUME] = p->volume[i];
  record[REC_P] = p->p[i] / (p->rho[i] * p->rho[i]);
  record[REC_WALL_MASS] = p->rho[i] * p->volume[i];
}

PAIR_INLINE void wall_rows(const Sweep *s, KernelKind kernel, bool periodic, ptrdiff_t first, ptrdiff_t end)
{
  const Particles *p = s->p;
  const PairList *list = s->wall_fluid;
  Block block;
  for (ptrdiff_t k = first; k < end; k++) {
    if (list->start[k] == list->start[k + 1]) continue;
    const ptrdiff_t i = p->n_fluid + k;
    const double x[3] = {p->x[0][i], p->x[1][i], p->x[2][i]};
    WallSums sum = {0};
    for (ptrdiff_t l = list->start[k]; l < list->start[k + 1]; l += BLOCK_PAIRS) {
      const ptrdiff_t left = list->start[k + 1] - l, n = left < BLOCK_PAIRS ? left : BLOCK_PAIRS;
      block_fill(&block, p->record, list->index + l, n, p->record); // no filler has W = 0: sum the n real ones
      extrapolate(s, kernel, periodic, x, &block, n, &sum);
    }
    set_wall(s, k, &sum);
  }
}

SIMD_CLONES static void walls_wendland(const Sweep *s, ptrdiff_t first, ptrdiff_t end)
{
  wall_rows(s, KERNEL_WENDLAND_C2, false, first, end);
}

static void walls_any(const Sweep *s, ptrdiff_t first, ptrdiff_t end)
{
  wall_rows(s, s->sph->kernel, s->periodic, first, end);
}

void sweep_walls(const Sweep *s)
{
  const ptrdiff_t n = s->p->n - s->p->n_fluid;
  const bool usual = s->sph->kernel == KERNEL_WENDLAND_C2 && !s->periodic;
#pragma omp parallel for schedule(dynamic)
  for (ptrdiff_t first = 0; first < n; first += WALLS_PER_TASK)
    (usual ? walls_wendland : walls_any)(s, first, first + WALLS_PER_TASK < n ? first + WALLS_PER_TASK : n);
}
