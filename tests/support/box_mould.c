#include "reduce/petsc/petsc_compat.h"
#include "tests/support/box_mould.h"

#include <math.h>
#include <stdio.h>

enum { TETRAHEDRA_PER_BRICK = 6 };

static PetscInt vertex_number(const BoxMould *box, const int at[3])
{
  return at[0] + (box->cells[0] + 1) * (at[1] + (PetscInt)(box->cells[1] + 1) * at[2]);
}

/* Kuhn's division: one tetrahedron for each order in which the axes are walked from corner 000 to corner 111. Odd
 * orders are mirror images: two vertices change places so that all volumes have one sign. */
static void divide_brick(const BoxMould *box, const int corner[3], PetscInt *vertices)
{
  static const int order[TETRAHEDRA_PER_BRICK][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (int t = 0; t < TETRAHEDRA_PER_BRICK; t++) {
    PetscInt *of_tetrahedron = vertices + 4 * t;
    int at[3] = {corner[0], corner[1], corner[2]};
    of_tetrahedron[0] = vertex_number(box, at);
    for (int step = 0; step < 3; step++) {
      at[order[t][step]]++;
      of_tetrahedron[step + 1] = vertex_number(box, at);
    }
    if (t < 3) { // PETSc's reference tetrahedron counts its second and third vertices the other way round
      const PetscInt swap = of_tetrahedron[1];
      of_tetrahedron[1] = of_tetrahedron[2];
      of_tetrahedron[2] = swap;
    }
  }
}

static void place_vertices(const BoxMould *box, PetscReal *x)
{
  for (int k = 0; k <= box->cells[2]; k++)
    for (int j = 0; j <= box->cells[1]; j++)
      for (int i = 0; i <= box->cells[0]; i++, x += 3) {
        x[0] = box->size[0] * i / box->cells[0];
        x[1] = box->size[1] * j / box->cells[1];
        x[2] = box->size[2] * pow((double)k / box->cells[2], box->grading);
      }
}

/* The whole mesh on rank 0. */
static PetscErrorCode create_plex(MPI_Comm comm, const BoxMould *box, DM *dm)
{
  PetscMPIInt rank;
  PetscInt n_bricks = 0, n_vertices = 0, *vertices;
  PetscReal *x;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) {
    n_bricks = (PetscInt)box->cells[0] * box->cells[1] * box->cells[2];
    n_vertices = (PetscInt)(box->cells[0] + 1) * (box->cells[1] + 1) * (box->cells[2] + 1);
  }
  PetscCall(PetscMalloc2((size_t)(4 * TETRAHEDRA_PER_BRICK * n_bricks), &vertices, (size_t)(3 * n_vertices), &x));
  if (rank == 0) {
    PetscInt *next = vertices;
    place_vertices(box, x);
    for (int k = 0; k < box->cells[2]; k++)
      for (int j = 0; j < box->cells[1]; j++)
        for (int i = 0; i < box->cells[0]; i++, next += 4 * TETRAHEDRA_PER_BRICK)
          divide_brick(box, (const int[3]){i, j, k}, next);
  }
  PetscCall(DMPlexCreateFromCellListPetsc(comm, 3, TETRAHEDRA_PER_BRICK * n_bricks, n_vertices, 4, PETSC_TRUE, vertices,
                                          3, x, dm));
  PetscCall(PetscFree2(vertices, x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Labels travel with the cells and faces. */
static PetscErrorCode distribute(DM *dm)
{
  DM distributed;

  PetscFunctionBeginUser;
  PetscCall(DMPlexDistribute(*dm, 0, NULL, &distributed));
  if (distributed) {
    PetscCall(DMDestroy(dm));
    *dm = distributed;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt patch_of_face(const BoxMould *box, const PetscReal centroid[3])
{
  const PetscInt n_cavity = (PetscInt)box->patches[0] * box->patches[1];
  const double near = 1e-9 * box->size[2];
  if (centroid[2] < near)
    return (PetscInt)(centroid[0] / box->size[0] * box->patches[0]) +
           box->patches[0] * (PetscInt)(centroid[1] / box->size[1] * box->patches[1]);
  return centroid[2] > box->size[2] - near ? n_cavity + 1 : n_cavity;
}

static PetscErrorCode label_boundary(const BoxMould *box, MouldMesh *mesh)
{
  DMLabel label;
  PetscInt first, last;

  PetscFunctionBeginUser;
  PetscCall(DMCreateLabel(mesh->dm, "patch"));
  PetscCall(DMGetLabel(mesh->dm, "patch", &label));
  PetscCall(DMPlexMarkBoundaryFaces(mesh->dm, 1, label));
  PetscCall(DMPlexGetHeightStratum(mesh->dm, 1, &first, &last));
  for (PetscInt face = first; face < last; face++) {
    PetscInt marked, patch;
    PetscReal area, centroid[3];
    PetscCall(DMLabelGetValue(label, face, &marked));
    if (marked != 1) continue;
    PetscCall(DMPlexComputeCellGeometryFVM(mesh->dm, face, &area, centroid, NULL));
    patch = patch_of_face(box, centroid);
    PetscCall(DMLabelClearValue(label, face, 1));
    PetscCall(DMLabelSetValue(label, face, patch));
    mesh->patch[patch].area += area;
    for (int d = 0; d < 3; d++) mesh->patch[patch].centroid[d] += area * centroid[d];
  }
  for (PetscInt l = 0; l < mesh->n_patches; l++) {
    double sums[4] = {mesh->patch[l].area, mesh->patch[l].centroid[0], mesh->patch[l].centroid[1],
                      mesh->patch[l].centroid[2]};
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, PetscObjectComm((PetscObject)mesh->dm)));
    mesh->patch[l].area = sums[0];
    for (int d = 0; d < 3; d++) mesh->patch[l].centroid[d] = sums[d + 1] / sums[0];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode label_regions(const BoxMould *box, DM dm)
{
  DMLabel label;
  PetscInt first, last;

  PetscFunctionBeginUser;
  PetscCall(DMCreateLabel(dm, "region"));
  PetscCall(DMGetLabel(dm, "region", &label));
  PetscCall(DMPlexGetHeightStratum(dm, 0, &first, &last));
  for (PetscInt cell = first; cell < last; cell++) {
    PetscReal centroid[3];
    PetscCall(DMPlexComputeCellGeometryFVM(dm, cell, NULL, centroid, NULL));
    PetscCall(DMLabelSetValue(label, cell, box->interface > 0 && centroid[2] > box->interface ? 1 : 0));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode describe_patches(const BoxMould *box, MouldMesh *mesh)
{
  PetscFunctionBeginUser;
  mesh->n_cavity = (PetscInt)box->patches[0] * box->patches[1];
  mesh->n_patches = mesh->n_cavity + 2;
  PetscCall(PetscCalloc1(mesh->n_patches, &mesh->patch));
  for (PetscInt l = 0; l < mesh->n_patches; l++) {
    RomPatch *patch = &mesh->patch[l];
    patch->outer = l >= mesh->n_cavity;
    patch->h = l == mesh->n_cavity ? box->h_sides : l > mesh->n_cavity ? box->h_top : box->h_cavity;
    snprintf(patch->surface, sizeof patch->surface, "%s",
             l == mesh->n_cavity  ? "sides"
             : l > mesh->n_cavity ? "top"
                                  : "cavity");
    if (patch->outer)
      snprintf(patch->name, sizeof patch->name, "%.20s", patch->surface);
    else
      snprintf(patch->name, sizeof patch->name, "cavity/%d", (int)l + 1);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode box_mould_create(MPI_Comm comm, const BoxMould *box, MouldMesh **mesh, ReduceConfig **config)
{
  PetscFunctionBeginUser;
  PetscCheck(box->cells[0] % box->patches[0] == 0 && box->cells[1] % box->patches[1] == 0, comm, PETSC_ERR_ARG_INCOMP,
             "the patches do not divide the cells of the cavity wall");
  PetscCall(PetscNew(mesh));
  PetscCall(create_plex(comm, box, &(*mesh)->dm));
  PetscCall(describe_patches(box, *mesh));
  PetscCall(label_boundary(box, *mesh));
  PetscCall(label_regions(box, (*mesh)->dm));
  PetscCall(distribute(&(*mesh)->dm));
  (*mesh)->volume = box->size[0] * box->size[1] * box->size[2];
  PetscCall(PetscNew(config));
  (*config)->n_regions = box->interface > 0 ? 2 : 1;
  (*config)->order = 1;
  PetscCall(PetscCalloc1((*config)->n_regions, &(*config)->region));
  for (size_t r = 0; r < (*config)->n_regions; r++) {
    RegionConfig *region = &(*config)->region[r];
    snprintf(region->name, sizeof region->name, "%s", r == 0 ? "lower" : "upper");
    region->material.conductivity = box->kappa[r];
    region->material.density = box->rho[r];
    region->material.specific_heat = box->c[r];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode box_mould_destroy(MouldMesh **mesh, ReduceConfig **config)
{
  PetscFunctionBeginUser;
  if (*mesh) {
    PetscCall(DMDestroy(&(*mesh)->dm));
    PetscCall(PetscFree((*mesh)->patch));
    PetscCall(PetscFree(*mesh));
  }
  if (*config) PetscCall(PetscFree((*config)->region));
  PetscCall(PetscFree(*config));
  PetscFunctionReturn(PETSC_SUCCESS);
}
