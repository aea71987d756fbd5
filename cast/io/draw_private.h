/* draw_private.h - for draw.c, draw_curves.c and draw_filling.c. */
#ifndef CAST_IO_DRAW_PRIVATE_H
#define CAST_IO_DRAW_PRIVATE_H

#include "cast/io/draw.h"

CastStatus draw_filling(const char *folder, const char *picture, CastError *err);
CastStatus draw_curves(const char *folder, const char *picture, CastError *err);

#endif
