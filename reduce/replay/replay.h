/* replay.h - the full model driven by the heat that a run recorded, beside the ROM driven by the same: the ROM's true
 * error on that run. With the heat by wall triangle also what lumping it on patches costs, on the ROM's own patches and
 * on finer ones. */
#ifndef REDUCE_REPLAY_REPLAY_H
#define REDUCE_REPLAY_REPLAY_H

#include "common/log.h"
#include "common/rom/heat_record.h"
#include "reduce/fem/thermal_system.h"
#include "reduce/replay/wall_triangles.h"

enum { REPLAY_LEVELS = 3 }; // patches as they are, halved and quartered along their edges

typedef struct ReplayTask {
  const ThermalSystem *system; // the full model made anew; borrowed like all here
  const MouldMesh *mesh;       // NULL: from matrices
  const RomData *rom;
  const HeatRecord *record;
  PetscInt substeps;
  const WallTriangles *wall;                        // NULL: not resolved
  const PetscInt *patch_of_triangle[REPLAY_LEVELS]; // [n_triangles of the ROM] of each level; resolved only
  PetscInt n_fields;
  const PetscReal
      *field_time;        // [n_fields] s ascending: whole fields are written at the ends of the intervals they are in
  const char *field_base; // path of the field files without their ending
  const char *csv_path;
  Log *log; // may be NULL
} ReplayTask;

typedef struct ReplayWorst { // a difference of patch temperatures
  PetscReal error;           // K
  PetscReal time;            // s
  PetscInt patch;
} ReplayWorst;

typedef struct ReplayResult { // cavity patches, ends of the intervals
  PetscReal rise;             // K, the largest difference of a patch from the preheat in the full model
  PetscReal heat;             // J that the record gave to the mould
  ReplayWorst rom;            // ROM against full model, both by the patches' heat
  PetscReal scheme;           // K, error of the time steps: of the same scheme on the ROM against its exact answer
  ReplayWorst lumping[REPLAY_LEVELS]; // patch temperatures by lumped heat against those by the triangles' own
  PetscReal pointwise[REPLAY_LEVELS]; // K, the same for the wall triangles' temperatures
} ReplayResult;

/* Collective; the result is the same on every rank. Errors: those of the solver and of the files. */
PetscErrorCode replay_run(const ReplayTask *task, ReplayResult *result);

#endif
