/* wall_maps.h - what happened at the cavity wall, triangle by triangle: when and how warm the melt came, and how the
 * melt before it froze (mean over the particles that stand before the triangle, the nearer the more). NAN on the
 * mould's outer surface, and where nothing is known. */
#ifndef CAST_RESULTS_WALL_MAPS_H
#define CAST_RESULTS_WALL_MAPS_H

#include "cast/io/vtk_series.h"
#include "cast/results/defects.h"
#include "cast/results/freezing.h"

enum { WALL_MAPS_OWN = 6, WALL_MAPS = WALL_MAPS_OWN + FREEZING_FIELDS };
extern const char *const wall_map_surface; // name of the first map, an integer: which named surface; -1: an outer one

typedef struct WallMapsInput { // all borrowed
  const RomData *rom;
  const Material *melt;
  const Particles *particles;
  double spacing; // m
  const Filling *filling;
  const Arrival *arrival;
  const Defects *defects;
  const Freezing *freezing;
} WallMapsInput;

typedef struct WallMaps {
  VtkField field[WALL_MAPS];
  void *values[WALL_MAPS]; // [n_triangles of the ROM] int32_t or float, as the field says
} WallMaps;

/* Errors: CAST_ERR_MEMORY. */
CastStatus wall_maps_create(const WallMapsInput *input, WallMaps *maps, CastError *err);
void wall_maps_free(WallMaps *maps);

#endif
