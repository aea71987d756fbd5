#include "reduce/mesh/geometry/mould_geometry_private.h"

#include <gmshc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "reduce/mesh/geometry/gmsh_session.h"

/* OpenCASCADE's boxes are larger than what is in them by 1e-7 units: not shown. */
void mould_geometry_place(const MouldGeometry *geometry, const GeometryEntity *entity, char *text, size_t size)
{
  double mm[6];
  for (int d = 0; d < 6; d++) mm[d] = round(entity->box[d] * 1e5) * 1e-5 * geometry->config->geometry_unit * 1e3 + 0.0;
  snprintf(text, size, "(%.4g, %.4g, %.4g) to (%.4g, %.4g, %.4g) mm", mm[0], mm[1], mm[2], mm[3], mm[4], mm[5]);
}

/* OpenCASCADE prints to the terminal when a STEP file is none: look at its first line before it does. */
static CastStatus check_step_header(const char *path, CastError *err)
{
  static const char header[] = "ISO-10303-21";
  char line[sizeof header] = "";
  FILE *file = fopen(path, "r");
  CAST_CHECK(file, err, CAST_ERR_IO, "'%s' cannot be opened", path);
  const bool good = fgets(line, sizeof line, file) && strcmp(line, header) == 0;
  fclose(file);
  CAST_CHECK(good, err, CAST_ERR_INPUT, "geometry '%s': not a STEP file, it does not begin with %s", path, header);
  return CAST_OK;
}

/* The solids of a STEP file are closed each by itself: where two touch, both have the surface. Make it one. */
static CastStatus join_solids(CastError *err)
{
  int *pairs = NULL, ierr;
  size_t n = 0;
  gmshModelGetEntities(&pairs, &n, 3, &ierr);
  gmshFree(pairs);
  if (n <= 2) return CAST_OK; // pairs of dimension and tag: one solid
  gmshModelOccRemoveAllDuplicates(&ierr);
  if (ierr == 0) gmshModelOccSynchronize(&ierr);
  return gmsh_session_check(ierr, "joining the solids of the STEP file", err);
}

static CastStatus open_file(MouldGeometry *geometry, CastError *err)
{
  const ReduceConfig *config = geometry->config;
  int ierr;
  if (config->geometry_kind == GEOMETRY_STL) return mould_geometry_from_stl(geometry, err);
  char doing[1200];
  snprintf(doing, sizeof doing, "geometry '%.1000s' cannot be read", config->geometry_path);
  if (config->geometry_kind == GEOMETRY_STEP) {
    CAST_CALL(check_step_header(config->geometry_path, err));
    gmshOptionSetString("Geometry.OCCTargetUnit", "MM", &ierr);
  }
  gmshOpen(config->geometry_path, &ierr);
  CAST_CALL(gmsh_session_check(ierr, doing, err));
  return config->geometry_kind == GEOMETRY_STEP ? join_solids(err) : CAST_OK;
}

static int by_tag(const void *left, const void *right)
{
  const GeometryEntity *a = left, *b = right;
  return (a->tag > b->tag) - (a->tag < b->tag);
}

static CastStatus list_entities(int dimension, size_t *n, GeometryEntity **entities, CastError *err)
{
  int *pairs = NULL, ierr;
  size_t n_pairs = 0;
  gmshModelGetEntities(&pairs, &n_pairs, dimension, &ierr);
  CAST_CALL(gmsh_session_check(ierr, "listing the geometry's parts", err));
  *n = n_pairs / 2;
  *entities = calloc(*n + 1, sizeof **entities);
  for (size_t i = 0; *entities && i < *n; i++) {
    GeometryEntity *entity = &(*entities)[i];
    *entity = (GeometryEntity){.tag = pairs[2 * i + 1], .name = NAME_NONE, .volumes = -1};
    double *b = entity->box;
    gmshModelGetBoundingBox(dimension, entity->tag, &b[0], &b[1], &b[2], &b[3], &b[4], &b[5], &ierr);
  }
  gmsh_session_forget(); // a ready mesh need not hold elements of every entity: an empty box, says gmsh
  gmshFree(pairs);
  CAST_CHECK(*entities, err, CAST_ERR_MEMORY, "no memory for the geometry");
  qsort(*entities, *n, sizeof **entities, by_tag);
  return CAST_OK;
}

static void count_volumes(GeometryEntity *surface)
{
  int *up = NULL, *down = NULL, ierr;
  size_t n_up = 0, n_down = 0;
  gmshModelGetAdjacencies(2, surface->tag, &up, &n_up, &down, &n_down, &ierr);
  if (ierr == 0) surface->volumes = (int)n_up;
  gmshFree(up);
  gmshFree(down);
}

static CastStatus build(MouldGeometry *geometry, CastError *err)
{
  const ReduceConfig *config = geometry->config;
  CAST_CALL(open_file(geometry, err));
  CAST_CALL(list_entities(2, &geometry->n_surfaces, &geometry->surface, err));
  CAST_CALL(list_entities(3, &geometry->n_volumes, &geometry->volume, err));
  CAST_CHECK(geometry->n_volumes > 0, err, CAST_ERR_INPUT, "geometry '%s' has no volume", config->geometry_path);
  for (size_t i = 0; config->geometry_kind != GEOMETRY_MESH && i < geometry->n_surfaces; i++)
    count_volumes(&geometry->surface[i]);
  CAST_CALL(gmsh_session_check(0, "listing the geometry's parts", err));
  return mould_geometry_resolve(geometry, err);
}

CastStatus mould_geometry_open(const ReduceConfig *config, MouldGeometry **geometry, CastError *err)
{
  *geometry = NULL;
  MouldGeometry *made = calloc(1, sizeof *made);
  CAST_CHECK(made, err, CAST_ERR_MEMORY, "no memory for the geometry");
  made->config = config;
  CastStatus status = gmsh_session_open(err);
  if (status != CAST_OK) {
    free(made);
    return status;
  }
  status = build(made, err);
  if (status != CAST_OK) mould_geometry_close(&made);
  *geometry = made;
  return status;
}

void mould_geometry_close(MouldGeometry **geometry)
{
  if (!geometry || !*geometry) return;
  gmsh_session_close();
  free((*geometry)->surface);
  free((*geometry)->volume);
  free(*geometry);
  *geometry = NULL;
}

/* gmsh can mesh the wrong side of a discrete surface without a word. */
static CastStatus check_volume(const MouldGeometry *geometry, const TetMesh *mesh, CastError *err)
{
  double volume = 0.0;
  for (size_t t = 0; t < mesh->n_tets; t++) volume += tet_mesh_tet_volume(mesh, mesh->tet + 4 * t);
  CAST_CHECK(geometry->volume_expected == 0.0 || fabs(volume - geometry->volume_expected) <= geometry->volume_slack,
             err, CAST_ERR_INPUT,
             "mesh of '%s': it fills %.6g mm3, but flask less cavity is %.6g mm3: a finer mesh_size may help",
             geometry->config->geometry_path, volume * 1e9, geometry->volume_expected * 1e9);
  return CAST_OK;
}

CastStatus mould_geometry_mesh(const MouldGeometry *geometry, TetMesh **mesh, CastError *err)
{
  *mesh = NULL;
  if (geometry->config->geometry_kind != GEOMETRY_MESH) CAST_CALL(mould_geometry_generate(geometry, err));
  TetMesh *made = NULL;
  CAST_CALL(mould_geometry_extract(geometry, &made, err));
  CastStatus status = tet_mesh_check(made, geometry->config, err);
  if (status == CAST_OK) status = check_volume(geometry, made, err);
  if (status != CAST_OK) tet_mesh_destroy(&made);
  *mesh = made;
  return status;
}
