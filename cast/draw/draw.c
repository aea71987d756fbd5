#include <stdio.h>

#include "cast/draw/draw_private.h"

CastStatus draw_folder(const char *folder, Log *log, CastError *err)
{
  char path[4200];
  static const char *const fields[] = {
      [DRAW_TEMPERATURE] = "filling", [DRAW_SPEED] = "speed", [DRAW_PRESSURE] = "pressure"};
  for (int k = 0; k < 3; k++) {
    snprintf(path, sizeof path, "%s/%s.png", folder, fields[k]);
    CAST_CALL(draw_filling(folder, (DrawField)k, path, err));
    log_info(log, "drawn: %s", path);
  }
  snprintf(path, sizeof path, "%s/curves.png", folder);
  CAST_CALL(draw_curves(folder, path, err));
  log_info(log, "drawn: %s", path);
  return draw_maps(folder, log, err);
}
