/* rom_picture.h - pictures of a ROM: `castreduce picture FILE out.png`. */
#ifndef COMMON_ROM_ROM_PICTURE_H
#define COMMON_ROM_ROM_PICTURE_H

#include "common/rom/rom.h"

/* The mould cut open, its cavity wall coloured by patch: one colour for each named surface, its patches in shades of it
 * with a line between them. Three views: cut across x, cut across y, and the cavity alone seen from below (as the
 * casting will look). Errors: CAST_ERR_ARGUMENT for a ROM without geometry; CAST_ERR_IO, CAST_ERR_MEMORY. */
CastStatus rom_picture(const RomData *rom, const char *path, CastError *err);

#endif
