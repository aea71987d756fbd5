/* surface_of.h - the boundary of a mould that is known to be sound. */
#ifndef TESTS_SUPPORT_SURFACE_OF_H
#define TESTS_SUPPORT_SURFACE_OF_H

#include "cast/geometry/surface.h"
#include "tests/support/assert_ok.h"

/* What fails, fails the test. The caller destroys it. */
static inline Surface *surface_of(const RomData *rom, double reach)
{
  CastError err = {0};
  Surface *surface = NULL;
  ok(surface_create(rom, reach, &surface, &err), &err);
  return surface;
}

#endif
