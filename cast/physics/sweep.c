/* Sums over pairs, fluid rows: drho, acceleration and heat of each fluid particle from its fluid and wall neighbours.
 * Method   full lists: iteration i writes particle i alone, so there are no races and the same bits at any number of
 *          threads; a pair is computed twice, which costs less than scattering.
 * Formulas cast/kernel/pair.h; docs/theory, eq. 13-16 */
#include "cast/physics/sweep.h"

#include "cast/physics/block.h"
#include "cast/kernel/dispatch.h"

enum { ROWS_PER_TASK = 128 };

/* Added to sums of viscosities (Pa s) and conductivities (W/(m K)) that are divided by: 0/0 must give 0. */
#define TINY_SUM 1e-30

Sweep sweep_begin(const SphParameters *sph, Particles *particles, const Neighbours *neighbours)
{
  const double h = sph->h, *period = neighbours_period(neighbours), norm = shape_norm(sph->kernel);
  Sweep s = {.sph = sph,
             .p = particles,
             .fluid_fluid = neighbours_fluid_fluid(neighbours),
             .fluid_wall = neighbours_fluid_wall(neighbours),
             .wall_fluid = neighbours_wall_fluid(neighbours),
             .scale = {.slope = norm / (h * h * h * h * h),
                       .value = norm / (h * h * h),
                       .per_h = 1.0 / h,
                       .diffusion = 2.0 * sph->delta * h * sph->c0,
                       .artificial = sph->alpha * sph->c0 * h / sph->rho0,
                       .soften = 0.01 * h * h}};
  for (int d = 0; d < 3; d++) {
    s.scale.body[d] = sph->gravity[d] + sph->extra[d];
    s.scale.held[d] = period[d] > 0.0 ? 0.0 : s.scale.body[d];
    s.scale.period[d] = period[d];
    s.scale.per_period[d] = period[d] > 0.0 ? 1.0 / period[d] : 0.0;
    s.periodic = s.periodic || period[d] > 0.0;
  }
  return s;
}

SIMD_CLONES static void pack_rows(const Sweep *s, ptrdiff_t first, ptrdiff_t end)
{
  const Particles *p = s->p;
  const SphParameters *sph = s->sph;
  const double rho0 = sph->rho0, c0 = sph->c0, gamma = sph->gamma, *g = s->scale.held;
  const bool cut = sph->cut_tension;
#pragma omp simd
  for (ptrdiff_t i = first; i < end; i++) {
    const double whole = whole_density(p->rho[i], rho0);
    const double g_dot_x = g[0] * p->x[0][i] + g[1] * p->x[1][i] + g[2] * p->x[2][i];
    p->p[i] = melt_pressure(p->rho[i], rho0, c0, gamma, cut);
    p->volume[i] = p->mass[i] / whole;
    double *record = p->record + i * RECORD_SIZE;
    record[REC_X] = p->x[0][i];
    record[REC_Y] = p->x[1][i];
    record[REC_Z] = p->x[2][i];
    record[REC_VOLUME] = p->volume[i];
    record[REC_VX] = p->v[0][i];
    record[REC_VY] = p->v[1][i];
    record[REC_VZ] = p->v[2][i];
    record[REC_P] = p->p[i] / (whole * whole);
    record[REC_ETA] = diffused_density(whole, rho0, c0, gamma, g_dot_x);
    record[REC_MU] = p->mu[i];
    record[REC_KAPPA] = p->kappa[i];
    record[REC_T] = p->T[i];
  }
}

void sweep_pack_fluid(const Sweep *s)
{
  const ptrdiff_t n = s->p->n_fluid;
#pragma omp parallel for
  for (ptrdiff_t first = 0; first < n; first += ROWS_PER_TASK)
    pack_rows(s, first, first + ROWS_PER_TASK < n ? first + ROWS_PER_TASK : n);
}

/* The nearest image of a distance; periods of zero leave it alone. */
PAIR_INLINE double nearest_image(const SweepScales *scale, int axis, double d)
{
  return d - scale->period[axis] * floor(d * scale->per_period[axis] + 0.5);
}

typedef struct Rates {
  double drho, a[3], heat;
  double away[3]; // 1/m, sum over walls of V_j F_ij d: points out of the wall
} Rates;

typedef struct Self {
  const double *record;
  double rho; // kg/m3, as it is; the record's volume goes by the whole_density
} Self;

/* Add to `sum` what the n fluid neighbours in the block do to the particle itself. */
PAIR_INLINE void fluid_pairs(const Sweep *s, KernelKind kernel, SweepTasks tasks, bool periodic, const Self *self,
                             const Block *b, ptrdiff_t n, Rates *sum)
{
  const SweepScales *c = &s->scale;
  const double *me = self->record, rho_i = self->rho, mass = s->p->mass[0], per_rho_i = me[REC_VOLUME] / mass;
  double drho = 0.0, ax = 0.0, ay = 0.0, az = 0.0, heat = 0.0;
#pragma omp simd reduction(+ : drho, ax, ay, az, heat)
  for (ptrdiff_t k = 0; k < n; k++) {
    double dx = me[REC_X] - b->field[REC_X][k], dy = me[REC_Y] - b->field[REC_Y][k],
           dz = me[REC_Z] - b->field[REC_Z][k];
    if (periodic) {
      dx = nearest_image(c, 0, dx);
      dy = nearest_image(c, 1, dy);
      dz = nearest_image(c, 2, dz);
    }
    const double r2 = dx * dx + dy * dy + dz * dz;
    const double F = c->slope * shape_slope(kernel, sqrt(r2) * c->per_h);
    const double mu_j = b->field[REC_MU][k], kappa_j = b->field[REC_KAPPA][k];
    // one division gives the three reciprocals
    const double mu_sum = (me[REC_MU] + mu_j) + TINY_SUM, kappa_sum = (me[REC_KAPPA] + kappa_j) + TINY_SUM;
    const double r2_plus = r2 + c->soften, per_all = 1.0 / ((mu_sum * kappa_sum) * r2_plus);
    const double volume_j = b->field[REC_VOLUME][k];
    if (tasks.flow) {
      const double ux = me[REC_VX] - b->field[REC_VX][k], uy = me[REC_VY] - b->field[REC_VY][k],
                   uz = me[REC_VZ] - b->field[REC_VZ][k];
      const double u_dot_d = ux * dx + uy * dy + uz * dz;
      const double artificial = pair_artificial(c->artificial, u_dot_d, per_all * (mu_sum * kappa_sum));
      const double push = pair_pressure(mass, me[REC_P], b->field[REC_P][k], artificial, F);
      const double drag = pair_viscosity(volume_j, per_rho_i, me[REC_MU], mu_j, per_all * (kappa_sum * r2_plus), F);
      drho += pair_continuity(rho_i, volume_j, u_dot_d, F) +
              pair_diffusion(volume_j, c->diffusion, me[REC_ETA], b->field[REC_ETA][k], F);
      ax += push * dx - drag * ux;
      ay += push * dy - drag * uy;
      az += push * dz - drag * uz;
    }
    if (tasks.heat)
      heat += pair_heat(me[REC_VOLUME], volume_j, me[REC_KAPPA], kappa_j, per_all * (mu_sum * r2_plus), me[REC_T],
                        b->field[REC_T][k], F);
  }
  sum->drho += drho;
  sum->a[0] += ax;
  sum->a[1] += ay;
  sum->a[2] += az;
  sum->heat += heat;
}

/* The same for walls: no diffusion into them, no artificial viscosity along them; the density feels the wall's own
 * velocity, the viscous stress the extrapolated one (Adami, Hu & Adams 2012). */
PAIR_INLINE void wall_pairs(const Sweep *s, KernelKind kernel, bool periodic, const Self *self, const Block *b,
                            ptrdiff_t n, Rates *sum)
{
  const SweepScales *c = &s->scale;
  const double *me = self->record, rho_i = self->rho, per_rho_i = me[REC_VOLUME] / s->p->mass[0];
  const double mu = me[REC_MU], per_mu_sum = 1.0 / (2.0 * mu + TINY_SUM);
  double drho = 0.0, ax = 0.0, ay = 0.0, az = 0.0, sx = 0.0, sy = 0.0, sz = 0.0;
#pragma omp simd reduction(+ : drho, ax, ay, az, sx, sy, sz)
  for (ptrdiff_t k = 0; k < n; k++) {
    double dx = me[REC_X] - b->field[REC_X][k], dy = me[REC_Y] - b->field[REC_Y][k],
           dz = me[REC_Z] - b->field[REC_Z][k];
    if (periodic) {
      dx = nearest_image(c, 0, dx);
      dy = nearest_image(c, 1, dy);
      dz = nearest_image(c, 2, dz);
    }
    const double F = c->slope * shape_slope(kernel, sqrt(dx * dx + dy * dy + dz * dz) * c->per_h);
    const double volume_j = b->field[REC_VOLUME][k];
    const double u_dot_d = (me[REC_VX] - b->field[REC_WALL_VX][k]) * dx + (me[REC_VY] - b->field[REC_WALL_VY][k]) * dy +
                           (me[REC_VZ] - b->field[REC_WALL_VZ][k]) * dz;
    const double push = pair_wall_pressure(b->field[REC_WALL_MASS][k], me[REC_P], b->field[REC_P][k], F);
    const double drag = pair_viscosity(volume_j, per_rho_i, mu, mu, per_mu_sum, F);
    drho += pair_continuity(rho_i, volume_j, u_dot_d, F);
    ax += push * dx - drag * (me[REC_VX] - b->field[REC_VX][k]);
    ay += push * dy - drag * (me[REC_VY] - b->field[REC_VY][k]);
    az += push * dz - drag * (me[REC_VZ] - b->field[REC_VZ][k]);
    sx += volume_j * F * dx;
    sy += volume_j * F * dy;
    sz += volume_j * F * dz;
  }
  sum->away[0] += sx;
  sum->away[1] += sy;
  sum->away[2] += sz;
  sum->drho += drho;
  sum->a[0] += ax;
  sum->a[1] += ay;
  sum->a[2] += az;
}

/* A torn particle that flies into a wall (at rest) is stopped. */
PAIR_INLINE void stop_torn(const Sweep *s, const Self *self, Rates *sum)
{
  const double torn = torn_fraction(self->rho, s->sph->rho0), *me = self->record, *away = sum->away;
  const double size2 = away[0] * away[0] + away[1] * away[1] + away[2] * away[2];
  if (torn <= 0.0 || size2 <= 0.0) return;
  const double along = me[REC_VX] * away[0] + me[REC_VY] * away[1] + me[REC_VZ] * away[2];
  const double push = impact_push(torn, s->sph->c0, -along / sqrt(size2));
  for (int d = 0; d < 3; d++) sum->a[d] += push * away[d];
}

/* A neighbour of nothing: its pair terms are zero because it coincides with `me`, and for walls has no mass or volume.
 */
PAIR_INLINE void wall_filler(const double *me, double filler[RECORD_SIZE])
{
  for (int f = 0; f < RECORD_SIZE; f++) filler[f] = f <= REC_Z ? me[f] : 0.0;
}

PAIR_INLINE void sweep_rows(const Sweep *s, KernelKind kernel, SweepTasks tasks, bool periodic, ptrdiff_t first,
                            ptrdiff_t end)
{
  Particles *p = s->p;
  const PairList *fluid = s->fluid_fluid, *wall = s->fluid_wall;
  Block block;
  for (ptrdiff_t i = first; i < end; i++) {
    const double *me = p->record + i * RECORD_SIZE;
    const Self self = {me, p->rho[i]};
    Rates sum = {0};
    for (ptrdiff_t k = fluid->start[i]; k < fluid->start[i + 1]; k += BLOCK_PAIRS) {
      const ptrdiff_t left = fluid->start[i + 1] - k;
      const ptrdiff_t n = block_fill(&block, p->record, fluid->index + k, left < BLOCK_PAIRS ? left : BLOCK_PAIRS, me);
      fluid_pairs(s, kernel, tasks, periodic, &self, &block, n, &sum);
    }
    if (tasks.heat) p->heat[i] = sum.heat;
    if (!tasks.flow) continue;
    double filler[RECORD_SIZE];
    if (wall->start[i] < wall->start[i + 1]) wall_filler(me, filler);
    for (ptrdiff_t k = wall->start[i]; k < wall->start[i + 1]; k += BLOCK_PAIRS) {
      const ptrdiff_t left = wall->start[i + 1] - k;
      const ptrdiff_t n =
          block_fill(&block, p->record, wall->index + k, left < BLOCK_PAIRS ? left : BLOCK_PAIRS, filler);
      wall_pairs(s, kernel, periodic, &self, &block, n, &sum);
    }
    stop_torn(s, &self, &sum);
    p->drho[i] = s->sph->density == SPH_CONTINUITY ? sum.drho : 0.0;
    for (int d = 0; d < 3; d++) p->a[d][i] = sum.a[d] + s->scale.body[d];
  }
}

typedef void (*SweepRows)(const Sweep *s, SweepTasks tasks, ptrdiff_t first, ptrdiff_t end);

/* What runs call is compiled once for each kernel, with nothing left to decide in the loop over pairs. */
SIMD_CLONES static void rates_wendland(const Sweep *s, SweepTasks tasks, ptrdiff_t first, ptrdiff_t end)
{
  (void)tasks;
  sweep_rows(s, KERNEL_WENDLAND_C2, (SweepTasks){true, true}, false, first, end);
}

SIMD_CLONES static void rates_cubic(const Sweep *s, SweepTasks tasks, ptrdiff_t first, ptrdiff_t end)
{
  (void)tasks;
  sweep_rows(s, KERNEL_CUBIC_SPLINE, (SweepTasks){true, true}, false, first, end);
}

SIMD_CLONES static void rates_quintic(const Sweep *s, SweepTasks tasks, ptrdiff_t first, ptrdiff_t end)
{
  (void)tasks;
  sweep_rows(s, KERNEL_QUINTIC_SPLINE, (SweepTasks){true, true}, false, first, end);
}

SIMD_CLONES static void rates_lucy(const Sweep *s, SweepTasks tasks, ptrdiff_t first, ptrdiff_t end)
{
  (void)tasks;
  sweep_rows(s, KERNEL_LUCY, (SweepTasks){true, true}, false, first, end);
}

SIMD_CLONES static void rates_wendland_periodic(const Sweep *s, SweepTasks tasks, ptrdiff_t first, ptrdiff_t end)
{
  (void)tasks;
  sweep_rows(s, KERNEL_WENDLAND_C2, (SweepTasks){true, true}, true, first, end);
}

/* Anything else decides as it goes. */
static void rates_any(const Sweep *s, SweepTasks tasks, ptrdiff_t first, ptrdiff_t end)
{
  sweep_rows(s, s->sph->kernel, tasks, s->periodic, first, end);
}

static SweepRows choose_rows(const Sweep *s, SweepTasks tasks)
{
  if (!tasks.flow || !tasks.heat) return rates_any;
  if (s->periodic) return s->sph->kernel == KERNEL_WENDLAND_C2 ? rates_wendland_periodic : rates_any;
  switch (s->sph->kernel) {
  case KERNEL_CUBIC_SPLINE:
    return rates_cubic;
  case KERNEL_QUINTIC_SPLINE:
    return rates_quintic;
  case KERNEL_LUCY:
    return rates_lucy;
  case KERNEL_WENDLAND_C2:
  default:
    return rates_wendland;
  }
}

void sweep_fluid(const Sweep *s, SweepTasks tasks)
{
  const SweepRows rows = choose_rows(s, tasks);
  const ptrdiff_t n = s->p->n_fluid;
#pragma omp parallel for schedule(dynamic)
  for (ptrdiff_t first = 0; first < n; first += ROWS_PER_TASK)
    rows(s, tasks, first, first + ROWS_PER_TASK < n ? first + ROWS_PER_TASK : n);
}

/* rho_i = sum_j m_j W_ij, the particle itself included; walls count as melt of density rho0    (eq. 13, second form) */
void sweep_sum_density(const Sweep *s)
{
  Particles *p = s->p;
  const SweepScales *c = &s->scale;
  const KernelKind kernel = s->sph->kernel;
#pragma omp parallel for schedule(dynamic, ROWS_PER_TASK)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const PairList *const lists[2] = {s->fluid_fluid, s->fluid_wall};
    double sum = p->mass[i] * shape_value(kernel, 0.0);
    for (int l = 0; l < 2; l++)
      for (ptrdiff_t k = lists[l]->start[i]; k < lists[l]->start[i + 1]; k++) {
        const int32_t j = lists[l]->index[k];
        double r2 = 0.0;
        for (int d = 0; d < 3; d++) {
          const double distance = nearest_image(c, d, p->x[d][i] - p->x[d][j]);
          r2 += distance * distance;
        }
        const double mass = j < p->n_fluid ? p->mass[j] : s->sph->rho0 * p->volume[j];
        sum += mass * shape_value(kernel, sqrt(r2) * c->per_h);
      }
    p->rho[i] = c->value * sum;
  }
}
