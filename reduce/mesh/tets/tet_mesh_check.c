/* tet_mesh_check.c - is this a mould? Every face of every tetrahedron and every triangle of the mesher is put in one
 * list and sorted by its points: what meets at a face then stands side by side. */
#include "reduce/mesh/tets/tet_mesh.h"

#include <stdlib.h>
#include <string.h>

#include "common/vector.h"
#include "reduce/mesh/surface/union_find.h"
#include "reduce/mesh/tets/faults.h"

typedef struct Face {
  int32_t point[3]; // ascending
  int32_t element;  // tetrahedron, or triangle
  int8_t side;      // of the tetrahedron, 0..3; -1: a triangle
} Face;

typedef struct Checker {
  TetMesh *mesh;
  const ReduceConfig *config;
  Faults faults;
  Face *face;
  size_t n_faces;
  int32_t *parent;    // [n_tets] union-find: which tetrahedra hang together
  int32_t *boundary;  // [n_triangles] tetrahedron behind each boundary triangle + 1; 0: not on the boundary
  int8_t *side;       // [n_triangles] its side there
  size_t *of_surface; // [surfaces] boundary triangles of each
} Checker;

/* Faces wound outwards for a tetrahedron of positive volume. */
static const int SIDES[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

static void centre_of(const TetMesh *mesh, const int32_t *points, int n, double mm[3])
{
  for (int d = 0; d < 3; d++) {
    mm[d] = 0.0;
    for (int k = 0; k < n; k++) mm[d] += 1e3 * mesh->x[3 * (size_t)points[k] + (size_t)d] / n;
  }
}

static int by_points(const void *left, const void *right)
{
  const Face *a = left, *b = right;
  for (int k = 0; k < 3; k++)
    if (a->point[k] != b->point[k]) return a->point[k] < b->point[k] ? -1 : 1;
  if (a->side != b->side) return a->side < b->side ? -1 : 1; // triangles first
  return (a->element > b->element) - (a->element < b->element);
}

static void list_faces(Checker *checker)
{
  const TetMesh *mesh = checker->mesh;
  Face *face = checker->face;
  for (size_t t = 0; t < mesh->n_tets; t++)
    for (int8_t side = 0; side < 4; side++, face++) {
      for (int k = 0; k < 3; k++) face->point[k] = mesh->tet[4 * t + (size_t)SIDES[side][k]];
      face->element = (int32_t)t;
      face->side = side;
      tet_mesh_sort_corners(face->point);
    }
  for (size_t t = 0; t < mesh->n_triangles; t++, face++) {
    memcpy(face->point, mesh->triangle + 3 * t, sizeof face->point);
    face->element = (int32_t)t;
    face->side = -1;
    tet_mesh_sort_corners(face->point);
  }
  qsort(checker->face, checker->n_faces, sizeof *checker->face, by_points);
}

static const char *surface_name(const Checker *checker, int32_t triangle)
{
  return reduce_config_surface_name(checker->config, (size_t)checker->mesh->triangle_surface[triangle]);
}

static void check_boundary_face(Checker *checker, const Face *triangle, size_t n_triangles, const Face *tet)
{
  const TetMesh *mesh = checker->mesh;
  double at[3];
  centre_of(mesh, tet->point, 3, at);
  if (n_triangles == 0) {
    faults_add(&checker->faults,
               "the boundary face of tetrahedron %zu (region '%s') at (%.6g, %.6g, %.6g) mm has no "
               "triangle in the mesh, hence no name",
               mesh->tet_tag[tet->element], checker->config->region[mesh->tet_region[tet->element]].name, at[0], at[1],
               at[2]);
    return;
  }
  if (mesh->triangle_surface[triangle->element] < 0) {
    faults_add(&checker->faults,
               "the boundary triangle at (%.6g, %.6g, %.6g) mm, of the geometry's surface %d, belongs "
               "to no boundary and to no cavity surface of the input",
               at[0], at[1], at[2], mesh->triangle_entity[triangle->element]);
    return;
  }
  checker->boundary[triangle->element] = tet->element + 1;
  checker->side[triangle->element] = tet->side;
  checker->of_surface[mesh->triangle_surface[triangle->element]]++;
}

/* All that meets at one face: first[0 .. n_triangles) are triangles, then n_tets sides of tetrahedra. */
static void check_face(Checker *checker, const Face *first, size_t n_triangles, size_t n_tets)
{
  const TetMesh *mesh = checker->mesh;
  double at[3];
  centre_of(mesh, first->point, 3, at);
  if (n_triangles > 1 && mesh->triangle_surface[first[0].element] >= 0 && mesh->triangle_surface[first[1].element] >= 0)
    faults_add(&checker->faults, "the triangle at (%.6g, %.6g, %.6g) mm is there twice, in '%s' and in '%s'", at[0],
               at[1], at[2], surface_name(checker, first[0].element), surface_name(checker, first[1].element));
  if (n_tets > 2)
    faults_add(&checker->faults, "%zu tetrahedra share the face at (%.6g, %.6g, %.6g) mm: they overlap", n_tets, at[0],
               at[1], at[2]);
  if (n_tets >= 2) union_find_join(checker->parent, first[n_triangles].element, first[n_triangles + 1].element);
  if (n_tets == 1)
    check_boundary_face(checker, first, n_triangles, first + n_triangles);
  else if (n_triangles > 0 && mesh->triangle_surface[first->element] >= 0)
    faults_add(&checker->faults, "the triangle at (%.6g, %.6g, %.6g) mm of '%s' %s", at[0], at[1], at[2],
               surface_name(checker, first->element),
               n_tets == 0 ? "bounds no tetrahedron" : "lies inside the mould, between two tetrahedra");
}

static void check_faces(Checker *checker)
{
  for (size_t i = 0, next; i < checker->n_faces; i = next) {
    size_t n_triangles = 0;
    for (next = i; next < checker->n_faces &&
                   memcmp(checker->face[next].point, checker->face[i].point, sizeof checker->face[i].point) == 0;
         next++)
      n_triangles += checker->face[next].side < 0;
    check_face(checker, checker->face + i, n_triangles, next - i - n_triangles);
  }
}

/* Flat elements ruin the conditioning long before their volume vanishes to rounding. */
static void check_tets(Checker *checker)
{
  static const double FLAT = 1e-5;
  const TetMesh *mesh = checker->mesh;
  for (size_t t = 0; t < mesh->n_tets; t++) {
    const int32_t *tet = mesh->tet + 4 * t;
    const double volume = tet_mesh_tet_volume(mesh, tet);
    double at[3];
    centre_of(mesh, tet, 4, at);
    if (mesh->tet_region[t] < 0)
      faults_add(&checker->faults, "tetrahedron %zu at (%.6g, %.6g, %.6g) mm is in no region: it has no material",
                 mesh->tet_tag[t], at[0], at[1], at[2]);
    else if (!(volume > 0.0) || tet_mesh_tet_quality(mesh, tet) < FLAT)
      faults_add(&checker->faults,
                 "tetrahedron %zu of region '%s' at (%.6g, %.6g, %.6g) mm is %s: its volume is %.3g mm3",
                 mesh->tet_tag[t], checker->config->region[mesh->tet_region[t]].name, at[0], at[1], at[2],
                 volume < 0.0 ? "inverted" : "flat", volume * 1e9);
  }
}

static void check_connected(Checker *checker)
{
  const TetMesh *mesh = checker->mesh;
  for (size_t t = 1; t < mesh->n_tets; t++) {
    if (union_find_root(checker->parent, (int32_t)t) == 0) continue;
    double here[3], there[3];
    centre_of(mesh, mesh->tet, 4, here);
    centre_of(mesh, mesh->tet + 4 * t, 4, there);
    faults_add(&checker->faults,
               "the mould is not one piece: no face joins the part at (%.6g, %.6g, %.6g) mm (region '%s') "
               "to the part at (%.6g, %.6g, %.6g) mm (region '%s'); touching volumes must share their surface "
               "(BooleanFragments or Coherence in gmsh)",
               here[0], here[1], here[2], checker->config->region[mesh->tet_region[0]].name, there[0], there[1],
               there[2], checker->config->region[mesh->tet_region[t]].name);
    return;
  }
}

typedef struct Edge {
  int32_t low, high, triangle;
} Edge;

static int by_ends(const void *left, const void *right)
{
  const Edge *a = left, *b = right;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  if (a->high != b->high) return a->high < b->high ? -1 : 1;
  return (a->triangle > b->triangle) - (a->triangle < b->triangle);
}

/* Surfaces of the n triangles at an edge, each name once: "'cup' and 'hull'". */
static void name_surfaces(const Checker *checker, const Edge *edge, size_t n, char *text, size_t size)
{
  text[0] = '\0';
  for (size_t i = 0; i < n; i++) {
    char name[NAME_LENGTH + 8];
    if (checker->mesh->triangle_surface[edge[i].triangle] < 0) continue; // which is a fault of its own
    snprintf(name, sizeof name, "'%s'", surface_name(checker, edge[i].triangle));
    if (strstr(text, name) || strlen(text) + strlen(name) + 6 > size) continue;
    if (text[0]) strcat(text, " and ");
    strcat(text, name);
  }
}

/* A boundary edge belongs to two triangles; at one with four the cavity touches itself or the outside, and inside and
 * outside cannot be told apart there. */
static CastStatus check_edges(Checker *checker, CastError *err)
{
  const TetMesh *mesh = checker->mesh;
  const size_t n = 3 * mesh->n_triangles;
  Edge *edges = malloc((n + 1) * sizeof *edges);
  CAST_CHECK(edges, err, CAST_ERR_MEMORY, "no memory to check the mesh");
  for (size_t i = 0; i < n; i++) {
    const int32_t a = mesh->triangle[i], b = mesh->triangle[i - i % 3 + (i + 1) % 3];
    edges[i] = (Edge){a < b ? a : b, a < b ? b : a, (int32_t)(i / 3)};
  }
  qsort(edges, n, sizeof *edges, by_ends);
  for (size_t i = 0, next; i < n; i = next) {
    for (next = i + 1; next < n && edges[next].low == edges[i].low && edges[next].high == edges[i].high;) next++;
    if (next - i == 2) continue;
    double at[3];
    char names[4 * NAME_LENGTH];
    centre_of(mesh, &edges[i].low, 1, at);
    name_surfaces(checker, &edges[i], next - i, names, sizeof names);
    faults_add(&checker->faults,
               "the boundary touches itself at (%.6g, %.6g, %.6g) mm: %zu triangles share an edge there, of %s", at[0],
               at[1], at[2], next - i, names);
  }
  free(edges);
  return CAST_OK;
}

/* Of the triangles keep the boundary's, each wound as its side of the tetrahedron. */
static CastStatus keep_boundary(Checker *checker, CastError *err)
{
  TetMesh *mesh = checker->mesh;
  size_t n = 0;
  mesh->triangle_tet = malloc((mesh->n_triangles + 1) * sizeof *mesh->triangle_tet);
  CAST_CHECK(mesh->triangle_tet, err, CAST_ERR_MEMORY, "no memory to check the mesh");
  for (size_t t = 0; t < mesh->n_triangles; t++) {
    if (checker->boundary[t] == 0) continue;
    const int32_t tet = checker->boundary[t] - 1;
    for (int k = 0; k < 3; k++) mesh->triangle[3 * n + (size_t)k] = mesh->tet[4 * tet + SIDES[checker->side[t]][k]];
    mesh->triangle_surface[n] = mesh->triangle_surface[t];
    mesh->triangle_entity[n] = mesh->triangle_entity[t];
    mesh->triangle_tet[n++] = tet;
  }
  mesh->n_triangles = n;
  return CAST_OK;
}

static CastStatus check(Checker *checker, const char *heading, CastError *err)
{
  const ReduceConfig *config = checker->config;
  check_tets(checker);
  CAST_CALL(faults_finish(&checker->faults, heading)); // what follows needs regions and orientation
  list_faces(checker);
  check_faces(checker);
  check_connected(checker);
  for (size_t s = 0; s < config->n_cavity + config->n_boundaries; s++)
    if (checker->of_surface[s] == 0)
      faults_add(&checker->faults, "%s '%s' has no triangle on the mould's boundary",
                 s < config->n_cavity ? "cavity surface" : "boundary", reduce_config_surface_name(config, s));
  CAST_CALL(faults_finish(&checker->faults, heading));
  CAST_CALL(keep_boundary(checker, err));
  CAST_CALL(check_edges(checker, err));
  return faults_finish(&checker->faults, heading);
}

CastStatus tet_mesh_check(TetMesh *mesh, const ReduceConfig *config, CastError *err)
{
  char heading[512];
  snprintf(heading, sizeof heading, "mesh of '%.300s'", config->geometry_path);
  CAST_CHECK(mesh->n_tets > 0, err, CAST_ERR_INPUT, "%s has no tetrahedra", heading);
  Checker checker = {.mesh = mesh, .config = config, .faults = {err, 0}};
  checker.n_faces = 4 * mesh->n_tets + mesh->n_triangles;
  checker.face = calloc(checker.n_faces, sizeof *checker.face);
  checker.parent = malloc(mesh->n_tets * sizeof *checker.parent);
  checker.boundary = calloc(mesh->n_triangles + 1, sizeof *checker.boundary);
  checker.side = calloc(mesh->n_triangles + 1, sizeof *checker.side);
  checker.of_surface = calloc(config->n_cavity + config->n_boundaries + 1, sizeof *checker.of_surface);
  CastStatus status = CAST_ERR_MEMORY;
  if (checker.face && checker.parent && checker.boundary && checker.side && checker.of_surface) {
    for (size_t t = 0; t < mesh->n_tets; t++) checker.parent[t] = (int32_t)t;
    status = check(&checker, heading, err);
  } else {
    cast_error_set(err, CAST_ERR_MEMORY, "no memory to check the mesh");
  }
  free(checker.face);
  free(checker.parent);
  free(checker.boundary);
  free(checker.side);
  free(checker.of_surface);
  return status;
}
