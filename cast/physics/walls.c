/* Wall particles take the pressure that holds the melt off, and the velocity that makes it stick.
 * References  Adami, Hu & Adams 2012, J. Comput. Phys. 231; docs/theory, eq. 17 */
#include "cast/kernel/dispatch.h"
#include "cast/physics/block.h"
#include "cast/physics/sweep.h"

enum { WALLS_PER_TASK = 256 };

typedef struct WallSums {
  float weight, p, v[3];
} WallSums;

/* sum_f W, sum_f (p_f + rho_f g.(x_w - x_f)) W and sum_f v_f W over the n fluid neighbours in the block; lengths in h,
 * volumes in h^3, W in norm/h^3. */
PAIR_INLINE void extrapolate(const Sweep *s, KernelKind kernel, const RecordField *me, const Block *b, ptrdiff_t n,
                             WallSums *sum)
{
  const SweepScales *c = &s->scale;
  const double h = 1.0 / c->per_h;
  const float mass = (float)(c->mass * c->per_h * c->per_h * c->per_h); // kg/h^3
  const float gx = (float)(c->held[0] * h), gy = (float)(c->held[1] * h), gz = (float)(c->held[2] * h);
  float weight = 0.0F, p = 0.0F, vx = 0.0F, vy = 0.0F, vz = 0.0F;
#pragma omp simd reduction(+ : weight, p, vx, vy, vz)
  for (ptrdiff_t k = 0; k < n; k++) {
    const float dx = (float)(int32_t)(me[REC_X].place - b->place[REC_X][k]) * c->step[0],
                dy = (float)(int32_t)(me[REC_Y].place - b->place[REC_Y][k]) * c->step[1],
                dz = (float)(int32_t)(me[REC_Z].place - b->place[REC_Z][k]) * c->step[2];
    const float W = shape_value_f(kernel, sqrtf(dx * dx + dy * dy + dz * dz));
    const float rho = mass / b->value[REC_VOLUME][k], head = gx * dx + gy * dy + gz * dz;
    weight += W;
    p += W * rho * (rho * b->value[REC_P][k] + head);
    vx += W * b->value[REC_VX][k];
    vy += W * b->value[REC_VY][k];
    vz += W * b->value[REC_VZ][k];
  }
  sum->weight += weight;
  sum->p += p;
  sum->v[0] += vx;
  sum->v[1] += vy;
  sum->v[2] += vz;
}

/* p, v, rho and record of wall k from its sums; a wall that nothing is within reach of has neither pressure nor pull.
 */
PAIR_INLINE void set_wall(const Sweep *s, ptrdiff_t k, const WallSums *sum, RecordField *record)
{
  Particles *p = s->p;
  const SphParameters *sph = s->sph;
  const SweepScales *c = &s->scale;
  const ptrdiff_t i = p->n_fluid + k;
  const double per_weight = sum->weight > 0.0F ? 1.0 / (double)sum->weight : 0.0;
  p->p[i] = (double)sum->p * per_weight;
  p->rho[i] = tait_density(p->p[i], sph->rho0, sph->c0, sph->gamma);
  for (int d = 0; d < 3; d++) {
    p->v[d][i] = 2.0 * p->wall_v[d][k] - (double)sum->v[d] * per_weight;
    record[REC_VX + d].value = (float)p->v[d][i];
    record[REC_WALL_VX + d].value = (float)p->wall_v[d][k];
  }
  record[REC_VOLUME].value = (float)(p->volume[i] * (c->per_h * c->per_h * c->per_h));
  record[REC_P].value = (float)(p->p[i] / (p->rho[i] * p->rho[i]));
  record[REC_WALL_MASS].value = (float)(p->rho[i] * p->volume[i] / c->mass);
}

/* A neighbour out of reach of `me`, half of all places away: W = 0. */
PAIR_INLINE void far_filler(const RecordField *me, RecordField filler[RECORD_SIZE])
{
  for (int f = 0; f < RECORD_SIZE; f++) filler[f] = f <= REC_Z ? me[f] : (RecordField){.value = 0.0F};
  filler[REC_X].place ^= 0x80000000U;
  filler[REC_VOLUME].value = 1.0F; // is divided by
}

PAIR_INLINE void wall_rows(const Sweep *s, KernelKind kernel, ptrdiff_t first, ptrdiff_t end)
{
  const Particles *p = s->p;
  const PairList *list = s->wall_fluid;
  Block block;
  for (ptrdiff_t k = first; k < end; k++) {
    if (list->start[k] == list->start[k + 1]) continue;
    const ptrdiff_t i = p->n_fluid + k;
    RecordField *me = p->record + i * RECORD_SIZE;
    for (int d = 0; d < 3; d++) me[REC_X + d] = sweep_place(&s->scale, d, p->x[d][i]);
    _Alignas(16) RecordField filler[RECORD_SIZE];
    far_filler(me, filler);
    WallSums sum = {0};
    for (ptrdiff_t l = list->start[k]; l < list->start[k + 1]; l += BLOCK_PAIRS) {
      const ptrdiff_t left = list->start[k + 1] - l, most = left < BLOCK_PAIRS ? left : BLOCK_PAIRS;
      const ptrdiff_t n = block_fill(&block, REC_P + 1, p->record, list->index + l, most, filler);
      extrapolate(s, kernel, me, &block, n, &sum);
    }
    set_wall(s, k, &sum, me);
  }
}

SIMD_CLONES static void walls_wendland(const Sweep *s, ptrdiff_t first, ptrdiff_t end)
{
  wall_rows(s, KERNEL_WENDLAND_C2, first, end);
}

SIMD_CLONES static void walls_any(const Sweep *s, ptrdiff_t first, ptrdiff_t end)
{
  wall_rows(s, s->sph->kernel, first, end);
}

void sweep_walls(const Sweep *s)
{
  const ptrdiff_t n = s->p->n - s->p->n_fluid;
  static void (*const forms[])(const Sweep *s, ptrdiff_t first, ptrdiff_t end) = {walls_any, walls_wendland};
  const bool wendland = s->sph->kernel == KERNEL_WENDLAND_C2;
#pragma omp parallel for schedule(dynamic)
  for (ptrdiff_t first = 0; first < n; first += WALLS_PER_TASK)
    forms[wendland](s, first, first + WALLS_PER_TASK < n ? first + WALLS_PER_TASK : n);
}
