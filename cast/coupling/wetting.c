/* Wetted area: points spread over the cavity wall, each wet by as much as particles that stand on the wall cover it.
 *
 *   wet_s = min(1, sum_i g(height_i) c(beside_i)/open_s), height along the wall's normal at s, beside across it;
 *   c spreads the area spacing^2 of one particle (Wendland C2 in the plane, 2 spacings wide);
 *   g is 1 for a particle that stands on the wall and 0 beyond: it falls off from 1.25 to 1.55 spacings, so that melt
 *   that has settled (layers at 1/2, 3/2..) and melt on a lattice that does not fit the wall (first particles anywhere
 *   from 0.4 to 1.4 spacings) both cover it, as does a film of one layer; a lone particle wets spacing^2.
 * open_s is the share of that space that no mould takes, so that a corner filled with melt is wet to its edge; what a
 * thin mould wall hides from s is not open, and its echoes (walls.h) stand there. */
#include "cast/coupling/wetting.h"

#include <math.h>
#include <stdlib.h>

#include "cast/kernel/pair.h"
#include "cast/particles/cells.h"

static const double least_open = 0.1;                        // below it a point lies in a crack
static const double stands = 1.25, off = 1.55, beside = 2.0; // spacings, see above
static const double lift = 0.05;                             // spacings: how far above the wall a sample looks from

struct Wetting {
  const SphParameters *sph;
  const Surface *surface;
  double reach; // m, the farthest that covers
  SurfaceSamples samples;
  double *normal[3]; // [n] into the cavity
  double *open;      // [n] 1: nothing in front
  double *wet;       // [n]
  uint8_t *thin;     // [n] a thin mould wall is near: look before counting
  Cells cells;
  double *x[3], *volume; // [capacity] the points to sum over, in the order of the cells
  int32_t *point;        // [capacity] their numbers, as given
  ptrdiff_t capacity;
  double *scratch[3]; // [capacity] the same before sorting
};

/* ---- what covers a sample ---- */

static bool reserve(Wetting *w, ptrdiff_t n)
{
  if (n <= w->capacity) return true;
  double **const arrays[] = {&w->x[0], &w->x[1], &w->x[2], &w->volume, &w->scratch[0], &w->scratch[1], &w->scratch[2]};
  bool ok = true;
  for (size_t a = 0; a < sizeof arrays / sizeof *arrays; a++) {
    free(*arrays[a]);
    *arrays[a] = malloc((size_t)n * sizeof(double));
    ok = ok && *arrays[a];
  }
  free(w->point);
  w->point = malloc((size_t)n * sizeof *w->point);
  w->capacity = ok && w->point ? n : 0;
  return w->capacity == n;
}

/* Take the particles index[0..n) as the points of the sums to come. */
static CastStatus set_points(Wetting *w, const Particles *p, const int32_t *index, ptrdiff_t n, const double period[3],
                             CastError *err)
{
  CAST_CHECK(reserve(w, n + 1), err, CAST_ERR_MEMORY, "wetted area: no memory for %td particles", n);
  for (int d = 0; d < 3; d++)
    for (ptrdiff_t k = 0; k < n; k++) w->scratch[d][k] = p->x[d][index[k]];
  CAST_CALL(cells_sort(&w->cells, n, w->scratch, w->reach, period, err));
  for (ptrdiff_t k = 0; k < n; k++) {
    const int32_t from = w->cells.order[k];
    for (int d = 0; d < 3; d++) w->x[d][k] = w->scratch[d][from];
    w->volume[k] = p->volume[index[from]];
    w->point[k] = from;
  }
  return CAST_OK;
}

/* What points a sample counts: the walls that it sees, or the melt that touches its patch. */
typedef struct Seen {
  const Particles *p;
  const Contacts *contacts; // NULL: the points are wall particles
} Seen;

/* Does what stands here count for what sample s sees? */
static bool wall_counts(const Wetting *w, const Particles *p, ptrdiff_t s, ptrdiff_t k)
{
  if (!w->thin[s]) return !p->echo[k];
  double eye[3], place[3], foot[3], normal[3];
  for (int d = 0; d < 3; d++) {
    eye[d] = w->samples.x[d][s] + lift * w->sph->spacing * w->normal[d][s];
    place[d] = p->x[d][p->n_fluid + k];
    foot[d] = p->foot[d][k];
    normal[d] = p->normal[d][k];
  }
  return walls_seen(w->surface, eye, place, foot, normal, p->echo[k]);
}

/* Melt that a thin mould wall hides from sample s has no contact with its patch (contacts.c has looked). */
static bool melt_counts(const Wetting *w, const Contacts *contacts, ptrdiff_t s, ptrdiff_t near)
{
  if (!w->thin[s]) return true;
  for (ptrdiff_t e = contacts->first[near]; e < contacts->first[near + 1]; e++)
    if (contacts->patch[e] == w->samples.patch[s]) return true;
  return false;
}

/* g(height) c(beside), lengths in spacings: the share of a sample that a particle's volume of spacing^3 covers. */
static double cover(double height, double beside2)
{
  const double g = height < stands ? 1.0 : positive(off - height) / (off - stands);
  const double q = 2.0 * sqrt(beside2) / beside, t = positive(1.0 - 0.5 * q);
  return g * 7.0 / (pair_pi * beside * beside) * t * t * t * t * (2.0 * q + 1.0);
}

/* Sum over the points that stand higher than `sunk` m above the wall at sample s. */
static double cover_sum(const Wetting *w, const Seen *seen, ptrdiff_t s, double sunk)
{
  enum { CHUNK = 128 };
  const double at[3] = {w->samples.x[0][s], w->samples.x[1][s], w->samples.x[2][s]}, per_dx = 1.0 / w->sph->spacing;
  const double n[3] = {w->normal[0][s], w->normal[1][s], w->normal[2][s]}, dx = w->sph->spacing;
  const double highest = off * dx, far2 = beside * beside * dx * dx; // beyond either nothing is covered
  CellRun run[CELLS_RUNS];
  const int runs = cells_runs(&w->cells, at, run);
  double sum = 0.0, aside2[CHUNK], height[CHUNK];
  for (int r = 0; r < runs; r++) {
    const double from[3] = {at[0] - run[r].shift[0], at[1] - run[r].shift[1], at[2] - run[r].shift[2]};
    for (ptrdiff_t first = run[r].first; first < run[r].end; first += CHUNK) {
      const ptrdiff_t m = run[r].end - first < CHUNK ? run[r].end - first : CHUNK;
      const double *x = w->x[0] + first, *y = w->x[1] + first, *z = w->x[2] + first;
#pragma omp simd
      for (ptrdiff_t k = 0; k < m; k++) {
        const double rx = x[k] - from[0], ry = y[k] - from[1], rz = z[k] - from[2];
        const double up = rx * n[0] + ry * n[1] + rz * n[2], aside = rx * rx + ry * ry + rz * rz - up * up;
        height[k] = up;
        aside2[k] = up > sunk && up < highest ? aside : far2;
      }
      for (ptrdiff_t k = 0; k < m; k++) {
        if (aside2[k] >= far2) continue;
        const double beside2 = positive(aside2[k]) * per_dx * per_dx;
        const double share = cover(height[k] * per_dx, beside2) * (w->volume[first + k] * cube(per_dx));
        const int32_t point = w->point[first + k];
        if (share > 0.0 &&
            (seen->contacts ? melt_counts(w, seen->contacts, s, point) : wall_counts(w, seen->p, s, point)))
          sum += share;
      }
    }
  }
  return sum;
}

/* ---- life ---- */

static CastStatus find_normals(Wetting *w, CastError *err)
{
  const size_t n = (size_t)(w->samples.n > 0 ? w->samples.n : 1);
  bool ok = true;
  for (int d = 0; d < 3; d++) ok = (w->normal[d] = calloc(n, sizeof(double))) && ok;
  w->open = malloc(n * sizeof(double));
  w->wet = malloc(n * sizeof(double));
  w->thin = calloc(n, 1);
  CAST_CHECK(ok && w->open && w->wet && w->thin, err, CAST_ERR_MEMORY, "wetted area: no memory for %zu points", n);
#pragma omp parallel for schedule(static)
  for (ptrdiff_t s = 0; s < w->samples.n; s++) {
    const double at[3] = {w->samples.x[0][s], w->samples.x[1][s], w->samples.x[2][s]};
    SurfaceHit hit;
    w->thin[s] = surface_thin_near(w->surface, at);
    if (!surface_nearest(w->surface, at, surface_reach(w->surface), &hit)) continue; // normal zero: all is in front
    for (int d = 0; d < 3; d++) w->normal[d][s] = hit.normal[d];
  }
  return CAST_OK;
}

/* What the mould leaves open in front of each sample: a wall particle's part of the half space is not open. */
static CastStatus find_open(Wetting *w, const Particles *p, CastError *err)
{
  const ptrdiff_t n = p->n - p->n_fluid;
  int32_t *index = malloc((size_t)(n + 1) * sizeof *index);
  CAST_CHECK(index, err, CAST_ERR_MEMORY, "wetted area: no memory");
  for (ptrdiff_t k = 0; k < n; k++) index[k] = (int32_t)(p->n_fluid + k);
  const CastStatus status = set_points(w, p, index, n, (const double[3]){0.0, 0.0, 0.0}, err);
  free(index);
  CAST_CALL(status);
  const Seen seen = {p, NULL};
#pragma omp parallel for schedule(dynamic, 64)
  for (ptrdiff_t s = 0; s < w->samples.n; s++) {
    const double mould = cover_sum(w, &seen, s, 0.0) / (0.5 * (stands + off)); // of all the space that counts
    w->open[s] = fmin(fmax(1.0 - mould, least_open), 1.0);
  }
  return CAST_OK;
}

CastStatus wetting_create(const Surface *surface, const SphParameters *sph, const Particles *particles, Wetting **out,
                          CastError *err)
{
  *out = NULL;
  Wetting *w = calloc(1, sizeof *w);
  CAST_CHECK(w, err, CAST_ERR_MEMORY, "wetted area: no memory");
  w->sph = sph;
  w->surface = surface;
  w->reach = sqrt(off * off + beside * beside) * sph->spacing;
  CastStatus status = surface_samples_create(surface, sph->spacing, &w->samples, err);
  if (status == CAST_OK) status = find_normals(w, err);
  if (status == CAST_OK) status = find_open(w, particles, err);
  if (status != CAST_OK) wetting_destroy(&w);
  *out = w;
  return status;
}

void wetting_destroy(Wetting **wetting)
{
  if (!wetting || !*wetting) return;
  Wetting *w = *wetting;
  surface_samples_destroy(&w->samples);
  cells_free(&w->cells);
  for (int d = 0; d < 3; d++) {
    free(w->normal[d]);
    free(w->x[d]);
    free(w->scratch[d]);
  }
  free(w->open);
  free(w->wet);
  free(w->thin);
  free(w->point);
  free(w->volume);
  free(w);
  *wetting = NULL;
}

CastStatus wetting_measure(Wetting *w, const Contacts *contacts, const Particles *particles,
                           const Neighbours *neighbours, double *area, CastError *err)
{
  CAST_CALL(set_points(w, particles, contacts->near, contacts->n_near, neighbours_period(neighbours), err));
  const Seen seen = {particles, contacts};
  const double sunk = -0.1 * w->sph->spacing; // the wall guard lets a particle sink that deep
#pragma omp parallel for schedule(dynamic, 64)
  for (ptrdiff_t s = 0; s < w->samples.n; s++) w->wet[s] = fmin(cover_sum(w, &seen, s, sunk) / w->open[s], 1.0);
  for (ptrdiff_t s = 0; s < w->samples.n; s++) area[w->samples.patch[s]] = 0.0;
  for (ptrdiff_t s = 0; s < w->samples.n; s++) area[w->samples.patch[s]] += w->samples.area[s] * w->wet[s];
  return CAST_OK;
}
