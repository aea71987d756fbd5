#include "cast/pour/outlet.h"

#include <stdlib.h>
#include <string.h>

#include "common/vector.h"

bool outlet_takes(const OutletConfig *o, const Surface *surface, const uint8_t *is_patch, double touch,
                  const double x[3])
{
  if (o->kind == OUTLET_SURFACE) {
    SurfaceHit hit;
    return surface_nearest(surface, x, touch, &hit) && is_patch[hit.patch];
  }
  if (o->kind == OUTLET_BOX) return vec_in_box(o->corner, o->size, x);
  double beyond = 0.0;
  for (int d = 0; d < 3; d++) beyond += (x[d] - o->point[d]) * o->normal[d];
  return beyond > 0.0;
}

CastStatus outlet_find_patches(const OutletConfig *outlet, const RomData *rom, uint8_t **is_patch, CastError *err)
{
  size_t found = 0;
  *is_patch = calloc(rom->m + 1, 1);
  CAST_CHECK(*is_patch, err, CAST_ERR_MEMORY, "no memory for %zu patches", rom->m);
  for (size_t l = 0; l < rom->m; l++) {
    (*is_patch)[l] = strcmp(rom->patch[l].surface, outlet->surface) == 0;
    found += (*is_patch)[l];
  }
  if (found == 0) {
    free(*is_patch);
    *is_patch = NULL;
  }
  CAST_CHECK(found > 0, err, CAST_ERR_INPUT, "the mould has no surface '%s'", outlet->surface);
  return CAST_OK;
}
