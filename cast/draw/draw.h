/* draw.h - pictures of a run, from the files in its folder. */
#ifndef CAST_DRAW_DRAW_H
#define CAST_DRAW_DRAW_H

#include "common/log.h"

/* filling.png: frames of the filling, melt and cut mould coloured by temperature; speed.png, pressure.png: the melt by
 * speed and pressure; curves.png: probes and tracers over time. Errors: CAST_ERR_IO, CAST_ERR_FORMAT. */
CastStatus draw_folder(const char *folder, Log *log, CastError *err);

#endif
