/* Method      continuum surface force on one phase, in four passes over fluid rows: fill and its gradient; curvature by
 *             least squares over normals of surface particles only; curvature spread to all near them; force.
 *             Interior disorder makes normals that mean nothing, so neither curvature nor contact line take them.
 * References  Brackbill, Kothe & Zemach 1992, J. Comput. Phys. 100; Morris 2000, Int. J. Numer. Methods Fluids 33;
 *             docs/theory, Surface tension */
#include "cast/physics/tension.h"

#include <stdlib.h>

#include "cast/kernel/interface.h"
#include "common/vector.h"

enum { ROWS_PER_TASK = 128 };
static const double surface_low = 0.3; // of the gradient at a flat surface: curvature is measured above
static const double line_low = 0.1;    // the same for the contact line
static const double near_wall = 0.2;   // filled by walls: half a spacing from a flat one
static const double least_open = 0.3;  // what divides the fill; a particle on a wall has 0.5

typedef struct Near { // of one particle
  double normal[3];   // unit, into the melt
  double gradient;    // 1/m, size of the fill's gradient
  double wall[3];     // 1/m, gradient of what walls fill
  double walls;       // what walls fill
  double share;       // how surely at the surface, 0 to 1
  double measured;    // 1/m, curvature at the particle
} Near;

struct Tension {
  KernelKind kernel;
  double h, slope, value; // m, 1/m5, 1/m3
  const Table *sigma;
  double cos_theta, sigma_most;
  double flat;   // 1/m, gradient at a flat surface
  double radius; // m, mean radius of the kernel
  double depth;  // m, mean depth of particles whose curvature is measured
  double line;   // makes up for what line_low leaves out
  Near *near;
  ptrdiff_t capacity;
};

/* ---- constants of the kernel ---- */

/* g(z) = 2 pi int_z W r dr, the gradient of the fill z below a flat surface */
static double flat_gradient(const Tension *t, double z)
{
  enum { PARTS = 200 };
  const double step = (kernel_support(t->kernel) * t->h - z) / PARTS;
  double sum = 0.0;
  for (int k = 0; k < PARTS; k++) {
    const double r = z + (k + 0.5) * step;
    sum += r * kernel_value(t->kernel, r, t->h) * step;
  }
  return 2.0 * pair_pi * sum;
}

static void set_constants(Tension *t)
{
  enum { PARTS = 400 };
  const double step = kernel_support(t->kernel) * t->h / PARTS;
  double all = 0.0, line = 0.0, depth = 0.0, share = 0.0;
  t->flat = flat_gradient(t, 0.0);
  for (int k = 0; k < PARTS; k++) {
    const double z = (k + 0.5) * step, g = flat_gradient(t, z), w = interface_share(g / t->flat, surface_low);
    t->radius += 4.0 * pair_pi * z * z * z * kernel_value(t->kernel, z, t->h) * step;
    all += g;
    line += g * interface_share(g / t->flat, line_low);
    depth += w * z;
    share += w;
  }
  t->line = all / line;
  t->depth = depth / share;
}

CastStatus tension_create(KernelKind kernel, double h, const Table *sigma, double contact_angle, Tension **tension,
                          CastError *err)
{
  Tension *t = *tension = calloc(1, sizeof *t);
  CAST_CHECK(t, err, CAST_ERR_MEMORY, "no memory");
  t->kernel = kernel;
  t->h = h;
  t->slope = shape_norm(kernel) / (h * h * h * h * h);
  t->value = shape_norm(kernel) / (h * h * h);
  t->sigma = sigma;
  t->cos_theta = cos(contact_angle);
  for (size_t k = 0; k < sigma->n; k++) t->sigma_most = fmax(t->sigma_most, sigma->y[k]);
  set_constants(t);
  return CAST_OK;
}

void tension_destroy(Tension **tension)
{
  if (!tension || !*tension) return;
  free((*tension)->near);
  free(*tension);
  *tension = NULL;
}

double tension_step(const Tension *t, double rho)
{
  return 0.25 * sqrt(rho * t->h * t->h * t->h / (2.0 * pair_pi * t->sigma_most));
}

/* ---- passes ---- */

typedef struct Pass {
  const Tension *t;
  Particles *p;
  const PairList *fluid, *wall;
  const double *period;
} Pass;

/* d = x_i - x_j of the nearest image; returns r in h, or a number beyond the support. */
static double offset(const Pass *s, ptrdiff_t i, ptrdiff_t j, double d[3])
{
  return sqrt(particles_offset(s->p, i, j, s->period, d)) / s->t->h;
}

/* Sum of V_j W_ij to *fill, of V_j grad W_ij to `gradient`. */
static void add_fill(const Pass *s, ptrdiff_t i, const PairList *list, double *fill, double gradient[3])
{
  const Tension *t = s->t;
  for (ptrdiff_t k = list->start[i]; k < list->start[i + 1]; k++) {
    const int32_t j = list->index[k];
    double d[3];
    const double q = offset(s, i, j, d), volume = s->p->volume[j];
    const double F = volume * t->slope * shape_slope(t->kernel, q);
    *fill += volume * t->value * shape_value(t->kernel, q);
    for (int a = 0; a < 3; a++) gradient[a] -= F * d[a];
  }
}

/* Unit, away from the wall; false where there is none. */
static bool wall_normal(const Near *n, double flat, double away[3])
{
  const double size = sqrt(vec_dot(n->wall, n->wall));
  for (int a = 0; a < 3; a++) away[a] = size > 0.0 ? -n->wall[a] / size : 0.0;
  return size > 1e-3 * flat;
}

/* Close to a wall the fill's gradient leans away from it, since a kernel round a corner of melt, wall and air is no
 * product of two: half of the part across the wall is left out there. */
static void lean_back(const Tension *t, Near *n)
{
  double away[3];
  if (!wall_normal(n, t->flat, away)) return;
  const double across = vec_dot(n->normal, away), close = 0.5 * fmin(1.0, n->walls / near_wall);
  double tangent[3];
  for (int a = 0; a < 3; a++) tangent[a] = n->normal[a] - across * away[a];
  const double size = sqrt(vec_dot(tangent, tangent));
  if (size < 0.1) return; // a surface along the wall has no contact line
  for (int a = 0; a < 3; a++) n->normal[a] = (1.0 - close) * n->normal[a] + close * tangent[a] / size;
  const double length = sqrt(vec_dot(n->normal, n->normal));
  for (int a = 0; a < 3; a++) n->normal[a] /= length;
}

static void find_normal(const Pass *s, ptrdiff_t i)
{
  const Tension *t = s->t;
  Near *n = &t->near[i];
  double fill = s->p->volume[i] * t->value * shape_value(t->kernel, 0.0), gradient[3] = {0};
  *n = (Near){.gradient = 0.0};
  add_fill(s, i, s->fluid, &fill, gradient);
  add_fill(s, i, s->wall, &n->walls, n->wall);
  const double open = fmax(1.0 - n->walls, least_open), part = fmin(1.0, fill / open);
  for (int a = 0; a < 3; a++) gradient[a] = (gradient[a] + part * n->wall[a]) / open; // of fill/(1 - walls)
  n->gradient = sqrt(vec_dot(gradient, gradient));
  n->share = interface_share(n->gradient / t->flat, surface_low);
  for (int a = 0; a < 3; a++) n->normal[a] = n->gradient > 0.0 ? gradient[a] / n->gradient : 0.0;
  lean_back(t, n);
}

/* The melt continued behind the wall meets it at a right angle: across the wall the normal changes its sign. */
static void add_mirror(const Pass *s, ptrdiff_t i, InterfaceSums *sums)
{
  const Tension *t = s->t;
  const Near *n = &t->near[i];
  double away[3], turn = 0.0, square = 0.0;
  if (!wall_normal(n, t->flat, away)) return;
  for (ptrdiff_t k = s->wall->start[i]; k < s->wall->start[i + 1]; k++) {
    const int32_t j = s->wall->index[k];
    double d[3];
    const double F = s->p->volume[j] * t->slope * shape_slope(t->kernel, offset(s, i, j, d)), depth = vec_dot(d, away);
    turn += F * 2.0 * vec_dot(n->normal, away) * depth;
    square += F * depth * depth;
  }
  for (int a = 0, q = 0; a < 3; a++) {
    for (int b = 0; b < 3; b++) sums->G[a][b] += turn * away[a] * away[b];
    for (int b = a; b < 3; b++, q++) sums->M[q] += square * away[a] * away[b];
  }
}

static void find_curvature(const Pass *s, ptrdiff_t i)
{
  const Tension *t = s->t;
  Near *n = &t->near[i];
  if (n->share <= 0.0) return;
  InterfaceSums sums = {.M = {0.0}};
  for (ptrdiff_t k = s->fluid->start[i]; k < s->fluid->start[i + 1]; k++) {
    const int32_t j = s->fluid->index[k];
    const Near *m = &t->near[j];
    if (m->share <= 0.0) continue;
    double d[3];
    const double F = m->share * s->p->volume[j] * t->slope * shape_slope(t->kernel, offset(s, i, j, d));
    for (int a = 0, q = 0; a < 3; a++) {
      for (int b = 0; b < 3; b++) sums.G[a][b] += F * (n->normal[a] - m->normal[a]) * d[b];
      for (int b = a; b < 3; b++, q++) sums.M[q] += F * d[a] * d[b];
    }
  }
  add_mirror(s, i, &sums);
  const double most = 1.5 / t->h, k = interface_at_surface(interface_shape(&sums), t->depth, t->radius);
  n->measured = fmax(-most, fmin(most, k));
}

/* Curvature at particle i: the mean of what was measured near it; 0 where nothing was. */
static double spread_curvature(const Pass *s, ptrdiff_t i)
{
  const Tension *t = s->t;
  double weight = t->near[i].share * shape_value(t->kernel, 0.0) * shape_value(t->kernel, 0.0),
         sum = weight * t->near[i].measured;
  for (ptrdiff_t k = s->fluid->start[i]; k < s->fluid->start[i + 1]; k++) {
    const int32_t j = s->fluid->index[k];
    if (t->near[j].share <= 0.0) continue;
    double d[3];
    const double W = shape_value(t->kernel, offset(s, i, j, d)), w = t->near[j].share * W * W;
    sum += w * t->near[j].measured;
    weight += w;
  }
  return weight > 0.0 ? sum / weight : 0.0;
}

static void push(const Pass *s, ptrdiff_t i)
{
  const Tension *t = s->t;
  const Near *n = &t->near[i];
  const double sigma = table_evaluate(t->sigma, s->p->T[i]), curvature = spread_curvature(s, i);
  double away[3], force[3]; // N/m3
  const bool at_wall = wall_normal(n, t->flat, away);
  const double line = -4.0 * sigma * t->cos_theta * sqrt(vec_dot(n->wall, n->wall)) * n->gradient * t->line *
                      interface_share(n->gradient / t->flat, line_low);
  const double across = vec_dot(n->normal, away);
  for (int a = 0; a < 3; a++)
    force[a] = 2.0 * sigma * curvature * n->gradient * n->normal[a] + line * (n->normal[a] - across * away[a]);
  // what pushes a particle at the wall into it or off it is the wall's to bear
  const double borne = at_wall ? fmin(1.0, n->walls / near_wall) * vec_dot(force, away) : 0.0;
  for (int a = 0; a < 3; a++) s->p->a[a][i] += (force[a] - borne * away[a]) * s->p->volume[i] / s->p->mass[i];
}

CastStatus tension_push(Tension *t, Particles *p, const Neighbours *neighbours, CastError *err)
{
  if (t->capacity < p->n_fluid) {
    free(t->near);
    t->near = malloc((size_t)p->n_fluid * sizeof *t->near);
    t->capacity = t->near ? p->n_fluid : 0;
    CAST_CHECK(t->near, err, CAST_ERR_MEMORY, "no memory for the surface tension of %td particles", p->n_fluid);
  }
  const Pass s = {t, p, neighbours_fluid_fluid(neighbours), neighbours_fluid_wall(neighbours),
                  neighbours_period(neighbours)};
#pragma omp parallel
  {
#pragma omp for schedule(dynamic, ROWS_PER_TASK)
    for (ptrdiff_t i = 0; i < p->n_fluid; i++) find_normal(&s, i);
#pragma omp for schedule(dynamic, ROWS_PER_TASK)
    for (ptrdiff_t i = 0; i < p->n_fluid; i++) find_curvature(&s, i);
#pragma omp for schedule(dynamic, ROWS_PER_TASK)
    for (ptrdiff_t i = 0; i < p->n_fluid; i++) push(&s, i);
  }
  return CAST_OK;
}
