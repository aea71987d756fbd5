/* pipeline_report.h - what the steps found, in words. */
#ifndef REDUCE_PIPELINE_PIPELINE_REPORT_H
#define REDUCE_PIPELINE_PIPELINE_REPORT_H

#include <stdio.h>
#include "common/log.h"
#include "reduce/mesh/geometry/mould_geometry.h"
#include "reduce/mesh/mould_mesh.h"

/* Size, patches and quality of the mesh, and warnings where it is too coarse for the times asked for. Collective. */
PetscErrorCode pipeline_report_mesh(const MouldMesh *mesh, const ReduceConfig *config, double seconds, Log *log);
/* How many volumes and surfaces each name holds. */
void pipeline_report_geometry(const MouldGeometry *geometry, FILE *out);

#endif
