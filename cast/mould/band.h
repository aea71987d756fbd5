/* band.h - which tetrahedron of the ROM's near-wall band holds a point. Internal to mould/. */
#ifndef CAST_MOULD_BAND_H
#define CAST_MOULD_BAND_H

#include <stdbool.h>
#include "common/rom/rom.h"

typedef struct Band Band;

typedef struct BandPlace {
  int32_t tetrahedron;
  int32_t point[4]; // into the ROM's points
  double weight[4]; // >= 0, sum 1
} BandPlace;

/*  rom  borrowed. Errors: CAST_ERR_MEMORY, CAST_ERR_INPUT where the ROM has no band. */
CastStatus band_create(const RomData *rom, Band **band, CastError *err);
void band_destroy(Band **band);
/* The tetrahedron that holds x, the lowest number where several do; false if none does. */
bool band_locate(const Band *band, const double x[3], BandPlace *place);

#endif
