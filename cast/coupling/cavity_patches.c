#include "cast/coupling/cavity_patches.h"

#include <stdio.h>
#include <string.h>

static CastStatus no_such_surface(const RomData *rom, const char *key, const char *name, CastError *err)
{
  char known[512] = "";
  for (size_t l = 0; l < rom->m; l++) {
    const RomPatch *patch = &rom->patch[l];
    if (patch->outer || (l > 0 && strcmp(patch->surface, rom->patch[l - 1].surface) == 0)) continue;
    const size_t used = strlen(known);
    snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", patch->surface);
  }
  return cast_error_set(err, CAST_ERR_INPUT, "%s: the mould has no cavity surface '%s', it has: %s", key, name, known);
}

CastStatus cavity_patches_set(const RomData *rom, const char *key, const char *surface, int32_t number, int32_t *value,
                              CastError *err)
{
  size_t found = 0;
  for (size_t l = 0; l < rom->m; l++) {
    if (rom->patch[l].outer || strcmp(rom->patch[l].surface, surface) != 0) continue;
    value[l] = number;
    found++;
  }
  return found ? CAST_OK : no_such_surface(rom, key, surface, err);
}
