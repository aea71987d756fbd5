#include "cast/coupling/wall_heat.h"

#include <math.h>
#include <stdlib.h>

#include "cast/coupling/contact_row.h"
#include "cast/coupling/coupling_private.h"

typedef struct Share { // of a contact's power
  int32_t triangle;    // number within WallHeat.triangle
  float part;          // the parts of a contact add up to one but for rounding, which `power` makes good
} Share;

struct WallHeat {
  const RomData *rom;
  size_t n;
  int32_t *triangle; // [n] of the ROM
  int32_t *number;   // [n_triangles] number within `triangle`; -1: not of the cavity
  int32_t *of_wall;  // [wall particles] number of the triangle under its foot
  ptrdiff_t *start;  // [contacts + 1] into share
  Share *share;
  ptrdiff_t n_contacts, room_contacts, room_shares;
  long builds;   // of the contacts that the shares belong to; -1: none
  double *power; // [n] W
};

/* ---- triangles under the feet ---- */

static CastStatus allocate(WallHeat *heat, size_t n_wall, CastError *err)
{
  const RomData *rom = heat->rom;
  heat->number = malloc((rom->n_triangles + 1) * sizeof *heat->number);
  heat->triangle = malloc((rom->n_triangles + 1) * sizeof *heat->triangle);
  heat->of_wall = malloc((n_wall + 1) * sizeof *heat->of_wall);
  heat->power = calloc(rom->n_triangles + 1, sizeof *heat->power);
  CAST_CHECK(heat->number && heat->triangle && heat->of_wall && heat->power, err, CAST_ERR_MEMORY,
             "no memory for the heat of %zu wall triangles", rom->n_triangles);
  return CAST_OK;
}

/* Most often the nearest triangle of all belongs to the patch; on a patch's edge its own are gone through. */
static int32_t find_triangle(const WallHeat *heat, const Surface *surface, const double x[3], int32_t patch)
{
  SurfaceHit hit;
  if (surface_nearest(surface, x, surface_reach(surface), &hit) && hit.patch == patch)
    return heat->number[hit.triangle];
  double least = INFINITY, foot[3];
  int32_t best = -1;
  for (size_t t = 0; t < heat->rom->n_triangles; t++) {
    if (heat->rom->triangle_patch[t] != patch) continue;
    const double distance = surface_triangle_distance(surface, (int32_t)t, x, foot);
    if (distance >= least) continue;
    least = distance;
    best = heat->number[t];
  }
  return best;
}

static void find_triangles(WallHeat *heat, const Surface *surface, const Particles *p)
{
  const RomData *rom = heat->rom;
  for (size_t t = 0; t < rom->n_triangles; t++) {
    const bool cavity = !rom->patch[rom->triangle_patch[t]].outer;
    heat->number[t] = cavity ? (int32_t)heat->n : -1;
    if (cavity) heat->triangle[heat->n++] = (int32_t)t;
  }
#pragma omp parallel for schedule(dynamic, 64)
  for (ptrdiff_t k = 0; k < p->n - p->n_fluid; k++) {
    const double x[3] = {p->foot[0][k], p->foot[1][k], p->foot[2][k]};
    heat->of_wall[k] = find_triangle(heat, surface, x, p->patch[k]);
  }
}

CastStatus wall_heat_create(const RomData *rom, const Surface *surface, const Particles *particles, WallHeat **out,
                            CastError *err)
{
  WallHeat *heat = *out = calloc(1, sizeof *heat);
  CAST_CHECK(heat, err, CAST_ERR_MEMORY, "no memory");
  heat->rom = rom;
  heat->builds = -1;
  const CastStatus status = allocate(heat, (size_t)(particles->n - particles->n_fluid), err);
  if (status == CAST_OK)
    find_triangles(heat, surface, particles);
  else
    wall_heat_destroy(out);
  return status;
}

void wall_heat_destroy(WallHeat **heat)
{
  if (!heat || !*heat) return;
  WallHeat *old = *heat;
  free(old->triangle);
  free(old->number);
  free(old->of_wall);
  free(old->start);
  free(old->share);
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

/* ---- shares ---- */

/* Room for one share a list entry and contact of its particle, which is never short. */
static CastStatus reserve(WallHeat *heat, const Contacts *contacts, const PairList *list, CastError *err)
{
  ptrdiff_t shares = 0;
  for (ptrdiff_t k = 0; k < contacts->n_near; k++) {
    const ptrdiff_t i = contacts->near[k];
    shares += (contacts->first[k + 1] - contacts->first[k]) * (list->start[i + 1] - list->start[i]);
  }
  if (contacts->n + 1 > heat->room_contacts) {
    free(heat->start);
    heat->room_contacts = contacts->n + contacts->n / 4 + 64;
    heat->start = malloc((size_t)heat->room_contacts * sizeof *heat->start);
  }
  if (shares > heat->room_shares) {
    free(heat->share);
    heat->room_shares = shares + shares / 4 + 64;
    heat->share = malloc((size_t)heat->room_shares * sizeof *heat->share);
  }
  if (!heat->start) heat->room_contacts = 0;
  if (!heat->share) heat->room_shares = 0;
  CAST_CHECK(heat->start && (heat->share || shares == 0), err, CAST_ERR_MEMORY,
             "no memory for the heat of %td contacts", contacts->n);
  return CAST_OK;
}

/* Shares of contact e of particle i, from `n` on; returns how many there are then. */
static ptrdiff_t add_contact(WallHeat *heat, const Coupling *coupling, const Particles *p, const Neighbours *neighbours,
                             ptrdiff_t i, ptrdiff_t e, ptrdiff_t n)
{
  const PairList *list = neighbours_fluid_wall(neighbours);
  const ptrdiff_t first = n;
  double sum = 0.0;
  for (ptrdiff_t l = list->start[i]; l < list->start[i + 1]; l++) {
    const ptrdiff_t k = list->index[l] - p->n_fluid;
    if (p->patch[k] != coupling->contacts.patch[e] || heat->of_wall[k] < 0) continue;
    const double part = contact_row_part(&coupling->rules, p, neighbours, i, k);
    if (part <= 0.0) continue;
    heat->share[n++] = (Share){heat->of_wall[k], (float)part};
    sum += part;
  }
  for (ptrdiff_t s = first; s < n; s++) heat->share[s].part = (float)((double)heat->share[s].part / sum);
  return n;
}

static CastStatus rebuild(WallHeat *heat, const Coupling *coupling, const Particles *p, const Neighbours *neighbours,
                          CastError *err)
{
  const Contacts *contacts = &coupling->contacts;
  ptrdiff_t n = 0;
  CAST_CALL(reserve(heat, contacts, neighbours_fluid_wall(neighbours), err));
  for (ptrdiff_t k = 0; k < contacts->n_near; k++)
    for (ptrdiff_t e = contacts->first[k]; e < contacts->first[k + 1]; e++) {
      heat->start[e] = n;
      n = add_contact(heat, coupling, p, neighbours, contacts->near[k], e, n);
    }
  heat->n_contacts = contacts->n;
  heat->start[contacts->n] = n;
  heat->builds = coupling->builds;
  return CAST_OK;
}

/* The last share takes what is left, so that nothing is lost to rounding. */
static void give(WallHeat *heat, ptrdiff_t e, double power, int32_t fallback)
{
  double left = power;
  for (ptrdiff_t s = heat->start[e]; s + 1 < heat->start[e + 1]; s++) {
    const double part = power * (double)heat->share[s].part;
    heat->power[heat->share[s].triangle] += part;
    left -= part;
  }
  const bool any = heat->start[e + 1] > heat->start[e];
  heat->power[any ? heat->share[heat->start[e + 1] - 1].triangle : fallback] += left;
}

/* A triangle of the patch, for a contact whose wall particles have all gone out of reach. */
static int32_t first_triangle(const WallHeat *heat, int32_t patch)
{
  for (size_t i = 0; i < heat->n; i++)
    if (heat->rom->triangle_patch[heat->triangle[i]] == patch) return (int32_t)i;
  return 0;
}

CastStatus wall_heat_power(WallHeat *heat, const Coupling *coupling, const Particles *particles,
                           const Neighbours *neighbours, const double **power, CastError *err)
{
  const Contacts *contacts = &coupling->contacts;
  if (heat->builds != coupling->builds) CAST_CALL(rebuild(heat, coupling, particles, neighbours, err));
  for (size_t i = 0; i < heat->n; i++) heat->power[i] = 0.0;
  for (ptrdiff_t e = 0; e < heat->n_contacts; e++) {
    const bool none = heat->start[e + 1] == heat->start[e];
    if (contacts->power[e] != 0.0)
      give(heat, e, contacts->power[e], none ? first_triangle(heat, contacts->patch[e]) : -1);
  }
  *power = heat->power;
  return CAST_OK;
}
