#include "reduce/replay/replay.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "reduce/linear/dense_block.h"
#include "reduce/mor/model/modal_model.h"
#include "reduce/petsc/collective.h"
#include "reduce/petsc/petsc_compat.h"
#include "reduce/replay/field_file.h"
#include "reduce/replay/full_run.h"

/* Columns of the full model's state: by patches; and, resolved, by triangles and by lumped triangles of each level. */
enum { BY_PATCH = 0, BY_TRIANGLE = 1, LUMPED = 2, COLUMNS = LUMPED + REPLAY_LEVELS };

typedef struct Replay {
  const ReplayTask *task;
  ReplayResult *result;
  MPI_Comm comm;
  PetscMPIInt rank;
  PetscInt k, m, n_cavity;
  PetscReal ambient; // K above preheat
  FullRun *full;
  Mat F;                   // [n x k]
  PetscReal *T;            // [m x k] column-major, K above preheat, the full model's patches
  PetscReal *z, *z_scheme; // [r] the ROM, exactly and by the full model's scheme
  PetscReal *T_rom, *flow; // [m]
  PetscReal *level_area[REPLAY_LEVELS], *level_heat[REPLAY_LEVELS]; // by finer patch
  PetscReal *triangle_area, *triangle_heat;                         // [n_triangles of the ROM]
  PetscReal *mean[COLUMNS];                                         // [wall->n]
  FILE *csv;                                                        // rank 0
  char csv_part[4096];
  PetscInt next_field, n_written;
} Replay;

/* ---- inputs ---- */

static PetscReal corner_area(const RomData *rom, size_t t)
{
  const double *a = rom->points + 3 * rom->triangles[3 * t], *b = rom->points + 3 * rom->triangles[3 * t + 1];
  const double *c = rom->points + 3 * rom->triangles[3 * t + 2];
  double square = 0.0;
  for (int d = 0; d < 3; d++) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    const double n = (b[e] - a[e]) * (c[f] - a[f]) - (b[f] - a[f]) * (c[e] - a[e]);
    square += n * n;
  }
  return 0.5 * sqrt(square);
}

static PetscErrorCode create_levels(Replay *replay)
{
  const ReplayTask *task = replay->task;
  const RomData *rom = task->rom;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc2(rom->n_triangles, &replay->triangle_area, rom->n_triangles, &replay->triangle_heat));
  for (size_t t = 0; t < rom->n_triangles; t++) replay->triangle_area[t] = corner_area(rom, t);
  for (int level = 0; level < REPLAY_LEVELS; level++) {
    PetscInt patches = 0;
    for (size_t t = 0; t < rom->n_triangles; t++) patches = PetscMax(patches, task->patch_of_triangle[level][t] + 1);
    PetscCall(PetscCalloc2((size_t)patches, &replay->level_area[level], (size_t)patches, &replay->level_heat[level]));
    for (size_t t = 0; t < rom->n_triangles; t++)
      replay->level_area[level][task->patch_of_triangle[level][t]] += replay->triangle_area[t];
  }
  for (int c = 0; c < COLUMNS; c++) PetscCall(PetscMalloc1((size_t)task->wall->n, &replay->mean[c]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* F(:, column) = B q + ambient (T_ambient - T_preheat), q NULL: 0 */
static PetscErrorCode load_patches(Replay *replay, PetscInt column, const PetscReal *q)
{
  Vec f;

  PetscFunctionBeginUser;
  PetscCall(MatDenseGetColumnVecWrite(replay->F, column, &f));
  PetscCall(VecCopy(replay->task->system->ambient, f));
  PetscCall(VecScale(f, replay->ambient));
  for (PetscInt l = 0; q && l < replay->m; l++) {
    Vec b;
    if (q[l] == 0.0) continue;
    PetscCall(MatDenseGetColumnVecRead(replay->task->system->B, l, &b));
    PetscCall(VecAXPY(f, q[l], b));
    PetscCall(MatDenseRestoreColumnVecRead(replay->task->system->B, l, &b));
  }
  PetscCall(MatDenseRestoreColumnVecWrite(replay->F, column, &f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode add_triangles(Replay *replay, PetscInt column)
{
  Vec f;

  PetscFunctionBeginUser;
  PetscCall(MatDenseGetColumnVec(replay->F, column, &f));
  PetscCall(wall_triangles_load(replay->task->wall, replay->triangle_heat, f));
  PetscCall(MatDenseRestoreColumnVec(replay->F, column, &f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The triangles' own heat, and the same lumped on the patches of each level. What went through outer patches has no
 * triangles: it comes by patch in each column. */
static PetscErrorCode load_triangles(Replay *replay, size_t interval, PetscReal span)
{
  const ReplayTask *task = replay->task;
  const HeatRecord *record = task->record;
  const double *heat = record->triangle_heat + interval * record->n_triangles;
  PetscReal *outer;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)replay->m, &outer));
  for (PetscInt l = 0; l < replay->m; l++) outer[l] = l < replay->n_cavity ? 0.0 : replay->flow[l];
  for (PetscInt c = BY_TRIANGLE; c < COLUMNS; c++) PetscCall(load_patches(replay, c, outer));
  PetscCall(PetscFree(outer));
  PetscCall(PetscArrayzero(replay->triangle_heat, task->rom->n_triangles));
  for (size_t t = 0; t < record->n_triangles; t++) replay->triangle_heat[record->triangle[t]] = heat[t] / span;
  PetscCall(add_triangles(replay, BY_TRIANGLE));
  for (int level = 0; level < REPLAY_LEVELS; level++) {
    const PetscInt *patch = task->patch_of_triangle[level];
    PetscReal *sum = replay->level_heat[level];
    for (size_t t = 0; t < record->n_triangles; t++) sum[patch[record->triangle[t]]] = 0.0;
    for (size_t t = 0; t < record->n_triangles; t++) sum[patch[record->triangle[t]]] += heat[t] / span;
    for (size_t t = 0; t < record->n_triangles; t++) {
      const int32_t of_rom = record->triangle[t];
      replay->triangle_heat[of_rom] =
          sum[patch[of_rom]] * replay->triangle_area[of_rom] / replay->level_area[level][patch[of_rom]];
    }
    PetscCall(add_triangles(replay, LUMPED + level));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the models ---- */

/* One span of the ROM, exactly and by the scheme; T_rom, and the scheme's error in it. */
static void advance_rom(Replay *replay, PetscReal span, PetscReal *scheme_error)
{
  const RomData *rom = replay->task->rom;
  PetscReal *difference = replay->T_rom;
  for (PetscInt l = 0; l < replay->m; l++) difference[l] = 0.0;
  for (size_t k = 0; k < rom->r; k++) {
    const double *row = rom->B + k * rom->m, lambda = rom->lambda[k];
    double u = rom->ambient[k] * replay->ambient;
    for (size_t l = 0; l < rom->m; l++) u += row[l] * replay->flow[l];
    replay->z[k] += modal_phi(lambda, span) * (u - lambda * replay->z[k]);
    replay->z_scheme[k] = full_run_advance_mode(lambda, u, span, replay->task->substeps, replay->z_scheme[k]);
    for (size_t l = 0; l < rom->m; l++) difference[l] += row[l] * (replay->z_scheme[k] - replay->z[k]);
  }
  for (PetscInt l = 0; l < replay->n_cavity; l++) *scheme_error = PetscMax(*scheme_error, PetscAbsReal(difference[l]));
  for (PetscInt l = 0; l < replay->m; l++) replay->T_rom[l] = 0.0;
  for (size_t k = 0; k < rom->r; k++)
    for (size_t l = 0; l < rom->m; l++) replay->T_rom[l] += rom->B[k * rom->m + l] * replay->z[k];
}

static void note_worst(const PetscReal *a, const PetscReal *b, PetscInt n, PetscReal time, ReplayWorst *worst,
                       PetscReal *at_time)
{
  *at_time = 0.0;
  for (PetscInt l = 0; l < n; l++) {
    const PetscReal error = PetscAbsReal(a[l] - b[l]);
    *at_time = PetscMax(*at_time, error);
    if (error > worst->error) *worst = (ReplayWorst){error, time, l};
  }
}

/* The triangles' temperatures of each column: the largest difference of the lumped from the resolved. */
static PetscErrorCode compare_points(Replay *replay)
{
  const WallTriangles *wall = replay->task->wall;
  PetscReal worst[REPLAY_LEVELS] = {0.0};

  PetscFunctionBeginUser;
  for (PetscInt c = BY_TRIANGLE; c < COLUMNS; c++) {
    Vec theta;
    PetscCall(MatDenseGetColumnVecRead(full_run_state(replay->full), c, &theta));
    PetscCall(wall_triangles_mean(wall, theta, replay->mean[c]));
    PetscCall(MatDenseRestoreColumnVecRead(full_run_state(replay->full), c, &theta));
  }
  for (int level = 0; level < REPLAY_LEVELS; level++)
    for (PetscInt i = 0; i < wall->n; i++)
      worst[level] =
          PetscMax(worst[level], PetscAbsReal(replay->mean[LUMPED + level][i] - replay->mean[BY_TRIANGLE][i]));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, worst, REPLAY_LEVELS, MPIU_REAL, MPIU_MAX, replay->comm));
  for (int level = 0; level < REPLAY_LEVELS; level++)
    replay->result->pointwise[level] = PetscMax(replay->result->pointwise[level], worst[level]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode compare(Replay *replay, PetscReal time)
{
  ReplayResult *result = replay->result;
  PetscReal error, lumping[REPLAY_LEVELS] = {0.0};

  PetscFunctionBeginUser;
  PetscCall(dense_block_inner(replay->task->system->B, full_run_state(replay->full), replay->T));
  for (PetscInt l = 0; l < replay->n_cavity; l++) result->rise = PetscMax(result->rise, PetscAbsReal(replay->T[l]));
  note_worst(replay->T, replay->T_rom, replay->n_cavity, time, &result->rom, &error);
  for (int level = 0; replay->task->wall && level < REPLAY_LEVELS; level++)
    note_worst(replay->T + (LUMPED + level) * replay->m, replay->T + BY_TRIANGLE * replay->m, replay->n_cavity, time,
               &result->lumping[level], &lumping[level]);
  if (replay->task->wall) PetscCall(compare_points(replay));
  if (!replay->csv) PetscFunctionReturn(PETSC_SUCCESS);
  fprintf(replay->csv, "%.9g,%.9g,%.6g", (double)time, (double)result->rise, (double)error);
  for (int level = 0; replay->task->wall && level < REPLAY_LEVELS; level++)
    fprintf(replay->csv, ",%.6g", (double)lumping[level]);
  fprintf(replay->csv, "\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- files ---- */

/* Under another name until it is whole. */
static CastStatus open_csv(Replay *replay, CastError *err)
{
  const char *path = replay->task->csv_path;
  if (!path || replay->rank != 0) return CAST_OK;
  snprintf(replay->csv_part, sizeof replay->csv_part, "%.4000s.part", path);
  replay->csv = fopen(replay->csv_part, "w");
  CAST_CHECK(replay->csv, err, CAST_ERR_IO, "'%s' cannot be written: %s", path, strerror(errno));
  fprintf(replay->csv, "time_s,largest_rise_K,rom_error_K%s\n",
          replay->task->wall ? ",lumping_error_K,lumping_error_half_K,lumping_error_quarter_K" : "");
  return CAST_OK;
}

static CastStatus close_csv(Replay *replay, CastError *err)
{
  const char *path = replay->task->csv_path;
  if (!replay->csv) return CAST_OK;
  const bool written = !ferror(replay->csv), closed = fclose(replay->csv) == 0;
  replay->csv = NULL;
  if (written && closed && rename(replay->csv_part, path) == 0) return CAST_OK;
  const int cause = errno;
  unlink(replay->csv_part);
  return cast_error_set(err, CAST_ERR_IO, "'%s' cannot be written: %s", path, strerror(cause));
}

static void field_name(const ReplayTask *task, PetscInt i, char *path, size_t size)
{
  snprintf(path, size, "%.4000s%04d.vtkhdf", task->field_base, (int)i + 1);
}

/* The field by the finest heat there is, where its time has come. */
static PetscErrorCode write_fields(Replay *replay, PetscReal time)
{
  const ReplayTask *task = replay->task;
  PetscBool due = PETSC_FALSE;
  char path[PETSC_MAX_PATH_LEN];
  Vec theta;

  PetscFunctionBeginUser;
  for (; replay->next_field < task->n_fields && task->field_time[replay->next_field] <= time * (1.0 + 1e-9);
       replay->next_field++)
    due = PETSC_TRUE;
  if (!due) PetscFunctionReturn(PETSC_SUCCESS);
  field_name(task, replay->n_written++, path, sizeof path);
  const PetscInt column = task->wall ? BY_TRIANGLE : BY_PATCH;
  PetscCall(MatDenseGetColumnVecRead(full_run_state(replay->full), column, &theta));
  PetscCall(field_file_write(task->mesh->dm, theta, task->record->preheat, time, path));
  PetscCall(MatDenseRestoreColumnVecRead(full_run_state(replay->full), column, &theta));
  log_info(task->log, "wrote %s: the mould's temperature at %.6g s", path, (double)time);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the run ---- */

static PetscErrorCode advance(Replay *replay, size_t interval)
{
  const HeatRecord *record = replay->task->record;
  const PetscReal time = record->time[interval], span = time - (interval > 0 ? record->time[interval - 1] : 0.0);

  PetscFunctionBeginUser;
  for (PetscInt l = 0; l < replay->m; l++) {
    const double joules = record->heat[interval * record->m + (size_t)l];
    replay->flow[l] = joules / span;
    replay->result->heat += joules;
  }
  PetscCall(load_patches(replay, BY_PATCH, replay->flow));
  if (replay->task->wall) PetscCall(load_triangles(replay, interval, span));
  PetscCall(full_run_advance(replay->full, span, replay->F));
  advance_rom(replay, span, &replay->result->scheme);
  PetscCall(compare(replay, time));
  PetscCall(write_fields(replay, time));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode create(Replay *replay)
{
  const ReplayTask *task = replay->task;
  CastError err = {CAST_OK, ""};
  const size_t m = (size_t)replay->m, r = task->rom->r;

  PetscFunctionBeginUser;
  PetscCall(full_run_create(task->system, replay->k, task->substeps, &replay->full));
  PetscCall(dense_block_create(task->system->E, replay->k, &replay->F));
  PetscCall(PetscMalloc5(m * (size_t)replay->k, &replay->T, r, &replay->z, r, &replay->z_scheme, m, &replay->T_rom, m,
                         &replay->flow));
  PetscCall(PetscArrayzero(replay->z, r));
  PetscCall(PetscArrayzero(replay->z_scheme, r));
  if (task->wall) PetscCall(create_levels(replay));
  PetscCall(collective_check(replay->comm, open_csv(replay, &err), &err));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode release(Replay *replay)
{
  CastError err = {CAST_OK, ""};

  PetscFunctionBeginUser;
  const CastStatus status = close_csv(replay, &err);
  PetscCall(full_run_destroy(&replay->full));
  PetscCall(MatDestroy(&replay->F));
  PetscCall(PetscFree5(replay->T, replay->z, replay->z_scheme, replay->T_rom, replay->flow));
  PetscCall(PetscFree2(replay->triangle_area, replay->triangle_heat));
  for (int level = 0; level < REPLAY_LEVELS; level++)
    PetscCall(PetscFree2(replay->level_area[level], replay->level_heat[level]));
  for (int c = 0; c < COLUMNS; c++) PetscCall(PetscFree(replay->mean[c]));
  PetscCall(collective_check(replay->comm, status, &err));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ParaView's list of the fields written. */
static PetscErrorCode write_series(const Replay *replay, const PetscReal *time)
{
  char path[PETSC_MAX_PATH_LEN], (*names)[PETSC_MAX_PATH_LEN], **pointers;
  const PetscInt n = replay->n_written;

  PetscFunctionBeginUser;
  if (n == 0 || replay->rank != 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc2((size_t)n, &names, (size_t)n, &pointers));
  for (PetscInt i = 0; i < n; i++) {
    field_name(replay->task, i, path, sizeof path);
    const char *slash = strrchr(path, '/');
    snprintf(names[i], sizeof names[i], "%s", slash ? slash + 1 : path);
    pointers[i] = names[i];
  }
  snprintf(path, sizeof path, "%.4000ss.vtkhdf.series", replay->task->field_base);
  PetscCall(field_file_write_series(path, n, pointers, time));
  PetscCall(PetscFree2(names, pointers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode replay_run(const ReplayTask *task, ReplayResult *result)
{
  Replay replay = {.task = task, .result = result, .comm = PetscObjectComm((PetscObject)task->system->E)};
  PetscReal *written;

  PetscFunctionBeginUser;
  *result = (ReplayResult){0};
  PetscCallMPI(MPI_Comm_rank(replay.comm, &replay.rank));
  replay.k = task->wall ? COLUMNS : 1;
  replay.m = task->system->m;
  while (replay.n_cavity < replay.m && !task->rom->patch[replay.n_cavity].outer) replay.n_cavity++;
  replay.ambient = task->record->ambient - task->record->preheat;
  PetscCall(create(&replay));
  PetscCall(PetscMalloc1(task->record->n, &written));
  for (size_t i = 0; i < task->record->n; i++) {
    const PetscInt before = replay.n_written;
    PetscCall(advance(&replay, i));
    if (replay.n_written > before) written[before] = task->record->time[i];
    log_progress(task->log, "replaying", (double)(i + 1) / (double)task->record->n, "");
  }
  log_progress_end(task->log);
  PetscCall(write_series(&replay, written));
  PetscCall(PetscFree(written));
  PetscCall(release(&replay));
  PetscFunctionReturn(PETSC_SUCCESS);
}
