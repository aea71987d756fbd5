#include "reduce/replay/wall_triangles.h"

#include <stdlib.h>
#include <string.h>
#include "reduce/petsc/collective.h"
#include "reduce/petsc/petsc_compat.h"

typedef struct Triple { // corners of a ROM triangle, ascending
  int32_t point[3], triangle;
} Triple;

static int compare_triples(const void *left, const void *right)
{
  return memcmp(left, right, sizeof((Triple *)NULL)->point);
}

static void sort_three(int32_t p[3])
{
  for (int pass = 0; pass < 2; pass++)
    for (int i = 0; i < 2; i++)
      if (p[i] > p[i + 1]) {
        const int32_t swap = p[i];
        p[i] = p[i + 1];
        p[i + 1] = swap;
      }
}

static Triple *list_triples(const RomData *rom)
{
  Triple *triples = calloc(rom->n_triangles + 1, sizeof *triples);
  for (size_t t = 0; triples && t < rom->n_triangles; t++) {
    memcpy(triples[t].point, rom->triangles + 3 * t, sizeof triples[t].point);
    sort_three(triples[t].point);
    triples[t].triangle = (int32_t)t;
  }
  if (triples) qsort(triples, rom->n_triangles, sizeof *triples, compare_triples);
  return triples;
}

static int compare_places(const void *left, const void *right)
{
  const double *a = left, *b = right;
  for (int d = 0; d < 3; d++)
    if (a[d] != b[d]) return a[d] < b[d] ? -1 : 1;
  return 0;
}

/* The vertices of a face (places into x) and the entries that carry its heat: its vertices with linear elements, the
 * middles of its edges with quadratic ones (whose corners' shape functions integrate to nothing over a triangle). */
static PetscErrorCode read_face(DM dm, PetscInt face, PetscReal x[9], PetscInt dof[3])
{
  PetscInt n, *closure = NULL, first, last, first_edge, last_edge, corners = 0, middles = 0, vertex_dof[3];
  PetscSection section, of_coordinates;
  Vec coordinates;
  const PetscScalar *place;

  PetscFunctionBeginUser;
  PetscCall(DMGetLocalSection(dm, &section));
  PetscCall(DMGetCoordinateSection(dm, &of_coordinates));
  PetscCall(DMGetCoordinatesLocal(dm, &coordinates));
  PetscCall(DMPlexGetDepthStratum(dm, 0, &first, &last));
  PetscCall(DMPlexGetDepthStratum(dm, 1, &first_edge, &last_edge));
  PetscCall(VecGetArrayRead(coordinates, &place));
  PetscCall(DMPlexGetTransitiveClosure(dm, face, PETSC_TRUE, &n, &closure));
  for (PetscInt i = 0; i < n; i++) {
    const PetscInt point = closure[2 * i];
    PetscInt offset, size;
    PetscCall(PetscSectionGetDof(section, point, &size));
    if (point >= first && point < last && corners < 3) {
      PetscCall(PetscSectionGetOffset(of_coordinates, point, &offset));
      PetscCall(PetscArraycpy(x + 3 * corners, place + offset, 3));
      PetscCall(PetscSectionGetOffset(section, point, &vertex_dof[corners++]));
    } else if (point >= first_edge && point < last_edge && size > 0 && middles < 3) {
      PetscCall(PetscSectionGetOffset(section, point, &dof[middles++]));
    }
  }
  PetscCall(DMPlexRestoreTransitiveClosure(dm, face, PETSC_TRUE, &n, &closure));
  PetscCall(VecRestoreArrayRead(coordinates, &place));
  for (int k = 0; k < 3 && middles == 0; k++) dof[k] = vertex_dof[k];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The ROM's triangle with corners at x, or -1. */
static PetscInt find_triangle(const RomData *rom, const Triple *triples, const PetscReal x[9])
{
  Triple key = {{0, 0, 0}, 0};
  for (int k = 0; k < 3; k++) {
    const double *found = bsearch(x + 3 * k, rom->points, rom->n_points, 3 * sizeof(double), compare_places);
    if (!found) return -1;
    key.point[k] = (int32_t)((found - rom->points) / 3);
  }
  sort_three(key.point);
  const Triple *triple = bsearch(&key, triples, rom->n_triangles, sizeof key, compare_triples);
  return triple ? triple->triangle : -1;
}

static PetscErrorCode add_faces(WallTriangles *wall, const RomData *rom, const Triple *triples, PetscInt patch,
                                PetscInt *lost)
{
  DMLabel label;
  IS faces;
  PetscInt n = 0, first, last;
  const PetscInt *face;

  PetscFunctionBeginUser;
  PetscCall(DMGetLabel(wall->dm, "patch", &label));
  PetscCall(DMPlexGetHeightStratum(wall->dm, 1, &first, &last));
  PetscCall(DMLabelGetStratumIS(label, patch, &faces));
  if (!faces) PetscFunctionReturn(PETSC_SUCCESS); // no part of this patch is here
  PetscCall(ISGetLocalSize(faces, &n));
  PetscCall(ISGetIndices(faces, &face));
  for (PetscInt i = 0; i < n; i++) {
    PetscReal x[9];
    if (face[i] < first || face[i] >= last) continue;
    PetscCall(read_face(wall->dm, face[i], x, wall->dof + 3 * wall->n));
    const PetscInt triangle = find_triangle(rom, triples, x);
    if (triangle < 0) {
      (*lost)++;
      continue;
    }
    wall->triangle[wall->n] = triangle;
    wall->patch[wall->n++] = patch;
  }
  PetscCall(ISRestoreIndices(faces, &face));
  PetscCall(ISDestroy(&faces));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode wall_triangles_create(const MouldMesh *mesh, const RomData *rom, WallTriangles **out)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)mesh->dm);
  WallTriangles *wall;
  PetscInt first, last, counts[2] = {0, 0};
  Triple *triples = list_triples(rom);

  PetscFunctionBeginUser;
  PetscCheck(triples, PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for %zu triangles", rom->n_triangles);
  PetscCall(PetscNew(&wall));
  *out = wall;
  wall->dm = mesh->dm;
  PetscCall(DMPlexGetHeightStratum(mesh->dm, 1, &first, &last));
  const size_t most = (size_t)(last - first);
  PetscCall(PetscMalloc3(most, &wall->triangle, most, &wall->patch, 3 * most, &wall->dof));
  for (PetscInt l = 0; l < mesh->n_patches; l++) PetscCall(add_faces(wall, rom, triples, l, &counts[1]));
  free(triples);
  counts[0] = wall->n;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPIU_INT, MPI_SUM, comm));
  PetscCheck(counts[1] == 0 && (size_t)counts[0] == rom->n_triangles, comm, PETSC_ERR_USER,
             "the mesh made anew has %" PetscInt_FMT " of the ROM's %zu wall triangles and %" PetscInt_FMT
             " others: was the ROM made with another version of gmsh (%s)?",
             counts[0], rom->n_triangles, counts[1], rom->provenance.libraries);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode wall_triangles_destroy(WallTriangles **wall)
{
  PetscFunctionBeginUser;
  if (!*wall) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree3((*wall)->triangle, (*wall)->patch, (*wall)->dof));
  PetscCall(PetscFree(*wall));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode wall_triangles_load(const WallTriangles *wall, const PetscReal *heat, Vec F)
{
  Vec local;
  PetscScalar *f;

  PetscFunctionBeginUser;
  PetscCall(DMGetLocalVector(wall->dm, &local));
  PetscCall(VecZeroEntries(local));
  PetscCall(VecGetArray(local, &f));
  for (PetscInt i = 0; i < wall->n; i++)
    for (int k = 0; k < 3; k++) f[wall->dof[3 * i + k]] += heat[wall->triangle[i]] / 3.0;
  PetscCall(VecRestoreArray(local, &f));
  PetscCall(DMLocalToGlobal(wall->dm, local, ADD_VALUES, F));
  PetscCall(DMRestoreLocalVector(wall->dm, &local));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode wall_triangles_mean(const WallTriangles *wall, Vec theta, PetscReal *mean)
{
  Vec local;
  const PetscScalar *T;

  PetscFunctionBeginUser;
  PetscCall(DMGetLocalVector(wall->dm, &local));
  PetscCall(DMGlobalToLocal(wall->dm, theta, INSERT_VALUES, local));
  PetscCall(VecGetArrayRead(local, &T));
  for (PetscInt i = 0; i < wall->n; i++)
    mean[i] = (T[wall->dof[3 * i]] + T[wall->dof[3 * i + 1]] + T[wall->dof[3 * i + 2]]) / 3.0;
  PetscCall(VecRestoreArrayRead(local, &T));
  PetscCall(DMRestoreLocalVector(wall->dm, &local));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode wall_triangles_patches(const WallTriangles *wall, size_t n_triangles, PetscInt *patch)
{
  PetscFunctionBeginUser;
  PetscCall(PetscArrayzero(patch, n_triangles));
  for (PetscInt i = 0; i < wall->n; i++) patch[wall->triangle[i]] = wall->patch[i];
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, patch, (PetscMPIInt)n_triangles, MPIU_INT, MPI_SUM,
                             PetscObjectComm((PetscObject)wall->dm)));
  PetscFunctionReturn(PETSC_SUCCESS);
}
