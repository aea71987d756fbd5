/* rom_check.h - the parts of rom_check; each names the data set at fault. */
#ifndef COMMON_ROM_ROM_CHECK_H
#define COMMON_ROM_ROM_CHECK_H

#include "common/rom/rom.h"

#define ROM_CHECK(condition, err, ...) CAST_CHECK(condition, err, CAST_ERR_FORMAT, __VA_ARGS__)

CastStatus rom_check_geometry(const RomData *rom, CastError *err);
/* The boundary is closed and wound one way: each edge is used once in each direction. */
CastStatus rom_check_closed(const RomData *rom, CastError *err);
/* Every one of n values is finite; else names the entry of `set`. */
CastStatus rom_check_finite(const char *set, const double *values, size_t n, CastError *err);
#endif
