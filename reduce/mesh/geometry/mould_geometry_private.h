/* mould_geometry_private.h - the steps behind mould_geometry.h. */
#ifndef REDUCE_MESH_GEOMETRY_MOULD_GEOMETRY_PRIVATE_H
#define REDUCE_MESH_GEOMETRY_MOULD_GEOMETRY_PRIVATE_H

#include "reduce/mesh/geometry/mould_geometry.h"

/* The model in gmsh from an STL file of the cavity and a flask. Errors: CAST_ERR_INPUT, of the STL file, of where the
 * cavity lies in the flask, and of gmsh. */
CastStatus mould_geometry_from_stl(MouldGeometry *geometry, CastError *err);
/* Give each entity its name, from geometry.groups or from the physical groups of the file. */
CastStatus mould_geometry_resolve(MouldGeometry *geometry, CastError *err);
/* Sizes graded from the cavity wall outwards, then tetrahedra, in gmsh. */
CastStatus mould_geometry_generate(const MouldGeometry *geometry, CastError *err);
/* What gmsh holds as a mesh in metres, unchecked. */
CastStatus mould_geometry_extract(const MouldGeometry *geometry, TetMesh **mesh, CastError *err);
/* "(1, 2, 3) to (4, 5, 6) mm" */
void mould_geometry_place(const MouldGeometry *geometry, const GeometryEntity *entity, char *text, size_t size);

#endif
