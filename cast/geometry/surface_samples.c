/* surface_samples.c - points spread over the cavity wall, with areas that add up exactly.
 * Method: triangles are cut into equal shares of at most half a spacing^2; shares of one patch that face the same way
 * (by the largest component of the normal) and lie in the same cube of edge `spacing` become one sample, which stands
 * at the share nearest to their common centroid, so on the wall. */
#include "cast/geometry/surface_internal.h"

#include <stdlib.h>

typedef struct Share {
  int32_t patch, cube[3], facing, number;
  double x[3], area;
} Share;

static int compare_shares(const void *left, const void *right)
{
  const Share *a = left, *b = right;
  if (a->patch != b->patch) return a->patch < b->patch ? -1 : 1;
  for (int k = 2; k >= 0; k--)
    if (a->cube[k] != b->cube[k]) return a->cube[k] < b->cube[k] ? -1 : 1;
  if (a->facing != b->facing) return a->facing < b->facing ? -1 : 1;
  return (a->number > b->number) - (a->number < b->number);
}

static bool same_sample(const Share *a, const Share *b)
{
  return a->patch == b->patch && a->facing == b->facing && a->cube[0] == b->cube[0] && a->cube[1] == b->cube[1] &&
         a->cube[2] == b->cube[2];
}

static double facet_area(const Facet *facet)
{
  double u[3], v[3], n[3];
  vec_sub(facet->corner[1], facet->corner[0], u);
  vec_sub(facet->corner[2], facet->corner[0], v);
  vec_cross(u, v, n);
  return 0.5 * vec_norm(n);
}

/* Rows into which a triangle is cut: rows^2 congruent shares. */
static int32_t count_rows(const Facet *facet, double spacing)
{
  return (int32_t)fmax(ceil(sqrt(facet_area(facet) / (0.5 * spacing * spacing))), 1.0);
}

static int32_t facing_of(const double n[3])
{
  int k = 0;
  for (int j = 1; j < 3; j++)
    if (fabs(n[j]) > fabs(n[k]) + 1.0e-9) k = j; // a margin, so that rounding does not tear a 45 degree wall apart
  return 2 * k + (n[k] < 0.0);
}

/* Shares of one triangle: in row i there are i + 1 upright ones and i upside down. */
static ptrdiff_t cut_triangle(const Surface *s, ptrdiff_t t, double spacing, Share *share)
{
  const Facet *facet = &s->facet[t];
  const int32_t rows = count_rows(facet, spacing);
  ptrdiff_t n = 0;
  for (int32_t i = 0; i < rows; i++)
    for (int32_t j = 0; j < 2 * i + 1; j++) {
      const double down = j % 2 ? i + 1.0 / 3.0 : i + 2.0 / 3.0, across = j % 2 ? j / 2 + 2.0 / 3.0 : j / 2 + 1.0 / 3.0;
      Share *out = &share[n++];
      *out = (Share){
          .patch = s->patch[t], .facing = facing_of(facet->normal), .area = facet_area(facet) / ((double)rows * rows)};
      for (int k = 0; k < 3; k++) {
        const double a = facet->corner[0][k], b = facet->corner[1][k], c = facet->corner[2][k];
        out->x[k] = a + (down - across) / rows * (b - a) + across / rows * (c - a);
        out->cube[k] = (int32_t)floor((out->x[k] - s->low[k]) / spacing);
      }
    }
  return n;
}

static CastStatus make_shares(const Surface *s, double spacing, Share **shares, ptrdiff_t *n, CastError *err)
{
  double total = 0.0;
  for (ptrdiff_t t = 0; t < s->n_triangles; t++)
    if (!s->outer[t]) total += pow((double)count_rows(&s->facet[t], spacing), 2.0);
  CAST_CHECK(total < 3.0e7, err, CAST_ERR_INPUT, "samples %g m apart would be %g on this cavity wall", spacing, total);
  *shares = malloc((size_t)(total + 1.0) * sizeof **shares);
  CAST_CHECK(*shares, err, CAST_ERR_MEMORY, "no memory for %g samples of the cavity wall", total);
  *n = 0;
  for (ptrdiff_t t = 0; t < s->n_triangles; t++)
    if (!s->outer[t]) *n += cut_triangle(s, t, spacing, *shares + *n);
  for (ptrdiff_t k = 0; k < *n; k++) (*shares)[k].number = (int32_t)k;
  qsort(*shares, (size_t)*n, sizeof **shares, compare_shares);
  return CAST_OK;
}

/* One sample from shares [0, n). */
static void add_sample(const Share *share, ptrdiff_t n, SurfaceSamples *samples)
{
  double centre[3] = {0.0, 0.0, 0.0}, area = 0.0;
  for (ptrdiff_t k = 0; k < n; k++) {
    area += share[k].area;
    vec_axpy(share[k].area, share[k].x, centre, centre);
  }
  for (int k = 0; k < 3; k++) centre[k] /= area;
  ptrdiff_t nearest = 0;
  for (ptrdiff_t k = 1; k < n; k++)
    if (vec_distance2(share[k].x, centre) < vec_distance2(share[nearest].x, centre)) nearest = k;
  const ptrdiff_t i = samples->n++;
  for (int k = 0; k < 3; k++) samples->x[k][i] = share[nearest].x[k];
  samples->area[i] = area;
  samples->patch[i] = share->patch;
}

static CastStatus gather_samples(const Share *shares, ptrdiff_t n, SurfaceSamples *samples, CastError *err)
{
  ptrdiff_t count = 0;
  for (ptrdiff_t k = 0; k < n; k++) count += k == 0 || !same_sample(&shares[k - 1], &shares[k]);
  const size_t size = (size_t)(count ? count : 1);
  for (int k = 0; k < 3; k++) samples->x[k] = malloc(size * sizeof(double));
  samples->area = malloc(size * sizeof(double));
  samples->patch = malloc(size * sizeof *samples->patch);
  CAST_CHECK(samples->x[0] && samples->x[1] && samples->x[2] && samples->area && samples->patch, err, CAST_ERR_MEMORY,
             "no memory for %td samples of the cavity wall", count);
  for (ptrdiff_t first = 0, next; first < n; first = next) {
    for (next = first + 1; next < n && same_sample(&shares[first], &shares[next]);) next++;
    add_sample(shares + first, next - first, samples);
  }
  return CAST_OK;
}

CastStatus surface_samples_create(const Surface *surface, double spacing, SurfaceSamples *samples, CastError *err)
{
  *samples = (SurfaceSamples){0};
  CAST_CHECK(spacing > 0.0 && isfinite(spacing), err, CAST_ERR_ARGUMENT, "samples: spacing %g m must be positive",
             spacing);
  Share *shares = NULL;
  ptrdiff_t n = 0;
  CastStatus status = make_shares(surface, spacing, &shares, &n, err);
  if (status == CAST_OK) status = gather_samples(shares, n, samples, err);
  free(shares);
  if (status != CAST_OK) surface_samples_destroy(samples);
  return status;
}

void surface_samples_destroy(SurfaceSamples *samples)
{
  for (int k = 0; k < 3; k++) free(samples->x[k]);
  free(samples->area);
  free(samples->patch);
  *samples = (SurfaceSamples){0};
}
