#include "reduce/pipeline/pipeline_private.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "reduce/io/matrix_system.h"
#include "reduce/io/rom_output.h"
#include "reduce/mesh/geometry/mould_geometry.h"
#include "reduce/petsc/collective.h"
#include "reduce/petsc/petsc_compat.h"
#include "reduce/pipeline/pipeline_report.h"

PetscErrorCode pipeline_read_config(Pipeline *pipeline)
{
  CastError err = {CAST_OK, ""};
  CastStatus status = CAST_OK;
  unsigned long length = 0;
  char *text = NULL;

  PetscFunctionBeginUser;
  if (pipeline->rank == 0) {
    status = reduce_config_read(pipeline->task->input_path, NULL, &pipeline->config, &err);
    if (status == CAST_OK) length = strlen(pipeline->config->input_text) + 1;
  }
  PetscCall(collective_check(pipeline->comm, status, &err));
  PetscCallMPI(MPI_Bcast(&length, 1, MPI_UNSIGNED_LONG, 0, pipeline->comm));
  PetscCall(PetscMalloc1(length, &text));
  if (pipeline->rank == 0) PetscCall(PetscArraycpy(text, pipeline->config->input_text, length));
  PetscCallMPI(MPI_Bcast(text, (PetscMPIInt)length, MPI_CHAR, 0, pipeline->comm));
  if (pipeline->rank != 0) status = reduce_config_read(pipeline->task->input_path, text, &pipeline->config, &err);
  PetscCall(PetscFree(text));
  PetscCall(collective_check(pipeline->comm, status, &err));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Better known now than after the reduction. */
static CastStatus check_output_folder(const char *rom_path, CastError *err)
{
  const char *slash = strrchr(rom_path, '/');
  char *folder = slash ? strndup(rom_path, (size_t)(slash - rom_path) + 1) : strdup(".");
  CAST_CHECK(folder, err, CAST_ERR_MEMORY, "no memory for the output's path");
  const int refused = access(folder, W_OK);
  const CastStatus status =
      refused ? cast_error_set(err, CAST_ERR_IO, "output.file: '%s' cannot be written: folder '%s': %s", rom_path,
                               folder, strerror(errno))
              : CAST_OK;
  free(folder);
  return status;
}

char *pipeline_output_path(const ReduceConfig *config, const char *ending)
{
  static const char old[] = ".rom.h5"; // which every output ends in
  const size_t length = strlen(config->rom_path) - strlen(old);
  char *path = malloc(length + strlen(ending) + 1);
  if (path) sprintf(path, "%.*s%s", (int)length, config->rom_path, ending);
  return path;
}

static CastStatus open_log(Pipeline *pipeline, const char *path, CastError *err)
{
  CAST_CHECK(path, err, CAST_ERR_MEMORY, "no memory for the log");
  CAST_CALL(check_output_folder(pipeline->config->rom_path, err));
  unlink(path); // the log tells of one run
  return log_open(path, pipeline->task->quiet, &pipeline->log, err);
}

PetscErrorCode pipeline_open_log(Pipeline *pipeline, const char *path)
{
  CastError err = {CAST_OK, ""};
  CastStatus status = CAST_OK;

  PetscFunctionBeginUser;
  if (pipeline->rank == 0) status = open_log(pipeline, path, &err);
  PetscCall(collective_check(pipeline->comm, status, &err));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Mesh and finite elements. */
static PetscErrorCode assemble_geometry(Pipeline *pipeline)
{
  const double begin = log_wall_time();

  PetscFunctionBeginUser;
  log_info(pipeline->log, "meshing %s", pipeline->config->geometry_path);
  PetscCall(mould_mesh_create(pipeline->comm, pipeline->config, &pipeline->mesh));
  const double meshed = log_wall_time();
  pipeline->seconds_mesh = meshed - begin;
  PetscCall(pipeline_report_mesh(pipeline->mesh, pipeline->config, pipeline->seconds_mesh, pipeline->log));
  PetscCall(thermal_system_create(pipeline->mesh, pipeline->config, &pipeline->system));
  pipeline->seconds_assembly = log_wall_time() - meshed;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode read_matrices(Pipeline *pipeline)
{
  const double begin = log_wall_time();

  PetscFunctionBeginUser;
  log_info(pipeline->log, "reading %s, %s, %s", pipeline->config->matrices->E, pipeline->config->matrices->K,
           pipeline->config->matrices->B);
  PetscCall(matrix_system_create(pipeline->comm, pipeline->config, &pipeline->system));
  pipeline->seconds_assembly = log_wall_time() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode pipeline_assemble(Pipeline *pipeline)
{
  PetscMPIInt size;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_size(pipeline->comm, &size));
  log_info(pipeline->log, "%s", pipeline->config->title);
  if (pipeline->config->matrices)
    PetscCall(read_matrices(pipeline));
  else
    PetscCall(assemble_geometry(pipeline));
  log_info(pipeline->log, "%" PetscInt_FMT " unknowns, %" PetscInt_FMT " patches, on %d %s (%.1f s)",
           pipeline->system->n, pipeline->system->m, size, size == 1 ? "rank" : "ranks", pipeline->seconds_assembly);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode pipeline_release(Pipeline *pipeline)
{
  PetscFunctionBeginUser;
  PetscCall(reduced_model_destroy(&pipeline->model));
  PetscCall(thermal_system_destroy(&pipeline->system));
  PetscCall(mould_mesh_destroy(&pipeline->mesh));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void pipeline_close(Pipeline *pipeline)
{
  log_close(&pipeline->log);
  reduce_config_destroy(&pipeline->config);
}

static PetscErrorCode run_steps(Pipeline *pipeline)
{
  const double begin = log_wall_time();
  char *log_path;

  PetscFunctionBeginUser;
  PetscCall(pipeline_read_config(pipeline));
  log_path = pipeline_output_path(pipeline->config, ".rom.h5.log");
  PetscCall(pipeline_open_log(pipeline, log_path));
  free(log_path);
  PetscCall(pipeline_assemble(pipeline));
  PetscCall(reduced_model_create(pipeline->system, &pipeline->config->reduction, pipeline->log, &pipeline->model));
  const RomOutputRun run = {.command = pipeline->task->command,
                            .seconds_mesh = pipeline->seconds_mesh,
                            .seconds_assembly = pipeline->seconds_assembly,
                            .log = pipeline->log};
  PetscCall(rom_output_write(pipeline->config, pipeline->mesh, pipeline->system, pipeline->model, &run));
  log_info(pipeline->log, "wrote %s: %" PetscInt_FMT " states for %" PetscInt_FMT " unknowns (%.1f s in all)",
           pipeline->config->rom_path, pipeline->model->r, pipeline->system->n, log_wall_time() - begin);
  PetscCall(pipeline_release(pipeline));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode pipeline_run(MPI_Comm comm, const PipelineTask *task)
{
  Pipeline pipeline = {.task = task, .comm = comm};
  PetscErrorCode ierr;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &pipeline.rank));
  ierr = run_steps(&pipeline);
  pipeline_close(&pipeline);
  PetscFunctionReturn(ierr);
}

static CastStatus check_model(const ReduceConfig *config, CastError *err)
{
  if (config->matrices) {
    char summary[256];
    CAST_CALL(matrix_system_check(config, summary, sizeof summary, err));
    reduce_config_print(config, stdout);
    printf("matrices                %s\n", summary);
    return CAST_OK;
  }
  MouldGeometry *geometry = NULL;
  CAST_CALL(mould_geometry_open(config, &geometry, err));
  reduce_config_print(config, stdout);
  pipeline_report_geometry(geometry, stdout);
  mould_geometry_close(&geometry);
  return CAST_OK;
}

PetscErrorCode pipeline_check(MPI_Comm comm, const PipelineTask *task)
{
  Pipeline pipeline = {.task = task, .comm = comm};
  CastError err = {CAST_OK, ""};
  CastStatus status = CAST_OK;
  PetscErrorCode ierr;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &pipeline.rank));
  ierr = pipeline_read_config(&pipeline);
  if (!ierr) {
    if (pipeline.rank == 0) status = check_model(pipeline.config, &err);
    ierr = collective_check(comm, status, &err);
  }
  pipeline_close(&pipeline);
  PetscFunctionReturn(ierr);
}
