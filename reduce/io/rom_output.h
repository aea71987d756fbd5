/* rom_output.h - from the distributed mesh and reduced model to the one ROM file, written by rank 0. */
#ifndef REDUCE_IO_ROM_OUTPUT_H
#define REDUCE_IO_ROM_OUTPUT_H

#include "reduce/mor/reduced_model.h"

/* Gather the boundary triangles, the band's tetrahedra and the basis on their points, and write config->rom_path.
 * Collective. `command`: the command line, for provenance. */
PetscErrorCode rom_output_write(const ReduceConfig *config, const MouldMesh *mesh, const ThermalSystem *system,
                                const ReducedModel *model, const char *command, Log *log);
#endif
