/* draw_private.h - for draw.c, draw_curves.c, draw_filling.c and draw_maps.c. */
#ifndef CAST_DRAW_DRAW_PRIVATE_H
#define CAST_DRAW_DRAW_PRIVATE_H

#include "cast/draw/draw.h"

typedef enum DrawField { DRAW_TEMPERATURE, DRAW_SPEED, DRAW_PRESSURE } DrawField; // of the melt
CastStatus draw_filling(const char *folder, DrawField field, const char *picture, CastError *err);
CastStatus draw_curves(const char *folder, const char *picture, CastError *err);

/* Those of the maps that the results have. */
CastStatus draw_maps(const char *folder, Log *log, CastError *err);

#endif
