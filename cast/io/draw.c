#include <stdio.h>

#include "cast/io/draw_private.h"

CastStatus draw_folder(const char *folder, Log *log, CastError *err)
{
  char path[4200];
  snprintf(path, sizeof path, "%s/filling.png", folder);
  CAST_CALL(draw_filling(folder, path, err));
  log_info(log, "drawn: %s", path);
  snprintf(path, sizeof path, "%s/curves.png", folder);
  CAST_CALL(draw_curves(folder, path, err));
  log_info(log, "drawn: %s", path);
  return draw_maps(folder, log, err);
}
