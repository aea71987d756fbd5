/* wall_geometry.h - what castrun needs of the mesh: the mould's whole boundary, the tetrahedra near the cavity wall and
 * the reduced basis on their nodes, gathered on rank 0. The rest of the mesh stays where it is. */
#ifndef REDUCE_IO_WALL_GEOMETRY_H
#define REDUCE_IO_WALL_GEOMETRY_H

#include <stdint.h>
#include "reduce/mesh/mould_mesh.h"
#include "reduce/mor/krylov/model_basis.h"

typedef struct WallGeometry { // arrays on rank 0; elsewhere empty. Owned.
  PetscInt r;
  PetscReal band; // m, on all ranks
  size_t n_points, n_triangles, n_tetrahedra;
  double *points;          // [n_points*3] m, ascending in x, then y, then z
  float *basis;            // [n_points*r] V on the points
  int32_t *triangles;      // [n_triangles*3] wound out of the mould; by patch, then by points
  int32_t *triangle_patch; // [n_triangles]
  int32_t *tetrahedra;     // [n_tetrahedra*4] positive volume, by points
} WallGeometry;

/* Take every tetrahedron of which any part is within `band` (m) of the cavity wall, and hardly any other. V has the
 * layout of the DM's global vectors. Where the basis would take more than `budget` bytes the band is made thinner, down
 * to the elements at the wall, which are always kept: geometry->band is what it came to. Collective. */
PetscErrorCode wall_geometry_gather(const MouldMesh *mesh, const ModelBasis *basis, PetscReal band, PetscReal budget,
                                    WallGeometry *geometry);
PetscErrorCode wall_geometry_destroy(WallGeometry *geometry);

#endif
