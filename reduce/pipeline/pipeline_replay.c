/* pipeline_replay.c - castreduce replay: a ROM's true error on a run that castrun recorded. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "common/hash.h"
#include "common/units.h"
#include "reduce/petsc/collective.h"
#include "reduce/petsc/petsc_compat.h"
#include "reduce/pipeline/pipeline_private.h"
#include "reduce/replay/replay.h"

enum { MOST_FIELDS = 1000 };
static const double SAME = 1e-9; // areas and heat capacity of the mesh made anew

typedef struct ReplayCase {
  Pipeline pipeline;
  PipelineTask task; // of the pipeline: the mould's own input file
  RomData *rom;
  HeatRecord record;
  char *base; // RECORD without .h5
  PetscInt n_fields;
  PetscReal field_time[MOST_FIELDS];
  MouldMesh *finer[REPLAY_LEVELS];
  WallTriangles *wall[REPLAY_LEVELS];
  PetscInt *patch[REPLAY_LEVELS];
} ReplayCase;

/* ---- what is to be replayed ---- */

static CastStatus check_same_rom(const ReplayCase *replay, const char *rom_path, const char *record_path,
                                 CastError *err)
{
  char digest[65];
  CAST_CALL(hash_file(rom_path, digest, err));
  CAST_CHECK(strcmp(digest, replay->record.rom_sha256) == 0, err, CAST_ERR_INPUT,
             "%s was recorded with another ROM file than %s (its hash differs)", record_path, rom_path);
  CAST_CHECK(replay->record.m == replay->rom->m, err, CAST_ERR_FORMAT, "%s: heat of %zu patches, the ROM has %zu",
             record_path, replay->record.m, replay->rom->m);
  for (size_t t = 0; t < replay->record.n_triangles; t++)
    CAST_CHECK((size_t)replay->record.triangle[t] < replay->rom->n_triangles, err, CAST_ERR_FORMAT,
               "%s: triangle %d, the ROM has %zu", record_path, (int)replay->record.triangle[t],
               replay->rom->n_triangles);
  return CAST_OK;
}

/* "10 ms, 0.5 s" */
static CastStatus read_times(const char *list, ReplayCase *replay, CastError *err)
{
  const double last = replay->record.time[replay->record.n - 1];
  while (list && *list) {
    char one[64];
    const size_t length = strcspn(list, ",");
    double t;
    CAST_CHECK(length < sizeof one && replay->n_fields < MOST_FIELDS, err, CAST_ERR_INPUT,
               "--fields: '%.60s': times such as '10 ms,0.5 s' are expected, %d at most", list, (int)MOST_FIELDS);
    snprintf(one, sizeof one, "%.*s", (int)length, list);
    if (units_convert(one, "s", &t, err) != CAST_OK) return cast_error_prefix(err, "--fields");
    const double before = replay->n_fields > 0 ? replay->field_time[replay->n_fields - 1] : 0.0;
    CAST_CHECK(t > before && t <= last * (1.0 + 1e-9), err, CAST_ERR_INPUT,
               "--fields: %g s: ascending times up to the record's end, %g s, are expected", t, last);
    replay->field_time[replay->n_fields++] = t;
    list += length + (list[length] == ',');
  }
  return CAST_OK;
}

static CastStatus read_files(ReplayCase *replay, const ReplayOptions *options, CastError *err)
{
  const size_t length = strlen(options->record_path), ending = strlen(".h5");
  CAST_CALL(rom_read(options->rom_path, &replay->rom, err));
  CAST_CALL(heat_record_read(options->record_path, &replay->record, err));
  CAST_CALL(check_same_rom(replay, options->rom_path, options->record_path, err));
  CAST_CHECK(replay->rom->n_triangles > 0, err, CAST_ERR_INPUT,
             "%s has no geometry: it was reduced from matrices, no run of castrun can have used it", options->rom_path);
  CAST_CHECK(!options->resolved || replay->record.n_triangles > 0, err, CAST_ERR_INPUT,
             "--resolved: %s holds no heat by wall triangle (output.record_triangles of castrun's input)",
             options->record_path);
  CAST_CALL(read_times(options->fields, replay, err));
  replay->base = strdup(options->record_path);
  CAST_CHECK(replay->base, err, CAST_ERR_MEMORY, "no memory for the output's path");
  if (length > ending && strcmp(replay->base + length - ending, ".h5") == 0) replay->base[length - ending] = '\0';
  return CAST_OK;
}

/* The input that made the ROM: where it says, or beside the ROM, or where the user says. */
static CastStatus find_mould(ReplayCase *replay, const ReplayOptions *options, CastError *err)
{
  static char beside[4096];
  const char *given = replay->rom->provenance.input_path;
  const char *name = strrchr(given, '/'), *slash = strrchr(options->rom_path, '/');
  snprintf(beside, sizeof beside, "%.*s%.2000s", slash ? (int)(slash - options->rom_path) + 1 : 0, options->rom_path,
           name ? name + 1 : given);
  const char *const places[] = {options->mould_path, beside, given};
  for (size_t i = 0; i < sizeof places / sizeof *places && !replay->task.input_path; i++)
    if (places[i] && (places[i] == options->mould_path || access(places[i], R_OK) == 0))
      replay->task.input_path = places[i];
  CAST_CHECK(
      replay->task.input_path, err, CAST_ERR_INPUT,
      "the input that the ROM was made from, '%s', is neither there nor beside the ROM: --mould says where it is",
      given);
  return CAST_OK;
}

/* ---- the full model made anew ---- */

static CastStatus check_same_input(const ReplayCase *replay, CastError *err)
{
  const ReduceConfig *config = replay->pipeline.config;
  const RomProvenance *provenance = &replay->rom->provenance;
  CAST_CHECK(strcmp(config->input_text, provenance->input_text) == 0, err, CAST_ERR_INPUT,
             "%s is not what the ROM was made from (the ROM keeps that text): the full model would be another one",
             config->input_path);
  CAST_CHECK(strcmp(config->geometry_sha256, provenance->geometry_sha256) == 0, err, CAST_ERR_INPUT,
             "%s has changed since the ROM was made (its hash differs)",
             config->matrices ? "one of the matrices" : config->geometry_path);
  for (size_t i = 0; i < config->n_regions && i < replay->rom->n_materials; i++)
    CAST_CHECK(strcmp(config->region[i].material.sha256, replay->rom->material[i].sha256) == 0, err, CAST_ERR_INPUT,
               "material '%s' has changed since the ROM was made (its hash differs)", config->region[i].material.name);
  return CAST_OK;
}

static CastStatus check_same_model(const ReplayCase *replay, CastError *err)
{
  const RomData *rom = replay->rom;
  const ThermalSystem *system = replay->pipeline.system;
  const MouldMesh *mesh = replay->pipeline.mesh;
  CAST_CHECK((size_t)system->m == rom->m && (size_t)system->n == rom->n_full, err, CAST_ERR_INPUT,
             "the mesh made anew has %d unknowns and %d patches, the ROM was made from %zu and %zu: another version of "
             "gmsh? (%s)",
             (int)system->n, (int)system->m, rom->n_full, rom->m, rom->provenance.libraries);
  for (size_t l = 0; l < rom->m; l++)
    CAST_CHECK(strcmp(mesh->patch[l].name, rom->patch[l].name) == 0 &&
                   fabs(mesh->patch[l].area - rom->patch[l].area) <= SAME * rom->patch[l].area,
               err, CAST_ERR_INPUT,
               "patch %zu of the mesh made anew, %s of %.9g m2, is %s of %.9g m2 in the ROM: another version of gmsh? "
               "(%s)",
               l, mesh->patch[l].name, mesh->patch[l].area, rom->patch[l].name, rom->patch[l].area,
               rom->provenance.libraries);
  return CAST_OK;
}

/* Patches of the wall's triangles on the mould's own patches, halved and quartered. The mesh does not depend on them.
 */
static PetscErrorCode make_levels(ReplayCase *replay)
{
  Pipeline *pipeline = &replay->pipeline;
  const size_t n = replay->rom->n_triangles;

  PetscFunctionBeginUser;
  PetscCall(wall_triangles_create(pipeline->mesh, replay->rom, &replay->wall[0]));
  for (int level = 0; level < REPLAY_LEVELS; level++) {
    PetscCall(PetscMalloc1(n, &replay->patch[level]));
    if (level > 0) {
      ThermalSystem *field; // only for the field on the mesh
      for (size_t s = 0; s < pipeline->config->n_cavity; s++) pipeline->config->cavity[s].patch_size *= 0.5;
      PetscCall(mould_mesh_create(pipeline->comm, pipeline->config, &replay->finer[level]));
      PetscCall(thermal_system_create(replay->finer[level], pipeline->config, &field));
      PetscCall(thermal_system_destroy(&field));
      PetscCall(wall_triangles_create(replay->finer[level], replay->rom, &replay->wall[level]));
      log_info(pipeline->log, "patches refined %dx: %d", 1 << level, (int)replay->finer[level]->n_cavity);
    }
    PetscCall(wall_triangles_patches(replay->wall[level], n, replay->patch[level]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what is said ---- */

static void report(const ReplayCase *replay, const ReplayResult *result)
{
  const RomData *rom = replay->rom;
  const double percent = 100.0 / (double)result->rise;
  printf("%s: %zu intervals to %.6g s, %.6g J into the mould\n", replay->base, replay->record.n,
         replay->record.time[replay->record.n - 1], (double)result->heat);
  printf("largest rise of a cavity patch  %.6g K\n", (double)result->rise);
  printf("ROM against the full model      %.3g K, %.3g %% of the rise (%s at %.4g s)\n", (double)result->rom.error,
         percent * (double)result->rom.error, rom->patch[result->rom.patch].name, (double)result->rom.time);
  printf("of it from the time steps       %.2g %% at most\n", percent * (double)result->scheme);
  for (int level = 0; replay->wall[0] && level < REPLAY_LEVELS; level++) {
    const char *const names[] = {"lumping the heat on patches     ", "on patches refined 2x           ",
                                 "on patches refined 4x           "};
    printf("%s%.3g %% of the rise in patch temperatures (%s at %.4g s), %.3g %% at single wall triangles\n",
           names[level], percent * (double)result->lumping[level].error, rom->patch[result->lumping[level].patch].name,
           (double)result->lumping[level].time, percent * (double)result->pointwise[level]);
  }
}

static char *with_ending(const char *base, const char *ending)
{
  char *path = malloc(strlen(base) + strlen(ending) + 1);
  if (path) sprintf(path, "%s%s", base, ending);
  return path;
}

/* ---- the command ---- */

static PetscErrorCode prepare(ReplayCase *replay, const ReplayOptions *options)
{
  Pipeline *pipeline = &replay->pipeline;
  CastError err = {CAST_OK, ""};
  CastStatus status;
  char *log_path;

  PetscFunctionBeginUser;
  status = read_files(replay, options, &err); // each rank for itself: a ROM is small
  if (status == CAST_OK) status = find_mould(replay, options, &err);
  PetscCall(collective_check(pipeline->comm, status, &err));
  PetscCall(pipeline_read_config(pipeline));
  status = check_same_input(replay, &err);
  PetscCall(collective_check(pipeline->comm, status, &err));
  log_path = with_ending(replay->base, ".replay.log");
  if (pipeline->rank == 0) {
    if (log_path) unlink(log_path); // the log tells of one run
    status = log_open(log_path, pipeline->task->quiet, &pipeline->log, &err);
  }
  free(log_path);
  PetscCall(collective_check(pipeline->comm, status, &err));
  PetscCall(pipeline_assemble(pipeline));
  status = check_same_model(replay, &err);
  PetscCall(collective_check(pipeline->comm, status, &err));
  if (options->resolved) PetscCall(make_levels(replay));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode run(ReplayCase *replay, const ReplayOptions *options)
{
  const Pipeline *pipeline = &replay->pipeline;
  char *csv = with_ending(replay->base, ".replay.csv"), *field = with_ending(replay->base, ".field");
  ReplayResult result;
  ReplayTask task = {.system = pipeline->system,
                     .mesh = pipeline->mesh,
                     .rom = replay->rom,
                     .record = &replay->record,
                     .substeps = (PetscInt)options->substeps,
                     .wall = replay->wall[0],
                     .n_fields = replay->n_fields,
                     .field_time = replay->field_time,
                     .field_base = field,
                     .csv_path = csv,
                     .log = pipeline->log};

  PetscFunctionBeginUser;
  PetscCheck(csv && field, PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for the output's path");
  for (int level = 0; level < REPLAY_LEVELS; level++) task.patch_of_triangle[level] = replay->patch[level];
  PetscCall(replay_run(&task, &result));
  if (pipeline->rank == 0) report(replay, &result);
  log_info(pipeline->log, "wrote %s", csv);
  free(csv);
  free(field);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode release(ReplayCase *replay)
{
  PetscFunctionBeginUser;
  for (int level = 0; level < REPLAY_LEVELS; level++) {
    PetscCall(wall_triangles_destroy(&replay->wall[level]));
    PetscCall(mould_mesh_destroy(&replay->finer[level]));
    PetscCall(PetscFree(replay->patch[level]));
  }
  PetscCall(pipeline_release(&replay->pipeline));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode pipeline_replay(MPI_Comm comm, const PipelineTask *task)
{
  ReplayCase replay = {.pipeline = {.comm = comm}, .task = {.command = task->command, .quiet = task->quiet}};
  PetscErrorCode ierr;

  PetscFunctionBeginUser;
  replay.pipeline.task = &replay.task;
  PetscCallMPI(MPI_Comm_rank(comm, &replay.pipeline.rank));
  ierr = prepare(&replay, task->replay);
  if (!ierr) ierr = run(&replay, task->replay);
  if (!ierr) ierr = release(&replay);
  rom_destroy(&replay.rom);
  heat_record_free(&replay.record);
  free(replay.base);
  pipeline_close(&replay.pipeline);
  PetscFunctionReturn(ierr);
}
