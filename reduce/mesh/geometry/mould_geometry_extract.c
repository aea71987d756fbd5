/* mould_geometry_extract.c - what gmsh holds as a mesh, as plain arrays in metres. */
#include "reduce/mesh/geometry/mould_geometry_private.h"

#include <gmshc.h>
#include <math.h>
#include <stdlib.h>
#include "reduce/mesh/geometry/gmsh_session.h"

enum { TRIANGLE = 2, TETRAHEDRON = 4 }; // gmsh's numbers for first-order elements

typedef struct Node {
  size_t tag;
  int32_t point; // -1: no tetrahedron uses it
  double x[3];
} Node;

typedef struct Elements { // of one type on one entity
  size_t n, *tag, n_node, *node;
} Elements;

typedef struct Extraction {
  const MouldGeometry *geometry;
  size_t n_nodes;
  Node *node; // by ascending tag
  Elements *surface, *volume;
  TetMesh *mesh;
} Extraction;

static int by_tag(const void *left, const void *right)
{
  const Node *a = left, *b = right;
  return (a->tag > b->tag) - (a->tag < b->tag);
}

static CastStatus read_nodes(Extraction *extraction, CastError *err)
{
  size_t *tags = NULL, n_x = 0, n_parametric = 0;
  double *x = NULL, *parametric = NULL;
  int ierr;
  gmshModelMeshGetNodes(&tags, &extraction->n_nodes, &x, &n_x, &parametric, &n_parametric, -1, -1, 0, 0, &ierr);
  CastStatus status = gmsh_session_check(ierr, "reading the mesh's nodes", err);
  extraction->node = calloc(extraction->n_nodes + 1, sizeof *extraction->node);
  if (status == CAST_OK && !extraction->node) status = cast_error_set(err, CAST_ERR_MEMORY, "no memory for the mesh");
  for (size_t i = 0; status == CAST_OK && i < extraction->n_nodes; i++) {
    Node *node = &extraction->node[i];
    *node = (Node){.tag = tags[i], .point = -1};
    for (size_t d = 0; d < 3; d++) node->x[d] = x[3 * i + d] * extraction->geometry->config->geometry_unit;
  }
  if (status == CAST_OK) qsort(extraction->node, extraction->n_nodes, sizeof *extraction->node, by_tag);
  gmshFree(tags);
  gmshFree(x);
  gmshFree(parametric);
  return status;
}

static CastStatus check_types(int dimension, int tag, CastError *err)
{
  int *types = NULL, ierr, foreign = 0;
  size_t n = 0;
  const int expected = dimension == 3 ? TETRAHEDRON : TRIANGLE;
  gmshModelMeshGetElementTypes(&types, &n, dimension, tag, &ierr);
  for (size_t i = 0; i < n; i++)
    if (types[i] != expected) foreign = types[i];
  gmshFree(types);
  if (foreign == 0) return gmsh_session_check(ierr, "reading the mesh's elements", err);
  char *name = NULL;
  int dim, order, n_nodes, n_primary;
  double *local = NULL;
  size_t n_local = 0;
  gmshModelMeshGetElementProperties(foreign, &name, &dim, &order, &n_nodes, &local, &n_local, &n_primary, &ierr);
  cast_error_set(err, CAST_ERR_INPUT, "the mesh has elements of type '%s' in %s %d: first-order %s are expected",
                 name ? name : "unknown", dimension == 3 ? "volume" : "surface", tag,
                 dimension == 3 ? "tetrahedra" : "triangles");
  gmshFree(name);
  gmshFree(local);
  return CAST_ERR_INPUT;
}

static CastStatus read_elements(int dimension, size_t n, const GeometryEntity *entities, Elements **elements,
                                CastError *err)
{
  *elements = calloc(n + 1, sizeof **elements);
  CAST_CHECK(*elements, err, CAST_ERR_MEMORY, "no memory for the mesh");
  for (size_t i = 0; i < n; i++) {
    Elements *read = &(*elements)[i];
    int ierr;
    CAST_CALL(check_types(dimension, entities[i].tag, err));
    gmshModelMeshGetElementsByType(dimension == 3 ? TETRAHEDRON : TRIANGLE, &read->tag, &read->n, &read->node,
                                   &read->n_node, entities[i].tag, 0, 1, &ierr);
    CAST_CALL(gmsh_session_check(ierr, "reading the mesh's elements", err));
  }
  return CAST_OK;
}

static void free_elements(size_t n, Elements **elements)
{
  for (size_t i = 0; *elements && i < n; i++) {
    gmshFree((*elements)[i].tag);
    gmshFree((*elements)[i].node);
  }
  free(*elements);
  *elements = NULL;
}

static Node *find_node(const Extraction *extraction, size_t tag)
{
  const Node key = {.tag = tag};
  return bsearch(&key, extraction->node, extraction->n_nodes, sizeof key, by_tag);
}

/* Number the nodes that tetrahedra use, in the order of their tags. */
static CastStatus number_points(Extraction *extraction, size_t *n_points, CastError *err)
{
  for (size_t i = 0; i < extraction->geometry->n_volumes; i++) {
    const Elements *volume = &extraction->volume[i];
    for (size_t k = 0; k < volume->n_node; k++) {
      Node *node = find_node(extraction, volume->node[k]);
      CAST_CHECK(node, err, CAST_ERR_INPUT, "tetrahedron %zu of the mesh uses node %zu, which is not there",
                 volume->tag[k / 4], volume->node[k]);
      node->point = 0;
    }
  }
  *n_points = 0;
  for (size_t i = 0; i < extraction->n_nodes; i++)
    if (extraction->node[i].point == 0) extraction->node[i].point = (int32_t)(*n_points)++;
  return CAST_OK;
}

static void fill_points(const Extraction *extraction)
{
  for (size_t i = 0; i < extraction->n_nodes; i++) {
    const Node *node = &extraction->node[i];
    for (size_t d = 0; node->point >= 0 && d < 3; d++) extraction->mesh->x[3 * (size_t)node->point + d] = node->x[d];
  }
}

/* number_points has found each of these nodes. */
static void fill_tets(const Extraction *extraction)
{
  TetMesh *mesh = extraction->mesh;
  size_t t = 0;
  for (size_t i = 0; i < extraction->geometry->n_volumes; i++) {
    const Elements *volume = &extraction->volume[i];
    for (size_t k = 0; k < volume->n; k++, t++) {
      mesh->tet_region[t] = extraction->geometry->volume[i].name;
      mesh->tet_tag[t] = volume->tag[k];
      for (size_t c = 0; c < 4; c++) {
        const Node *node = find_node(extraction, volume->node[4 * k + c]);
        if (node) mesh->tet[4 * t + c] = node->point;
      }
    }
  }
}

static CastStatus fill_triangles(const Extraction *extraction, CastError *err)
{
  TetMesh *mesh = extraction->mesh;
  size_t t = 0;
  for (size_t i = 0; i < extraction->geometry->n_surfaces; i++) {
    const Elements *surface = &extraction->surface[i];
    const GeometryEntity *entity = &extraction->geometry->surface[i];
    for (size_t k = 0; k < surface->n; k++) {
      bool whole = true;
      for (size_t c = 0; c < 3; c++) {
        const Node *node = find_node(extraction, surface->node[3 * k + c]);
        whole = whole && node && node->point >= 0;
        if (whole) mesh->triangle[3 * t + c] = node->point;
      }
      CAST_CHECK(whole || entity->name == NAME_NONE, err, CAST_ERR_INPUT,
                 "triangle %zu of '%s' has a corner that belongs to no tetrahedron", surface->tag[k],
                 reduce_config_surface_name(extraction->geometry->config, (size_t)entity->name));
      if (!whole) continue;
      mesh->triangle_surface[t] = entity->name;
      mesh->triangle_entity[t++] = entity->tag;
    }
  }
  mesh->n_triangles = t;
  return CAST_OK;
}

static CastStatus extract(Extraction *extraction, CastError *err)
{
  const MouldGeometry *geometry = extraction->geometry;
  size_t n_points = 0, n_tets = 0, n_triangles = 0;
  CAST_CALL(read_nodes(extraction, err));
  CAST_CALL(read_elements(3, geometry->n_volumes, geometry->volume, &extraction->volume, err));
  CAST_CALL(read_elements(2, geometry->n_surfaces, geometry->surface, &extraction->surface, err));
  CAST_CALL(number_points(extraction, &n_points, err));
  for (size_t i = 0; i < geometry->n_volumes; i++) n_tets += extraction->volume[i].n;
  for (size_t i = 0; i < geometry->n_surfaces; i++) n_triangles += extraction->surface[i].n;
  CAST_CALL(tet_mesh_create(n_points, n_tets, n_triangles, &extraction->mesh, err));
  fill_points(extraction);
  fill_tets(extraction);
  return fill_triangles(extraction, err);
}

CastStatus mould_geometry_extract(const MouldGeometry *geometry, TetMesh **mesh, CastError *err)
{
  Extraction extraction = {.geometry = geometry};
  const CastStatus status = extract(&extraction, err);
  if (status != CAST_OK) tet_mesh_destroy(&extraction.mesh);
  *mesh = extraction.mesh;
  free(extraction.node);
  free_elements(geometry->n_volumes, &extraction.volume);
  free_elements(geometry->n_surfaces, &extraction.surface);
  return status;
}
