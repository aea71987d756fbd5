/* mould_geometry_generate.c - tetrahedra from a geometry, with sizes graded away from the cavity wall:
 *   size(x) = min(outside_size, min over cavity surfaces s (mesh_size_s + growth * distance to s))
 * Distances need the cavity's surface, so gmsh meshes the surfaces twice: first each cavity surface at its own size,
 * then everything by the distance to the triangles of the first pass. */
#include "reduce/mesh/geometry/mould_geometry_private.h"

#include <float.h>
#include <gmshc.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "reduce/mesh/geometry/gmsh_session.h"
#include "reduce/mesh/surface/triangle_tree.h"

enum { TRIANGLE = 2 }; // gmsh's number for a triangle of three nodes

typedef struct EntitySizes { // first pass: the size at each point, curve and surface, by tag
  int n[3];
  double *size[3]; // [n] in the geometry's unit
  double outside;
} EntitySizes;

typedef struct WallTriangles {
  size_t n, capacity;
  double *corners, *size; // [n*9], [n] in the geometry's unit
} WallTriangles;

typedef struct GradedSize { // second pass
  const TriangleTree *tree;
  double outside;
} GradedSize;

#if GMSH_API_VERSION_MAJOR > 4 || (GMSH_API_VERSION_MAJOR == 4 && GMSH_API_VERSION_MINOR >= 9)
#define SIZE_CALLBACK(name) static double name(int dim, int tag, double x, double y, double z, double lc, void *data)
#define UNUSED_LC (void)lc
#else
#define SIZE_CALLBACK(name) static double name(int dim, int tag, double x, double y, double z, void *data)
#define UNUSED_LC (void)0
#endif

SIZE_CALLBACK(size_by_entity)
{
  const EntitySizes *sizes = data;
  UNUSED_LC;
  (void)x, (void)y, (void)z;
  return dim < 3 && tag >= 0 && tag < sizes->n[dim] ? sizes->size[dim][tag] : sizes->outside;
}

SIZE_CALLBACK(size_by_distance)
{
  const GradedSize *graded = data;
  const double at[3] = {x, y, z};
  UNUSED_LC;
  (void)dim, (void)tag;
  return triangle_tree_query(graded->tree, at, graded->outside);
}

/* --- first pass --- */

static CastStatus allocate_sizes(EntitySizes *sizes, int dimension, CastError *err)
{
  int *pairs = NULL, ierr;
  size_t n = 0;
  gmshModelGetEntities(&pairs, &n, dimension, &ierr);
  for (size_t i = 0; i + 1 < n; i += 2)
    if (pairs[i + 1] >= sizes->n[dimension]) sizes->n[dimension] = pairs[i + 1] + 1;
  gmshFree(pairs);
  sizes->size[dimension] = malloc(((size_t)sizes->n[dimension] + 1) * sizeof(double));
  CAST_CHECK(sizes->size[dimension], err, CAST_ERR_MEMORY, "no memory for the mesh sizes");
  for (int i = 0; i < sizes->n[dimension]; i++) sizes->size[dimension][i] = sizes->outside;
  return CAST_OK;
}

/* A surface's size holds on its curves and their end points, where the finest of those that meet wins. */
static void spread_size(EntitySizes *sizes, int surface, double size)
{
  int pair[2] = {2, surface}, ierr;
  sizes->size[2][surface] = size;
  for (int recursive = 0; recursive <= 1; recursive++) {
    int *pairs = NULL;
    size_t n = 0;
    gmshModelGetBoundary(pair, 2, &pairs, &n, 0, 0, recursive, &ierr);
    for (size_t i = 0; ierr == 0 && i + 1 < n; i += 2) {
      const int dimension = pairs[i], tag = abs(pairs[i + 1]);
      if (dimension <= 1 && tag < sizes->n[dimension])
        sizes->size[dimension][tag] = fmin(sizes->size[dimension][tag], size);
    }
    gmshFree(pairs);
  }
}

static CastStatus fill_sizes(const MouldGeometry *geometry, EntitySizes *sizes, CastError *err)
{
  const ReduceConfig *config = geometry->config;
  for (int dimension = 0; dimension < 3; dimension++) CAST_CALL(allocate_sizes(sizes, dimension, err));
  for (size_t i = 0; i < geometry->n_surfaces; i++) {
    const GeometryEntity *surface = &geometry->surface[i];
    if (surface->name >= 0 && (size_t)surface->name < config->n_cavity)
      spread_size(sizes, surface->tag, config->cavity[surface->name].mesh_size / config->geometry_unit);
  }
  return gmsh_session_check(0, "mesh sizes", err);
}

static CastStatus reserve(WallTriangles *wall, size_t n, CastError *err)
{
  if (wall->n + n <= wall->capacity) return CAST_OK;
  const size_t capacity = 2 * (wall->n + n);
  double *corners = realloc(wall->corners, 9 * capacity * sizeof *corners);
  if (corners) wall->corners = corners;
  double *size = realloc(wall->size, capacity * sizeof *size);
  if (size) wall->size = size;
  CAST_CHECK(corners && size, err, CAST_ERR_MEMORY, "no memory for the cavity's surface");
  wall->capacity = capacity;
  return CAST_OK;
}

static CastStatus collect_surface(int tag, double size, WallTriangles *wall, CastError *err)
{
  double *x = NULL, *parametric = NULL;
  size_t *tags = NULL, n_tags = 0, n_x = 0, n_parametric = 0;
  int ierr;
  // corner coordinates, triangle by triangle
  gmshModelMeshGetNodesByElementType(TRIANGLE, &tags, &n_tags, &x, &n_x, &parametric, &n_parametric, tag, 0, &ierr);
  CastStatus status = gmsh_session_check(ierr, "reading the cavity's surface", err);
  const size_t n = n_x / 9;
  if (status == CAST_OK) status = reserve(wall, n, err);
  if (status == CAST_OK && n > 0) {
    memcpy(wall->corners + 9 * wall->n, x, 9 * n * sizeof *x);
    for (size_t i = 0; i < n; i++) wall->size[wall->n + i] = size;
    wall->n += n;
  }
  gmshFree(tags);
  gmshFree(x);
  gmshFree(parametric);
  return status;
}

static CastStatus collect_cavity(const MouldGeometry *geometry, WallTriangles *wall, CastError *err)
{
  const ReduceConfig *config = geometry->config;
  for (size_t i = 0; i < geometry->n_surfaces; i++) {
    const GeometryEntity *surface = &geometry->surface[i];
    if (surface->name < 0 || (size_t)surface->name >= config->n_cavity) continue;
    CAST_CALL(
        collect_surface(surface->tag, config->cavity[surface->name].mesh_size / config->geometry_unit, wall, err));
  }
  CAST_CHECK(wall->n > 0, err, CAST_ERR_INPUT, "the cavity's surfaces have no area");
  return CAST_OK;
}

static CastStatus mesh_cavity(const MouldGeometry *geometry, EntitySizes *sizes, WallTriangles *wall, CastError *err)
{
  int ierr;
  CAST_CALL(fill_sizes(geometry, sizes, err));
  gmshModelMeshSetSizeCallback(size_by_entity, sizes, &ierr);
  gmshModelMeshGenerate(2, &ierr);
  CAST_CALL(gmsh_session_check(ierr, "meshing the cavity's surface", err));
  CAST_CALL(collect_cavity(geometry, wall, err));
  gmshModelMeshClear(NULL, 0, &ierr);
  return gmsh_session_check(ierr, "meshing the cavity's surface", err);
}

/* --- second pass --- */

static CastStatus mesh_volumes(const MouldGeometry *geometry, const WallTriangles *wall, CastError *err)
{
  TriangleTree *tree = NULL;
  int ierr;
  CAST_CALL(triangle_tree_create(wall->n, wall->corners, wall->size, geometry->config->growth, &tree, err));
  GradedSize graded = {tree, geometry->config->outside_size / geometry->config->geometry_unit};
  gmshModelMeshSetSizeCallback(size_by_distance, &graded, &ierr);
  gmshModelMeshGenerate(3, &ierr);
  const CastStatus status = gmsh_session_check(ierr, "meshing the mould", err);
  gmshModelMeshRemoveSizeCallback(&ierr);
  triangle_tree_destroy(&tree);
  return status;
}

/* Sizes come from the callback alone, whatever the file asks for; the rest are gmsh's defaults, set again because a
 * .geo file may change them. */
static void set_options(void)
{
  static const struct {
    const char *name;
    double value;
  } options[] = {{"Mesh.MeshSizeExtendFromBoundary", 0},
                 {"Mesh.MeshSizeFromPoints", 0},
                 {"Mesh.MeshSizeFromCurvature", 0},
                 {"Mesh.MeshSizeFactor", 1},
                 {"Mesh.MeshSizeMin", 0},
                 {"Mesh.MeshSizeMax", 1e22},
                 {"Mesh.ElementOrder", 1},
                 {"Mesh.RecombineAll", 0},
                 {"Mesh.Algorithm", 6},
                 {"Mesh.Algorithm3D", 1},
                 {"Mesh.Optimize", 1},
                 {"Mesh.OptimizeThreshold", 0.3}};
  int ierr;
  for (size_t i = 0; i < sizeof options / sizeof *options; i++)
    gmshOptionSetNumber(options[i].name, options[i].value, &ierr);
}

CastStatus mould_geometry_generate(const MouldGeometry *geometry, CastError *err)
{
  EntitySizes sizes = {.outside = geometry->config->outside_size / geometry->config->geometry_unit};
  WallTriangles wall = {0};
  int ierr;
  set_options();
  const bool ready = geometry->config->geometry_kind == GEOMETRY_STL; // its surfaces are meshed
  if (!ready) gmshModelMeshClear(NULL, 0, &ierr);                     // of a .geo file that meshes itself
  CastStatus status = gmsh_session_check(0, "mesh options", err);
  if (status == CAST_OK)
    status = ready ? collect_cavity(geometry, &wall, err) : mesh_cavity(geometry, &sizes, &wall, err);
  if (status == CAST_OK) status = mesh_volumes(geometry, &wall, err);
  for (int dimension = 0; dimension < 3; dimension++) free(sizes.size[dimension]);
  free(wall.corners);
  free(wall.size);
  return status;
}
