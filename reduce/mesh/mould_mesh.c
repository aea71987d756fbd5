#include "reduce/mesh/mould_mesh.h"

#include "reduce/mesh/geometry/mould_geometry.h"
#include "reduce/mesh/layers/wall_layers.h"
#include "reduce/mesh/mesh_plex.h"
#include "reduce/mesh/patches/patches.h"
#include "reduce/petsc/collective.h"
#include "reduce/petsc/petsc_compat.h"

typedef struct WholeMould { // on rank 0
  TetMesh *mesh;
  Patches *patches;
  TetMeshMeasures measures;
} WholeMould;

static void destroy_whole(WholeMould *whole)
{
  tet_mesh_destroy(&whole->mesh);
  patches_destroy(&whole->patches);
}

static CastStatus create_whole(const ReduceConfig *config, WholeMould *whole, CastError *err)
{
  MouldGeometry *geometry = NULL;
  CAST_CALL(mould_geometry_open(config, &geometry, err));
  CastStatus status = mould_geometry_mesh(geometry, &whole->mesh, err);
  mould_geometry_close(&geometry);
  if (status == CAST_OK) status = wall_layers_grow(whole->mesh, config, err);
  if (status == CAST_OK) status = tet_mesh_measure(whole->mesh, config, &whole->measures, err);
  if (status == CAST_OK) status = patches_create(whole->mesh, config, &whole->patches, err);
  if (status != CAST_OK) destroy_whole(whole);
  return status;
}

/* The patch table and the measures, from rank 0 to all. */
static PetscErrorCode share_description(MPI_Comm comm, const WholeMould *whole, MouldMesh *mesh)
{
  enum { MEASURES = 8 };
  PetscInt counts[3] = {0, 0, 0};
  PetscReal measures[MEASURES] = {0};

  PetscFunctionBeginUser;
  if (whole->patches) {
    const TetMeshMeasures *of = &whole->measures;
    counts[0] = (PetscInt)whole->patches->n;
    counts[1] = (PetscInt)whole->patches->n_cavity;
    counts[2] = (PetscInt)whole->mesh->n_layer_tets;
    const PetscReal found[MEASURES] = {of->volume,         of->shortest_edge,  of->first_layer,    of->worst_quality,
                                       of->worst_place[0], of->worst_place[1], of->worst_place[2], of->thick_layer};
    PetscCall(PetscArraycpy(measures, found, MEASURES));
  }
  PetscCallMPI(MPI_Bcast(counts, 3, MPIU_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(measures, MEASURES, MPIU_REAL, 0, comm));
  mesh->n_patches = counts[0];
  mesh->n_cavity = counts[1];
  mesh->n_layer_cells = counts[2];
  mesh->volume = measures[0];
  mesh->shortest_edge = measures[1];
  mesh->first_layer = measures[2];
  mesh->worst_quality = measures[3];
  PetscCall(PetscArraycpy(mesh->worst_place, measures + 4, 3));
  mesh->thick_layer = measures[7];
  PetscCall(PetscCalloc1((size_t)mesh->n_patches, &mesh->patch));
  PetscCall(PetscCalloc1((size_t)mesh->n_patches, &mesh->triangles));
  for (PetscInt l = 0; whole->patches && l < mesh->n_patches; l++) {
    mesh->patch[l] = whole->patches->patch[l];
    mesh->triangles[l] = whole->patches->triangle_count[l];
  }
  PetscCallMPI(MPI_Bcast(mesh->patch, (PetscMPIInt)(mesh->n_patches * (PetscInt)sizeof(RomPatch)), MPI_BYTE, 0, comm));
  PetscCallMPI(MPI_Bcast(mesh->triangles, (PetscMPIInt)mesh->n_patches, MPIU_INT, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode mould_mesh_create(MPI_Comm comm, const ReduceConfig *config, MouldMesh **mesh)
{
  WholeMould whole = {0};
  CastError err = {CAST_OK, ""};
  CastStatus status = CAST_OK;
  PetscMPIInt rank;

  PetscFunctionBeginUser;
  *mesh = NULL;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) status = create_whole(config, &whole, &err);
  PetscCall(collective_check(comm, status, &err));
  PetscCall(PetscNew(mesh));
  PetscCall(share_description(comm, &whole, *mesh));
  PetscCall(mesh_plex_create(comm, whole.mesh, whole.patches ? whole.patches->of_triangle : NULL, &(*mesh)->dm));
  destroy_whole(&whole);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode mould_mesh_destroy(MouldMesh **mesh)
{
  PetscFunctionBeginUser;
  if (!*mesh) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DMDestroy(&(*mesh)->dm));
  PetscCall(PetscFree((*mesh)->patch));
  PetscCall(PetscFree((*mesh)->triangles));
  PetscCall(PetscFree(*mesh));
  PetscFunctionReturn(PETSC_SUCCESS);
}
