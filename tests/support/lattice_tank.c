#include "tests/support/lattice_tank.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <cmocka.h>

static bool inside(const LatticeTank *tank, const int at[3])
{
  for (int d = 0; d < 3; d++)
    if (at[d] < 0 || at[d] >= tank->box[d]) return false;
  return true;
}

/* Every lattice place of the box and its walls in turn; returns false after the last. */
static bool next_place(const LatticeTank *tank, int at[3])
{
  for (int d = 0; d < 3; d++) {
    if (++at[d] < tank->box[d] + (tank->high[d] ? tank->layers : 0)) return true;
    at[d] = tank->low[d] ? -tank->layers : 0;
  }
  return false;
}

static void make_walls(const LatticeTank *tank, WallSet *walls)
{
  size_t most = 1;
  for (int d = 0; d < 3; d++) most *= (size_t)(tank->box[d] + 2 * tank->layers);
  double **arrays[] = {&walls->x[0],      &walls->x[1],    &walls->x[2],      &walls->foot[0],
                       &walls->foot[1],   &walls->foot[2], &walls->normal[0], &walls->normal[1],
                       &walls->normal[2], &walls->volume,  &walls->depth};
  for (size_t a = 0; a < sizeof arrays / sizeof *arrays; a++) *arrays[a] = calloc(most, sizeof **arrays[a]);
  walls->patch = calloc(most, sizeof *walls->patch);
  walls->echo = calloc(most, sizeof *walls->echo);
  const double dx = tank->sph.spacing;
  int at[3];
  for (int d = 0; d < 3; d++) at[d] = tank->low[d] ? -tank->layers : 0;
  do {
    if (inside(tank, at)) continue;
    for (int d = 0; d < 3; d++) {
      const double x = (at[d] + 0.5) * dx, end = tank->box[d] * dx;
      walls->x[d][walls->n] = x;
      walls->foot[d][walls->n] = x < 0.0 ? 0.0 : x > end ? end : x;
    }
    walls->volume[walls->n] = dx * dx * dx;
    walls->n++;
  } while (next_place(tank, at));
}

void lattice_tank_create(LatticeTank *tank)
{
  CastError err = {0};
  WallSet walls = {0};
  const double dx = tank->sph.spacing;
  const ptrdiff_t n = (ptrdiff_t)tank->fluid[0] * tank->fluid[1] * tank->fluid[2];
  double *x[3], period[3];
  for (int d = 0; d < 3; d++) {
    x[d] = malloc((size_t)n * sizeof *x[d]);
    period[d] = tank->low[d] || tank->high[d] ? 0.0 : tank->box[d] * dx;
  }
  for (ptrdiff_t i = 0; i < n; i++) {
    x[0][i] = ((double)(i % tank->fluid[0]) + 0.5) * dx;
    x[1][i] = ((double)(i / tank->fluid[0] % tank->fluid[1]) + 0.5) * dx;
    x[2][i] = ((double)(i / ((ptrdiff_t)tank->fluid[0] * tank->fluid[1])) + 0.5) * dx;
  }
  make_walls(tank, &walls);
  const double reach = kernel_support(tank->sph.kernel) * tank->sph.h;
  if (particles_create(n, x, dx, tank->sph.rho0, &walls, &tank->particles, &err) != CAST_OK)
    fail_msg("%s", err.message);
  walls_destroy(&walls);
  for (int d = 0; d < 3; d++) free(x[d]);
  const CastStatus status = neighbours_create_periodic(reach, neighbours_skin(dx), period, &tank->neighbours, &err);
  if (status != CAST_OK) fail_msg("%s", err.message);
  neighbours_suit_skin(tank->neighbours, dx, sph_sound_step(&tank->sph, 0.0));
  tank->time = 0.0;
  tank->steps = 0;
}

void lattice_tank_destroy(LatticeTank *tank)
{
  particles_destroy(&tank->particles);
  neighbours_destroy(&tank->neighbours);
}

static void start(LatticeTank *tank)
{
  CastError err = {0};
  sph_initialise(&tank->sph, &tank->particles);
  if (neighbours_update(tank->neighbours, &tank->particles, true, NULL, &err) != CAST_OK) fail_msg("%s", err.message);
  sph_rates(&tank->sph, &tank->particles, tank->neighbours);
}

double lattice_tank_step(LatticeTank *tank, double dt)
{
  CastError err = {0};
  if (tank->steps == 0) start(tank);
  if (dt <= 0.0) dt = sph_time_step(&tank->sph, &tank->particles).step;
  if (sph_drift(&tank->sph, &tank->particles, NULL, dt, NULL, &err) != CAST_OK) fail_msg("%s", err.message);
  if (neighbours_update(tank->neighbours, &tank->particles, false, NULL, &err) != CAST_OK) fail_msg("%s", err.message);
  sph_rates(&tank->sph, &tank->particles, tank->neighbours);
  if (sph_finish(&tank->sph, &tank->particles, dt, &err) != CAST_OK) fail_msg("%s", err.message);
  tank->time += dt;
  tank->steps++;
  return dt;
}
