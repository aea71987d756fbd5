/* run_case.h - a casting from its input to its files: what `castrun run` does, and each run of a study. */
#ifndef CAST_SIM_RUN_CASE_H
#define CAST_SIM_RUN_CASE_H

#include <signal.h>
#include "cast/sim/sim.h"

typedef struct RunCase {
  const char *command;               // for provenance
  bool quiet;                        // only warnings and errors on the terminal
  const volatile sig_atomic_t *stop; // set by a signal handler: stop with a checkpoint; NULL: never
} RunCase;

/* The input file with `overrides`, lines of YAML of the map of that name, behind it; NULL: as it is.
 * Errors: those of cast_config_read. */
CastStatus run_case_read(const char *path, const char *overrides, CastConfig **config, CastError *err);
/* A folder and those above it; one that exists is fine. Errors: CAST_ERR_IO. */
CastStatus run_case_make_folder(const char *path, CastError *err);
/* Run to the end, into config->output.folder. Errors: as sim_run. */
CastStatus run_case(const CastConfig *config, const RunCase *how, SimEnd *end, CastError *err);
/* Go on from folder/checkpoint.h5. Errors: as sim_resume and sim_run. */
CastStatus run_case_resume(const char *folder, const RunCase *how, SimEnd *end, CastError *err);

#endif
