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
#include "cast/mould/contacts.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "cast/kernel/pair.h"

/* A particle as far behind a wall particle's tangent plane as this, in spacings, does not see that side of an edge. */
static const double behind = 0.2;

/* What is asked of a wall particle for every pair, side by side in one cache line: walls never move. */
struct WallFacing {
  double x[3], normal[3], lift, volume; // m; lift: from the foot to x along the normal, m; m3
};

typedef struct Build {
  const ContactRules *rules;
  const Particles *p;
  const WallFacing *facing; // [walls]
  const PairList *list;
  double period[3], slope, reach2; // m; 1/m5; m2
} Build;

typedef struct Touch {   // one wall particle within reach of the row's fluid particle
  int32_t wall, contact; // contact: its number within the row
  double r2, across;     // m2, m: the way between them, squared and along the wall's normal
  double area, distance; // m2, m
} Touch;

typedef struct Contact {
  int32_t particle, patch;
  ptrdiff_t n_pairs;
  double area, plane[4];
} Contact;

/* What one thread finds in its share of the rows, in their order. */
typedef struct Share {
  Contact *contact;
  int32_t *pair; // sinks of the contacts, one after the other
  ptrdiff_t n, n_pairs, n_near, room, room_pairs;
  Touch *touch; // [longest row] scratch
  ptrdiff_t n_touch;
  bool failed;
} Share;

static bool grow(void **array, ptrdiff_t count, size_t size)
{
  void *more = realloc(*array, (size_t)count * size);
  if (more) *array = more;
  return more != NULL;
}

/* ---- one row ---- */

static WallFacing face_wall(const Particles *p, ptrdiff_t k)
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
static void place_touch(const Build *b, ptrdiff_t i, const WallFacing *wall, Touch *touch)
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
PAIR_INLINE void measure_rows(const Build *b, KernelKind kernel, double twice_volume, Touch *touch, ptrdiff_t n)
{
  const double h = b->rules->sph->h, slope = b->slope;
#pragma omp simd
  for (ptrdiff_t t = 0; t < n; t++) {
    const double F = slope * shape_slope(kernel, sqrt(touch[t].r2) / h);
    touch[t].area = twice_volume * touch[t].area * F * touch[t].across;
  }
}

static int32_t contact_of(Share *share, ptrdiff_t first, ptrdiff_t i, int32_t patch)
{
  for (ptrdiff_t c = first; c < share->n; c++)
    if (share->contact[c].patch == patch) return (int32_t)(c - first);
  share->contact[share->n] = (Contact){.particle = (int32_t)i, .patch = patch};
  return (int32_t)(share->n++ - first);
}

/* embedded: every wall particle of the list, since one may come into reach before the next build. */
static ptrdiff_t gather_near(const Build *b, ptrdiff_t i, Touch *touch)
{
  const bool all = b->rules->kind == COUPLING_EMBEDDED;
  const double lowest = -behind * b->rules->sph->spacing;
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

static void gather(const Build *b, ptrdiff_t i, ptrdiff_t first, Share *share)
{
  Touch *touch = share->touch;
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
static bool patch_in_sight(const Build *b, ptrdiff_t i, const Share *share, int32_t number)
{
  const Particles *p = b->p;
  const double x[3] = {p->x[0][i], p->x[1][i], p->x[2][i]}, lift = 0.05 * b->rules->sph->spacing;
  double least = INFINITY;
  int32_t nearest = share->touch[0].wall;
  for (ptrdiff_t t = 0; t < share->n_touch; t++) {
    const Touch *touch = &share->touch[t];
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
static void sum_contact(const Build *b, ptrdiff_t i, int32_t number, Share *share, Contact *contact)
{
  const bool embedded = b->rules->kind == COUPLING_EMBEDDED;
  const double least = b->rules->least_distance;
  double area = 0.0, per_distance = 0.0, normal[3] = {0.0, 0.0, 0.0};
  const ptrdiff_t before = share->n_pairs;
  for (ptrdiff_t t = 0; t < share->n_touch; t++) {
    const Touch *touch = &share->touch[t];
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

static void fill_row(const Build *b, ptrdiff_t i, Share *share)
{
  const ptrdiff_t first = share->n;
  gather(b, i, first, share);
  const double x[3] = {b->p->x[0][i], b->p->x[1][i], b->p->x[2][i]};
  const bool look = share->n > first && b->rules->surface && surface_thin_near(b->rules->surface, x);
  ptrdiff_t kept = first;
  for (ptrdiff_t c = first; c < share->n; c++) {
    const int32_t number = (int32_t)(c - first);
    if (look && !patch_in_sight(b, i, share, number)) continue;
    Contact contact = share->contact[c];
    sum_contact(b, i, number, share, &contact);
    share->contact[kept++] = contact;
  }
  share->n_near += kept > first;
  share->n = kept;
}

/* ---- all rows ---- */

static bool reserve_row(Share *share, ptrdiff_t length)
{
  if (share->n + length > share->room) {
    const ptrdiff_t room = 2 * (share->n + length) + 256;
    if (!grow((void **)&share->contact, room, sizeof *share->contact)) return false;
    share->room = room;
  }
  if (share->n_pairs + length > share->room_pairs) {
    const ptrdiff_t room = 2 * (share->n_pairs + length) + 256;
    if (!grow((void **)&share->pair, room, sizeof *share->pair)) return false;
    share->room_pairs = room;
  }
  return true;
}

static ptrdiff_t longest_row(const PairList *list)
{
  ptrdiff_t longest = 0;
  for (ptrdiff_t i = 0; i < list->n; i++) {
    const ptrdiff_t length = list->start[i + 1] - list->start[i];
    longest = length > longest ? length : longest;
  }
  return longest;
}

/* The first row of a thread's share: as many list entries to each. */
static ptrdiff_t share_begin(const PairList *list, int thread, int threads)
{
  const ptrdiff_t wanted = list->start[list->n] / threads * thread;
  ptrdiff_t low = 0, high = list->n;
  while (low < high) {
    const ptrdiff_t middle = (low + high) / 2;
    if (list->start[middle] < wanted)
      low = middle + 1;
    else
      high = middle;
  }
  return thread == threads ? list->n : low;
}

static void fill_share(const Build *b, int thread, int threads, ptrdiff_t longest, Share *share)
{
  const ptrdiff_t end = share_begin(b->list, thread + 1, threads);
  share->touch = malloc((size_t)(longest + 1) * sizeof *share->touch);
  share->failed = !share->touch;
  for (ptrdiff_t i = share_begin(b->list, thread, threads); i < end && !share->failed; i++) {
    const ptrdiff_t length = b->list->start[i + 1] - b->list->start[i];
    if (length == 0) continue;
    share->failed = !reserve_row(share, length + 1);
    if (!share->failed) fill_row(b, i, share);
  }
}

static bool reserve(Contacts *c, ptrdiff_t n_near, ptrdiff_t n, ptrdiff_t pairs)
{
  bool ok = true;
  if (n_near + 1 > c->room_near) {
    c->room_near = n_near + n_near / 4 + 64;
    ok = grow((void **)&c->near, c->room_near, sizeof *c->near) &&
         grow((void **)&c->first, c->room_near, sizeof *c->first);
  }
  if (ok && n + 1 > c->room_contacts) {
    const ptrdiff_t room = c->room_contacts = n + n / 4 + 64;
    ok = grow((void **)&c->patch, room, sizeof *c->patch) && grow((void **)&c->area, room, sizeof *c->area) &&
         grow((void **)&c->plane, room, sizeof *c->plane) && grow((void **)&c->power, room, sizeof *c->power) &&
         grow((void **)&c->most, room, sizeof *c->most) && grow((void **)&c->mean_power, room, sizeof *c->mean_power) &&
         grow((void **)&c->pair_start, room, sizeof *c->pair_start) &&
         grow((void **)&c->of_patch, room, sizeof *c->of_patch);
  }
  if (ok && pairs + 1 > c->room_pairs) {
    c->room_pairs = pairs + pairs / 4 + 64;
    ok = grow((void **)&c->sink, c->room_pairs, sizeof *c->sink) &&
         grow((void **)&c->conductance, c->room_pairs, sizeof *c->conductance);
  }
  if (!ok) c->room_near = c->room_contacts = c->room_pairs = 0;
  return ok;
}

static void append_share(Contacts *c, ptrdiff_t *pairs, const Share *share)
{
  for (ptrdiff_t s = 0; s < share->n; s++) {
    const Contact *from = &share->contact[s];
    const ptrdiff_t e = c->n++;
    if (c->n_near == 0 || c->near[c->n_near - 1] != from->particle) {
      c->first[c->n_near] = e;
      c->near[c->n_near++] = from->particle;
    }
    c->patch[e] = from->patch;
    c->area[e] = from->area;
    c->power[e] = c->most[e] = 0.0;
    memcpy(c->plane[e], from->plane, sizeof from->plane);
    c->pair_start[e + 1] = c->pair_start[e] + from->n_pairs;
  }
  if (share->n_pairs > 0) memcpy(c->sink + *pairs, share->pair, (size_t)share->n_pairs * sizeof *c->sink);
  *pairs += share->n_pairs;
}

static bool join_shares(Contacts *c, const Share *shares, int n_shares)
{
  ptrdiff_t near = 0, n = 0, pairs = 0;
  for (int s = 0; s < n_shares; s++) {
    if (shares[s].failed) return false;
    near += shares[s].n_near;
    n += shares[s].n;
    pairs += shares[s].n_pairs;
  }
  if (!reserve(c, near, n, pairs)) return false;
  c->n_near = c->n = pairs = 0;
  c->pair_start[0] = 0;
  for (int s = 0; s < n_shares; s++) append_share(c, &pairs, &shares[s]);
  c->first[c->n_near] = c->n;
  return true;
}

static bool sort_by_patch(Contacts *c, size_t n_patches)
{
  if (!grow((void **)&c->of_patch_start, (ptrdiff_t)n_patches + 2, sizeof *c->of_patch_start)) return false;
  ptrdiff_t *start = c->of_patch_start;
  for (size_t l = 0; l < n_patches + 2; l++) start[l] = 0;
  for (ptrdiff_t e = 0; e < c->n; e++) start[c->patch[e] + 2]++;
  for (size_t l = 2; l < n_patches + 2; l++) start[l] += start[l - 1];
  for (ptrdiff_t e = 0; e < c->n; e++) c->of_patch[start[c->patch[e] + 1]++] = e;
  return true;
}

static void free_shares(Share *shares, int n)
{
  for (int s = 0; s < n && shares; s++) {
    free(shares[s].contact);
    free(shares[s].pair);
    free(shares[s].touch);
  }
  free(shares);
}

static Build begin_build(const ContactRules *rules, const Particles *p, const Neighbours *neighbours)
{
  const double h = rules->sph->h, *period = neighbours_period(neighbours);
  return (Build){.rules = rules,
                 .p = p,
                 .list = neighbours_fluid_wall(neighbours),
                 .period = {period[0], period[1], period[2]},
                 .slope = shape_norm(rules->sph->kernel) / (h * h * h * h * h),
                 .reach2 = (1.0 - 1e-12) * pow(kernel_support(rules->sph->kernel) * h, 2.0)}; // no area is zero
}

double contacts_share(const ContactRules *rules, const Particles *p, const Neighbours *neighbours, ptrdiff_t i,
                      ptrdiff_t k)
{
  const Build build = begin_build(rules, p, neighbours);
  const WallFacing wall = face_wall(p, k);
  Touch touch;
  place_touch(&build, i, &wall, &touch);
  measure_rows(&build, rules->sph->kernel, 2.0 * p->volume[i], &touch, 1);
  if (touch.area <= 0.0 || touch.distance < -behind * rules->sph->spacing) return 0.0;
  return touch.area / fmax(touch.distance, rules->least_distance);
}

/* Once for a run. */
static bool face_walls(Contacts *c, const Particles *p)
{
  const ptrdiff_t n = p->n - p->n_fluid;
  if (c->facing && c->n_facing == n) return true;
  free(c->facing);
  c->facing = aligned_alloc(64, (size_t)(n + 1) * sizeof *c->facing);
  c->n_facing = n;
  for (ptrdiff_t k = 0; c->facing && k < n; k++) c->facing[k] = face_wall(p, k);
  return c->facing != NULL;
}

CastStatus contacts_build(Contacts *c, const ContactRules *rules, const Particles *p, const Neighbours *neighbours,
                          CastError *err)
{
  CAST_CHECK(face_walls(c, p), err, CAST_ERR_MEMORY, "coupling: no memory for %td walls", p->n - p->n_fluid);
  Build build = begin_build(rules, p, neighbours);
  build.facing = c->facing;
  const ptrdiff_t longest = longest_row(build.list);
  const int most = omp_get_max_threads();
  int used = 0;
  Share *shares = calloc((size_t)most, sizeof *shares);
  CAST_CHECK(shares, err, CAST_ERR_MEMORY, "coupling: no memory");
#pragma omp parallel num_threads(most)
  {
#pragma omp single
    used = omp_get_num_threads();
    fill_share(&build, omp_get_thread_num(), used, longest, &shares[omp_get_thread_num()]);
  }
  const bool ok = join_shares(c, shares, used) && sort_by_patch(c, rules->n_patches);
  free_shares(shares, most);
  CAST_CHECK(ok, err, CAST_ERR_MEMORY, "coupling: no memory for the contacts of %td particles", p->n_fluid);
  return CAST_OK;
}

void contacts_free(Contacts *c)
{
  free(c->near);
  free(c->first);
  free(c->patch);
  free(c->area);
  free(c->plane);
  free(c->power);
  free(c->most);
  free(c->mean_power);
  free(c->pair_start);
  free(c->sink);
  free(c->conductance);
  free(c->of_patch_start);
  free(c->of_patch);
  free(c->facing);
  *c = (Contacts){0};
}
