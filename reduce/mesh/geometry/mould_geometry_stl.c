/* mould_geometry_stl.c - a mould from the STL file of its cavity: the closed surface of flask and cavity meshed
 * anew, as a discrete model in gmsh, split at its edges into surfaces, each in the group of what it is part of. gmsh's
 * own way, by parameters over the file's triangles, fails on the needles that STL files are made of. */
#include "reduce/mesh/geometry/mould_geometry_private.h"

#include <gmshc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "reduce/mesh/geometry/flask.h"
#include "reduce/mesh/geometry/gmsh_session.h"
#include "reduce/mesh/surface/triangle_tree.h"

enum { TRIANGLE = 2 }; // gmsh's number for a triangle of three nodes

/* Face f as the discrete surface f + 1; the node of point i has the tag i + 1. */
static CastStatus put_in(const RemeshSurface *surface, size_t n_faces, const int32_t *face, CastError *err)
{
  size_t n_used = 0, *tag = malloc((surface->n_points + 1) * sizeof *tag);
  size_t *node = malloc((3 * surface->n_triangles + 1) * sizeof *node);
  double *x = malloc((3 * surface->n_points + 1) * sizeof *x);
  bool *used = calloc(surface->n_points + 1, sizeof *used);
  int ierr = 0;
  const bool room = tag && node && x && used;
  for (size_t i = 0; room && i < 3 * surface->n_triangles; i++) used[surface->triangle[i]] = true;
  for (size_t i = 0; room && i < surface->n_points; i++) {
    if (!used[i]) continue;
    tag[n_used] = i + 1;
    memcpy(x + 3 * n_used++, surface->x + 3 * i, 3 * sizeof *x);
  }
  for (size_t f = 0; room && !ierr && f < n_faces; f++) gmshModelAddDiscreteEntity(2, (int)f + 1, NULL, 0, &ierr);
  if (room && !ierr) gmshModelMeshAddNodes(2, 1, tag, n_used, x, 3 * n_used, NULL, 0, &ierr);
  for (size_t f = 0; room && !ierr && f < n_faces; f++) {
    size_t n = 0;
    for (size_t i = 0; i < 3 * surface->n_triangles; i++)
      if (face[i / 3] == (int32_t)f) node[n++] = (size_t)surface->triangle[i] + 1;
    gmshModelMeshAddElementsByType((int)f + 1, TRIANGLE, NULL, 0, node, n, &ierr);
  }
  if (room && !ierr) gmshModelMeshReclassifyNodes(&ierr);
  free(tag);
  free(node);
  free(x);
  free(used);
  CAST_CHECK(room, err, CAST_ERR_MEMORY, "no memory for the geometry");
  return gmsh_session_check(ierr, "the surface of the mould", err);
}

typedef struct Graded { // sizes in the file's unit
  const TriangleTree *tree;
  double outside;
} Graded;

static double graded_size(const void *context, const double x[3])
{
  const Graded *graded = context;
  return triangle_tree_query(graded->tree, x, graded->outside);
}

static const char *name_of(const ReduceConfig *config, const StlSurface *body, int32_t origin)
{
  if (origin < FLASK_SIDES) return FLASK_NAMES[origin];
  if (body->n_solids == 1 && config->n_cavity == 1) return config->cavity[0].name;
  return body->name[origin - FLASK_SIDES];
}

/* The surface of the input that a solid is part of, by its name; the finest mesh size if the names come from elsewhere,
 * from geometry.groups. */
static double mesh_size_of(const ReduceConfig *config, const StlSurface *body, int32_t origin)
{
  double finest = config->outside_size;
  for (size_t s = 0; s < config->n_cavity; s++) {
    if (strcmp(config->cavity[s].name, name_of(config, body, origin)) == 0) return config->cavity[s].mesh_size;
    finest = fmin(finest, config->cavity[s].mesh_size);
  }
  return finest;
}

/* From the file's triangles to ones of the sizes asked for. */
static CastStatus remesh(const ReduceConfig *config, const StlSurface *body, FlaskSurface *flask, CastError *err)
{
  TriangleTree *tree = NULL;
  double *corners = malloc((9 * body->n_triangles + 1) * sizeof *corners);
  double *offset = malloc((body->n_triangles + 1) * sizeof *offset);
  CastStatus status = corners && offset ? CAST_OK : cast_error_set(err, CAST_ERR_MEMORY, "no memory for the geometry");
  for (size_t t = 0; status == CAST_OK && t < body->n_triangles; t++) {
    offset[t] = mesh_size_of(config, body, FLASK_SIDES + body->solid[t]) / config->geometry_unit;
    for (size_t k = 0; k < 3; k++)
      memcpy(corners + 9 * t + 3 * k, body->x + 3 * (size_t)body->triangle[3 * t + k], 3 * sizeof *corners);
  }
  if (status == CAST_OK) status = triangle_tree_create(body->n_triangles, corners, offset, config->growth, &tree, err);
  double outside = config->outside_size; // the cylinder's facets stay: 36 round it, each 0.17 radii
  if (config->flask.kind == FLASK_CYLINDER) outside = fmin(outside, 0.25 * config->flask.radius);
  const Graded graded = {tree, outside / config->geometry_unit};
  const RemeshSize size = {graded_size, &graded};
  if (status == CAST_OK) status = surface_remesh(&flask->surface, config->split_angle, &size, err);
  triangle_tree_destroy(&tree);
  free(corners);
  free(offset);
  return status;
}

/* Groups under the names that the input must use; where it has geometry.groups those name the surfaces instead. */
static CastStatus name_groups(const ReduceConfig *config, const StlSurface *body, size_t n, const int *surface,
                              const int32_t *origins, CastError *err)
{
  int *members = malloc((n + 1) * sizeof *members), ierr = 0, tag;
  CAST_CHECK(members, err, CAST_ERR_MEMORY, "no memory for the geometry");
  for (int32_t origin = 0; origin < FLASK_SIDES + (int32_t)body->n_solids; origin++) {
    size_t count = 0;
    for (size_t i = 0; i < n; i++)
      if (origins[i] == origin) members[count++] = surface[i];
    if (count == 0) continue; // a solid of which nothing is left
    tag = gmshModelAddPhysicalGroup(2, members, count, -1, &ierr);
    const char *name = name_of(config, body, origin);
    if (name[0]) gmshModelSetPhysicalName(2, tag, name, &ierr);
  }
  free(members);
  int volume = 1;
  tag = gmshModelAddPhysicalGroup(3, &volume, 1, -1, &ierr);
  if (config->n_regions > 0) gmshModelSetPhysicalName(3, tag, config->region[0].name, &ierr);
  return gmsh_session_check(ierr, "naming the surfaces of the mould", err);
}

static CastStatus fill_model(const ReduceConfig *config, const StlSurface *body, const RemeshSurface *surface,
                             int32_t *face, int32_t *origins, CastError *err)
{
  size_t n_faces = 0;
  int ierr;
  CAST_CALL(surface_faces(surface, config->split_angle, face, &n_faces, err));
  for (size_t t = 0; t < surface->n_triangles; t++) origins[face[t]] = surface->tag[t];
  CAST_CALL(put_in(surface, n_faces, face, err));
  for (size_t f = 0; f < n_faces; f++) face[f] = (int32_t)f + 1; // no longer needed by triangle: gmsh's tags
  int loop = gmshModelGeoAddSurfaceLoop(face, n_faces, -1, &ierr);
  if (!ierr) gmshModelGeoAddVolume(&loop, 1, 1, &ierr);
  if (!ierr) gmshModelGeoSynchronize(&ierr);
  CAST_CALL(gmsh_session_check(ierr, "the volume of the mould", err));
  return name_groups(config, body, n_faces, face, origins, err);
}

static CastStatus make_model(const ReduceConfig *config, const StlSurface *body, FlaskSurface *flask, CastError *err)
{
  int ierr;
  CAST_CALL(remesh(config, body, flask, err));
  gmshModelAdd("mould", &ierr);
  CAST_CALL(gmsh_session_check(ierr, "the surface of the mould", err));
  int32_t *face = malloc((flask->surface.n_triangles + 1) * sizeof *face);
  int32_t *origins = malloc((flask->surface.n_triangles + 1) * sizeof *origins);
  const CastStatus status = face && origins ? fill_model(config, body, &flask->surface, face, origins, err)
                                            : cast_error_set(err, CAST_ERR_MEMORY, "no memory for the geometry");
  free(face);
  free(origins);
  return status;
}

CastStatus mould_geometry_from_stl(MouldGeometry *geometry, CastError *err)
{
  const ReduceConfig *config = geometry->config;
  StlSurface *body = NULL;
  FlaskSurface *flask = NULL;
  CAST_CALL(stl_read(config->geometry_path, &body, err));
  CastStatus status = stl_check(body, config->geometry_path, config->geometry_unit, err);
  if (status == CAST_OK) status = flask_create(&config->flask, config->geometry_unit, body, &flask, err);
  if (status == CAST_OK) status = make_model(config, body, flask, err);
  if (status == CAST_OK) {
    const double cube = pow(config->geometry_unit, 3);
    geometry->volume_expected = flask->volume * cube;
    geometry->volume_slack = 0.3 * stl_volume(body) * cube; // facets over curved walls
  }
  stl_destroy(&body);
  flask_destroy(&flask);
  return status;
}
