/* pipeline.h - what the subcommands of castreduce do, step by step. */
#ifndef REDUCE_PIPELINE_PIPELINE_H
#define REDUCE_PIPELINE_PIPELINE_H

#include <petscsys.h>
#include <stdbool.h>

typedef struct ReplayOptions {
  const char *rom_path, *record_path;
  const char *mould_path; // NULL: where the ROM says, or beside it
  const char *fields;     // times at which the whole field is wanted, "10 ms,0.5 s"; NULL: none
  bool resolved;          // by wall triangle too
  long substeps;          // of each interval
} ReplayOptions;

typedef struct PipelineTask {
  const char *input_path; // mould.yaml
  const char *command;    // the command line, for provenance
  bool quiet;             // no messages but warnings on the terminal
  const ReplayOptions *replay; // replay only
} PipelineTask;

/* mould.yaml -> mesh (or files) -> E, K, B -> reduced model -> ROM file. Messages go to the terminal and to a log
 * beside the ROM file. Collective; user's faults are PETSC_ERR_USER with a message for a person, raised by all ranks.
 */
PetscErrorCode pipeline_run(MPI_Comm comm, const PipelineTask *task);
/* The full model reduced by every method, to compare: a table on the terminal, OUTPUT.compare.csv and .compare.png
 * beside the ROM file that the input names, which is not written. Collective. */
PetscErrorCode pipeline_compare(MPI_Comm comm, const PipelineTask *task);
/* The full model driven by the heat that castrun recorded: the ROM's true error on that run, printed, and over time as
 * RECORD.replay.csv; whole fields as RECORD.fieldNNNN.vtkhdf. Collective. */
PetscErrorCode pipeline_replay(MPI_Comm comm, const PipelineTask *task);
/* Read the input and open the geometry, without meshing; print on rank 0 everything as it was understood. Collective.
 */
PetscErrorCode pipeline_check(MPI_Comm comm, const PipelineTask *task);

#endif
