/* wall_triangles.h - the boundary triangles of a ROM file on a mesh made anew from the same input: which face of which
 * rank each of them is, found by the places of its corners, which are the same to the last bit. */
#ifndef REDUCE_REPLAY_WALL_TRIANGLES_H
#define REDUCE_REPLAY_WALL_TRIANGLES_H

#include "common/rom/rom.h"
#include "reduce/mesh/mould_mesh.h"

typedef struct WallTriangles {
  DM dm;              // borrowed
  PetscInt n;         // on this rank
  PetscInt *triangle; // [n] of the ROM
  PetscInt *patch;    // [n] of the mesh
  PetscInt *dof;      // [n*3] entries of the DM's local vectors that carry a third of the triangle's heat each
} WallTriangles;

/* The mesh has its temperature field. Errors: PETSC_ERR_USER where the meshes differ. Collective. */
PetscErrorCode wall_triangles_create(const MouldMesh *mesh, const RomData *rom, WallTriangles **wall);
PetscErrorCode wall_triangles_destroy(WallTriangles **wall);
/* F += heat, J or W, [n_triangles of the ROM], spread evenly over each triangle. Collective. */
PetscErrorCode wall_triangles_load(const WallTriangles *wall, const PetscReal *heat, Vec F);
/* Mean temperatures of the triangles on this rank, [n], of theta. Collective. */
PetscErrorCode wall_triangles_mean(const WallTriangles *wall, Vec theta, PetscReal *mean);
/* Patch of each of the ROM's triangles [n_triangles] on another mesh of the same triangles, the same on every rank. */
PetscErrorCode wall_triangles_patches(const WallTriangles *wall, size_t n_triangles, PetscInt *patch);

#endif
