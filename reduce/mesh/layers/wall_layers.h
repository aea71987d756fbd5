/* wall_layers.h - thin layers of tetrahedra at the cavity wall, grown into a mesh that is there.
 *
 * Over each point of the wall stands a column of points w_k = w + t_k d, t_k = first (g^k - 1)/(g - 1), k = 0..n. The
 * mesh behind the wall lets go of w and takes hold of w_n instead, which squeezes it a little; between the wall and it,
 * prisms over each wall triangle are cut into three tetrahedra, the diagonals going up from the lower to the higher
 * number of the wall points, so that neighbours agree. The wall's own triangles stay as they are, and so do all other
 * points. Where the mould's outside or the border between two regions meets the wall, columns lie in those faces.
 *
 * d looks away from all wall triangles at the point as evenly as it can. n is as large as the mesh behind has room for
 * (and at most what is asked): it is lowered, to 0 if need be, until every tetrahedron of the mesh behind keeps a part
 * of its volume and its quality and every piece of a prism has the volume it should have. All volumes are then positive
 * and the boundary is where it was, so nothing overlaps: no test for collisions is needed. */
#ifndef REDUCE_MESH_LAYERS_WALL_LAYERS_H
#define REDUCE_MESH_LAYERS_WALL_LAYERS_H

#include "reduce/mesh/tets/tet_mesh.h"

/* Grow the layers that the config asks for into a checked mesh, and check it again. The tetrahedra of the layers are
 * the last mesh->n_layer_tets. Errors: CAST_ERR_MEMORY; those of tet_mesh_check. */
CastStatus wall_layers_grow(TetMesh *mesh, const ReduceConfig *config, CastError *err);

#endif
