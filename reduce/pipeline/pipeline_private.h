/* pipeline_private.h - what the subcommands share: mould.yaml read on every rank, the log, the full model. */
#ifndef REDUCE_PIPELINE_PIPELINE_PRIVATE_H
#define REDUCE_PIPELINE_PIPELINE_PRIVATE_H

#include "common/log.h"
#include "reduce/fem/thermal_system.h"
#include "reduce/mor/reduced_model.h"
#include "reduce/pipeline/pipeline.h"

typedef struct Pipeline {
  const PipelineTask *task;
  MPI_Comm comm;
  PetscMPIInt rank;
  ReduceConfig *config;
  Log *log; // rank 0
  MouldMesh *mesh;
  ThermalSystem *system;
  ReducedModel *model;
  double seconds_mesh, seconds_assembly;
} Pipeline;

/* Rank 0 reads the file; the others parse the same text. Errors: PETSC_ERR_USER, on all ranks. */
PetscErrorCode pipeline_read_config(Pipeline *pipeline);
/* The output's path with another ending in place of .rom.h5; malloc'ed, NULL without memory. */
char *pipeline_output_path(const ReduceConfig *config, const char *ending);
/* Open the log `path` anew on rank 0, and see whether its folder can be written. */
PetscErrorCode pipeline_open_log(Pipeline *pipeline, const char *path);
/* Mesh and finite elements, or the files of the matrices: pipeline->system. */
PetscErrorCode pipeline_assemble(Pipeline *pipeline);
/* What PETSc holds. After a failure PETSc's objects may be half made: left to the end of the process then. */
PetscErrorCode pipeline_release(Pipeline *pipeline);
void pipeline_close(Pipeline *pipeline); // log and input

#endif
