/* Wall particles take the pressure that holds the melt off, and the velocity that makes it stick.
 * References  Adami, Hu & Adams 2012, J. Comput. Phys. 231; docs/theory, eq. 17 */
#include "cast/kernel/dispatch.h"
#include "cast/physics/block.h"
#include "cast/physics/sweep.h"

enum { WALLS_PER_TASK = 256 };

typedef struct WallSums {
  float weight, p, v[3];
} WallSums;

/* What body forces do to the pressure between a wall particle and its neighbours: that in the middle of the way, which
 * is exact for a force that changes evenly with the place; lengths in h. */
typedef struct WallForce {
  float g[3];       // m2/s2, at the wall particle: uniform, centrifugal and Euler's, times h
  float rate[3];    // m/s, angular velocity times h
  float half_rate2; // m2/s2, w^2/2 times h^2
} WallForce;

PAIR_INLINE WallForce wall_force(const Sweep *s, const double x[3])
{
  const double h = 1.0 / s->scale.per_h, *held = s->scale.held;
  double g[3] = {held[0], held[1], held[2]};
  if (s->spins) spin_add_acceleration(&s->sph->spin, x, g);
  WallForce force = {.half_rate2 = (float)(0.5 * spin_rate2(&s->sph->spin) * h * h)};
  for (int d = 0; d < 3; d++) {
    force.g[d] = (float)(g[d] * h);
    force.rate[d] = (float)(s->sph->spin.rate[d] * h);
  }
  return force;
}

/* sum_f W, sum_f (p_f + rho_f g.(x_w - x_f)) W and sum_f v_f W over the n fluid neighbours in the block; lengths in h,
 * volumes in h^3, W in norm/h^3. */
PAIR_INLINE void extrapolate(const Sweep *s, KernelKind kernel, bool spins, const RecordField *me,
                             const WallForce *force, const Block *b, ptrdiff_t n, WallSums *sum)
{
  const SweepScales *c = &s->scale;
  const float mass = (float)(c->mass * c->per_h * c->per_h * c->per_h); // kg/h^3
  const float gx = force->g[0], gy = force->g[1], gz = force->g[2];
  const float wx = force->rate[0], wy = force->rate[1], wz = force->rate[2], half_w2 = force->half_rate2;
  float weight = 0.0F, p = 0.0F, vx = 0.0F, vy = 0.0F, vz = 0.0F;
#pragma omp simd reduction(+ : weight, p, vx, vy, vz)
  for (ptrdiff_t k = 0; k < n; k++) {
    const float dx = (float)(int32_t)(me[REC_X].place - b->place[REC_X][k]) * c->step[0],
                dy = (float)(int32_t)(me[REC_Y].place - b->place[REC_Y][k]) * c->step[1],
                dz = (float)(int32_t)(me[REC_Z].place - b->place[REC_Z][k]) * c->step[2];
    const float r2 = dx * dx + dy * dy + dz * dz, W = shape_value_f(kernel, sqrtf(r2));
    const float rho = mass / b->value[REC_VOLUME][k];
    float head = gx * dx + gy * dy + gz * dz;
    if (spins) {
      const float ux = b->value[REC_VX][k], uy = b->value[REC_VY][k], uz = b->value[REC_VZ][k];
      const float along = wx * dx + wy * dy + wz * dz;
      head -= half_w2 * r2 - 0.5F * along * along;
      head -= 2.0F * (dx * (wy * uz - wz * uy) + dy * (wz * ux - wx * uz) + dz * (wx * uy - wy * ux));
    }
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

PAIR_INLINE void wall_rows(const Sweep *s, KernelKind kernel, bool spins, ptrdiff_t first, ptrdiff_t end)
{
  const Particles *p = s->p;
  const PairList *list = s->wall_fluid;
  Block block;
  for (ptrdiff_t k = first; k < end; k++) {
    const ptrdiff_t row_end = pair_list_end(list, k);
    if (list->start[k] == row_end) continue;
    const ptrdiff_t i = p->n_fluid + k;
    RecordField *me = p->record + i * RECORD_SIZE;
    for (int d = 0; d < 3; d++) me[REC_X + d] = sweep_place(&s->scale, d, p->x[d][i]);
    _Alignas(16) RecordField filler[RECORD_SIZE];
    far_filler(me, filler);
    const WallForce force = wall_force(s, (const double[3]){p->x[0][i], p->x[1][i], p->x[2][i]});
    WallSums sum = {0};
    for (ptrdiff_t l = list->start[k]; l < row_end; l += BLOCK_PAIRS) {
      const ptrdiff_t left = row_end - l, most = left < BLOCK_PAIRS ? left : BLOCK_PAIRS;
      const ptrdiff_t n = block_fill(&block, REC_P + 1, p->record, list->index + l, most, filler);
      extrapolate(s, kernel, spins, me, &force, &block, n, &sum);
    }
    set_wall(s, k, &sum, me);
  }
}

SIMD_CLONES static void walls_wendland(const Sweep *s, ptrdiff_t first, ptrdiff_t end)
{
  wall_rows(s, KERNEL_WENDLAND_C2, false, first, end);
}

SIMD_CLONES static void walls_wendland_spun(const Sweep *s, ptrdiff_t first, ptrdiff_t end)
{
  wall_rows(s, KERNEL_WENDLAND_C2, true, first, end);
}

SIMD_CLONES static void walls_any(const Sweep *s, ptrdiff_t first, ptrdiff_t end)
{
  wall_rows(s, s->sph->kernel, s->spins, first, end);
}

void sweep_walls(const Sweep *s)
{
  const ptrdiff_t n = s->p->n - s->p->n_fluid;
  static void (*const forms[])(const Sweep *s, ptrdiff_t first, ptrdiff_t end) = {walls_any, walls_wendland,
                                                                                  walls_wendland_spun};
  const int form = s->sph->kernel != KERNEL_WENDLAND_C2 ? 0 : s->spins ? 2 : 1;
#pragma omp parallel for schedule(dynamic)
  for (ptrdiff_t first = 0; first < n; first += WALLS_PER_TASK)
    forms[form](s, first, first + WALLS_PER_TASK < n ? first + WALLS_PER_TASK : n);
}
