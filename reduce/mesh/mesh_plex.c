#include "reduce/mesh/mesh_plex.h"

#include "reduce/petsc/petsc_compat.h"

static PetscErrorCode build_plex(MPI_Comm comm, const TetMesh *mesh, DM *dm)
{
  const PetscInt n_cells = mesh ? (PetscInt)mesh->n_tets : 0, n_points = mesh ? (PetscInt)mesh->n_points : 0;
  PetscInt *cells;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)(4 * n_cells), &cells));
  for (PetscInt t = 0; t < n_cells; t++) {
    const int32_t *tet = mesh->tet + 4 * t;
    const PetscInt turned[4] = {tet[0], tet[2], tet[1], tet[3]}; // PETSc's reference cell is the mirror image
    PetscCall(PetscArraycpy(cells + 4 * t, turned, 4));
  }
  PetscCall(
      DMPlexCreateFromCellListPetsc(comm, 3, n_cells, n_points, 4, PETSC_TRUE, cells, 3, mesh ? mesh->x : NULL, dm));
  PetscCall(PetscFree(cells));
  PetscCall(PetscObjectSetName((PetscObject)*dm, "mould"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode mark_regions(DM dm, const TetMesh *mesh)
{
  DMLabel label;

  PetscFunctionBeginUser;
  PetscCall(DMCreateLabel(dm, "region"));
  PetscCall(DMGetLabel(dm, "region", &label));
  for (size_t t = 0; mesh && t < mesh->n_tets; t++) PetscCall(DMLabelSetValue(label, (PetscInt)t, mesh->tet_region[t]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode mark_patches(DM dm, const TetMesh *mesh, const int32_t *patch_of_triangle)
{
  DMLabel label;
  PetscInt first, last;

  PetscFunctionBeginUser;
  PetscCall(DMCreateLabel(dm, "patch"));
  PetscCall(DMGetLabel(dm, "patch", &label));
  PetscCall(DMPlexGetDepthStratum(dm, 0, &first, &last));
  for (size_t t = 0; mesh && t < mesh->n_triangles; t++) {
    const int32_t *triangle = mesh->triangle + 3 * t;
    const PetscInt points[3] = {first + triangle[0], first + triangle[1], first + triangle[2]};
    const PetscInt *faces;
    PetscInt n_faces;
    PetscCall(DMPlexGetFullJoin(dm, 3, points, &n_faces, &faces));
    PetscCheck(n_faces == 1, PETSC_COMM_SELF, PETSC_ERR_PLIB,
               "boundary triangle %zu is %" PetscInt_FMT " faces of the distributed mesh", t, n_faces);
    PetscCall(DMLabelSetValue(label, faces[0], patch_of_triangle[t]));
    PetscCall(DMPlexRestoreJoin(dm, 3, points, &n_faces, &faces));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode mesh_plex_create(MPI_Comm comm, const TetMesh *mesh, const int32_t *patch_of_triangle, DM *dm)
{
  DM distributed;

  PetscFunctionBeginUser;
  PetscCall(build_plex(comm, mesh, dm));
  PetscCall(mark_regions(*dm, mesh));
  PetscCall(mark_patches(*dm, mesh, patch_of_triangle));
  PetscCall(DMPlexDistribute(*dm, 0, NULL, &distributed));
  if (distributed) { // NULL on one rank
    PetscCall(DMDestroy(dm));
    *dm = distributed;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
