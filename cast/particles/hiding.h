/* hiding.h - pairs of a row that the mould keeps apart: beside walls thinner than the kernel's reach. Internal to
 * particles/. */
#ifndef CAST_PARTICLES_HIDING_H
#define CAST_PARTICLES_HIDING_H

#include "cast/geometry/surface.h"
#include "cast/particles/particles.h"

typedef struct Hiding { // all borrowed
  const Surface *surface;
  const uint8_t *thin; // [n_fluid] a thin mould wall is near
  const Particles *p;
  double range; // m, no entry of a row is farther away
} Hiding;

/* Drop from the n entries of fluid particle `row` what the mould hides from it: fluid, or wall particles. Returns how
 * many are left; they keep their order. */
ptrdiff_t hiding_drop_fluid(const Hiding *hiding, ptrdiff_t row, ptrdiff_t n, int32_t *index);
ptrdiff_t hiding_drop_walls(const Hiding *hiding, ptrdiff_t row, ptrdiff_t n, int32_t *index);

#endif
