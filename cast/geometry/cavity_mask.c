/* cavity_mask.c - which lattice cells belong to the cavity.
 * Method: within the box round the cavity wall, void cells at the wall belong to the cavity if nothing but cavity wall
 * is nearest to them; from them the cavity spreads through void cells face to face. The box ends at the openings' rims,
 * so the open air beyond them stays out. */
#include "cast/geometry/cavity_mask.h"

#include <stdlib.h>

enum { CELL_SOLID = 0, CELL_CAVITY = 1, CELL_VOID = 2 }; // CELL_VOID: void, not known to be the cavity's

ptrdiff_t cavity_mask_size(const CavityMask *mask)
{
  return (ptrdiff_t)mask->n[0] * mask->n[1] * mask->n[2];
}

/* The cell's box cut to the box round the cavity wall; false if nothing is left. */
static bool cell_box(const CavityMask *mask, ptrdiff_t cell, CutBox *box)
{
  const int32_t at[3] = {(int32_t)(cell % mask->n[0]), (int32_t)(cell / mask->n[0] % mask->n[1]),
                         (int32_t)(cell / mask->n[0] / mask->n[1])};
  for (int k = 0; k < 3; k++) {
    const double low = mask->origin[k] + (mask->first[k] + at[k]) * mask->spacing;
    box->low[k] = fmax(low, mask->surface->cavity_low[k]);
    box->high[k] = fmin(low + mask->spacing, mask->surface->cavity_high[k]);
    if (box->high[k] - box->low[k] <= 1.0e-9 * mask->spacing) return false;
  }
  return true;
}

void cavity_mask_void(const CavityMask *mask, ptrdiff_t cell, CutPart *part)
{
  CutBox box;
  CutPart mould = {0};
  *part = (CutPart){0};
  if (!cell_box(mask, cell, &box)) return;
  cut_whole(&box, part);
  double centre[3], half_diagonal = 0.0;
  for (int k = 0; k < 3; k++) {
    centre[k] = 0.5 * (box.low[k] + box.high[k]);
    half_diagonal += 0.25 * (box.high[k] - box.low[k]) * (box.high[k] - box.low[k]);
  }
  SurfaceHit hit;
  if (surface_nearest(mask->surface, centre, sqrt(half_diagonal), &hit))
    cut_box(mask->surface, &box, NULL, &mould);
  else if (surface_inside_mould(mask->surface, centre))
    mould = *part;
  cut_add(part, -1.0, &mould);
  if (part->volume < 1.0e-6 * mask->spacing * mask->spacing * mask->spacing) *part = (CutPart){0};
}

static uint8_t classify(const CavityMask *mask, ptrdiff_t cell)
{
  CutPart part;
  cavity_mask_void(mask, cell, &part);
  if (part.volume == 0.0) return CELL_SOLID;
  double x[3];
  for (int k = 0; k < 3; k++) x[k] = part.moment[k] / part.volume;
  SurfaceHit any, cavity;
  if (!surface_nearest(mask->surface, x, 1.01 * mask->spacing, &any)) return CELL_VOID;
  const NearestQuery query = {.reach = fabs(any.distance) * (1.0 + 1.0e-9) + mask->surface->tiny,
                              .guess = -1,
                              .cavity_only = true}; // at the rim cavity wall and outer face are equally near
  return surface_nearest_query(mask->surface, x, &query, &cavity) ? CELL_CAVITY : CELL_VOID;
}

static void spread(CavityMask *mask, int32_t *stack)
{
  static const int32_t step[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
  const ptrdiff_t cells = cavity_mask_size(mask);
  ptrdiff_t height = 0;
  for (ptrdiff_t c = 0; c < cells; c++)
    if (mask->is_cavity[c] == CELL_CAVITY) stack[height++] = (int32_t)c;
  while (height > 0) {
    const int32_t c = stack[--height];
    const int32_t at[3] = {c % mask->n[0], c / mask->n[0] % mask->n[1], c / mask->n[0] / mask->n[1]};
    for (int k = 0; k < 6; k++) {
      const int32_t to[3] = {at[0] + step[k][0], at[1] + step[k][1], at[2] + step[k][2]};
      bool within = true;
      for (int axis = 0; axis < 3; axis++) within = within && to[axis] >= 0 && to[axis] < mask->n[axis];
      if (!within) continue;
      const ptrdiff_t next = ((ptrdiff_t)to[2] * mask->n[1] + to[1]) * mask->n[0] + to[0];
      if (mask->is_cavity[next] != CELL_VOID) continue;
      mask->is_cavity[next] = CELL_CAVITY;
      stack[height++] = (int32_t)next;
    }
  }
  for (ptrdiff_t c = 0; c < cells; c++)
    if (mask->is_cavity[c] != CELL_CAVITY) mask->is_cavity[c] = CELL_SOLID;
}

static CastStatus lay_cells(CavityMask *mask, CastError *err)
{
  const Surface *s = mask->surface;
  CAST_CHECK(mask->spacing > 0.0 && isfinite(mask->spacing), err, CAST_ERR_ARGUMENT, "spacing %g m must be positive",
             mask->spacing);
  CAST_CHECK(s->cavity_low[0] <= s->cavity_high[0], err, CAST_ERR_INPUT, "the mould has no cavity wall");
  double cells = 1.0;
  for (int k = 0; k < 3; k++)
    cells *= floor((s->cavity_high[k] - mask->origin[k]) / mask->spacing) -
             floor((s->cavity_low[k] - mask->origin[k]) / mask->spacing) + 1.0;
  CAST_CHECK(cells < 2.0e9, err, CAST_ERR_INPUT,
             "a lattice of %g m over the cavity would have %g cells, at most 2e9 are possible", mask->spacing, cells);
  for (int k = 0; k < 3; k++) {
    mask->first[k] = (int32_t)floor((s->cavity_low[k] - mask->origin[k]) / mask->spacing);
    mask->n[k] = (int32_t)floor((s->cavity_high[k] - mask->origin[k]) / mask->spacing) - mask->first[k] + 1;
  }
  return CAST_OK;
}

CastStatus cavity_mask_create(const Surface *surface, double spacing, const double origin[3], CavityMask *mask,
                              CastError *err)
{
  *mask = (CavityMask){.surface = surface, .spacing = spacing, .origin = {origin[0], origin[1], origin[2]}};
  CAST_CALL(lay_cells(mask, err));
  const ptrdiff_t cells = cavity_mask_size(mask);
  mask->is_cavity = malloc((size_t)cells);
  int32_t *stack = malloc((size_t)cells * sizeof *stack);
  if (!mask->is_cavity || !stack) {
    free(stack);
    cavity_mask_destroy(mask);
    return cast_error_set(err, CAST_ERR_MEMORY, "no memory for a lattice of %td cells over the cavity", cells);
  }
#pragma omp parallel for schedule(dynamic, 1024)
  for (ptrdiff_t c = 0; c < cells; c++) mask->is_cavity[c] = classify(mask, c);
  spread(mask, stack);
  free(stack);
  return CAST_OK;
}

void cavity_mask_destroy(CavityMask *mask)
{
  free(mask->is_cavity);
  mask->is_cavity = NULL;
}
