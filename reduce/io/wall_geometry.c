/* wall_geometry.c - from every rank's share to rank 0. */
#include "reduce/io/wall_geometry_private.h"

#include <stdlib.h>
#include "reduce/petsc/collective.h"
#include "reduce/petsc/petsc_compat.h"

static const PetscReal THINNEST = 1e-3; // of the band that was asked for
static const PetscReal NEAR = 1.25;     // a band thicker by this does not fit: thick enough

typedef struct Points { // in use and owned by this rank
  PetscInt n;
  PetscInt *number; // [n] global
  PetscReal *x;     // [n*3] m
  float *basis;     // [n*r]
} Points;

/* A node is in use if any rank's share has it; only its owner knows its row of V. */
static PetscErrorCode mark_used(const WallShare *share, Vec used)
{
  PetscSection section;
  PetscScalar *mark;
  Vec local;

  PetscFunctionBeginUser;
  PetscCall(DMGetLocalSection(share->dm, &section));
  PetscCall(DMGetLocalVector(share->dm, &local));
  PetscCall(VecZeroEntries(local));
  PetscCall(VecGetArray(local, &mark));
  for (PetscInt i = 0; i < share->n_local; i++) {
    PetscInt offset;
    PetscCall(PetscSectionGetOffset(section, share->local[i], &offset));
    mark[offset] = 1.0;
  }
  PetscCall(VecRestoreArray(local, &mark));
  PetscCall(VecZeroEntries(used));
  PetscCall(DMLocalToGlobal(share->dm, local, ADD_VALUES, used));
  PetscCall(DMRestoreLocalVector(share->dm, &local));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode list_points(const WallShare *share, Vec used, Points *points)
{
  PetscInt first, last, begin, end;
  PetscSection coordinate_section;
  Vec coordinates;
  const PetscScalar *x, *mark;

  PetscFunctionBeginUser;
  PetscCall(DMPlexGetDepthStratum(share->dm, 0, &first, &last));
  PetscCall(VecGetOwnershipRange(used, &begin, &end));
  PetscCall(PetscMalloc2((size_t)(end - begin), &points->number, (size_t)(3 * (end - begin)), &points->x));
  PetscCall(DMGetCoordinateSection(share->dm, &coordinate_section));
  PetscCall(DMGetCoordinatesLocal(share->dm, &coordinates));
  PetscCall(VecGetArrayRead(coordinates, &x));
  PetscCall(VecGetArrayRead(used, &mark));
  for (PetscInt vertex = first; vertex < last; vertex++) {
    PetscInt number, offset;
    PetscCall(PetscSectionGetOffset(share->section, vertex, &number));
    if (number < begin || number >= end || mark[number - begin] == 0.0) continue;
    PetscCall(PetscSectionGetOffset(coordinate_section, vertex, &offset));
    PetscCall(PetscArraycpy(points->x + 3 * points->n, x + offset, 3));
    points->number[points->n++] = number;
  }
  PetscCall(VecRestoreArrayRead(used, &mark));
  PetscCall(VecRestoreArrayRead(coordinates, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode copy_basis(const ModelBasis *basis, PetscInt begin, Points *points)
{
  PetscInt *row;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)points->n * (size_t)basis->r, &points->basis));
  PetscCall(PetscMalloc1((size_t)points->n, &row));
  for (PetscInt i = 0; i < points->n; i++) row[i] = points->number[i] - begin;
  PetscCall(model_basis_rows(basis, points->n, row, points->basis));
  PetscCall(PetscFree(row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows of `width` values of `type` from all ranks to rank 0, in the order of the ranks. total: on rank 0, rows.
 * A type of one row keeps the counts, which MPI wants as int, small. */
static PetscErrorCode gather_rows(MPI_Comm comm, const void *own, PetscInt n, PetscMPIInt width, MPI_Datatype type,
                                  void **all, size_t *total)
{
  PetscMPIInt rank, size, bytes, *counts, *starts, sum = 0, rows = (PetscMPIInt)n;
  MPI_Datatype row;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscCalloc2((size_t)size, &counts, (size_t)size, &starts));
  PetscCallMPI(MPI_Gather(&rows, 1, MPI_INT, counts, 1, MPI_INT, 0, comm));
  for (PetscMPIInt k = 0; rank == 0 && k < size; k++) {
    starts[k] = sum;
    sum += counts[k];
  }
  PetscCallMPI(MPI_Type_contiguous(width, type, &row));
  PetscCallMPI(MPI_Type_commit(&row));
  PetscCallMPI(MPI_Type_size(row, &bytes));
  *all = malloc((size_t)sum * (size_t)bytes + 1);
  PetscCheck(*all, PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for %d rows of the mould's wall", sum);
  PetscCallMPI(MPI_Gatherv(own, rows, row, *all, counts, starts, row, 0, comm));
  PetscCallMPI(MPI_Type_free(&row));
  PetscCall(PetscFree2(counts, starts));
  *total = (size_t)sum;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode gather_all(MPI_Comm comm, const WallShare *share, const Points *points, WallGeometry *geometry)
{
  CastError err = {CAST_OK, ""};
  CastStatus status = CAST_OK;
  void *number, *triangle, *tetrahedron, *x, *basis;
  PetscMPIInt rank;
  size_t n;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(gather_rows(comm, points->number, points->n, 1, MPIU_INT, &number, &geometry->n_points));
  PetscCall(gather_rows(comm, points->x, points->n, 3, MPIU_REAL, &x, &n));
  PetscCall(gather_rows(comm, points->basis, points->n, (PetscMPIInt)geometry->r, MPI_FLOAT, &basis, &n));
  PetscCall(gather_rows(comm, share->triangle, share->n_triangles, 4, MPIU_INT, &triangle, &geometry->n_triangles));
  PetscCall(
      gather_rows(comm, share->tetrahedron, share->n_tetrahedra, 4, MPIU_INT, &tetrahedron, &geometry->n_tetrahedra));
  geometry->points = x;
  geometry->basis = basis;
  if (rank == 0) status = wall_geometry_sort(geometry, number, triangle, tetrahedron, &err);
  free(number);
  free(triangle);
  free(tetrahedron);
  PetscCall(collective_check(comm, status, &err));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode count_used(Vec used, PetscReal *n)
{
  const PetscScalar *mark;
  PetscInt size;

  PetscFunctionBeginUser;
  PetscCall(VecGetLocalSize(used, &size));
  PetscCall(VecGetArrayRead(used, &mark));
  *n = 0.0;
  for (PetscInt i = 0; i < size; i++) *n += mark[i] != 0.0;
  PetscCall(VecRestoreArrayRead(used, &mark));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, n, 1, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)used)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The elements of a band, in place of those of another, and `used` that marks their nodes. */
static PetscErrorCode take_band(const MouldMesh *mesh, PetscReal band, WallGeometry *geometry, WallShare *share,
                                Vec used)
{
  PetscFunctionBeginUser;
  if (share->dm) PetscCall(wall_share_destroy(share));
  geometry->band = band;
  PetscCall(wall_share_create(mesh, band, share));
  PetscCall(mark_used(share, used));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode basis_fits(const WallGeometry *geometry, Vec used, PetscReal budget, PetscBool *fits)
{
  PetscReal n_points;

  PetscFunctionBeginUser;
  PetscCall(count_used(used, &n_points));
  *fits = (PetscBool)(n_points * (PetscReal)geometry->r * (PetscReal)sizeof(float) <= budget);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As thick as the budget allows, by bisection of its logarithm; the thinnest where even the wall's own nodes take more.
 */
static PetscErrorCode choose_band(const MouldMesh *mesh, PetscReal budget, WallGeometry *geometry, WallShare *share,
                                  Vec used)
{
  PetscReal too_thick = geometry->band, thin_enough = THINNEST * too_thick;
  PetscBool fits = PETSC_FALSE;

  PetscFunctionBeginUser;
  PetscCall(take_band(mesh, too_thick, geometry, share, used));
  PetscCall(basis_fits(geometry, used, budget, &fits));
  if (fits) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(take_band(mesh, thin_enough, geometry, share, used));
  PetscCall(basis_fits(geometry, used, budget, &fits));
  if (!fits) PetscFunctionReturn(PETSC_SUCCESS);
  while (too_thick > NEAR * thin_enough) {
    const PetscReal band = PetscSqrtReal(thin_enough * too_thick);
    PetscCall(take_band(mesh, band, geometry, share, used));
    PetscCall(basis_fits(geometry, used, budget, &fits));
    if (fits)
      thin_enough = band;
    else
      too_thick = band;
  }
  if (geometry->band > thin_enough) PetscCall(take_band(mesh, thin_enough, geometry, share, used));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode wall_geometry_gather(const MouldMesh *mesh, const ModelBasis *basis, PetscReal band, PetscReal budget,
                                    WallGeometry *geometry)
{
  WallShare share = {0};
  Points points = {0};
  PetscInt begin, end;
  Vec used;

  PetscFunctionBeginUser;
  *geometry = (WallGeometry){.band = band};
  geometry->r = basis->r;
  PetscCall(DMGetGlobalVector(mesh->dm, &used));
  PetscCall(choose_band(mesh, budget, geometry, &share, used));
  PetscCall(list_points(&share, used, &points));
  PetscCall(VecGetOwnershipRange(used, &begin, &end));
  PetscCall(DMRestoreGlobalVector(mesh->dm, &used));
  PetscCall(copy_basis(basis, begin, &points));
  PetscCall(gather_all(PetscObjectComm((PetscObject)mesh->dm), &share, &points, geometry));
  PetscCall(PetscFree(points.basis));
  PetscCall(PetscFree2(points.number, points.x));
  PetscCall(wall_share_destroy(&share));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode wall_geometry_destroy(WallGeometry *geometry)
{
  PetscFunctionBeginUser;
  free(geometry->points);
  free(geometry->basis);
  free(geometry->triangles);
  free(geometry->triangle_patch);
  free(geometry->tetrahedra);
  *geometry = (WallGeometry){0};
  PetscFunctionReturn(PETSC_SUCCESS);
}
