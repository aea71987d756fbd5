/* rom_output.h - from the distributed mesh and reduced model to the one ROM file, written by rank 0. */
#ifndef REDUCE_IO_ROM_OUTPUT_H
#define REDUCE_IO_ROM_OUTPUT_H

#include "reduce/mor/reduced_model.h"

typedef struct RomOutputRun { // what the file says of the run that made it
  const char *command;        // the command line
  double seconds_mesh, seconds_assembly;
  Log *log;
} RomOutputRun;

/* mesh NULL: a model from matrices, without geometry; its patches are called inputs/1, inputs/2, ..
 * Gather the boundary triangles, the band's tetrahedra and the basis on their points, and write config->rom_path.
 * The contents are sorted by place, so that they do not depend on how the mesh was distributed. Collective. */
PetscErrorCode rom_output_write(const ReduceConfig *config, const MouldMesh *mesh, const ThermalSystem *system,
                                const ReducedModel *model, const RomOutputRun *run);
#endif
