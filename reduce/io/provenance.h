/* provenance.h - who made a ROM file, when, how and with what. */
#ifndef REDUCE_IO_PROVENANCE_H
#define REDUCE_IO_PROVENANCE_H

#include "common/rom/rom.h"
#include "reduce/config/config.h"

/* Fill the texts (owned, released by provenance_destroy). Errors: CAST_ERR_MEMORY. */
CastStatus provenance_create(const ReduceConfig *config, const char *command, RomProvenance *provenance,
                             CastError *err);
void provenance_destroy(RomProvenance *provenance);

#endif
