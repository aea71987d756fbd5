/* Sums over pairs, fluid rows: drho, acceleration and heat of each fluid particle from its fluid and wall neighbours.
 * Method   full lists: iteration i writes particle i alone, so there are no races and the same bits at any number of
 *          threads; a pair is computed twice, which costs less than scattering. Pair terms are single, added up in
 *          double: what particles give each other is the same number with two signs, so sums over all are conserved as
 *          well as in double.
 * Formulas cast/kernel/pair.h; docs/theory, eq. 13-16 */
#include "cast/physics/sweep.h"

#include "cast/kernel/dispatch.h"
#include "cast/physics/block.h"
#include "cast/physics/flow.h"

enum { ROWS_PER_TASK = 128 };

Sweep sweep_begin(const SphParameters *sph, Particles *particles, const Neighbours *neighbours)
{
  const double h = sph->h, *period = neighbours_period(neighbours), norm = shape_norm(sph->kernel);
  Sweep s = {.sph = sph,
             .p = particles,
             .spins = !spin_is_none(&sph->spin),
             .fluid_fluid = neighbours_fluid_fluid(neighbours),
             .fluid_wall = neighbours_fluid_wall(neighbours),
             .wall_fluid = neighbours_wall_fluid(neighbours),
             .scale = {.slope = norm / (h * h * h * h * h),
                       .value = norm / (h * h * h),
                       .per_h = 1.0 / h,
                       .mass = particles->n_fluid > 0 ? particles->mass[0] : 0.0,
                       .diffusion = 2.0 * sph->delta * h * sph->c0,
                       .artificial = sph->alpha * sph->c0 * h / sph->rho0,
                       .soften = 0.01 * h * h,
                       .apart = APART_STRENGTH * sph->c0 * sph->c0 / sph->rho0,
                       .per_q_apart = h / (APART_BELOW * sph->spacing),
                       .T0 = particles->n_fluid > 0 ? particles->T[0] : 0.0}};
  const double h2 = h * h, h6 = h2 * h2 * h2;
  s.scale.si.heat = s.scale.slope * h6;
  s.scale.si.drho = s.scale.slope * h6 * h;
  s.scale.si.a = s.scale.slope * h * s.scale.mass;
  s.scale.si.away = s.scale.slope * h2 * h2;
  for (int d = 0; d < 3; d++) {
    const double unit = period[d] > 0.0 ? 0x1p-32 * period[d] : 0x1p-24 * h;
    s.scale.body[d] = sph->gravity[d] + sph->extra[d];
    s.scale.held[d] = period[d] > 0.0 ? 0.0 : s.scale.body[d];
    s.scale.period[d] = period[d];
    s.scale.per_period[d] = period[d] > 0.0 ? 1.0 / period[d] : 0.0;
    s.scale.per_unit[d] = 1.0 / unit;
    s.scale.step[d] = (float)(unit / h);
  }
  return s;
}

/* ---- records ---- */

/* x in units of place, wrapped into [-2^31, 2^31). */
PAIR_INLINE int32_t wrapped_place(double x, double per_unit)
{
  const double place = x * per_unit;
  return (int32_t)(place - 0x1p32 * floor(place * 0x1p-32) - 0x1p31);
}

RecordField sweep_place(const SweepScales *scale, int axis, double x)
{
  return (RecordField){.place = (uint32_t)wrapped_place(x, scale->per_unit[axis])};
}

SIMD_CLONES static void pack_rows(const Sweep *s, ptrdiff_t first, ptrdiff_t end)
{
  const Particles *p = s->p;
  const SphParameters *sph = s->sph;
  const SweepScales *c = &s->scale;
  const double rho0 = sph->rho0, c0 = sph->c0, gamma = sph->gamma, *g = c->held, T0 = c->T0;
  const double per_h3 = c->per_h * c->per_h * c->per_h,
               per_mu = 1.0 / (c->mass * c->mass * per_h3 * c->per_h * c->per_h);
  const bool cut = sph->cut_tension;
  const Spin spin = sph->spin;
#pragma omp simd
  for (ptrdiff_t i = first; i < end; i++) {
    const double whole = whole_density(p->rho[i], rho0);
    const double held = g[0] * p->x[0][i] + g[1] * p->x[1][i] + g[2] * p->x[2][i] +
                        spin_potential(&spin, p->x[0][i], p->x[1][i], p->x[2][i]);
    p->p[i] = melt_pressure(p->rho[i], rho0, c0, gamma, cut);
    p->volume[i] = p->mass[i] / whole;
    RecordField *record = p->record + i * RECORD_SIZE;
    record[REC_X].place = (uint32_t)wrapped_place(p->x[0][i], c->per_unit[0]);
    record[REC_Y].place = (uint32_t)wrapped_place(p->x[1][i], c->per_unit[1]);
    record[REC_Z].place = (uint32_t)wrapped_place(p->x[2][i], c->per_unit[2]);
    record[REC_VOLUME].value = (float)(p->volume[i] * per_h3);
    record[REC_VX].value = (float)p->v[0][i];
    record[REC_VY].value = (float)p->v[1][i];
    record[REC_VZ].value = (float)p->v[2][i];
    record[REC_P].value = (float)(p->p[i] / (whole * whole));
    record[REC_ETA].value = (float)diffused_density(whole, rho0, c0, gamma, held);
    record[REC_MU].value = (float)(p->mu[i] * per_mu + SWEEP_TINY);
    record[REC_KAPPA].value = (float)(p->kappa[i] + SWEEP_TINY);
    record[REC_T].value = (float)(p->T[i] - T0);
  }
}

void sweep_pack_fluid(const Sweep *s)
{
  const ptrdiff_t n = s->p->n_fluid;
#pragma omp parallel for
  for (ptrdiff_t first = 0; first < n; first += ROWS_PER_TASK)
    pack_rows(s, first, first + ROWS_PER_TASK < n ? first + ROWS_PER_TASK : n);
}

/* ---- pairs: lengths in h, F in norm/h^5, volumes in h^3, masses in fluid particles' ---- */

PAIR_INLINE float offset(const SweepScales *c, const RecordField *me, const Block *b, int axis, ptrdiff_t k)
{
  return (float)(int32_t)(me[axis].place - b->place[axis][k]) * c->step[axis];
}

/* Add to `sum` what the n fluid neighbours in the block do to the particle itself. */
PAIR_INLINE void fluid_pairs(const Sweep *s, KernelKind kernel, float rho_i, const RecordField *me, const Block *b,
                             ptrdiff_t n, Rates *sum)
{
  const SweepScales *c = &s->scale;
  const float diffusion = (float)(c->diffusion * c->per_h), artificial_strength = (float)(c->artificial * c->per_h);
  const float soften = (float)(c->soften * c->per_h * c->per_h);
  const float apart = (float)c->apart, per_q_apart = (float)c->per_q_apart;
  double drho = 0.0, fx = 0.0, fy = 0.0, fz = 0.0, heat = 0.0;
#pragma omp simd reduction(+ : drho, fx, fy, fz, heat)
  for (ptrdiff_t k = 0; k < n; k++) {
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
    const float push = pair_pressure_f(1.0F, me[REC_P].value, b->value[REC_P][k], extra, F);
    const float drag = pair_viscosity_f(volumes, me[REC_MU].value, mu_j, per_mu_sum, F);
    drho += (double)(pair_continuity_f(rho_i, volumes, u_dot_d, F) +
                     pair_diffusion_f(volumes, diffusion, me[REC_ETA].value, b->value[REC_ETA][k], F));
    fx += (double)(push * dx - drag * ux);
    fy += (double)(push * dy - drag * uy);
    fz += (double)(push * dz - drag * uz);
    heat += (double)pair_heat_f(volumes, me[REC_KAPPA].value, kappa_j, per_kappa_sum, me[REC_T].value,
                                b->value[REC_T][k], F);
  }
  sum->drho += drho;
  sum->a[0] += fx;
  sum->a[1] += fy;
  sum->a[2] += fz;
  sum->heat += heat;
}

/* The same for walls: no diffusion into them, no artificial viscosity along them; the density feels the wall's own
 * velocity, the viscous stress the extrapolated one (Adami, Hu & Adams 2012). */
PAIR_INLINE void wall_pairs(const Sweep *s, KernelKind kernel, float rho_i, const RecordField *me, const Block *b,
                            ptrdiff_t n, Rates *sum)
{
  const SweepScales *c = &s->scale;
  const float mu = me[REC_MU].value, per_mu_sum = 1.0F / (mu + mu);
  const float vx = me[REC_VX].value, vy = me[REC_VY].value, vz = me[REC_VZ].value;
  float drho = 0.0F, fx = 0.0F, fy = 0.0F, fz = 0.0F, sx = 0.0F, sy = 0.0F, sz = 0.0F;
#pragma omp simd reduction(+ : drho, fx, fy, fz, sx, sy, sz)
  for (ptrdiff_t k = 0; k < n; k++) {
    const float dx = offset(c, me, b, REC_X, k), dy = offset(c, me, b, REC_Y, k), dz = offset(c, me, b, REC_Z, k);
    const float F = shape_slope_f(kernel, sqrtf(dx * dx + dy * dy + dz * dz));
    const float volume_j = b->value[REC_VOLUME][k], volumes = me[REC_VOLUME].value * volume_j;
    const float u_dot_d = (vx - b->value[REC_WALL_VX][k]) * dx + (vy - b->value[REC_WALL_VY][k]) * dy +
                          (vz - b->value[REC_WALL_VZ][k]) * dz;
    const float push = pair_wall_pressure_f(b->value[REC_WALL_MASS][k], me[REC_P].value, b->value[REC_P][k], F);
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
    const float rho_i = (float)p->rho[i];
    Rates sum = {0};
    for (ptrdiff_t k = fluid->start[i]; k < fluid->start[i + 1]; k += BLOCK_PAIRS) {
      const ptrdiff_t left = fluid->start[i + 1] - k, most = left < BLOCK_PAIRS ? left : BLOCK_PAIRS;
      const ptrdiff_t n = block_fill(&block, RECORD_SIZE, p->record, fluid->index + k, most, me);
      fluid_pairs(s, kernel, rho_i, me, &block, n, &sum);
    }
    _Alignas(16) RecordField filler[RECORD_SIZE];
    if (wall->start[i] < wall->start[i + 1]) wall_filler(me, filler);
    for (ptrdiff_t k = wall->start[i]; k < wall->start[i + 1]; k += BLOCK_PAIRS) {
      const ptrdiff_t left = wall->start[i + 1] - k, most = left < BLOCK_PAIRS ? left : BLOCK_PAIRS;
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
