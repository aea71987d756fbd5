#include "tests/support/lattice_tank.h"

#include <math.h>
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

static bool in_block(const LatticeTank *tank, const int at[3])
{
  for (int d = 0; d < 3; d++)
    if (at[d] < tank->block_low[d] || at[d] >= tank->block_high[d]) return false;
  return true;
}

/* Foot of a cell's wall particle at x on the inside of the box, or on that face of the block within the box which is
 * nearest. */
static void find_foot(const LatticeTank *tank, const int at[3], const double x[3], double foot[3])
{
  const double dx = tank->sph.spacing;
  if (!inside(tank, at)) {
    for (int d = 0; d < 3; d++) foot[d] = fmax(0.0, fmin(tank->box[d] * dx, x[d]));
    return;
  }
  double least = INFINITY;
  int axis = 0;
  double place = 0.0;
  for (int d = 0; d < 3; d++) {
    const int ends[] = {tank->block_low[d], tank->block_high[d]};
    for (int k = 0; k < 2; k++) {
      if (ends[k] == 0 || ends[k] == tank->box[d] || fabs(ends[k] * dx - x[d]) >= least) continue;
      least = fabs(ends[k] * dx - x[d]);
      axis = d;
      place = ends[k] * dx;
    }
  }
  for (int d = 0; d < 3; d++) foot[d] = d == axis ? place : x[d];
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
    if (inside(tank, at) && !in_block(tank, at)) continue;
    const double x[3] = {(at[0] + 0.5) * dx, (at[1] + 0.5) * dx, (at[2] + 0.5) * dx};
    double foot[3];
    find_foot(tank, at, x, foot);
    for (int d = 0; d < 3; d++) {
      walls->x[d][walls->n] = x[d];
      walls->foot[d][walls->n] = foot[d];
      walls->normal[d][walls->n] = foot[d] > x[d] ? 1.0 : foot[d] < x[d] ? -1.0 : 0.0; // along one axis
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
  const ptrdiff_t most = (ptrdiff_t)tank->fluid[0] * tank->fluid[1] * tank->fluid[2];
  ptrdiff_t n = 0;
  double *x[3], period[3];
  for (int d = 0; d < 3; d++) {
    x[d] = malloc((size_t)most * sizeof *x[d]);
    period[d] = tank->low[d] || tank->high[d] ? 0.0 : tank->box[d] * dx;
  }
  for (ptrdiff_t i = 0; i < most; i++) {
    const int at[3] = {(int)(i % tank->fluid[0]), (int)(i / tank->fluid[0] % tank->fluid[1]),
                       (int)(i / ((ptrdiff_t)tank->fluid[0] * tank->fluid[1]))};
    if (in_block(tank, at)) continue;
    for (int d = 0; d < 3; d++) x[d][n] = (at[d] + 0.5) * dx;
    n++;
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
