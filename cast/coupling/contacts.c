/* All contacts of a build: rows are shared out among threads in contiguous pieces and joined in their order, so they
 * are the same on any number of threads. What a row holds: contact_row.c. */
#include "cast/coupling/contact_row.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

static bool grow(void **array, ptrdiff_t count, size_t size)
{
  void *more = realloc(*array, (size_t)count * size);
  if (more) *array = more;
  return more != NULL;
}

static bool reserve_row(ContactShare *share, ptrdiff_t length)
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

static void fill_share(const ContactBuild *b, int thread, int threads, ptrdiff_t longest, ContactShare *share)
{
  const ptrdiff_t end = share_begin(b->list, thread + 1, threads);
  share->touch = malloc((size_t)(longest + 1) * sizeof *share->touch);
  share->failed = !share->touch;
  for (ptrdiff_t i = share_begin(b->list, thread, threads); i < end && !share->failed; i++) {
    const ptrdiff_t length = b->list->start[i + 1] - b->list->start[i];
    if (length == 0) continue;
    share->failed = !reserve_row(share, length + 1);
    if (!share->failed) contact_row_fill(b, i, share);
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

static void append_share(Contacts *c, ptrdiff_t *pairs, const ContactShare *share)
{
  for (ptrdiff_t s = 0; s < share->n; s++) {
    const RowContact *from = &share->contact[s];
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

static bool join_shares(Contacts *c, const ContactShare *shares, int n_shares)
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

static void free_shares(ContactShare *shares, int n)
{
  for (int s = 0; s < n && shares; s++) {
    free(shares[s].contact);
    free(shares[s].pair);
    free(shares[s].touch);
  }
  free(shares);
}

/* Once for a run. */
static bool face_walls(Contacts *c, const Particles *p)
{
  const ptrdiff_t n = p->n - p->n_fluid;
  if (c->facing && c->n_facing == n) return true;
  free(c->facing);
  c->facing = aligned_alloc(64, (size_t)(n + 1) * sizeof *c->facing);
  c->n_facing = n;
  for (ptrdiff_t k = 0; c->facing && k < n; k++) c->facing[k] = contact_face_wall(p, k);
  return c->facing != NULL;
}

CastStatus contacts_build(Contacts *c, const ContactRules *rules, const Particles *p, const Neighbours *neighbours,
                          CastError *err)
{
  CAST_CHECK(face_walls(c, p), err, CAST_ERR_MEMORY, "coupling: no memory for %td walls", p->n - p->n_fluid);
  ContactBuild build = contact_build_begin(rules, p, neighbours);
  build.facing = c->facing;
  const ptrdiff_t longest = longest_row(build.list);
  const int most = omp_get_max_threads();
  int used = 0;
  ContactShare *shares = calloc((size_t)most, sizeof *shares);
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
