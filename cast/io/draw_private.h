/* draw_private.h - for draw.c, draw_curves.c, draw_filling.c and draw_maps.c. */
#ifndef CAST_IO_DRAW_PRIVATE_H
#define CAST_IO_DRAW_PRIVATE_H

#include "cast/io/draw.h"

CastStatus draw_filling(const char *folder, const char *picture, CastError *err);
CastStatus draw_curves(const char *folder, const char *picture, CastError *err);

/* Those of the maps that the results have. */
CastStatus draw_maps(const char *folder, Log *log, CastError *err);

#endif
