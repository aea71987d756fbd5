/* Sums over pairs in double precision, one pair after the other: what the fast form is tested against, and what takes
 * flow or heat alone (conduction in melt that stands still). Formulas cast/kernel/pair.h; docs/theory, eq. 13-16 */
#include "cast/physics/flow.h"

enum { ROWS_PER_TASK = 128 };

/* The nearest image of a distance; periods of zero leave it alone. */
static double nearest_image(const SweepScales *scale, int axis, double d)
{
  return d - scale->period[axis] * floor(d * scale->per_period[axis] + 0.5);
}

typedef struct Pair {
  double d[3], u[3], r2, u_dot_d, F;
} Pair;

/* u: towards the velocity given, of j or of a wall. */
static Pair measure(const Sweep *s, ptrdiff_t i, ptrdiff_t j, double *const v_j[3], ptrdiff_t at)
{
  const Particles *p = s->p;
  Pair pair = {.r2 = 0.0};
  for (int axis = 0; axis < 3; axis++) {
    pair.d[axis] = nearest_image(&s->scale, axis, p->x[axis][i] - p->x[axis][j]);
    pair.u[axis] = p->v[axis][i] - v_j[axis][at];
    pair.r2 += pair.d[axis] * pair.d[axis];
    pair.u_dot_d += pair.u[axis] * pair.d[axis];
  }
  pair.F = s->scale.slope * shape_slope(s->sph->kernel, sqrt(pair.r2) * s->scale.per_h);
  return pair;
}

static double whole(const Sweep *s, ptrdiff_t i)
{
  return whole_density(s->p->rho[i], s->sph->rho0);
}

static double eta(const Sweep *s, ptrdiff_t i)
{
  const double *g = s->scale.held;
  const double x = s->p->x[0][i], y = s->p->x[1][i], z = s->p->x[2][i];
  const double held = g[0] * x + g[1] * y + g[2] * z + spin_potential(&s->sph->spin, x, y, z);
  return diffused_density(whole(s, i), s->sph->rho0, s->sph->c0, s->sph->gamma, held);
}

static double per_sum(double a, double b)
{
  return 1.0 / (a + b + 2.0 * SWEEP_TINY);
}

static void add_fluid(const Sweep *s, SweepTasks tasks, ptrdiff_t i, ptrdiff_t j, Rates *sum)
{
  const SweepScales *c = &s->scale;
  const Particles *p = s->p;
  const Pair pair = measure(s, i, j, p->v, j);
  const double volumes = p->volume[i] * p->volume[j], masses = c->mass * c->mass;
  if (tasks.heat)
    sum->heat +=
        pair_heat(volumes, p->kappa[i], p->kappa[j], per_sum(p->kappa[i], p->kappa[j]), p->T[i], p->T[j], pair.F);
  if (!tasks.flow) return;
  const double P_i = p->p[i] / (whole(s, i) * whole(s, i)), P_j = p->p[j] / (whole(s, j) * whole(s, j));
  const double artificial = pair_artificial(c->artificial, pair.u_dot_d, 1.0 / (pair.r2 + c->soften));
  const double apart = pair_apart(c->apart, sqrt(pair.r2) * c->per_h, c->per_q_apart);
  const double push = pair_pressure(masses, P_i, P_j, artificial + apart, pair.F);
  const double drag = pair_viscosity(volumes, p->mu[i], p->mu[j], per_sum(p->mu[i], p->mu[j]), pair.F);
  sum->drho += (pair_continuity(p->rho[i], volumes, pair.u_dot_d, pair.F) +
                pair_diffusion(volumes, c->diffusion, eta(s, i), eta(s, j), pair.F)) /
               p->volume[i];
  for (int axis = 0; axis < 3; axis++) sum->a[axis] += (push * pair.d[axis] - drag * pair.u[axis]) / c->mass;
}

static void add_wall(const Sweep *s, ptrdiff_t i, ptrdiff_t j, Rates *sum)
{
  const Particles *p = s->p;
  const Pair stuck = measure(s, i, j, p->v, j), moved = measure(s, i, j, p->wall_v, j - p->n_fluid);
  const double volumes = p->volume[i] * p->volume[j], F = stuck.F;
  const double P_i = p->p[i] / (whole(s, i) * whole(s, i)), P_wall = p->p[j] / (p->rho[j] * p->rho[j]);
  const double push =
      pair_wall_pressure(s->scale.mass * (p->rho[j] * p->volume[j]), P_i, P_wall, s->scale.wall_least, F);
  const double drag = pair_viscosity(volumes, p->mu[i], p->mu[i], per_sum(p->mu[i], p->mu[i]), F);
  sum->drho += pair_continuity(p->rho[i], volumes, moved.u_dot_d, F) / p->volume[i];
  for (int axis = 0; axis < 3; axis++) {
    sum->a[axis] += (push * stuck.d[axis] - drag * stuck.u[axis]) / s->scale.mass;
    sum->away[axis] += p->volume[j] * F * stuck.d[axis];
  }
}

void sweep_fluid_plain(const Sweep *s, SweepTasks tasks)
{
  Particles *p = s->p;
#pragma omp parallel for schedule(dynamic, ROWS_PER_TASK)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const PairList *fluid = s->fluid_fluid, *wall = s->fluid_wall;
    Rates sum = {0};
    for (ptrdiff_t k = fluid->start[i]; k < pair_list_end(fluid, i); k++) add_fluid(s, tasks, i, fluid->index[k], &sum);
    if (tasks.heat) p->heat[i] = sum.heat;
    if (!tasks.flow) continue;
    for (ptrdiff_t k = wall->start[i]; k < pair_list_end(wall, i); k++) add_wall(s, i, wall->index[k], &sum);
    set_flow(s, i, &sum);
  }
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
      for (ptrdiff_t k = lists[l]->start[i]; k < pair_list_end(lists[l], i); k++) {
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
