/* sim_setup.c - geometry, lattice, melt and walls at the start. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cast/geometry/placement.h"
#include "cast/kernel/pair.h"
#include "cast/sim/sim_private.h"
#include "common/hash.h"

static const double TAIT_GAMMA = 7.0;

/* ---- lattice ---- */

static void triangle_area_vector(const RomData *rom, size_t t, double area[3], double corner[3])
{
  const double *a = &rom->points[3 * rom->triangles[3 * t]], *b = &rom->points[3 * rom->triangles[3 * t + 1]],
               *c = &rom->points[3 * rom->triangles[3 * t + 2]];
  for (int d = 0; d < 3; d++) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    area[d] = 0.5 * ((b[e] - a[e]) * (c[f] - a[f]) - (b[f] - a[f]) * (c[e] - a[e]));
    corner[d] = a[d];
  }
}

/* Along each axis, the phase of the lattice at which most of the cavity's plane walls across that axis lie on planes
 * between particles: the direction of sum area exp(2 pi i x/spacing). Where the walls do not agree (round ones have no
 * area across x or y alone), the melt's own corner decides. */
static void choose_origin(Sim *sim)
{
  const RomData *rom = sim->rom;
  const double spacing = sim->config->spacing;
  double sine[3] = {0}, cosine[3] = {0}, total[3] = {0};
  for (size_t t = 0; t < rom->n_triangles; t++) {
    if (rom->patch[rom->triangle_patch[t]].outer) continue;
    double area[3], corner[3];
    triangle_area_vector(rom, t, area, corner);
    const double size = sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
    for (int d = 0; d < 3; d++) {
      if (fabs(area[d]) < 0.9999 * size) continue;
      const double phase = 2.0 * pair_pi * corner[d] / spacing;
      sine[d] += size * sin(phase);
      cosine[d] += size * cos(phase);
      total[d] += size;
    }
  }
  double low[3], high[3];
  surface_bounds(sim->surface, low, high);
  for (int d = 0; d < 3; d++) {
    sim->origin[d] = sim->config->n_blocks ? sim->config->block[0].corner[d] : low[d];
    if (total[d] > 0.0 && hypot(sine[d], cosine[d]) > 0.5 * total[d])
      sim->origin[d] = spacing * atan2(sine[d], cosine[d]) / (2.0 * pair_pi);
  }
}

/* ---- how fast ---- */

/* c0 = 10 max(v_max, sqrt(p_max/rho0)): all that the forces may do to a unit of mass, from the blocks' own speed,
 * gives v_max; the pressure of the same head gives sqrt(p_max/rho0), which is less.               (docs/theory, eq. 14)
 */
static double choose_sound_speed(const Sim *sim)
{
  const CastConfig *c = sim->config;
  if (c->sound_speed > 0.0) return c->sound_speed;
  double fastest2 = 0.0, pull = 0.0;
  for (size_t b = 0; b < c->n_blocks; b++) {
    const double *v = c->block[b].velocity;
    fastest2 = fmax(fastest2, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  }
  for (size_t k = 0; k < c->n_inlets; k++)
    for (size_t i = 0; i < c->inlet[k].rate.n; i++) {
      const double speed = inlet_speed(&sim->inlet[k], c->inlet[k].rate.x[i]);
      fastest2 = fmax(fastest2, speed * speed);
    }
  for (size_t i = 0; i < c->drive.n; i++) {
    double g2 = 0.0;
    for (int d = 0; d < 3; d++)
      g2 += (c->drive.gravity[i][d] + c->drive.acceleration[d]) * (c->drive.gravity[i][d] + c->drive.acceleration[d]);
    pull = fmax(pull, sqrt(g2));
  }
  // a drop of at least ten particles: melt at rest still needs a sound speed
  const Table *sigma = &c->melt.surface_tension_of_t;
  double tension = 0.0; // N/m; in a pin of four particles its pressure is 2 sigma/(2 spacings)
  for (size_t i = 0; i < sigma->n && c->tension; i++) tension = fmax(tension, sigma->y[i]);
  fastest2 = fmax(fastest2, tension / (c->melt.density * c->spacing));
  return 10.0 * sqrt(fastest2 + 2.0 * fmax(sim_drive_gain(sim), 10.0 * pull * c->spacing));
}

static void set_sph(Sim *sim)
{
  const CastConfig *c = sim->config;
  sim->sph = (SphParameters){.kernel = c->kernel,
                             .h = c->smoothing * c->spacing,
                             .spacing = c->spacing,
                             .rho0 = c->melt.density,
                             .gamma = TAIT_GAMMA,
                             .density = c->density,
                             .delta = c->density_diffusion,
                             .alpha = c->artificial_viscosity,
                             .cut_tension = c->cut_tension,
                             .melt = &c->melt};
  sim_set_forces(sim, 0.0);
}

CastStatus sim_setup_geometry(Sim *sim, CastError *err)
{
  const CastConfig *c = sim->config;
  sim->rom = c->loaded_rom;
  if (!sim->rom) CAST_CALL(rom_read(c->rom_path, &sim->rom, err));
  CAST_CHECK(
      sim->rom->n_triangles > 0, err, CAST_ERR_INPUT,
      "rom: '%s' was reduced from matrices and has no geometry: there is no cavity to pour into. castreduce makes "
      "one that has from a mould.yaml with a geometry",
      c->rom_path);
  CAST_CALL(hash_file(c->rom_path, sim->rom_sha256, err));
  const double support = kernel_support(c->kernel) * c->smoothing * c->spacing;
  CAST_CALL(surface_create(sim->rom, neighbours_range(support, neighbours_skin(c->spacing)), &sim->surface, err));
  choose_origin(sim);
  set_sph(sim);
  CAST_CALL(sim_pour_create(sim, err));
  sim->sph.c0 = choose_sound_speed(sim);
  return CAST_OK;
}

/* ---- melt ---- */

typedef struct Region { // points [first, end) of the melt
  ptrdiff_t first, end;
  double temperature;     // K
  const double *velocity; // m/s; NULL: at rest
  bool hydrostatic;
} Region;

static CastStatus place_blocks(const Sim *sim, PointSet *points, Region *region, CastError *err)
{
  const CastConfig *c = sim->config;
  for (size_t b = 0; b < c->n_blocks; b++) {
    const BlockConfig *block = &c->block[b];
    region[b] = (Region){points->n, 0, block->temperature, block->velocity, false};
    // open at its upper ends: where the lattice has points on both faces, only one of them may count
    double size[3];
    for (int d = 0; d < 3; d++) size[d] = block->size[d] - 1e-5 * c->spacing;
    if (placement_add_block(sim->surface, c->spacing, sim->origin, block->corner, size, points, err) != CAST_OK) {
      char text[64];
      snprintf(text, sizeof text, "melt.blocks[%zu]", b + 1);
      return cast_error_prefix(err, text);
    }
    region[b].end = points->n;
  }
  return CAST_OK;
}

static int compare_cells(const void *a, const void *b)
{
  const int64_t *u = a, *w = b;
  for (int d = 0; d < 3; d++)
    if (u[d] != w[d]) return u[d] < w[d] ? -1 : 1;
  return 0;
}

/* Two regions that overlap would put two particles into one place of the lattice. */
static CastStatus check_overlap(const Sim *sim, const PointSet *points, CastError *err)
{
  int64_t(*cell)[3] = malloc((size_t)points->n * sizeof *cell + 1);
  CAST_CHECK(cell, err, CAST_ERR_MEMORY, "no memory for %td particles", points->n);
  for (ptrdiff_t i = 0; i < points->n; i++)
    for (int d = 0; d < 3; d++) cell[i][d] = llround((points->x[d][i] - sim->origin[d]) / sim->config->spacing - 0.5);
  qsort(cell, (size_t)points->n, sizeof *cell, compare_cells);
  ptrdiff_t twice = -1;
  for (ptrdiff_t i = 1; i < points->n && twice < 0; i++)
    if (compare_cells(cell[i - 1], cell[i]) == 0) twice = i;
  double x[3] = {0};
  for (int d = 0; d < 3 && twice >= 0; d++)
    x[d] = sim->origin[d] + ((double)cell[twice][d] + 0.5) * sim->config->spacing;
  free(cell);
  CAST_CHECK(twice < 0, err, CAST_ERR_INPUT, "melt: two of its regions overlap near (%g, %g, %g) mm", 1e3 * x[0],
             1e3 * x[1], 1e3 * x[2]);
  return CAST_OK;
}

/* Pressure of rest below a free surface through the region's highest point: a pool starts without a shock. */
static void set_hydrostatic(const Sim *sim, Particles *p, const Region *region)
{
  const SphParameters *sph = &sim->sph;
  double top = INFINITY, at[3] = {0.0, 0.0, 0.0}, half2 = 0.0;
  for (ptrdiff_t i = region->first; i < region->end; i++) {
    const double x[3] = {p->x[0][i], p->x[1][i], p->x[2][i]}, head = drive_potential(sph, x);
    if (!(head < top)) continue;
    top = head;
    memcpy(at, x, sizeof at);
  }
  Spin steady = sph->spin; // Euler's acceleration has no potential and holds nothing at rest
  double pull[3];
  for (int d = 0; d < 3; d++) {
    steady.spin_up[d] = 0.0;
    pull[d] = sph->gravity[d] + sph->extra[d];
  }
  spin_add_acceleration(&steady, at, pull);
  for (int d = 0; d < 3; d++) half2 += pull[d] * pull[d];
  for (ptrdiff_t i = region->first; i < region->end; i++) {
    const double x[3] = {p->x[0][i], p->x[1][i], p->x[2][i]};
    const double head = drive_potential(sph, x) - top + 0.5 * sph->spacing * sqrt(half2);
    p->rho[i] = tait_density(sph->rho0 * head, sph->rho0, sph->c0, sph->gamma);
  }
}

static void set_region(const Sim *sim, Particles *p, const Region *region)
{
  const double E = material_enthalpy(&sim->config->melt, region->temperature);
  for (ptrdiff_t i = region->first; i < region->end; i++) {
    p->E[i] = E;
    for (int d = 0; d < 3 && region->velocity; d++) p->v[d][i] = region->velocity[d];
  }
  if (region->hydrostatic && region->end > region->first) set_hydrostatic(sim, p, region);
}

/* Melt that gets farther than this from mould and melt at the start has left. */
static void set_box(Sim *sim)
{
  const double margin = 20.0 * sim->config->spacing;
  surface_bounds(sim->surface, sim->box_low, sim->box_high);
  for (int d = 0; d < 3; d++) {
    for (ptrdiff_t i = 0; i < sim->particles.n_fluid; i++) {
      sim->box_low[d] = fmin(sim->box_low[d], sim->particles.x[d][i]);
      sim->box_high[d] = fmax(sim->box_high[d], sim->particles.x[d][i]);
    }
    sim->box_low[d] -= margin;
    sim->box_high[d] += margin;
  }
}

static CastStatus place_melt(Sim *sim, PointSet *points, Region *region, size_t n_regions, CastError *err)
{
  const CastConfig *c = sim->config;
  CAST_CALL(place_blocks(sim, points, region, err));
  if (c->has_level) {
    Region *pool = &region[n_regions - 1];
    *pool = (Region){points->n, 0, c->melt_temperature, NULL, true};
    if (placement_add_cavity_below(sim->surface, c->spacing, sim->origin, c->level, points, err) != CAST_OK)
      return cast_error_prefix(err, "melt.cavity_below");
    pool->end = points->n;
  }
  CAST_CALL(check_overlap(sim, points, err));
  CAST_CALL(sim_pour_add_buffers(sim, points, err));
  WallSet walls = {0};
  CAST_CALL(walls_generate(sim->surface, c->spacing, kernel_support(c->kernel) * sim->sph.h, sim->origin, &walls, err));
  const CastStatus status =
      particles_create(points->n, points->x, c->spacing, sim->sph.rho0, &walls, &sim->particles, err);
  walls_destroy(&walls);
  return status;
}

CastStatus sim_setup_particles(Sim *sim, CastError *err)
{
  const size_t n_regions = sim->config->n_blocks + (sim->config->has_level ? 1 : 0);
  Region *region = calloc(n_regions + 1, sizeof *region);
  CAST_CHECK(region, err, CAST_ERR_MEMORY, "no memory");
  PointSet points = {0};
  const CastStatus status = place_melt(sim, &points, region, n_regions, err);
  for (size_t k = 0; k < n_regions && status == CAST_OK; k++) set_region(sim, &sim->particles, &region[k]);
  points_destroy(&points);
  free(region);
  CAST_CALL(status);
  for (ptrdiff_t i = sim->particles.n_fluid; i < sim->particles.n; i++) sim->particles.T[i] = sim->config->preheat;
  sim_pour_start(sim);
  sph_initialise(&sim->sph, &sim->particles);
  set_box(sim);
  return CAST_OK;
}
