/* cavity_patches.h - the patches of a named cavity surface, for what an input says of surfaces by name. */
#ifndef CAST_COUPLING_CAVITY_PATCHES_H
#define CAST_COUPLING_CAVITY_PATCHES_H

#include "common/rom/rom.h"

/* Set value[l] to `number` on all patches of the surface.
 *   key    of the input, for the message: "contact.surfaces"
 *   value  [rom->m]
 * Errors: CAST_ERR_INPUT for a surface that the ROM does not have, or that is no cavity surface. */
CastStatus cavity_patches_set(const RomData *rom, const char *key, const char *surface, int32_t number, int32_t *value,
                              CastError *err);

#endif
