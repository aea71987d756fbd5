#include "cast/geometry/placement.h"
#include "tests/support/melt_on_mould.h"
#include "tests/support/voxel_mould.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MUST(call)                                                                                                     \
  do {                                                                                                                 \
    CastError err_ = {0};                                                                                              \
    CastError *err = &err_;                                                                                            \
    if ((call) != CAST_OK) fail_msg("%s", err_.message);                                                               \
  } while (0)

/* As cast.yaml would give it. */
static void read_melt(MeltCase *given, Material *melt)
{
  char text[4096];
  snprintf(text, sizeof text, "material: %s\n", given->material);
  YamlInput *input = NULL;
  MUST(yaml_input_parse(text, "melt.yaml", &input, err));
  MUST(material_read(yaml_get(yaml_root(input), "material"), melt, err));
  MUST(yaml_input_finish(input, err));
  MUST(material_check_melt(melt, err));
  yaml_input_destroy(&input);
  given->rho = melt->density;
  given->kappa = melt->conductivity;
  given->c = melt->specific_heat;
}

static void make_melt(const MeltCase *given, Material *melt)
{
  memset(melt, 0, sizeof *melt);
  strcpy(melt->name, "test melt");
  melt->density = given->rho;
  melt->specific_heat = given->c;
  melt->conductivity = given->kappa;
  const double T[2] = {0.0, 4000.0}, E[2] = {0.0, 4000.0 * given->c}, viscosity = 1e-3;
  MUST(table_create(2, T, E, &melt->enthalpy, err));
  MUST(table_create(1, T, &given->kappa, &melt->conductivity_of_t, err));
  MUST(table_create(1, T, &viscosity, &melt->viscosity_of_t, err));
}

static double *numbers(ptrdiff_t n)
{
  return synthetic_array((size_t)n, sizeof(double));
}

static void allocate_walls(WallSet *walls, ptrdiff_t n)
{
  *walls = (WallSet){.n = n, .volume = numbers(n), .depth = numbers(n)};
  for (int d = 0; d < 3; d++) {
    walls->x[d] = numbers(n);
    walls->foot[d] = numbers(n);
    walls->normal[d] = numbers(n);
  }
  walls->patch = synthetic_array((size_t)n, sizeof *walls->patch);
  walls->echo = synthetic_array((size_t)n, 1);
}

/* Layers of wall particles below z = 0, periodic in x and y; the uppermost layer is what the wall leaves of its
 * cells. */
static void layered_walls(const MeltCase *given, double reach, WallSet *walls)
{
  const double dx = given->spacing;
  const int columns = given->columns, layers = (int)ceil(reach / dx) + 1;
  allocate_walls(walls, (ptrdiff_t)columns * columns * layers);
  ptrdiff_t n = 0;
  for (int k = 0; k < layers; k++)
    for (int j = 0; j < columns; j++)
      for (int i = 0; i < columns; i++, n++) {
        const double left = given->shift > 0.0 ? given->shift : 1.0; // of the uppermost layer
        const double top = k == 0 ? 0.0 : -(left + k - 1) * dx, bottom = -(left + k) * dx;
        const double x[3] = {(i + 0.5) * dx, (j + 0.5) * dx, 0.5 * (top + bottom)};
        for (int d = 0; d < 3; d++) {
          walls->x[d][n] = x[d];
          walls->foot[d][n] = d < 2 ? x[d] : 0.0;
          walls->normal[d][n] = d < 2 ? 0.0 : 1.0;
        }
        walls->volume[n] = dx * dx * (top - bottom);
        walls->depth[n] = -x[2];
        walls->patch[n] = 0;
      }
}

static void place_block(const MeltCase *given, double *x[3], ptrdiff_t *n)
{
  const bool periodic = given->columns > 0;
  const int count[3] = {periodic ? given->columns : given->count[0], periodic ? given->columns : given->count[1],
                        periodic ? given->layers : given->count[2]};
  *n = (ptrdiff_t)count[0] * count[1] * count[2];
  for (int d = 0; d < 3; d++) x[d] = numbers(*n);
  ptrdiff_t at = 0;
  for (int k = 0; k < count[2]; k++)
    for (int j = 0; j < count[1]; j++)
      for (int i = 0; i < count[0]; i++, at++) {
        x[0][at] = given->corner[0] + (i + 0.5) * given->spacing;
        x[1][at] = given->corner[1] + (j + 0.5) * given->spacing;
        x[2][at] = given->corner[2] + (k + 0.5) * given->spacing;
      }
}

/* The block's lattice points as a run would place them. */
static void place_clear_of_mould(const MeltOnMould *melt, double *x[3], ptrdiff_t *n)
{
  const MeltCase *given = &melt->given;
  double size[3];
  for (int d = 0; d < 3; d++) size[d] = given->count[d] * given->spacing;
  PointSet points = {0};
  MUST(placement_add_block(melt->surface, given->spacing, given->corner, given->corner, size, &points, err));
  *n = points.n;
  for (int d = 0; d < 3; d++) x[d] = points.x[d];
}

static void make_particles(MeltOnMould *melt, double reach)
{
  const MeltCase *given = &melt->given;
  double *x[3];
  ptrdiff_t n;
  WallSet walls;
  if (given->clear_of_mould)
    place_clear_of_mould(melt, x, &n);
  else
    place_block(given, x, &n);
  if (given->columns > 0)
    layered_walls(given, reach, &walls);
  else
    MUST(walls_generate(melt->surface, given->spacing, reach, given->corner, &walls, err));
  MUST(particles_create(n, x, given->spacing, given->rho, &walls, &melt->particles, err));
  walls_destroy(&walls);
  for (int d = 0; d < 3; d++) free(x[d]);
  for (ptrdiff_t i = 0; i < n; i++) melt->particles.E[i] = material_enthalpy(&melt->melt, given->hot);
  sph_initialise(&melt->sph, &melt->particles);
}

static void make_lists(MeltOnMould *melt, double reach)
{
  const double width = melt->given.columns * melt->given.spacing, period[3] = {width, width, 0.0};
  if (melt->given.columns > 0)
    MUST(neighbours_create_periodic(reach, 0.0, period, &melt->neighbours, err));
  else
    MUST(neighbours_create(reach, 0.0, melt->surface, &melt->neighbours, err));
}

void melt_on_mould_create(const MeltCase *given, MeltOnMould *melt)
{
  memset(melt, 0, sizeof *melt);
  melt->given = *given;
  MeltCase *own = &melt->given;
  if (own->support == 0.0) own->support = 3.0;
  if (own->columns > 0) own->slab.size[0] = own->slab.size[1] = own->columns * own->spacing;
  const double reach = own->support * own->spacing;
  if (own->material)
    read_melt(own, &melt->melt);
  else
    make_melt(own, &melt->melt);
  melt->rom = own->rom;
  if (!own->rom) MUST(synthetic_rom_slab(&own->slab, &melt->rom, err));
  MUST(surface_create(melt->rom, 1.5 * reach, &melt->surface, err));
  melt->sph = (SphParameters){.kernel = KERNEL_WENDLAND_C2,
                              .h = reach / kernel_support(KERNEL_WENDLAND_C2),
                              .spacing = own->spacing,
                              .rho0 = own->rho,
                              .c0 = 10.0,
                              .gamma = 7.0,
                              .melt = &melt->melt,
                              .frozen_flow = true};
  make_particles(melt, reach);
  make_lists(melt, reach);
  MUST(rom_state_create(melt->rom, own->scheme, own->preheat, own->ambient, &melt->mould, err));
  MUST(coupling_create(&own->coupling, &melt->sph, melt->rom, melt->surface, &melt->particles, &melt->coupling, err));
  melt_on_mould_rebuild(melt);
}

void melt_on_mould_destroy(MeltOnMould *melt)
{
  coupling_destroy(&melt->coupling);
  rom_state_destroy(&melt->mould);
  neighbours_destroy(&melt->neighbours);
  particles_destroy(&melt->particles);
  surface_destroy(&melt->surface);
  rom_destroy(&melt->rom);
  material_destroy(&melt->melt);
}

void melt_on_mould_rebuild(MeltOnMould *melt)
{
  MUST(neighbours_update(melt->neighbours, &melt->particles, true, NULL, err));
  MUST(coupling_rebuild(melt->coupling, &melt->particles, melt->neighbours, err));
}

void melt_on_mould_step(MeltOnMould *melt, double dt)
{
  sph_rates(&melt->sph, &melt->particles, melt->neighbours);
  MUST(coupling_advance(melt->coupling, melt->mould, &melt->particles, melt->neighbours, dt, err));
  MUST(sph_finish(&melt->sph, &melt->particles, dt, err));
  melt->time += dt;
}

Cool *melt_on_mould_begin_cooling(MeltOnMould *melt, double tolerance, double first_step)
{
  const CoolParameters parameters = {tolerance, first_step};
  const CoolSystem system = {&melt->sph, &melt->particles, melt->neighbours, melt->coupling, melt->mould};
  Cool *cool = NULL;
  MUST(cool_create(&parameters, &system, &cool, err));
  return cool;
}

CoolCounts melt_on_mould_cool(MeltOnMould *melt, double tolerance, double first_step, double until)
{
  Cool *cool = melt_on_mould_begin_cooling(melt, tolerance, first_step);
  while (melt->time < until * (1.0 - 1e-12)) {
    double taken = 0.0;
    MUST(cool_step(cool, until - melt->time, &taken, err));
    melt->time += taken;
  }
  const CoolCounts counts = cool_counts(cool);
  cool_destroy(&cool);
  return counts;
}

double melt_on_mould_time_step(const MeltOnMould *melt)
{
  return sph_time_step(&melt->sph, &melt->particles).step;
}

double melt_on_mould_temperature(const MeltOnMould *melt, double z)
{
  const Particles *p = &melt->particles;
  const double place = z / melt->given.spacing - 0.5;
  const int layers = melt->given.columns > 0 ? melt->given.layers : melt->given.count[2];
  const int low = (int)fmax(fmin(floor(place), layers - 2), 0.0);
  double sum[2] = {0.0, 0.0}, n[2] = {0.0, 0.0};
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const long layer = lround(p->x[2][i] / melt->given.spacing - 0.5);
    if (layer != low && layer != low + 1) continue;
    sum[layer - low] += p->T[i];
    n[layer - low] += 1.0;
  }
  if (n[1] == 0.0) return sum[0] / n[0]; // a film
  return sum[0] / n[0] + (place - low) * (sum[1] / n[1] - sum[0] / n[0]);
}
