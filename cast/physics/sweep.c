/* Sums over pairs, fluid rows: drho, acceleration and heat of each fluid particle from its fluid and wall neighbours.
 * Method   full lists: iteration i writes particle i alone, so there are no races and the same bits at any number of
 *          threads; a pair is computed twice, which costs less than scattering. Pair terms are single, those between
 *          fluid particles rounded to whole grains and added up as integers (pack.c): what particles give each other is
 *          the same number with two signs, so sums over all are conserved as well as in double.
 * Formulas cast/kernel/pair.h; docs/theory, eq. 13-16 */
#include "cast/physics/sweep.h"

#include "cast/kernel/dispatch.h"
#include "cast/physics/block.h"
#include "cast/physics/flow.h"

enum { ROWS_PER_TASK = 128 };

/* ---- pairs: lengths in h, F in norm/h^5, volumes in h^3, masses in fluid particles' ---- */

PAIR_INLINE float offset(const SweepScales *c, const RecordField *me, const Block *b, int axis, ptrdiff_t k)
{
  return (float)(int32_t)(me[axis].place - b->place[axis][k]) * c->step[axis];
}

/* Sums of a lane of the vectors each, in grains: no lane has more than BLOCK_PAIRS/BLOCK_LANES terms of a block. */
typedef struct Grains {
  _Alignas(64) int32_t drho[BLOCK_LANES];
  int32_t fx[BLOCK_LANES], fy[BLOCK_LANES], fz[BLOCK_LANES], heat[BLOCK_LANES];
} Grains;
_Static_assert((BLOCK_PAIRS / BLOCK_LANES) <= 1 << (31 - SWEEP_GRAIN_BITS), "lanes of a block may overflow");

PAIR_INLINE double all_lanes(const int32_t lane[BLOCK_LANES])
{
  int64_t sum = 0;
#pragma omp simd reduction(+ : sum)
  for (int l = 0; l < BLOCK_LANES; l++) sum += lane[l];
  return (double)sum;
}

PAIR_INLINE void add_grains(const SweepScales *c, const Grains *grains, Rates *sum)
{
  sum->drho += c->grain.drho * all_lanes(grains->drho);
  sum->a[0] += c->grain.a * all_lanes(grains->fx);
  sum->a[1] += c->grain.a * all_lanes(grains->fy);
  sum->a[2] += c->grain.a * all_lanes(grains->fz);
  sum->heat += c->grain.heat * all_lanes(grains->heat);
}

/* Add to `sum` what the n fluid neighbours in the block do to the particle itself. Terms come out in grains because one
 * of their factors is given so: a grain is a power of two, and rounds nothing. */
PAIR_INLINE void fluid_pairs(const Sweep *s, KernelKind kernel, float rho_i, const RecordField *me, const Block *b,
                             ptrdiff_t n, Rates *sum)
{
  const SweepScales *c = &s->scale;
  const float per_drho = (float)(1.0 / c->grain.drho), per_a = (float)(1.0 / c->grain.a),
              per_heat = (float)(1.0 / c->grain.heat);
  const float diffusion = (float)(c->diffusion * c->per_h) * per_drho,
              artificial_strength = (float)(c->artificial * c->per_h);
  const float soften = (float)(c->soften * c->per_h * c->per_h);
  const float apart = (float)c->apart, per_q_apart = (float)c->per_q_apart;
  const float drho_i = rho_i * per_drho, mu_i = me[REC_MU].value * per_a, kappa_i = me[REC_KAPPA].value * per_heat;
  Grains grains = {0};
  for (ptrdiff_t first = 0; first < n; first += BLOCK_LANES)
#pragma omp simd
    for (ptrdiff_t l = 0; l < BLOCK_LANES; l++) {
      const ptrdiff_t k = first + l;
      const float dx = offset(c, me, b, REC_X, k), dy = offset(c, me, b, REC_Y, k), dz = offset(c, me, b, REC_Z, k);
      const float ux = me[REC_VX].value - b->value[REC_VX][k], uy = me[REC_VY].value - b->value[REC_VY][k],
                  uz = me[REC_VZ].value - b->value[REC_VZ][k];
      const float r2 = dx * dx + dy * dy + dz * dz, u_dot_d = ux * dx + uy * dy + uz * dz;
      const float q = sqrtf(r2), F = shape_slope_f(kernel, q);
      const float mu_j = b->value[REC_MU][k], kappa_j = b->value[REC_KAPPA][k];
      // dividers work beside all else: three divisions cost less than one and the products that share it
      const float per_mu_sum = 1.0F / (me[REC_MU].value + mu_j), per_kappa_sum = 1.0F / (me[REC_KAPPA].value + kappa_j);
      const float volumes = me[REC_VOLUME].value * b->value[REC_VOLUME][k];
      const float artificial = pair_artificial_f(artificial_strength, u_dot_d, 1.0F / (r2 + soften));
      const float extra = artificial + pair_apart_f(apart, q, per_q_apart);
      const float push = pair_pressure_f(per_a, me[REC_P].value, b->value[REC_P][k], extra, F);
      const float drag = pair_viscosity_f(volumes, mu_i, mu_j, per_mu_sum, F);
      grains.drho[l] += nearest_whole(pair_continuity_f(drho_i, volumes, u_dot_d, F) +
                                      pair_diffusion_f(volumes, diffusion, me[REC_ETA].value, b->value[REC_ETA][k], F));
      grains.fx[l] += nearest_whole(push * dx - drag * ux);
      grains.fy[l] += nearest_whole(push * dy - drag * uy);
      grains.fz[l] += nearest_whole(push * dz - drag * uz);
      grains.heat[l] +=
          nearest_whole(pair_heat_f(volumes, kappa_i, kappa_j, per_kappa_sum, me[REC_T].value, b->value[REC_T][k], F));
    }
  add_grains(c, &grains, sum);
}

/* The same for walls: no diffusion into them, no artificial viscosity along them; the density feels the wall's own
 * velocity, the viscous stress the extrapolated one (Adami, Hu & Adams 2012). */
PAIR_INLINE void wall_pairs(const Sweep *s, KernelKind kernel, float rho_i, const RecordField *me, const Block *b,
                            ptrdiff_t n, Rates *sum)
{
  const SweepScales *c = &s->scale;
  const float mu = me[REC_MU].value, per_mu_sum = 1.0F / (mu + mu), least = (float)c->wall_least;
  const float vx = me[REC_VX].value, vy = me[REC_VY].value, vz = me[REC_VZ].value;
  float drho = 0.0F, fx = 0.0F, fy = 0.0F, fz = 0.0F, sx = 0.0F, sy = 0.0F, sz = 0.0F;
#pragma omp simd reduction(+ : drho, fx, fy, fz, sx, sy, sz)
  for (ptrdiff_t k = 0; k < n; k++) {
    const float dx = offset(c, me, b, REC_X, k), dy = offset(c, me, b, REC_Y, k), dz = offset(c, me, b, REC_Z, k);
    const float F = shape_slope_f(kernel, sqrtf(dx * dx + dy * dy + dz * dz));
    const float volume_j = b->value[REC_VOLUME][k], volumes = me[REC_VOLUME].value * volume_j;
    const float u_dot_d = (vx - b->value[REC_WALL_VX][k]) * dx + (vy - b->value[REC_WALL_VY][k]) * dy +
                          (vz - b->value[REC_WALL_VZ][k]) * dz;
    const float push = pair_wall_pressure_f(b->value[REC_WALL_MASS][k], me[REC_P].value, b->value[REC_P][k], least, F);
    const float drag = pair_viscosity_f(volumes, mu, mu, per_mu_sum, F);
    drho += pair_continuity_f(rho_i, volumes, u_dot_d, F);
    fx += push * dx - drag * (vx - b->value[REC_VX][k]);
    fy += push * dy - drag * (vy - b->value[REC_VY][k]);
    fz += push * dz - drag * (vz - b->value[REC_VZ][k]);
    sx += volume_j * F * dx;
    sy += volume_j * F * dy;
    sz += volume_j * F * dz;
  }
  const float force[3] = {fx, fy, fz}, away[3] = {sx, sy, sz};
  sum->drho += (double)drho;
  for (int d = 0; d < 3; d++) {
    sum->a[d] += (double)force[d];
    sum->away[d] += (double)away[d];
  }
}

/* ---- rows ---- */

PAIR_INLINE void scale_rates(const SweepScales *c, double per_volume_i, Rates *sum)
{
  sum->drho *= c->si.drho * per_volume_i;
  sum->heat *= c->si.heat;
  for (int d = 0; d < 3; d++) {
    sum->a[d] *= c->si.a;
    sum->away[d] *= c->si.away;
  }
}

/* A neighbour of nothing: its pair terms are zero because it coincides with `me`, and for walls has no mass or volume.
 */
PAIR_INLINE void wall_filler(const RecordField *me, RecordField filler[RECORD_SIZE])
{
  for (int f = 0; f < RECORD_SIZE; f++) filler[f] = f <= REC_Z ? me[f] : (RecordField){.value = 0.0F};
}

PAIR_INLINE void sweep_rows(const Sweep *s, KernelKind kernel, ptrdiff_t first, ptrdiff_t end)
{
  Particles *p = s->p;
  const PairList *fluid = s->fluid_fluid, *wall = s->fluid_wall;
  Block block;
  for (ptrdiff_t i = first; i < end; i++) {
    const RecordField *me = p->record + i * RECORD_SIZE;
    const ptrdiff_t fluid_end = pair_list_end(fluid, i), wall_end = pair_list_end(wall, i);
    const float rho_i = (float)p->rho[i];
    Rates sum = {0};
    for (ptrdiff_t k = fluid->start[i]; k < fluid_end; k += BLOCK_PAIRS) {
      const ptrdiff_t left = fluid_end - k, most = left < BLOCK_PAIRS ? left : BLOCK_PAIRS;
      const ptrdiff_t n = block_fill(&block, RECORD_SIZE, p->record, fluid->index + k, most, me);
      fluid_pairs(s, kernel, rho_i, me, &block, n, &sum);
    }
    _Alignas(16) RecordField filler[RECORD_SIZE];
    if (wall->start[i] < wall_end) wall_filler(me, filler);
    for (ptrdiff_t k = wall->start[i]; k < wall_end; k += BLOCK_PAIRS) {
      const ptrdiff_t left = wall_end - k, most = left < BLOCK_PAIRS ? left : BLOCK_PAIRS;
      const ptrdiff_t n = block_fill(&block, RECORD_SIZE, p->record, wall->index + k, most, filler);
      wall_pairs(s, kernel, rho_i, me, &block, n, &sum);
    }
    scale_rates(&s->scale, 1.0 / p->volume[i], &sum);
    p->heat[i] = sum.heat;
    set_flow(s, i, &sum);
  }
}

/* Compiled once for each kernel, with nothing left to decide in the loop over pairs. */
SIMD_CLONES static void rates_wendland(const Sweep *s, ptrdiff_t first, ptrdiff_t end)
{
  sweep_rows(s, KERNEL_WENDLAND_C2, first, end);
}

SIMD_CLONES static void rates_cubic(const Sweep *s, ptrdiff_t first, ptrdiff_t end)
{
  sweep_rows(s, KERNEL_CUBIC_SPLINE, first, end);
}

SIMD_CLONES static void rates_quintic(const Sweep *s, ptrdiff_t first, ptrdiff_t end)
{
  sweep_rows(s, KERNEL_QUINTIC_SPLINE, first, end);
}

SIMD_CLONES static void rates_lucy(const Sweep *s, ptrdiff_t first, ptrdiff_t end)
{
  sweep_rows(s, KERNEL_LUCY, first, end);
}

void sweep_fluid(const Sweep *s)
{
  static void (*const kernels[])(const Sweep *s, ptrdiff_t first,
                                 ptrdiff_t end) = {[KERNEL_WENDLAND_C2] = rates_wendland,
                                                   [KERNEL_CUBIC_SPLINE] = rates_cubic,
                                                   [KERNEL_QUINTIC_SPLINE] = rates_quintic,
                                                   [KERNEL_LUCY] = rates_lucy};
  const ptrdiff_t n = s->p->n_fluid;
#pragma omp parallel for schedule(dynamic)
  for (ptrdiff_t first = 0; first < n; first += ROWS_PER_TASK)
    kernels[s->sph->kernel](s, first, first + ROWS_PER_TASK < n ? first + ROWS_PER_TASK : n);
}
