/* Method      continuum surface force on one phase, in three passes over fluid rows: fill, its gradients and the stress
 *             of surfaces; curvature by least squares over normals of surface particles and, where walls are near, the
 *             stress's divergence; curvature from what is near of both, and force. Interior disorder makes normals that
 *             mean nothing, so curvature does not take them.
 * References  Brackbill, Kothe & Zemach 1992, J. Comput. Phys. 100; Morris 2000, Int. J. Numer. Methods Fluids 33; Hu &
 *             Adams 2006, J. Comput. Phys. 213 (stress at contact lines); docs/theory, Surface tension */
#include "cast/physics/tension.h"

#include <stdlib.h>

#include "cast/kernel/interface.h"
#include "cast/physics/surface_scales.h"
#include "cast/physics/wedge.h"
#include "common/vector.h"

enum { ROWS_PER_TASK = 128 };
static const double least_along = 0.1;    // of the normal: less of it along the wall is no contact line
static const double most_across = 0.99;   // of the normal across the wall
static const double least_open = 0.3;     // what divides the fill; a particle on a wall has 0.5
static const double pooled_low = 0.05;    // of the flat gradient: forces are pooled above
static const double little_wall = 1e-3;   // of the kernel: walls nearer than that are near
static const double little_facing = 1e-3; // of the flat gradient: walls of more hold melt across themselves
static const double little_push = 0.05;   // of a flat surface's: less has no direction

typedef struct Angle { // at which melt meets walls
  double cos_theta;
  Wedge *wedge;
} Angle;

typedef struct Near { // of one particle; what neighbours look at first stands first
  bool counts;        // has a curvature or a force
  bool acts;          // has a stress, a normal, or walls near
  double share;       // how surely at the surface, 0 to 1
  double measured;    // 1/m, curvature at the particle by least squares
  double wet;         // how near walls are, 0 to 1
  double force[3];    // N, along the wall where there is one
  double push[3];     // N m, the same by a curvature of 1 1/m
  double walls;       // what walls fill
  double normal[3];   // unit, into the melt
  double stress[6];   // N/m2, xx, xy, xz, yy, yz, zz: of the free surface and of that on the wall
  double melt[3];     // 1/m, gradient of what melt fills
  double wall[3];     // 1/m, gradient of what walls fill
  double facing[6];   // 1/m, of each wall's part of it, across itself: sum of g a a over walls of normals a
  double weight;      // m3, with which forces are pooled
  double fill;        // what melt fills
} Near;

struct Tension {
  KernelKind kernel;
  double h, slope, value; // m, 1/m5, 1/m3
  double per_h, reach2;   // 1/m, m2
  const Table *sigma;
  double sigma_most;
  SurfaceScales scale;
  Angle *angle; // [n_angles], the first on all patches but those below
  size_t n_angles, n_patches;
  const Angle **of_patch; // [n_patches]; NULL: one angle for all
  Near *near;
  ptrdiff_t capacity;
};

/* Behind those there are. */
static CastStatus add_angles(Tension *t, size_t n, const double *theta, CastError *err)
{
  Angle *more = realloc(t->angle, (t->n_angles + n) * sizeof *more);
  CAST_CHECK(more, err, CAST_ERR_MEMORY, "no memory for %zu contact angles", t->n_angles + n);
  t->angle = more;
  for (size_t k = 0; k < n; k++) {
    Angle *angle = &t->angle[t->n_angles];
    *angle = (Angle){.cos_theta = cos(theta[k])};
    CAST_CALL(wedge_create(t->kernel, theta[k], &angle->wedge, err));
    t->n_angles++;
  }
  return CAST_OK;
}

CastStatus tension_create(KernelKind kernel, double h, double spacing, const Table *sigma, double contact_angle,
                          Tension **tension, CastError *err)
{
  Tension *t = *tension = calloc(1, sizeof *t);
  CAST_CHECK(t, err, CAST_ERR_MEMORY, "no memory");
  t->kernel = kernel;
  t->h = h;
  t->slope = shape_norm(kernel) / (h * h * h * h * h);
  t->value = shape_norm(kernel) / (h * h * h);
  t->per_h = 1.0 / h;
  t->reach2 = kernel_support(kernel) * h * kernel_support(kernel) * h;
  t->sigma = sigma;
  for (size_t k = 0; k < sigma->n; k++) t->sigma_most = fmax(t->sigma_most, sigma->y[k]);
  t->scale = surface_scales(kernel, h, spacing);
  return add_angles(t, 1, &contact_angle, err);
}

CastStatus tension_set_angles(Tension *t, size_t n, const double *angle, size_t patches, const int32_t *of_patch,
                              CastError *err)
{
  CAST_CALL(add_angles(t, n, angle, err));
  t->of_patch = calloc(patches ? patches : 1, sizeof *t->of_patch);
  CAST_CHECK(t->of_patch, err, CAST_ERR_MEMORY, "no memory for the contact angles of %zu patches", patches);
  t->n_patches = patches;
  for (size_t l = 0; l < patches; l++) t->of_patch[l] = &t->angle[of_patch[l] + 1];
  return CAST_OK;
}

void tension_destroy(Tension **tension)
{
  if (!tension || !*tension) return;
  for (size_t k = 0; k < (*tension)->n_angles; k++) wedge_destroy(&(*tension)->angle[k].wedge);
  free((*tension)->angle);
  free((*tension)->of_patch);
  free((*tension)->near);
  free(*tension);
  *tension = NULL;
}

double tension_step(const Tension *t, double rho)
{
  return 0.25 * sqrt(rho * t->h * t->h * t->h / (2.0 * pair_pi * t->sigma_most));
}

double tension_wall_pull(const Tension *t)
{
  return 1.5 * t->sigma_most / t->h;
}

/* ---- passes ---- */

typedef struct Pass {
  const Tension *t;
  Particles *p;
  const PairList *fluid, *wall;
  const double *period;
} Pass;

/* d = x_i - x_j of the nearest image and r in h; false beyond the support. */
static inline bool offset(const Pass *s, ptrdiff_t i, ptrdiff_t j, double d[3], double *q)
{
  const double r2 = particles_offset(s->p, i, j, s->period, d);
  if (r2 >= s->t->reach2) return false;
  *q = sqrt(r2) * s->t->per_h;
  return true;
}

/* Sum of V_j W_ij to *fill, of V_j grad W_ij to `gradient`. */
static void add_fill(const Pass *s, ptrdiff_t i, const PairList *list, double *fill, double gradient[3])
{
  const Tension *t = s->t;
  for (ptrdiff_t k = list->start[i]; k < pair_list_end(list, i); k++) {
    const int32_t j = list->index[k];
    double d[3], q;
    if (!offset(s, i, j, d, &q)) continue;
    const double volume = s->p->volume[j], F = volume * t->slope * shape_slope(t->kernel, q);
    *fill += volume * t->value * shape_value(t->kernel, q);
    for (int a = 0; a < 3; a++) gradient[a] -= F * d[a];
  }
}

/* Sum of g a a over the walls, each of the normal a, whose parts of the gradient are g: of one flat wall |grad| a a; in
 * a corner walls add up, which the gradient, a vector, does not. */
static void add_facing(const Pass *s, ptrdiff_t i, double facing[6])
{
  const Tension *t = s->t;
  const Particles *p = s->p;
  for (ptrdiff_t k = s->wall->start[i]; k < pair_list_end(s->wall, i); k++) {
    const ptrdiff_t j = s->wall->index[k], w = j - p->n_fluid;
    const double a[3] = {p->normal[0][w], p->normal[1][w], p->normal[2][w]};
    double d[3], q;
    if (!offset(s, i, j, d, &q)) continue;
    const double g = p->volume[j] * t->slope * shape_slope(t->kernel, q) * vec_dot(d, a);
    for (int b = 0, e = 0; b < 3; b++)
      for (int c = b; c < 3; c++, e++) facing[e] += g * a[b] * a[c];
  }
}

/* The angle at the wall particle whose foot is nearest to particle i. */
static const Angle *nearest_angle(const Pass *s, ptrdiff_t i)
{
  const Tension *t = s->t;
  const Particles *p = s->p;
  const Angle *angle = t->angle;
  double least = INFINITY;
  if (!t->of_patch) return angle;
  for (ptrdiff_t k = s->wall->start[i]; k < s->wall->start[i + 1]; k++) {
    const ptrdiff_t w = s->wall->index[k] - p->n_fluid;
    double r2 = 0.0;
    for (int a = 0; a < 3; a++) {
      const double d = particles_image(p->x[a][i] - p->foot[a][w], s->period[a]);
      r2 += d * d;
    }
    if (r2 >= least) continue;
    const size_t l = (size_t)p->patch[w];
    least = r2;
    angle = l < t->n_patches ? t->of_patch[l] : t->angle;
  }
  return angle;
}

/* Unit, away from the wall; false where there is none. */
static bool wall_normal(const Near *n, double flat, double away[3])
{
  const double size = sqrt(vec_dot(n->wall, n->wall));
  for (int a = 0; a < 3; a++) away[a] = size > 0.0 ? -n->wall[a] / size : 0.0;
  return size > 1e-3 * flat;
}

/* Unit, along the wall from air to melt; false where the surface lies along the wall and has no contact line. */
static bool along_wall(const Near *n, const double away[3], double along[3])
{
  vec_axpy(-vec_dot(n->normal, away), away, n->normal, along);
  return vec_normalise(along) > least_along;
}

/* Turn the normal to what it would be with melt behind the wall too, under the same plane. Returns how much steeper the
 * gradient would be. */
static double see_behind_wall(const Tension *t, Near *n, const Angle *angle, double part)
{
  double away[3], along[3];
  if (!wall_normal(n, t->scale.flat, away) || !along_wall(n, away, along)) return 1.0;
  const WedgePlace at = wedge_look(angle->wedge, n->walls, part);
  const double across = fmax(-most_across, fmin(most_across, vec_dot(n->normal, away) + at.lean)),
               beside = sqrt(1.0 - across * across);
  for (int a = 0; a < 3; a++) n->normal[a] = across * away[a] + beside * along[a];
  return at.raise;
}

/* Of the free surface, and on each wall of -sigma cos(theta), what the wet wall costs more than the dry one, so much
 * more as pairs see less of the kernel there. */
static void find_stress(const Tension *t, Near *n, const Angle *angle, double sigma, double gradient)
{
  const double *facing = n->facing, wall = facing[0] + facing[3] + facing[5],
               wet = -sigma * angle->cos_theta * t->scale.wet / fmax(1.0 - n->walls, least_open);
  interface_add_stress(sigma * t->scale.free * interface_stress(gradient / t->scale.flat), n->normal, n->stress);
  for (int e = 0; e < 6; e++) n->stress[e] += wet * ((e == 0 || e == 3 || e == 5 ? wall : 0.0) - facing[e]);
}

static void find_normal(const Pass *s, ptrdiff_t i)
{
  const Tension *t = s->t;
  Near *n = &t->near[i];
  const Angle *angle = nearest_angle(s, i);
  double fill = s->p->volume[i] * t->value * shape_value(t->kernel, 0.0), gradient[3] = {0};
  *n = (Near){.share = 0.0};
  add_fill(s, i, s->fluid, &fill, gradient);
  vec_copy(gradient, n->melt);
  add_fill(s, i, s->wall, &n->walls, n->wall);
  if (n->walls > 0.0) add_facing(s, i, n->facing);
  const double open = fmax(1.0 - n->walls, least_open), part = fmin(1.0, fill / open);
  for (int a = 0; a < 3; a++) gradient[a] = (gradient[a] + part * n->wall[a]) / open; // of fill/(1 - walls)
  vec_copy(gradient, n->normal);
  const double size = vec_normalise(n->normal) * see_behind_wall(t, n, angle, part);
  n->share = interface_share(size / t->scale.flat, interface_measured_low);
  find_stress(t, n, angle, table_evaluate(t->sigma, s->p->T[i]), size);
  double push[3];
  vec_axpy(1.0, n->wall, n->melt, push);
  n->fill = fill;
  n->weight = s->p->volume[i] * interface_share(vec_norm(push) / t->scale.flat, pooled_low);
  n->counts = n->share > 0.0 || n->weight > 0.0;
  n->acts = n->counts || n->walls > 0.0 || size > interface_stress_low * t->scale.flat;
}

typedef struct Sums {
  InterfaceSums surface;
  double force[3]; // N/m3, divergence of the stress
  double walls;    // what walls fill of the kernel where melt is
} Sums;

static Sums sum_pairs(const Pass *s, ptrdiff_t i)
{
  const Tension *t = s->t;
  const Near *n = &t->near[i];
  Sums sums = {.walls = n->walls * s->p->volume[i] * t->value * shape_value(t->kernel, 0.0)};
  interface_times_stress(n->stress, n->melt, sums.force);
  for (ptrdiff_t k = s->fluid->start[i]; k < pair_list_end(s->fluid, i); k++) {
    const int32_t j = s->fluid->index[k];
    const Near *m = &t->near[j];
    if (!m->acts) continue;
    double d[3], pulled[3], q;
    if (!offset(s, i, j, d, &q)) continue;
    const double F = s->p->volume[j] * t->slope * shape_slope(t->kernel, q);
    interface_times_stress(m->stress, d, pulled);
    vec_axpy(-F, pulled, sums.force, sums.force);
    sums.walls += m->walls * s->p->volume[j] * t->value * shape_value(t->kernel, q);
    const double w = n->share * m->share * F;
    if (w <= 0.0) continue;
    for (int a = 0, c = 0; a < 3; a++) {
      for (int b = 0; b < 3; b++) sums.surface.G[a][b] += m->share * F * (n->normal[a] - m->normal[a]) * d[b];
      for (int b = a; b < 3; b++, c++) sums.surface.M[c] += m->share * F * d[a] * d[b];
    }
  }
  return sums;
}

static void find_force(const Pass *s, ptrdiff_t i)
{
  const Tension *t = s->t;
  Near *n = &t->near[i];
  if (!n->counts) return;
  const Sums sums = sum_pairs(s, i);
  const double most = 1.5 / t->h, sigma = table_evaluate(t->sigma, s->p->T[i]);
  if (n->share > 0.0)
    n->measured =
        fmax(-most, fmin(most, interface_at_surface(interface_shape(&sums.surface), t->scale.depth, t->scale.radius)));
  n->wet = sums.walls / (sums.walls + little_wall);
  double keep[6], both[3], force[3], push[3];
  vec_axpy(1.0, n->wall, n->melt, both);
  interface_along_walls(n->facing, little_facing * t->scale.flat, keep);
  interface_times_stress(keep, sums.force, force);
  interface_times_stress(keep, both, push);
  const double open = fmax(1.0 - n->walls, least_open);
  for (int a = 0; a < 3; a++) {
    n->push[a] = n->weight * 2.0 * sigma * push[a] / open;
    n->force[a] = n->wet * n->weight * force[a] + (1.0 - n->wet) * n->measured * n->push[a];
  }
}

typedef struct Pool {
  double weight, measured;                // of the curvature by least squares, away from walls
  double surface, wet, force[3], push[3]; // of all at the surface
} Pool;

static void pool(const Pass *s, ptrdiff_t j, double q, Pool *pool)
{
  const Near *m = &s->t->near[j];
  const double W = shape_value(s->t->kernel, q), free = m->share * W * W * (1.0 - m->wet);
  pool->weight += free;
  pool->measured += free * m->measured;
  pool->surface += W * m->share;
  pool->wet += W * m->share * m->wet;
  for (int a = 0; a < 3; a++) {
    pool->force[a] += W * m->force[a];
    pool->push[a] += W * m->push[a];
  }
}

/* Curvature at particle i from what was found near it; 0 where nothing was. Near walls that whose push, along the
 * walls, is the stress's: forces are added up before they are divided, so that what particles do to each other cancels.
 */
static double find_curvature(const Pass *s, ptrdiff_t i)
{
  const Tension *t = s->t;
  Pool sum = {0};
  pool(s, i, 0.0, &sum);
  for (ptrdiff_t k = s->fluid->start[i]; k < pair_list_end(s->fluid, i); k++) {
    const int32_t j = s->fluid->index[k];
    if (!t->near[j].counts) continue;
    double d[3], q;
    if (offset(s, i, j, d, &q)) pool(s, j, q, &sum);
  }
  const double away = sum.weight > 0.0 ? sum.measured / sum.weight : 0.0;
  if (sum.wet <= 0.0) return away;
  const double wet = sum.weight > 0.0 ? sum.wet / sum.surface : 1.0, most = 1.5 / t->h,
               noise = little_push * 2.0 * table_evaluate(t->sigma, s->p->T[i]) * t->scale.flat * s->t->near[i].fill /
                       t->value;
  const double at_wall = vec_dot(sum.force, sum.push) / (vec_dot(sum.push, sum.push) + noise * noise);
  return (1.0 - wet) * away + wet * fmax(-most, fmin(most, at_wall));
}

/* Along the gradient that pressure acts with, of melt and walls: where curvature is the same everywhere sigma times it
 * is the pressure, particle by particle. */
static void push(const Pass *s, ptrdiff_t i)
{
  const Near *n = &s->t->near[i];
  const double curvature = find_curvature(s, i);
  if (curvature == 0.0) return;
  const double per_mass = 2.0 * table_evaluate(s->t->sigma, s->p->T[i]) * s->p->volume[i] / s->p->mass[i];
  for (int a = 0; a < 3; a++) s->p->a[a][i] += per_mass * curvature * (n->melt[a] + n->wall[a]);
}

static Pass begin_pass(const Tension *t, Particles *p, const Neighbours *neighbours)
{
  return (Pass){t, p, neighbours_fluid_fluid(neighbours), neighbours_fluid_wall(neighbours),
                neighbours_period(neighbours)};
}

void tension_stress_force(const Tension *t, Particles *p, const Neighbours *neighbours, ptrdiff_t i, double force[3])
{
  const Pass s = begin_pass(t, p, neighbours);
  vec_copy(sum_pairs(&s, i).force, force);
}

CastStatus tension_push(Tension *t, Particles *p, const Neighbours *neighbours, CastError *err)
{
  if (t->capacity < p->n_fluid) {
    free(t->near);
    t->near = malloc((size_t)p->n_fluid * sizeof *t->near);
    t->capacity = t->near ? p->n_fluid : 0;
    CAST_CHECK(t->near, err, CAST_ERR_MEMORY, "no memory for the surface tension of %td particles", p->n_fluid);
  }
  const Pass s = begin_pass(t, p, neighbours);
#pragma omp parallel
  {
#pragma omp for schedule(dynamic, ROWS_PER_TASK)
    for (ptrdiff_t i = 0; i < p->n_fluid; i++) find_normal(&s, i);
#pragma omp for schedule(dynamic, ROWS_PER_TASK)
    for (ptrdiff_t i = 0; i < p->n_fluid; i++) find_force(&s, i);
#pragma omp for schedule(dynamic, ROWS_PER_TASK)
    for (ptrdiff_t i = 0; i < p->n_fluid; i++) push(&s, i);
  }
  return CAST_OK;
}
