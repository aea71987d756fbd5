#include "cast/pour/inlet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cast/kernel/pair.h"
#include "cast/physics/properties.h"
#include "common/vector.h"

static const double CLEARANCE = 0.4; // spacings from the mould, as where melt stands at the start
static const double APART = 0.7;     // spacings between melt that is there and a buffer

/* ---- where ---- */

/* The rectangle's width goes along `u`, its height along `v`. */
static void in_plane(const InletConfig *c, double u[3], double v[3])
{
  const double *n = c->direction;
  if (c->disc) { // the coordinate axis most across the direction
    int axis = 0;
    for (int d = 1; d < 3; d++)
      if (fabs(n[d]) < fabs(n[axis])) axis = d;
    for (int d = 0; d < 3; d++) u[d] = (d == axis) - n[axis] * n[d];
  } else {
    memcpy(u, c->along, 3 * sizeof *u);
  }
  const double size = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
  for (int d = 0; d < 3; d++) u[d] /= size;
  for (int d = 0; d < 3; d++) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    v[d] = n[e] * u[f] - n[f] * u[e];
  }
}

/* Is the whole way from the back of the buffer to the inlet clear of the mould? */
static bool way_is_clear(const Inlet *inlet, const Surface *surface, const double at[3])
{
  for (int half = 0; half < 2 * inlet->layers; half++) {
    double x[3];
    for (int d = 0; d < 3; d++) x[d] = at[d] - 0.5 * half * inlet->spacing * inlet->config->direction[d];
    if (!placement_is_clear(surface, x, CLEARANCE * inlet->spacing)) return false;
  }
  return true;
}

static void place_columns(Inlet *inlet, const Surface *surface, const ptrdiff_t count[2])
{
  const InletConfig *c = inlet->config;
  double u[3], v[3];
  in_plane(c, u, v);
  for (ptrdiff_t k = 0; k < count[0] * count[1]; k++) {
    const double a = ((double)(k % count[0]) + 0.5 - 0.5 * (double)count[0]) * inlet->spacing,
                 b = ((double)(k / count[0]) + 0.5 - 0.5 * (double)count[1]) * inlet->spacing;
    if (c->disc && a * a + b * b > c->radius * c->radius) continue;
    double x[3];
    for (int d = 0; d < 3; d++) x[d] = c->centre[d] + a * u[d] + b * v[d];
    inlet->in_shape++;
    if (surface && !way_is_clear(inlet, surface, x)) continue;
    for (int d = 0; d < 3; d++) inlet->at[d][inlet->n] = x[d];
    inlet->n++;
  }
}

CastStatus inlet_create(const InletConfig *config, const SphParameters *sph, const Surface *surface, Inlet *inlet,
                        CastError *err)
{
  const double dx = sph->spacing, reach = kernel_support(sph->kernel) * sph->h;
  *inlet = (Inlet){.config = config, .layers = (int)ceil(reach / dx) + 1, .spacing = dx};
  inlet->made = inlet->layers;
  const double width = config->disc ? 2.0 * config->radius : config->width,
               height = config->disc ? width : config->height;
  const ptrdiff_t count[2] = {(ptrdiff_t)llround(width / dx), (ptrdiff_t)llround(height / dx)};
  CAST_CHECK(width / dx < 1e4 && height / dx < 1e4, err, CAST_ERR_INPUT,
             "%g mm by %g mm are too many particles of %g mm", 1e3 * width, 1e3 * height, 1e3 * dx);
  for (int d = 0; d < 3; d++) inlet->at[d] = malloc((size_t)(count[0] * count[1] + 1) * sizeof *inlet->at[d]);
  inlet->front = malloc((size_t)(2 * count[0] * count[1] + 1) * sizeof *inlet->front);
  if (!inlet->at[0] || !inlet->at[1] || !inlet->at[2] || !inlet->front) {
    inlet_destroy(inlet);
    return cast_error_set(err, CAST_ERR_MEMORY, "no memory for an inlet");
  }
  place_columns(inlet, surface, count);
  const ptrdiff_t n = inlet->n, in_shape = inlet->in_shape;
  if (n == 0) inlet_destroy(inlet);
  CAST_CHECK(in_shape > 0, err, CAST_ERR_INPUT, "%g mm by %g mm is less than a particle of %g mm", 1e3 * width,
             1e3 * height, 1e3 * dx);
  CAST_CHECK(n > 0, err, CAST_ERR_INPUT,
             "the mould leaves no room for it and for the %g mm of melt behind it that move on to it",
             1e3 * inlet->layers * dx);
  const double area = (double)n * dx * dx;
  inlet->speed_per_rate = config->kind == INLET_VELOCITY ? 1.0
                          : config->kind == INLET_FLOW   ? 1.0 / area
                                                         : 1.0 / (sph->rho0 * area);
  return CAST_OK;
}

void inlet_destroy(Inlet *inlet)
{
  free(inlet->front);
  inlet->front = NULL;
  for (int d = 0; d < 3; d++) {
    free(inlet->at[d]);
    inlet->at[d] = NULL;
  }
}

/* ---- over time ---- */

double inlet_speed(const Inlet *inlet, double time)
{
  return inlet->speed_per_rate * table_evaluate(&inlet->config->rate, time);
}

double inlet_way(const Inlet *inlet, double time)
{
  return inlet->speed_per_rate * table_integral(&inlet->config->rate, 0.0, time);
}

double inlet_end(const InletConfig *config)
{
  const Table *rate = &config->rate;
  size_t n = rate->n;
  if (n == 0 || rate->y[n - 1] > 0.0) return (double)INFINITY;
  while (n > 1 && rate->y[n - 2] == 0.0) n--;
  return n > 1 ? rate->x[n - 1] : 0.0;
}

/* Layers whose back has come clear of the buffer's: one for each spacing of the way. The hair makes up for rounding. */
static ptrdiff_t layers_at(const Inlet *inlet, double time)
{
  return inlet->layers + (ptrdiff_t)floor(inlet_way(inlet, time) / inlet->spacing + 1e-9);
}

ptrdiff_t inlet_most_layers(const Inlet *inlet, double end)
{
  return layers_at(inlet, end) + 1;
}

/* m, of a layer beyond the inlet; below zero: behind it. */
static double height_of(const Inlet *inlet, ptrdiff_t layer, double time)
{
  return inlet_way(inlet, time) - ((double)layer + 0.5) * inlet->spacing;
}

static void place_of(const Inlet *inlet, ptrdiff_t column, double height, double x[3])
{
  for (int d = 0; d < 3; d++) x[d] = inlet->at[d][column] + height * inlet->config->direction[d];
}

/* ---- the start ---- */

CastStatus inlet_add_buffer(const Inlet *inlet, PointSet *points, CastError *err)
{
  const ptrdiff_t there = points->n;
  const double apart2 = APART * APART * inlet->spacing * inlet->spacing;
  CAST_CALL(points_reserve(points, inlet->n * inlet->layers, err));
  for (ptrdiff_t k = 0; k < inlet->n * inlet->layers; k++) {
    double x[3];
    place_of(inlet, k % inlet->n, height_of(inlet, k / inlet->n, 0.0), x);
    for (ptrdiff_t i = 0; i < there; i++) {
      double r2 = 0.0;
      for (int d = 0; d < 3; d++) r2 += (points->x[d][i] - x[d]) * (points->x[d][i] - x[d]);
      CAST_CHECK(r2 > apart2, err, CAST_ERR_INPUT,
                 "melt stands at (%.3g, %.3g, %.3g) mm, where the %g mm of melt behind the inlet begin", 1e3 * x[0],
                 1e3 * x[1], 1e3 * x[2], 1e3 * inlet->layers * inlet->spacing);
    }
    for (int d = 0; d < 3; d++) points->x[d][points->n] = x[d];
    points->n++;
  }
  return CAST_OK;
}

/* ---- the buffer ---- */

bool inlet_holds(const Inlet *inlet, double time, int32_t id, ptrdiff_t *layer, ptrdiff_t *column)
{
  const ptrdiff_t begun = inlet->n * inlet->layers, later = inlet->n * (inlet->made - inlet->layers);
  ptrdiff_t place = (ptrdiff_t)id - inlet->first_id;
  if (place < 0 || place >= begun) {
    place = (ptrdiff_t)id - inlet->next_id;
    if (place < 0 || place >= later) return false;
    place += begun;
  }
  if (inlet->over || height_of(inlet, place / inlet->n, time) >= 0.0) return false;
  if (layer) *layer = place / inlet->n;
  if (column) *column = place % inlet->n;
  return true;
}

void inlet_place(const Inlet *inlet, double time, Particles *p)
{
  if (inlet->over) return;
#pragma omp parallel for
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    ptrdiff_t layer, column;
    if (!inlet_holds(inlet, time, p->id[i], &layer, &column)) continue;
    double x[3];
    place_of(inlet, column, height_of(inlet, layer, time), x);
    for (int d = 0; d < 3; d++) p->x[d][i] = x[d];
  }
}

/* Add what the free melt at x with this pressure tells each column near it. */
static void tell_columns(const Inlet *inlet, const double x[3], double pressure, double *weight, double *sum)
{
  const double dx = inlet->spacing, reach2 = 2.25 * dx * dx;
  for (ptrdiff_t c = 0; c < inlet->n; c++) {
    const double r[3] = {x[0] - inlet->at[0][c], x[1] - inlet->at[1][c], x[2] - inlet->at[2][c]};
    const double height = vec_dot(r, inlet->config->direction), beside2 = vec_dot(r, r) - height * height;
    if (beside2 > reach2) continue;
    weight[c] += 1.0 - beside2 / reach2;
    sum[c] += (1.0 - beside2 / reach2) * pressure;
  }
}

/* Pressure of the free melt up to two spacings beyond the inlet, weighted by how near it is to the column. */
void inlet_sense(const Inlet *inlet, const SphParameters *sph, double time, const Particles *p)
{
  if (inlet->over) return;
  double *sum = inlet->front, *weight = inlet->front + inlet->n;
  for (ptrdiff_t c = 0; c < 2 * inlet->n; c++) inlet->front[c] = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const double x[3] = {p->x[0][i], p->x[1][i], p->x[2][i]};
    double r[3];
    vec_sub(x, inlet->config->centre, r);
    const double height = vec_dot(r, inlet->config->direction);
    if (height < 0.0 || height > 2.0 * inlet->spacing || inlet_holds(inlet, time, p->id[i], NULL, NULL)) continue;
    tell_columns(inlet, x, p->p[i], weight, sum);
  }
  for (ptrdiff_t c = 0; c < inlet->n; c++) {
    const double pressure = weight[c] > 0.0 && sum[c] > 0.0 ? sum[c] / weight[c] : 0.0;
    inlet->front[c] = tait_density(pressure, sph->rho0, sph->c0, sph->gamma);
  }
}

void inlet_carry(const Inlet *inlet, const SphParameters *sph, double time, Particles *p)
{
  if (inlet->over) return;
  const double speed = inlet_speed(inlet, time), *w = sph->spin.rate;
  double v[3], a[3];
  for (int d = 0; d < 3; d++) v[d] = speed * inlet->config->direction[d];
  for (int d = 0; d < 3; d++) { // takes off Coriolis', which the next step adds
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    a[d] = 2.0 * (w[e] * v[f] - w[f] * v[e]);
  }
#pragma omp parallel for
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    ptrdiff_t column;
    if (!inlet_holds(inlet, time, p->id[i], NULL, &column)) continue;
    for (int d = 0; d < 3; d++) {
      p->v[d][i] = v[d];
      p->a[d][i] = a[d];
    }
    p->rho[i] = p->rho_start[i] = inlet->front[column];
    p->drho[i] = p->drho_last[i] = 0.0;
    p->volume[i] = p->mass[i] / whole_density(p->rho[i], sph->rho0);
  }
}

/* ---- new layers ---- */

static void set_new(const Inlet *inlet, const SphParameters *sph, double time, Particles *p, ptrdiff_t first)
{
  const double E = material_enthalpy(sph->melt, table_evaluate(&inlet->config->temperature, time));
  const double volume = sph->spacing * sph->spacing * sph->spacing;
  const ptrdiff_t later = (inlet->made - inlet->layers) * inlet->n;
  const double *rho = inlet->front;
  for (ptrdiff_t c = 0; c < inlet->n; c++) {
    const ptrdiff_t i = first + c;
    double x[3];
    place_of(inlet, c, height_of(inlet, inlet->made, time), x);
    for (int d = 0; d < 3; d++) p->x[d][i] = x[d];
    p->id[i] = (int32_t)(inlet->next_id + later + c);
    p->mass[i] = sph->rho0 * volume;
    p->rho[i] = p->rho_start[i] = rho[c];
    p->p[i] = melt_pressure(rho[c], sph->rho0, sph->c0, sph->gamma, sph->cut_tension);
    p->volume[i] = p->mass[i] / whole_density(rho[c], sph->rho0);
    p->E[i] = E;
  }
  properties_of_rows(sph->melt, p, first, first + inlet->n);
}

CastStatus inlet_feed(Inlet *inlet, const SphParameters *sph, double time, Particles *p, ptrdiff_t *added,
                      double *joules, CastError *err)
{
  *added = 0;
  if (inlet->over) return CAST_OK;
  const ptrdiff_t due = layers_at(inlet, time);
  while (inlet->made < due) {
    const ptrdiff_t first = p->n_fluid;
    CAST_CALL(particles_add(p, inlet->n, err));
    set_new(inlet, sph, time, p, first);
    for (ptrdiff_t i = first; i < p->n_fluid; i++) *joules += p->mass[i] * p->E[i];
    inlet->made++;
    *added += inlet->n;
  }
  return CAST_OK;
}
