/* field_file.h - the mould's whole temperature field for ParaView: VTKHDF UnstructuredGrid, one file a time, each rank
 * writing its own part. */
#ifndef REDUCE_REPLAY_FIELD_FILE_H
#define REDUCE_REPLAY_FIELD_FILE_H

#include <petscdmplex.h>

/* theta: global vector of the DM's field, K above preheat; T = preheat + theta at the vertices, float. Written under
 * another name, then renamed. Collective. Errors: PETSC_ERR_USER with the system's reason. */
PetscErrorCode field_file_write(DM dm, Vec theta, PetscReal preheat, PetscReal time, const char *path);
/* ParaView's list of files over time, `path` ending in .vtkhdf.series; on one rank.
 *   names [n] file names beside it, time [n] s */
PetscErrorCode field_file_write_series(const char *path, PetscInt n, char *const *names, const PetscReal *time);

#endif
