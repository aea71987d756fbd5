/* wall_share.c - the boundary triangles of this rank, and its tetrahedra near the cavity wall. */
#include "common/vector.h"
#include "reduce/io/wall_geometry_private.h"
#include "reduce/mesh/surface/triangle_tree.h"
#include "reduce/petsc/collective.h"
#include "reduce/petsc/petsc_compat.h"

enum { MOST_CORNERS = 4 };

typedef struct Corners { // of a face or a cell
  PetscInt n;
  PetscInt point[MOST_CORNERS];
  PetscReal x[MOST_CORNERS][3]; // m
} Corners;

static bool is_before(const PetscReal a[3], const PetscReal b[3])
{
  for (int d = 0; d < 3; d++)
    if (a[d] != b[d]) return a[d] < b[d];
  return false;
}

static void swap_corners(Corners *corners, PetscInt a, PetscInt b)
{
  const Corners copy = *corners;
  corners->point[a] = copy.point[b];
  corners->point[b] = copy.point[a];
  for (int d = 0; d < 3; d++) {
    corners->x[a][d] = copy.x[b][d];
    corners->x[b][d] = copy.x[a][d];
  }
}

/* The vertices in an order that does not depend on how the mesh was distributed, so that sums over them round alike. */
static PetscErrorCode get_corners(DM dm, PetscInt point, Corners *corners)
{
  PetscInt n, *closure = NULL, first, last;
  PetscSection section;
  Vec coordinates;
  const PetscScalar *x;

  PetscFunctionBeginUser;
  PetscCall(DMPlexGetDepthStratum(dm, 0, &first, &last));
  PetscCall(DMGetCoordinateSection(dm, &section));
  PetscCall(DMGetCoordinatesLocal(dm, &coordinates));
  PetscCall(VecGetArrayRead(coordinates, &x));
  PetscCall(DMPlexGetTransitiveClosure(dm, point, PETSC_TRUE, &n, &closure));
  corners->n = 0;
  for (PetscInt i = 0; i < n; i++) {
    const PetscInt vertex = closure[2 * i];
    PetscInt offset;
    if (vertex < first || vertex >= last || corners->n == MOST_CORNERS) continue;
    PetscCall(PetscSectionGetOffset(section, vertex, &offset));
    corners->point[corners->n] = vertex;
    PetscCall(PetscArraycpy(corners->x[corners->n++], x + offset, 3));
  }
  PetscCall(DMPlexRestoreTransitiveClosure(dm, point, PETSC_TRUE, &n, &closure));
  PetscCall(VecRestoreArrayRead(coordinates, &x));
  for (PetscInt pass = 1; pass < corners->n; pass++)
    for (PetscInt i = 0; i + pass < corners->n; i++)
      if (is_before(corners->x[i + 1], corners->x[i])) swap_corners(corners, i, i + 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal signed_volume(const Corners *triangle, const PetscReal top[3])
{
  double u[3], v[3], normal[3], w[3];
  vec_between(triangle->x[0], triangle->x[1], u);
  vec_between(triangle->x[0], triangle->x[2], v);
  vec_between(triangle->x[0], top, w);
  vec_cross(u, v, normal);
  return vec_dot(normal, w) / 6.0;
}

static PetscErrorCode global_numbers(const WallShare *share, const Corners *corners, PetscInt *numbers)
{
  PetscFunctionBeginUser;
  for (PetscInt k = 0; k < corners->n; k++) {
    PetscInt number;
    PetscCall(PetscSectionGetOffset(share->section, corners->point[k], &number));
    numbers[k] = number < 0 ? -(number + 1) : number;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode note_points(WallShare *share, const Corners *corners)
{
  PetscFunctionBeginUser;
  PetscCall(PetscArraycpy(share->local + share->n_local, corners->point, corners->n));
  share->n_local += corners->n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A boundary face looks away from the one cell behind it. */
static PetscErrorCode add_triangle(WallShare *share, PetscInt face, PetscInt patch)
{
  Corners triangle, cell;
  const PetscInt *support;
  PetscReal centre[3] = {0, 0, 0};

  PetscFunctionBeginUser;
  PetscCall(DMPlexGetSupport(share->dm, face, &support));
  PetscCall(get_corners(share->dm, face, &triangle));
  PetscCall(get_corners(share->dm, support[0], &cell));
  for (PetscInt k = 0; k < cell.n; k++)
    for (int d = 0; d < 3; d++) centre[d] += cell.x[k][d] / (PetscReal)cell.n;
  if (signed_volume(&triangle, centre) > 0.0) swap_corners(&triangle, 1, 2);
  PetscCall(global_numbers(share, &triangle, share->triangle + 4 * share->n_triangles));
  share->triangle[4 * share->n_triangles + 3] = patch;
  for (int k = 0; k < 3; k++)
    PetscCall(PetscArraycpy(share->corners + 9 * share->n_triangles + 3 * k, triangle.x[k], 3));
  share->n_triangles++;
  PetscCall(note_points(share, &triangle));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode list_triangles(const MouldMesh *mesh, WallShare *share)
{
  DMLabel label;
  PetscInt first, last;

  PetscFunctionBeginUser;
  PetscCall(DMGetLabel(share->dm, "patch", &label));
  PetscCall(DMPlexGetHeightStratum(share->dm, 1, &first, &last));
  for (PetscInt l = 0; l < mesh->n_patches; l++) {
    IS faces;
    PetscInt n = 0;
    const PetscInt *face;
    PetscCall(DMLabelGetStratumIS(label, l, &faces));
    if (!faces) continue; // no part of this patch is here
    PetscCall(ISGetLocalSize(faces, &n));
    PetscCall(ISGetIndices(faces, &face));
    for (PetscInt i = 0; i < n; i++)
      if (face[i] >= first && face[i] < last) PetscCall(add_triangle(share, face[i], l));
    PetscCall(ISRestoreIndices(faces, &face));
    PetscCall(ISDestroy(&faces));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The cavity's triangles of all ranks, on every rank: a surface, small beside the mesh. */
static PetscErrorCode gather_cavity(const MouldMesh *mesh, const WallShare *share, TriangleTree **tree)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)share->dm);
  PetscMPIInt n = 0, size, *counts, *starts, total = 0;
  PetscReal *own, *all;
  CastError err = {CAST_OK, ""};

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc3((size_t)(9 * share->n_triangles), &own, (size_t)size, &counts, (size_t)size, &starts));
  for (PetscInt t = 0; t < share->n_triangles; t++) {
    if (share->triangle[4 * t + 3] >= mesh->n_cavity) continue;
    PetscCall(PetscArraycpy(own + n, share->corners + 9 * t, 9));
    n += 9;
  }
  PetscCallMPI(MPI_Allgather(&n, 1, MPI_INT, counts, 1, MPI_INT, comm));
  for (PetscMPIInt k = 0; k < size; k++) {
    starts[k] = total;
    total += counts[k];
  }
  PetscCall(PetscMalloc1((size_t)total, &all));
  PetscCallMPI(MPI_Allgatherv(own, n, MPIU_REAL, all, counts, starts, MPIU_REAL, comm));
  const CastStatus status = triangle_tree_create((size_t)total / 9, all, NULL, 1.0, tree, &err);
  PetscCall(PetscFree(all));
  PetscCall(PetscFree3(own, counts, starts));
  PetscCall(collective_check(comm, status, &err));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode add_tetrahedron(WallShare *share, Corners *cell)
{
  PetscFunctionBeginUser;
  if (signed_volume(cell, cell->x[3]) < 0.0) swap_corners(cell, 2, 3);
  PetscCall(global_numbers(share, cell, share->tetrahedron + 4 * share->n_tetrahedra++));
  PetscCall(note_points(share, cell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Does any point of the tetrahedron lie within `band` of the wall? The distance changes by at most as much as the
 * place: no point is nearer than the centroid's distance less the radius about it. Where that leaves it open the
 * longest edge is halved, up to DEPTH times; what is then still open counts as near, so that nothing is missed. */
static bool reaches_band(const TriangleTree *tree, PetscReal x[4][3], PetscReal band, int depth)
{
  static const int edges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  PetscReal centre[3], radius = 0.0, longest = -1.0, half[4][3];
  int edge = 0;
  for (int d = 0; d < 3; d++) centre[d] = 0.25 * (x[0][d] + x[1][d] + x[2][d] + x[3][d]);
  for (int k = 0; k < 4; k++) radius = PetscMax(radius, vec_distance(centre, x[k]));
  const PetscReal distance = triangle_tree_query(tree, centre, band + radius);
  if (distance >= band + radius) return false;
  if (distance <= band || depth == 0) return true;
  for (int e = 0; e < 6; e++) {
    const PetscReal length = vec_distance(x[edges[e][0]], x[edges[e][1]]);
    if (length <= longest) continue;
    longest = length;
    edge = e;
  }
  for (int side = 0; side < 2; side++) {
    for (int k = 0; k < 4; k++)
      for (int d = 0; d < 3; d++) half[k][d] = x[k][d];
    for (int d = 0; d < 3; d++) half[edges[edge][side]][d] = 0.5 * (x[edges[edge][0]][d] + x[edges[edge][1]][d]);
    if (reaches_band(tree, half, band, depth - 1)) return true;
  }
  return false;
}

static PetscErrorCode list_tetrahedra(WallShare *share, const TriangleTree *tree, PetscReal band)
{
  enum { DEPTH = 12 }; // halvings: edges of a sixteenth
  PetscInt first, last;

  PetscFunctionBeginUser;
  PetscCall(DMPlexGetHeightStratum(share->dm, 0, &first, &last));
  for (PetscInt c = first; c < last; c++) {
    Corners cell;
    PetscCall(get_corners(share->dm, c, &cell));
    if (reaches_band(tree, cell.x, band, DEPTH)) PetscCall(add_tetrahedron(share, &cell));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode wall_share_create(const MouldMesh *mesh, PetscReal band, WallShare *share)
{
  PetscInt first_face, last_face, first_cell, last_cell;
  TriangleTree *tree = NULL;

  PetscFunctionBeginUser;
  *share = (WallShare){.dm = mesh->dm};
  PetscCall(DMGetGlobalSection(mesh->dm, &share->section));
  PetscCall(DMPlexGetHeightStratum(mesh->dm, 1, &first_face, &last_face));
  PetscCall(DMPlexGetHeightStratum(mesh->dm, 0, &first_cell, &last_cell));
  const size_t faces = (size_t)(last_face - first_face), cells = (size_t)(last_cell - first_cell);
  PetscCall(PetscMalloc4(4 * faces, &share->triangle, 9 * faces, &share->corners, 4 * cells, &share->tetrahedron,
                         3 * faces + 4 * cells, &share->local));
  PetscCall(list_triangles(mesh, share));
  PetscCall(gather_cavity(mesh, share, &tree));
  PetscCall(list_tetrahedra(share, tree, band));
  triangle_tree_destroy(&tree);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode wall_share_destroy(WallShare *share)
{
  PetscFunctionBeginUser;
  PetscCall(PetscFree4(share->triangle, share->corners, share->tetrahedron, share->local));
  PetscFunctionReturn(PETSC_SUCCESS);
}
