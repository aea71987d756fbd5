/* patches.h - the numbered patches of the mould's boundary: the cavity's, then those of the outer surfaces. */
#ifndef REDUCE_MESH_PATCHES_PATCHES_H
#define REDUCE_MESH_PATCHES_PATCHES_H

#include "common/rom/rom.h"
#include "reduce/mesh/tets/tet_mesh.h"

typedef struct Patches {
  size_t n, n_cavity;
  RomPatch *patch;         // [n] owned; names, areas, centroids, Robin coefficients
  int32_t *triangle_count; // [n] owned
  int32_t *of_triangle;    // [mesh->n_triangles] owned
} Patches;

/* Cut the surfaces of a checked mesh by the config's patch sizes (outer ones are whole where it gives none). The same on any number of ranks, as it is done
 * before the mesh is distributed. A fixed temperature becomes a Robin wall whose coefficient is far above what
 * conduction through an outer element of size L can match, h L/kappa = 1e5: the wall is off by 1e-5 of the drop over
 * that element. Errors: CAST_ERR_MEMORY. */
CastStatus patches_create(const TetMesh *mesh, const ReduceConfig *config, Patches **patches, CastError *err);
void patches_destroy(Patches **patches);

#endif
