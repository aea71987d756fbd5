/* placement.c - lattice points where melt stands at the start. */
#include "cast/geometry/placement.h"

#include <stdlib.h>
#include "cast/geometry/cavity_mask.h"

static const double CLEARANCE = 0.4; // of the spacing, from the mould's surface

void points_destroy(PointSet *points)
{
  for (int k = 0; k < 3; k++) free(points->x[k]);
  *points = (PointSet){0};
}

CastStatus points_reserve(PointSet *points, ptrdiff_t more, CastError *err)
{
  for (int k = 0; k < 3; k++) {
    double *grown = realloc(points->x[k], (size_t)(points->n + more + 1) * sizeof *grown);
    CAST_CHECK(grown, err, CAST_ERR_MEMORY, "no memory for %td points of melt", points->n + more);
    points->x[k] = grown;
  }
  return CAST_OK;
}

bool placement_is_clear(const Surface *surface, const double x[3], double clearance)
{
  SurfaceHit hit;
  if (surface_nearest(surface, x, clearance * (1.0 - 1.0e-9), &hit)) return false;
  return !surface_inside_mould(surface, x);
}

typedef struct LatticeRange {
  int32_t first[3], n[3];
} LatticeRange;

/* Cells whose centres lie in [low, high]; a hair of rounding is allowed for at both ends. */
static CastStatus range_of(const double low[3], const double high[3], double spacing, const double origin[3],
                           LatticeRange *range, CastError *err)
{
  double cells = 1.0;
  CAST_CHECK(spacing > 0.0 && isfinite(spacing), err, CAST_ERR_ARGUMENT, "spacing %g m must be positive", spacing);
  for (int k = 0; k < 3; k++) {
    const double first = ceil((low[k] - origin[k]) / spacing - 0.5 - 1.0e-6);
    const double last = floor((high[k] - origin[k]) / spacing - 0.5 + 1.0e-6);
    CAST_CHECK(isfinite(first) && isfinite(last) && fabs(first) < 1.0e9 && fabs(last) < 1.0e9, err, CAST_ERR_INPUT,
               "a block from %g to %g m cannot be filled %g m apart", low[k], high[k], spacing);
    range->first[k] = (int32_t)first;
    range->n[k] = last >= first ? (int32_t)(last - first) + 1 : 0;
    cells *= range->n[k];
  }
  CAST_CHECK(cells < 2.0e9, err, CAST_ERR_INPUT, "a block %g m apart would hold %g particles", spacing, cells);
  return CAST_OK;
}

/* Centre of cell number c of the range. */
static void range_point(const LatticeRange *range, ptrdiff_t c, double spacing, const double origin[3], double x[3])
{
  const ptrdiff_t at[3] = {c % range->n[0], c / range->n[0] % range->n[1], c / range->n[0] / range->n[1]};
  for (int k = 0; k < 3; k++) x[k] = origin[k] + ((double)(range->first[k] + at[k]) + 0.5) * spacing;
}

/* The points with wanted[c] != 0, appended in the order of the lattice. */
static CastStatus append_wanted(const LatticeRange *range, const uint8_t *wanted, double spacing,
                                const double origin[3], PointSet *points, CastError *err)
{
  const ptrdiff_t cells = (ptrdiff_t)range->n[0] * range->n[1] * range->n[2];
  ptrdiff_t n = 0;
  for (ptrdiff_t c = 0; c < cells; c++) n += wanted[c];
  CAST_CHECK(n > 0, err, CAST_ERR_INPUT,
             "no room for melt: none of %td lattice points is outside the mould and %g m from its wall", cells,
             CLEARANCE * spacing);
  CAST_CALL(points_reserve(points, n, err));
  for (ptrdiff_t c = 0; c < cells; c++) {
    double x[3];
    if (!wanted[c]) continue;
    range_point(range, c, spacing, origin, x);
    for (int k = 0; k < 3; k++) points->x[k][points->n] = x[k];
    points->n++;
  }
  return CAST_OK;
}

CastStatus placement_add_block(const Surface *surface, double spacing, const double origin[3], const double corner[3],
                               const double size[3], PointSet *points, CastError *err)
{
  double high[3];
  for (int k = 0; k < 3; k++) high[k] = corner[k] + size[k];
  LatticeRange range;
  CAST_CALL(range_of(corner, high, spacing, origin, &range, err));
  const ptrdiff_t cells = (ptrdiff_t)range.n[0] * range.n[1] * range.n[2];
  uint8_t *wanted = malloc((size_t)(cells ? cells : 1));
  CAST_CHECK(wanted, err, CAST_ERR_MEMORY, "no memory for a block of %td points", cells);
#pragma omp parallel for schedule(dynamic, 1024)
  for (ptrdiff_t c = 0; c < cells; c++) {
    double x[3];
    range_point(&range, c, spacing, origin, x);
    wanted[c] = placement_is_clear(surface, x, CLEARANCE * spacing) ? 1 : 0;
  }
  const CastStatus status = append_wanted(&range, wanted, spacing, origin, points, err);
  free(wanted);
  return status;
}

/* Keep of the cavity's cells those whose centre is below the level and clear of the mould. */
static void thin_out(const CavityMask *mask, const LatticeRange *range, double level)
{
  const ptrdiff_t cells = cavity_mask_size(mask);
#pragma omp parallel for schedule(dynamic, 1024)
  for (ptrdiff_t c = 0; c < cells; c++) {
    if (!mask->is_cavity[c]) continue;
    double x[3];
    range_point(range, c, mask->spacing, mask->origin, x);
    bool keep = x[2] < level && placement_is_clear(mask->surface, x, CLEARANCE * mask->spacing);
    for (int k = 0; k < 3; k++)
      keep = keep && x[k] > mask->surface->cavity_low[k] && x[k] < mask->surface->cavity_high[k];
    mask->is_cavity[c] = keep ? 1 : 0;
  }
}

CastStatus placement_add_cavity_below(const Surface *surface, double spacing, const double origin[3], double level,
                                      PointSet *points, CastError *err)
{
  CavityMask mask;
  CAST_CALL(cavity_mask_create(surface, spacing, origin, &mask, err));
  LatticeRange range;
  for (int k = 0; k < 3; k++) {
    range.first[k] = mask.first[k];
    range.n[k] = mask.n[k];
  }
  thin_out(&mask, &range, level);
  const CastStatus status = append_wanted(&range, mask.is_cavity, spacing, origin, points, err);
  cavity_mask_destroy(&mask);
  return status;
}
