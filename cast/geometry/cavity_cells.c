/* cavity_cells.c - the cavity as lattice cells with volumes and names, and its thinnest gap. */
#include "cast/geometry/cavity_mask.h"
#include "cast/geometry/cavity_names.h"
#include "cast/geometry/placement.h"

#include <stdlib.h>
#include <string.h>

/* Named cavity surfaces in the order of the patches, and the one that each patch is part of. */
static CastStatus list_names(const RomData *rom, CavityCells *cells, int32_t *name_of_patch, CastError *err)
{
  cells->names = calloc(rom->m ? rom->m : 1, sizeof *cells->names);
  CAST_CHECK(cells->names, err, CAST_ERR_MEMORY, "no memory for the names of %zu patches", rom->m);
  for (size_t p = 0; p < rom->m; p++) {
    name_of_patch[p] = -1;
    if (rom->patch[p].outer) continue;
    size_t k = 0;
    while (k < cells->n_surfaces && strcmp(cells->names[k], rom->patch[p].surface) != 0) k++;
    if (k == cells->n_surfaces) memcpy(cells->names[cells->n_surfaces++], rom->patch[p].surface, ROM_NAME_LENGTH);
    name_of_patch[p] = (int32_t)k;
  }
  return CAST_OK;
}

static CastStatus allocate_cells(CavityCells *cells, const CavityMask *mask, int32_t **list, CastError *err)
{
  ptrdiff_t n = 0;
  for (ptrdiff_t c = 0; c < cavity_mask_size(mask); c++) n += mask->is_cavity[c];
  const size_t size = (size_t)(n ? n : 1);
  for (int k = 0; k < 3; k++) cells->x[k] = malloc(size * sizeof(double));
  cells->volume = malloc(size * sizeof(double));
  cells->surface = malloc(size * sizeof *cells->surface);
  *list = malloc(size * sizeof **list);
  CAST_CHECK(cells->x[0] && cells->x[1] && cells->x[2] && cells->volume && cells->surface && *list, err,
             CAST_ERR_MEMORY, "no memory for %td cells of the cavity", n);
  for (ptrdiff_t c = 0; c < cavity_mask_size(mask); c++)
    if (mask->is_cavity[c]) (*list)[cells->n++] = (int32_t)c;
  return CAST_OK;
}

/* Volumes and centroids. Iteration i writes only what is cell i's. */
static void fill_cells(const CavityMask *mask, const int32_t *list, CavityCells *cells)
{
  enum { CHUNK = 1024 };
#pragma omp parallel for schedule(dynamic, 1)
  for (ptrdiff_t chunk = 0; chunk < (cells->n + CHUNK - 1) / CHUNK; chunk++) {
    const ptrdiff_t first = chunk * CHUNK, end = first + CHUNK < cells->n ? first + CHUNK : cells->n;
    ptrdiff_t near = cavity_mask_find(mask, list[first]);
    for (ptrdiff_t i = first; i < end; i++) {
      CutPart part;
      while (near < mask->n_near && mask->near[near].cell < list[i]) near++;
      if (near < mask->n_near && mask->near[near].cell == list[i])
        part = mask->near[near].part;
      else
        cavity_mask_whole(mask, list[i], &part);
      for (int k = 0; k < 3; k++) cells->x[k][i] = part.moment[k] / part.volume;
      cells->volume[i] = part.volume;
    }
  }
}

static CastStatus build_cells(const CavityMask *mask, const RomData *rom, int32_t *name_of_patch, int32_t **list,
                              CavityCells *cells, CastError *err)
{
  CAST_CALL(list_names(rom, cells, name_of_patch, err));
  CAST_CALL(allocate_cells(cells, mask, list, err));
  fill_cells(mask, *list, cells);
  return cavity_name_cells(mask, *list, name_of_patch, cells, err);
}

CastStatus cavity_cells_create(const Surface *surface, const RomData *rom, double spacing, const double origin[3],
                               CavityCells *cells, CastError *err)
{
  *cells = (CavityCells){.cell = spacing};
  CavityMask mask;
  CAST_CALL(cavity_mask_create(surface, spacing, origin, &mask, err));
  int32_t *name_of_patch = malloc((rom->m ? rom->m : 1) * sizeof *name_of_patch);
  int32_t *list = NULL;
  CastStatus status = CAST_ERR_MEMORY;
  if (name_of_patch)
    status = build_cells(&mask, rom, name_of_patch, &list, cells, err);
  else
    cast_error_set(err, status, "no memory for %zu patches", rom->m);
  free(list);
  free(name_of_patch);
  cavity_mask_destroy(&mask);
  if (status != CAST_OK) cavity_cells_destroy(cells);
  return status;
}

void cavity_cells_destroy(CavityCells *cells)
{
  for (int k = 0; k < 3; k++) free(cells->x[k]);
  free(cells->volume);
  free(cells->surface);
  free(cells->names);
  *cells = (CavityCells){0};
}

typedef struct Gap {
  double width, area;
  ptrdiff_t sample;
} Gap;

static int compare_gaps(const void *left, const void *right)
{
  const Gap *a = left, *b = right;
  if (a->width != b->width) return a->width < b->width ? -1 : 1;
  return (a->sample > b->sample) - (a->sample < b->sample);
}

/* From a point of the cavity wall straight to the wall that faces it (within 60 degrees); INFINITY if none does. A wall
 * met askew, as in a corner, bounds no feature. */
static double measure_gap(const Surface *surface, const double x[3], double far)
{
  SurfaceHit at;
  double start[3], distance;
  int32_t triangle;
  if (!surface_nearest(surface, x, surface->reach, &at)) return INFINITY;
  const double *normal = surface->facet[at.triangle].normal;
  vec_axpy(1.0e-7 * far, normal, x, start);
  if (!surface_first_crossing(surface, start, normal, far, &distance, &triangle)) return INFINITY;
  if (surface->outer[triangle] || vec_dot(normal, surface->facet[triangle].normal) > -0.5) return INFINITY;
  return distance;
}

static CastStatus measure_gaps(const Surface *surface, const SurfaceSamples *samples, Gap **gaps, CastError *err)
{
  double size[3];
  vec_sub(surface->high, surface->low, size);
  const double far = vec_norm(size);
  *gaps = malloc((size_t)(samples->n ? samples->n : 1) * sizeof **gaps);
  CAST_CHECK(*gaps, err, CAST_ERR_MEMORY, "no memory for %td rays across the cavity", samples->n);
  Gap *const out = *gaps;
#pragma omp parallel for schedule(dynamic, 256)
  for (ptrdiff_t i = 0; i < samples->n; i++) {
    const double x[3] = {samples->x[0][i], samples->x[1][i], samples->x[2][i]};
    out[i] = (Gap){measure_gap(surface, x, far), samples->area[i], i};
  }
  qsort(out, (size_t)samples->n, sizeof *out, compare_gaps);
  return CAST_OK;
}

/* The width below which 1 % of the wall's area lies; without any facing walls, the cavity's own least extent. */
static void pick_gap(const Surface *surface, const SurfaceSamples *samples, const Gap *gaps, double *gap,
                     double where[3])
{
  double total = 0.0, sum = 0.0;
  for (ptrdiff_t i = 0; i < samples->n; i++) total += gaps[i].area;
  ptrdiff_t pick = 0;
  while (pick + 1 < samples->n && (sum += gaps[pick].area) < 0.01 * total) pick++;
  *gap = gaps[pick].width;
  for (int k = 0; k < 3; k++) where[k] = samples->x[k][gaps[pick].sample];
  if (isfinite(*gap)) return;
  for (int k = 0; k < 3; k++) {
    const double extent = surface->cavity_high[k] - surface->cavity_low[k];
    if (extent > 1.0e3 * surface->tiny) *gap = fmin(*gap, extent);
    where[k] = 0.5 * (surface->cavity_low[k] + surface->cavity_high[k]);
  }
}

CastStatus cavity_thinnest_gap(const Surface *surface, double *gap, double where[3], CastError *err)
{
  enum { SAMPLES = 20000 };
  double area = 0.0;
  for (ptrdiff_t t = 0; t < surface->n_triangles; t++) {
    double u[3], v[3], n[3];
    vec_sub(surface->facet[t].corner[1], surface->facet[t].corner[0], u);
    vec_sub(surface->facet[t].corner[2], surface->facet[t].corner[0], v);
    vec_cross(u, v, n);
    if (!surface->outer[t]) area += 0.5 * vec_norm(n);
  }
  CAST_CHECK(area > 0.0, err, CAST_ERR_INPUT, "the mould has no cavity wall");
  SurfaceSamples samples;
  CAST_CALL(surface_samples_create(surface, sqrt(area / SAMPLES), &samples, err));
  Gap *gaps = NULL;
  const CastStatus status = measure_gaps(surface, &samples, &gaps, err);
  if (status == CAST_OK) pick_gap(surface, &samples, gaps, gap, where);
  free(gaps);
  surface_samples_destroy(&samples);
  return status;
}
