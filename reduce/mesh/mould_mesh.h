/* mould_mesh.h - the mould's tetrahedra as a distributed DMPlex, with its regions and patches.
 * Labels on the DM, on every rank:
 *   "region"  cells: index into region[] of the config
 *   "patch"   boundary faces: patch number 0..m-1, cavity patches first, then one for each named outer surface
 * Coordinates are in metres. The patch table is the same on every rank. */
#ifndef REDUCE_MESH_MOULD_MESH_H
#define REDUCE_MESH_MOULD_MESH_H

#include <petscdmplex.h>
#include "common/rom/rom.h"
#include "reduce/config/config.h"

typedef struct MouldMesh {
  DM dm;                    // owned
  PetscInt n_patches;       // m
  PetscInt n_cavity;        // the first n_cavity patches are cavity wall
  RomPatch *patch;          // [m] owned; area and centroid of the faceted surface
  PetscInt *triangles;      // [m] owned: boundary triangles of each patch; NULL: not known
  PetscReal volume;         // m3 of the mesh
  PetscReal shortest_edge;  // m, of cavity triangles
  PetscReal first_layer;    // m, median height of the tetrahedra on the cavity wall
  PetscReal thick_layer;    // m, the height that 95 % of the cavity's area stay below
  PetscInt n_layer_cells;   // tetrahedra in thin layers at the wall
  PetscReal worst_quality;  // least radius ratio (1 = regular), layers apart
  PetscReal worst_place[3]; // m, where that is
} MouldMesh;

/* Mesh the geometry (or read a ready .msh) on rank 0, cut the cavity wall into patches, distribute. Collective.
 * Errors name the physical group, surface or element at fault. */
PetscErrorCode mould_mesh_create(MPI_Comm comm, const ReduceConfig *config, MouldMesh **mesh);
PetscErrorCode mould_mesh_destroy(MouldMesh **mesh);

#endif
