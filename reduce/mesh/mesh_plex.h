/* mesh_plex.h - a TetMesh on rank 0 as a distributed DMPlex. */
#ifndef REDUCE_MESH_MESH_PLEX_H
#define REDUCE_MESH_MESH_PLEX_H

#include <petscdmplex.h>
#include "reduce/mesh/tets/tet_mesh.h"

/* Build the plex of `mesh` (checked; NULL on all ranks but 0), mark the labels "region" (cells) and "patch" (boundary
 * faces, patch_of_triangle [n_triangles]), and distribute it. Collective. */
PetscErrorCode mesh_plex_create(MPI_Comm comm, const TetMesh *mesh, const int32_t *patch_of_triangle, DM *dm);

#endif
