/* wall_geometry_private.h - each rank's share, before it is gathered. */
#ifndef REDUCE_IO_WALL_GEOMETRY_PRIVATE_H
#define REDUCE_IO_WALL_GEOMETRY_PRIVATE_H

#include "reduce/io/wall_geometry.h"

typedef struct WallShare {
  DM dm;                // borrowed
  PetscSection section; // borrowed: global numbers of the vertices
  PetscInt n_triangles;
  PetscInt *triangle; // [n*4] global numbers of three vertices wound outwards, patch
  PetscReal *corners; // [n*9] m, the same vertices
  PetscInt n_tetrahedra;
  PetscInt *tetrahedron; // [n*4] global numbers, positive volume
  PetscInt *local;       // [4*n_tetrahedra + 3*n_triangles] DM points of all of them: which nodes are in use
  PetscInt n_local;
} WallShare;

/* This rank's boundary triangles and its tetrahedra in the band. Collective. */
PetscErrorCode wall_share_create(const MouldMesh *mesh, PetscReal band, WallShare *share);
PetscErrorCode wall_share_destroy(WallShare *share);

/* Sort what rank 0 holds by place and replace global numbers by places in the list of points.
 *   number [n_points] global number of each point; triangle [n*4], tetrahedron [n*4] as in WallShare */
CastStatus wall_geometry_sort(WallGeometry *geometry, const PetscInt *number, const PetscInt *triangle,
                              const PetscInt *tetrahedron, CastError *err);

#endif
