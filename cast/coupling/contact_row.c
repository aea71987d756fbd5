/* Contacts between fluid particles and patches.
 *
 * Each wall particle j of volume V_j, foot f_j and normal n_j (into the melt) stands for a part of the wall. With it
 * fluid particle i has the area a_ij = 2 V_i V_j F_ij (r_ij . n_j) at the distance d_ij = (x_i - f_j) . n_j: the pair
 * form of conduction, with the temperature continued linearly through the wall,
 *   T_i - T_j = (T_i - T_wall) (r_ij . n_j)/d_ij, is
 *   2 kappa V_i V_j F_ij (T_i - T_j) = a_ij (T_i - T_wall)/(d_ij/kappa).
 * So a linear temperature is in equilibrium with it at any depth. On a flat wall
 *   sum_j a_ij = 2 V_i |sum_j V_j grad W_ij|                                                   (docs/theory, eq. 18).
 * Summed patch by patch, not as one vector, the two walls of a slot or a corner do not cancel. A contact's distance is
 * the harmonic mean of its d_ij weighted by a_ij, that of the sum of the conductances; until the next build it follows
 * the particle's way along the mean normal. */
#include "cast/coupling/contact_row.h"

#include <math.h>

#include "cast/kernel/pair.h"

ContactBuild contact_build_begin(const ContactRules *rules, const Particles *p, const Neighbours *neighbours)
{
  const double h = rules->sph->h, *period = neighbours_period(neighbours);
  return (ContactBuild){.rules = rules,
                        .p = p,
                        .list = neighbours_fluid_wall(neighbours),
                        .period = {period[0], period[1], period[2]},
                        .slope = shape_norm(rules->sph->kernel) / (h * h * h * h * h),
                        .reach2 = (1.0 - 1e-12) * pow(kernel_support(rules->sph->kernel) * h, 2.0)}; // no area is zero
}

WallFacing contact_face_wall(const Particles *p, ptrdiff_t k)
{
  WallFacing facing = {.volume = p->volume[p->n_fluid + k]};
  for (int d = 0; d < 3; d++) {
    facing.x[d] = p->x[d][p->n_fluid + k];
    facing.normal[d] = p->normal[d][k];
    facing.lift += (facing.x[d] - p->foot[d][k]) * facing.normal[d];
  }
  return facing;
}

/* How fluid i lies to a wall particle. */
static void place_touch(const ContactBuild *b, ptrdiff_t i, const WallFacing *wall, ContactTouch *touch)
{
  double r2 = 0.0, across = 0.0;
  for (int d = 0; d < 3; d++) {
    const double way = particles_image(b->p->x[d][i] - wall->x[d], b->period[d]);
    r2 += way * way;
    across += way * wall->normal[d];
  }
  touch->r2 = r2;
  touch->across = across;
  touch->distance = across + wall->lift;
  touch->area = wall->volume; // until measure_rows
}

/* The areas of n touches, from the volumes of their wall particles. */
PAIR_INLINE void measure_rows(const ContactBuild *b, KernelKind kernel, double twice_volume, ContactTouch *touch,
                              ptrdiff_t n)
{
  const double h = b->rules->sph->h, slope = b->slope;
#pragma omp simd
  for (ptrdiff_t t = 0; t < n; t++) {
    const double F = slope * shape_slope(kernel, sqrt(touch[t].r2) / h);
    touch[t].area = twice_volume * touch[t].area * F * touch[t].across;
  }
}

static int32_t contact_of(ContactShare *share, ptrdiff_t first, ptrdiff_t i, int32_t patch)
{
  for (ptrdiff_t c = first; c < share->n; c++)
    if (share->contact[c].patch == patch) return (int32_t)(c - first);
  share->contact[share->n] = (RowContact){.particle = (int32_t)i, .patch = patch};
  return (int32_t)(share->n++ - first);
}

/* embedded: every wall particle of the list, since one may come into reach before the next build. */
static ptrdiff_t gather_near(const ContactBuild *b, ptrdiff_t i, ContactTouch *touch)
{
  const bool all = b->rules->kind == COUPLING_EMBEDDED;
  const double lowest = -contact_behind * b->rules->sph->spacing;
  ptrdiff_t n = 0;
  for (ptrdiff_t l = b->list->start[i]; l < b->list->start[i + 1]; l++) {
    const int32_t k = b->list->index[l] - (int32_t)b->p->n_fluid;
    touch[n].wall = k;
    place_touch(b, i, &b->facing[k], &touch[n]);
    // beyond reach: listed for what may come, the area is zero
    n += all || (touch[n].r2 < b->reach2 && touch[n].across > 0.0 && touch[n].distance >= lowest);
  }
  return n;
}

static void gather(const ContactBuild *b, ptrdiff_t i, ptrdiff_t first, ContactShare *share)
{
  ContactTouch *touch = share->touch;
  const ptrdiff_t n = share->n_touch = gather_near(b, i, touch);
  const double twice_volume = 2.0 * b->p->volume[i];
  if (b->rules->sph->kernel == KERNEL_WENDLAND_C2) // nothing left to decide in the loop: vectors
    measure_rows(b, KERNEL_WENDLAND_C2, twice_volume, touch, n);
  else
    measure_rows(b, b->rules->sph->kernel, twice_volume, touch, n);
  for (ptrdiff_t t = 0; t < n; t++) touch[t].contact = contact_of(share, first, i, b->p->patch[touch[t].wall]);
}

/* Near a thin mould wall a particle may see wall particles whose foot is on the other side: under the floor of the
 * next cavity, say. They hold up its pressure, but its heat does not come out there. The nearest foot speaks for the
 * patch. */
static bool patch_in_sight(const ContactBuild *b, ptrdiff_t i, const ContactShare *share, int32_t number)
{
  const Particles *p = b->p;
  const double x[3] = {p->x[0][i], p->x[1][i], p->x[2][i]}, lift = 0.05 * b->rules->sph->spacing;
  double least = INFINITY;
  int32_t nearest = share->touch[0].wall;
  for (ptrdiff_t t = 0; t < share->n_touch; t++) {
    const ContactTouch *touch = &share->touch[t];
    if (touch->contact != number) continue;
    double foot2 = 0.0;
    for (int d = 0; d < 3; d++) {
      const double to = particles_image(x[d] - p->foot[d][touch->wall], b->period[d]);
      foot2 += to * to;
    }
    if (foot2 >= least) continue;
    least = foot2;
    nearest = touch->wall;
  }
  double foot[3];
  for (int d = 0; d < 3; d++) foot[d] = p->foot[d][nearest] + lift * p->normal[d][nearest];
  return !surface_separates(b->rules->surface, x, foot);
}

/* Area, mean distance and mean normal of one contact's touches; its sinks. */
static void sum_contact(const ContactBuild *b, ptrdiff_t i, int32_t number, ContactShare *share, RowContact *contact)
{
  const bool embedded = b->rules->kind == COUPLING_EMBEDDED;
  const double least = b->rules->least_distance;
  double area = 0.0, per_distance = 0.0, normal[3] = {0.0, 0.0, 0.0};
  const ptrdiff_t before = share->n_pairs;
  for (ptrdiff_t t = 0; t < share->n_touch; t++) {
    const ContactTouch *touch = &share->touch[t];
    if (touch->contact != number) continue;
    area += touch->area;
    per_distance += touch->area / (touch->distance > least ? touch->distance : least);
    for (int d = 0; d < 3; d++) normal[d] += touch->area * b->facing[touch->wall].normal[d];
    if (embedded) share->pair[share->n_pairs++] = touch->wall;
  }
  if (!embedded) {
    share->pair[share->n_pairs++] = contact->patch;
    contact->area = area;
    contact->plane[3] = area / per_distance;
    for (int d = 0; d < 3; d++) {
      contact->plane[d] = normal[d] / area;
      contact->plane[3] -= contact->plane[d] * b->p->x[d][i];
    }
  }
  contact->n_pairs = share->n_pairs - before;
}

void contact_row_fill(const ContactBuild *b, ptrdiff_t i, ContactShare *share)
{
  const ptrdiff_t first = share->n;
  gather(b, i, first, share);
  const double x[3] = {b->p->x[0][i], b->p->x[1][i], b->p->x[2][i]};
  const bool look = share->n > first && b->rules->surface && surface_thin_near(b->rules->surface, x);
  ptrdiff_t kept = first;
  for (ptrdiff_t c = first; c < share->n; c++) {
    const int32_t number = (int32_t)(c - first);
    if (look && !patch_in_sight(b, i, share, number)) continue;
    RowContact contact = share->contact[c];
    sum_contact(b, i, number, share, &contact);
    share->contact[kept++] = contact;
  }
  share->n_near += kept > first;
  share->n = kept;
}

double contact_row_part(const ContactRules *rules, const Particles *p, const Neighbours *neighbours, ptrdiff_t i,
                        ptrdiff_t k)
{
  const ContactBuild build = contact_build_begin(rules, p, neighbours);
  const WallFacing wall = contact_face_wall(p, k);
  ContactTouch touch;
  place_touch(&build, i, &wall, &touch);
  measure_rows(&build, rules->sph->kernel, 2.0 * p->volume[i], &touch, 1);
  if (touch.area <= 0.0 || touch.distance < -contact_behind * rules->sph->spacing) return 0.0;
  return touch.area / fmax(touch.distance, rules->least_distance);
}
