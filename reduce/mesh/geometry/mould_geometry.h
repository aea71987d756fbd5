/* mould_geometry.h - the geometry in gmsh's hands: opened, each of its volumes and surfaces under the name that the
 * input gives it. Lives on one rank; one at a time. */
#ifndef REDUCE_MESH_GEOMETRY_MOULD_GEOMETRY_H
#define REDUCE_MESH_GEOMETRY_MOULD_GEOMETRY_H

#include "reduce/config/config.h"
#include "reduce/mesh/tets/tet_mesh.h"

enum { NAME_NONE = -1 };

typedef struct GeometryEntity { // a surface or a volume
  int tag;                      // gmsh's number
  int name;                     // region, or surface (cavity's first, then the outer ones); NAME_NONE
  double box[6];                // in the geometry's unit: low x y z, high x y z
  int volumes;                  // surfaces: how many volumes it bounds; -1: not known (ready mesh)
} GeometryEntity;

typedef struct MouldGeometry {
  const ReduceConfig *config; // borrowed
  size_t n_surfaces, n_volumes;
  GeometryEntity *surface, *volume; // [n] owned
  double volume_expected;           // m3 of mould material; 0: not known
  double volume_slack;              // m3
} MouldGeometry;

/* Open the file that the config names, resolve the names and check that nothing is missing, overlapping or unnamed.
 * Errors: CAST_ERR_INPUT with all such faults, by entity and place. */
CastStatus mould_geometry_open(const ReduceConfig *config, MouldGeometry **geometry, CastError *err);
void mould_geometry_close(MouldGeometry **geometry);

/* Mesh it (or take the mesh that it is) and check the result. See tet_mesh.h. */
CastStatus mould_geometry_mesh(const MouldGeometry *geometry, TetMesh **mesh, CastError *err);

#endif
