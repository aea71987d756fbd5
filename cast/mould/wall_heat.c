#include "cast/mould/wall_heat.h"

#include <math.h>
#include <stdlib.h>

#include "cast/mould/coupling_private.h"

struct WallHeat {
  const RomData *rom;
  const Surface *surface;
  size_t n;
  int32_t *triangle;      // [n] of the ROM
  size_t *of_patch_start; // [m + 1] into of_patch
  int32_t *of_patch;      // [n] numbers within `triangle`, patch by patch
  int32_t *number;        // [n_triangles] number within `triangle`; -1: not of the cavity
  int32_t *nearest;       // [contacts] number of the triangle
  ptrdiff_t n_contacts, room;
  long builds;   // of the contacts that `nearest` belongs to; -1: none
  double *power; // [n] W
};

static CastStatus allocate(WallHeat *heat, CastError *err)
{
  const RomData *rom = heat->rom;
  heat->number = malloc((rom->n_triangles + 1) * sizeof *heat->number);
  heat->triangle = malloc((rom->n_triangles + 1) * sizeof *heat->triangle);
  heat->of_patch = malloc((rom->n_triangles + 1) * sizeof *heat->of_patch);
  heat->of_patch_start = calloc(rom->m + 2, sizeof *heat->of_patch_start);
  heat->power = calloc(rom->n_triangles + 1, sizeof *heat->power);
  CAST_CHECK(heat->number && heat->triangle && heat->of_patch && heat->of_patch_start && heat->power, err,
             CAST_ERR_MEMORY, "no memory for the heat of %zu wall triangles", rom->n_triangles);
  return CAST_OK;
}

static void sort_triangles(WallHeat *heat)
{
  const RomData *rom = heat->rom;
  size_t *start = heat->of_patch_start;
  for (size_t t = 0; t < rom->n_triangles; t++) {
    const bool cavity = !rom->patch[rom->triangle_patch[t]].outer;
    heat->number[t] = cavity ? (int32_t)heat->n : -1;
    if (!cavity) continue;
    heat->triangle[heat->n++] = (int32_t)t;
    start[rom->triangle_patch[t] + 2]++;
  }
  for (size_t l = 2; l < rom->m + 2; l++) start[l] += start[l - 1];
  for (size_t i = 0; i < heat->n; i++) heat->of_patch[start[rom->triangle_patch[heat->triangle[i]] + 1]++] = (int32_t)i;
}

CastStatus wall_heat_create(const RomData *rom, const Surface *surface, WallHeat **out, CastError *err)
{
  WallHeat *heat = *out = calloc(1, sizeof *heat);
  CAST_CHECK(heat, err, CAST_ERR_MEMORY, "no memory");
  heat->rom = rom;
  heat->surface = surface;
  heat->builds = -1;
  const CastStatus status = allocate(heat, err);
  if (status == CAST_OK)
    sort_triangles(heat);
  else
    wall_heat_destroy(out);
  return status;
}

void wall_heat_destroy(WallHeat **heat)
{
  if (!heat || !*heat) return;
  WallHeat *old = *heat;
  free(old->triangle);
  free(old->of_patch_start);
  free(old->of_patch);
  free(old->number);
  free(old->nearest);
  free(old->power);
  free(old);
  *heat = NULL;
}

size_t wall_heat_n(const WallHeat *heat)
{
  return heat->n;
}

const int32_t *wall_heat_triangles(const WallHeat *heat)
{
  return heat->triangle;
}

/* Most often the nearest triangle of all belongs to the patch; near a patch's edge its own are gone through. */
static int32_t find_nearest(const WallHeat *heat, const double x[3], int32_t patch)
{
  SurfaceHit hit;
  if (surface_nearest(heat->surface, x, surface_reach(heat->surface), &hit) && hit.patch == patch)
    return heat->number[hit.triangle];
  double least = INFINITY, foot[3];
  int32_t best = heat->of_patch[heat->of_patch_start[patch]];
  for (size_t i = heat->of_patch_start[patch]; i < heat->of_patch_start[patch + 1]; i++) {
    const double distance = surface_triangle_distance(heat->surface, heat->triangle[heat->of_patch[i]], x, foot);
    if (distance >= least) continue;
    least = distance;
    best = heat->of_patch[i];
  }
  return best;
}

static CastStatus rebuild(WallHeat *heat, const Coupling *coupling, const Particles *p, CastError *err)
{
  const Contacts *contacts = &coupling->contacts;
  heat->n_contacts = 0;
  if (contacts->n > heat->room) {
    free(heat->nearest);
    heat->room = contacts->n + contacts->n / 4 + 64;
    heat->nearest = malloc((size_t)heat->room * sizeof *heat->nearest);
    if (!heat->nearest) heat->room = 0;
    CAST_CHECK(heat->nearest, err, CAST_ERR_MEMORY, "no memory for the heat of %td contacts", contacts->n);
  }
  heat->n_contacts = contacts->n;
  heat->builds = coupling->builds;
#pragma omp parallel for schedule(dynamic, 64)
  for (ptrdiff_t k = 0; k < contacts->n_near; k++) {
    const ptrdiff_t i = contacts->near[k];
    const double x[3] = {p->x[0][i], p->x[1][i], p->x[2][i]};
    for (ptrdiff_t e = contacts->first[k]; e < contacts->first[k + 1]; e++)
      heat->nearest[e] = find_nearest(heat, x, contacts->patch[e]);
  }
  return CAST_OK;
}

CastStatus wall_heat_power(WallHeat *heat, const Coupling *coupling, const Particles *particles, const double **power,
                           CastError *err)
{
  const Contacts *contacts = &coupling->contacts;
  if (heat->builds != coupling->builds) CAST_CALL(rebuild(heat, coupling, particles, err));
  for (size_t i = 0; i < heat->n; i++) heat->power[i] = 0.0;
  for (ptrdiff_t e = 0; e < heat->n_contacts; e++) heat->power[heat->nearest[e]] += contacts->power[e];
  *power = heat->power;
  return CAST_OK;
}
