/* rom_report.h - a ROM in plain words: what `castreduce info FILE` and `castrun info FILE` print. */
#ifndef COMMON_ROM_ROM_REPORT_H
#define COMMON_ROM_ROM_REPORT_H

#include "common/rom/rom.h"

/*  path  of the file, for the first line; NULL: none
 *  text  out: owned by the caller, lines of at most 100 columns
 * Errors: CAST_ERR_MEMORY. */
CastStatus rom_report(const RomData *rom, const char *path, char **text, CastError *err);

/* The sentence that says whether the tolerance asked for is reached, without a line end, into `text`. */
void rom_report_verdict(const RomData *rom, char *text, size_t size);

#endif
