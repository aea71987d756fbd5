/* Method      continuum surface force on one phase, in four passes over fluid rows: fill and its gradient; curvature by
 *             least squares over normals of surface particles and, at walls, of the contact angle; curvature spread to
 *             all near them; force. Interior disorder makes normals that mean nothing, so curvature does not take them.
 * References  Brackbill, Kothe & Zemach 1992, J. Comput. Phys. 100; Morris 2000, Int. J. Numer. Methods Fluids 33;
 *             docs/theory, Surface tension */
#include "cast/physics/tension.h"

#include <stdlib.h>

#include "cast/kernel/interface.h"
#include "cast/physics/wedge.h"
#include "common/vector.h"

enum { ROWS_PER_TASK = 128, SHARES = 64 };
static const double surface_low = 0.3;  // of the gradient at a flat surface: curvature is measured above
static const double least_along = 0.1;  // of the normal: less of it along the wall is no contact line
static const double most_across = 0.99; // of the normal across the wall
static const double least_height = 0.1; // h, above a wall: nearer, noise of the normal would be all there is
static const double least_open = 0.3;   // what divides the fill; a particle on a wall has 0.5

typedef struct Angle { // at which melt meets walls
  double cos_theta, sin_theta;
  Wedge *wedge;
} Angle;

typedef struct Near { // of one particle
  const Angle *angle; // of the wall nearest to it
  double normal[3];   // unit, into the melt
  double melt[3];     // 1/m, gradient of what melt fills
  double wall[3];     // 1/m, gradient of what walls fill
  double walls;       // what walls fill
  double height;      // m, above the wall; 0: no wall near
  double depth;       // m, below the surface; near walls only
  double share;       // how surely at the surface, 0 to 1
  double measured;    // 1/m, curvature at the particle
} Near;

struct Tension {
  KernelKind kernel;
  double h, slope, value; // m, 1/m5, 1/m3
  const Table *sigma;
  double sigma_most;
  double flat;                        // 1/m, gradient at a flat surface
  double radius;                      // m, mean radius of the kernel
  double depth;                       // m, mean depth of particles whose curvature is measured
  double shares[SHARES], shares_step; // share of a flat surface's particles over depth, m
  Angle *angle;                       // [n_angles], the first on all patches but those below
  size_t n_angles, n_patches;
  const Angle **of_patch; // [n_patches]; NULL: one angle for all
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
  double depth = 0.0, share = 0.0;
  t->flat = flat_gradient(t, 0.0);
  for (int k = 0; k < PARTS; k++) {
    const double z = (k + 0.5) * step, g = flat_gradient(t, z), w = interface_share(g / t->flat, surface_low);
    t->radius += 4.0 * pair_pi * z * z * z * kernel_value(t->kernel, z, t->h) * step;
    depth += w * z;
    share += w;
  }
  t->depth = depth / share;
  t->shares_step = kernel_support(t->kernel) * t->h / SHARES;
  for (int k = 0; k < SHARES; k++)
    t->shares[k] = interface_share(flat_gradient(t, (k + 0.5) * t->shares_step) / t->flat, surface_low);
}

/* Behind those there are. */
static CastStatus add_angles(Tension *t, size_t n, const double *theta, CastError *err)
{
  Angle *more = realloc(t->angle, (t->n_angles + n) * sizeof *more);
  CAST_CHECK(more, err, CAST_ERR_MEMORY, "no memory for %zu contact angles", t->n_angles + n);
  t->angle = more;
  for (size_t k = 0; k < n; k++) {
    Angle *angle = &t->angle[t->n_angles];
    *angle = (Angle){.cos_theta = cos(theta[k]), .sin_theta = sin(theta[k])};
    CAST_CALL(wedge_create(t->kernel, theta[k], &angle->wedge, err));
    t->n_angles++;
  }
  return CAST_OK;
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
  for (size_t k = 0; k < sigma->n; k++) t->sigma_most = fmax(t->sigma_most, sigma->y[k]);
  set_constants(t);
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

/* ---- passes ---- */

/* How surely a place in the wall would be at the surface, so deep below it (or above). */
static double wall_share(const Tension *t, double depth)
{
  const double s = fabs(depth) / t->shares_step;
  return s < SHARES ? t->shares[(int)s] : 0.0;
}

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
  for (ptrdiff_t k = list->start[i]; k < pair_list_end(list, i); k++) {
    const int32_t j = list->index[k];
    double d[3];
    const double q = offset(s, i, j, d), volume = s->p->volume[j];
    const double F = volume * t->slope * shape_slope(t->kernel, q);
    *fill += volume * t->value * shape_value(t->kernel, q);
    for (int a = 0; a < 3; a++) gradient[a] -= F * d[a];
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
static double see_behind_wall(const Tension *t, Near *n, double part)
{
  double away[3], along[3];
  if (!wall_normal(n, t->flat, away) || !along_wall(n, away, along)) return 1.0;
  const WedgePlace at = wedge_look(n->angle->wedge, n->walls, part);
  const double across = fmax(-most_across, fmin(most_across, vec_dot(n->normal, away) + at.lean)),
               beside = sqrt(1.0 - across * across);
  for (int a = 0; a < 3; a++) n->normal[a] = across * away[a] + beside * along[a];
  n->height = fmax(at.height, least_height) * t->h;
  n->depth = at.depth * t->h;
  return at.raise;
}

static void find_normal(const Pass *s, ptrdiff_t i)
{
  const Tension *t = s->t;
  Near *n = &t->near[i];
  double fill = s->p->volume[i] * t->value * shape_value(t->kernel, 0.0), gradient[3] = {0};
  *n = (Near){.angle = nearest_angle(s, i)};
  add_fill(s, i, s->fluid, &fill, gradient);
  vec_copy(gradient, n->melt);
  add_fill(s, i, s->wall, &n->walls, n->wall);
  const double open = fmax(1.0 - n->walls, least_open), part = fmin(1.0, fill / open);
  for (int a = 0; a < 3; a++) gradient[a] = (gradient[a] + part * n->wall[a]) / open; // of fill/(1 - walls)
  vec_copy(gradient, n->normal);
  const double size = vec_normalise(n->normal);
  n->share = interface_share(size * see_behind_wall(t, n, part) / t->flat, surface_low);
}

/* At the wall the normal is that of the contact angle. A wall particle near the surface's plane stands for melt there,
 * whose normal lies on the line from that of particle i through that at the wall, and further; how the surface turns
 * along the contact line it does not tell. */
static void add_wall(const Pass *s, ptrdiff_t i, InterfaceSums *sums)
{
  const Tension *t = s->t;
  const Near *n = &t->near[i];
  const Angle *angle = n->angle;
  double away[3], along[3], line[3], turn[3]; // turn: of the normal from the wall to particle i
  if (n->height <= 0.0 || !wall_normal(n, t->flat, away) || !along_wall(n, away, along)) return;
  vec_cross(away, along, line);
  for (int a = 0; a < 3; a++) turn[a] = n->normal[a] + angle->cos_theta * away[a] - angle->sin_theta * along[a];
  for (ptrdiff_t k = s->wall->start[i]; k < pair_list_end(s->wall, i); k++) {
    const int32_t j = s->wall->index[k];
    double d[3];
    const double F = s->p->volume[j] * t->slope * shape_slope(t->kernel, offset(s, i, j, d)), across = vec_dot(d, away);
    if (across <= n->height) continue; // of the other wall of a corner
    const double w = F * wall_share(t, n->depth - vec_dot(d, n->normal)), beyond = across / n->height;
    vec_axpy(-vec_dot(d, line), line, d, d);
    for (int a = 0, q = 0; a < 3; a++) {
      for (int b = 0; b < 3; b++) sums->G[a][b] += w * beyond * turn[a] * d[b];
      for (int b = a; b < 3; b++, q++) sums->M[q] += w * d[a] * d[b];
    }
  }
}

static void find_curvature(const Pass *s, ptrdiff_t i)
{
  const Tension *t = s->t;
  Near *n = &t->near[i];
  if (n->share <= 0.0) return;
  InterfaceSums sums = {.M = {0.0}};
  for (ptrdiff_t k = s->fluid->start[i]; k < pair_list_end(s->fluid, i); k++) {
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
  add_wall(s, i, &sums);
  const double most = 1.5 / t->h, k = interface_at_surface(interface_shape(&sums), t->depth, t->radius);
  n->measured = fmax(-most, fmin(most, k));
}

/* Curvature at particle i: the mean of what was measured near it; 0 where nothing was. */
static double spread_curvature(const Pass *s, ptrdiff_t i)
{
  const Tension *t = s->t;
  double weight = t->near[i].share * shape_value(t->kernel, 0.0) * shape_value(t->kernel, 0.0),
         sum = weight * t->near[i].measured;
  for (ptrdiff_t k = s->fluid->start[i]; k < pair_list_end(s->fluid, i); k++) {
    const int32_t j = s->fluid->index[k];
    if (t->near[j].share <= 0.0) continue;
    double d[3];
    const double W = shape_value(t->kernel, offset(s, i, j, d)), w = t->near[j].share * W * W;
    sum += w * t->near[j].measured;
    weight += w;
  }
  return weight > 0.0 ? sum / weight : 0.0;
}

/* Along the gradient that pressure acts with, of melt and, where it presses on them, walls: where curvature is the same
 * everywhere sigma times it is the pressure, particle by particle. */
static void push(const Pass *s, ptrdiff_t i)
{
  const Near *n = &s->t->near[i];
  const double curvature = spread_curvature(s, i), pressing = positive(curvature);
  if (curvature == 0.0) return;
  const double per_mass = 2.0 * table_evaluate(s->t->sigma, s->p->T[i]) * s->p->volume[i] / s->p->mass[i];
  for (int a = 0; a < 3; a++) s->p->a[a][i] += per_mass * (curvature * n->melt[a] + pressing * n->wall[a]);
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
