#include "reduce/mesh/patches/patches.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "common/vector.h"
#include "reduce/mesh/patches/partition.h"

static const double FIXED_BIOT = 1e5; // h L/kappa of a wall of fixed temperature

typedef struct SurfacePart { // the boundary triangles of one named surface
  size_t n;
  int32_t *number;   // [n] in the mesh's boundary
  int32_t *triangle; // [n*3]
  int32_t *entity;   // [n]
  int32_t *part;     // [n]
} SurfacePart;

static void free_part(SurfacePart *part)
{
  free(part->number);
  free(part->triangle);
  free(part->entity);
  free(part->part);
}

static CastStatus pick_surface(const TetMesh *mesh, size_t surface, SurfacePart *part, CastError *err)
{
  const size_t most = mesh->n_triangles + 1;
  part->number = malloc(most * sizeof *part->number);
  part->triangle = malloc(3 * most * sizeof *part->triangle);
  part->entity = malloc(most * sizeof *part->entity);
  part->part = malloc(most * sizeof *part->part);
  CAST_CHECK(part->number && part->triangle && part->entity && part->part, err, CAST_ERR_MEMORY,
             "no memory for the patches");
  for (size_t t = 0; t < mesh->n_triangles; t++) {
    if ((size_t)mesh->triangle_surface[t] != surface) continue;
    part->number[part->n] = (int32_t)t;
    part->entity[part->n] = mesh->triangle_entity[t];
    memcpy(part->triangle + 3 * part->n++, mesh->triangle + 3 * t, 3 * sizeof(int32_t));
  }
  return CAST_OK;
}

/* Room for `more` patches, zeroed. */
static CastStatus extend(Patches *patches, size_t more, CastError *err)
{
  const size_t n = patches->n + more;
  RomPatch *patch = realloc(patches->patch, n * sizeof *patch);
  if (patch) patches->patch = patch;
  int32_t *count = realloc(patches->triangle_count, n * sizeof *count);
  if (count) patches->triangle_count = count;
  CAST_CHECK(patch && count, err, CAST_ERR_MEMORY, "no memory for the patches");
  memset(patch + patches->n, 0, more * sizeof *patch);
  memset(count + patches->n, 0, more * sizeof *count);
  patches->n = n;
  return CAST_OK;
}

/* Add the parts of a surface as patches "name/1", "name/2", ..; a surface of one part keeps its plain name. */
static CastStatus append(Patches *patches, const char *name, const SurfacePart *part, size_t n_parts, CastError *err)
{
  const size_t first = patches->n;
  CAST_CALL(extend(patches, n_parts, err));
  for (size_t l = 0; l < n_parts; l++) {
    RomPatch *patch = &patches->patch[first + l];
    snprintf(patch->surface, sizeof patch->surface, "%s", name);
    if (n_parts == 1)
      snprintf(patch->name, sizeof patch->name, "%s", name);
    else
      snprintf(patch->name, sizeof patch->name, "%.48s/%u", name, (unsigned)l + 1U);
  }
  for (size_t i = 0; i < part->n; i++) patches->of_triangle[part->number[i]] = (int32_t)first + part->part[i];
  return CAST_OK;
}

static CastStatus cut_surface(const TetMesh *mesh, double patch_size, SurfacePart *part, size_t *n_parts,
                              CastError *err)
{
  SurfaceGraph *graph = NULL;
  CAST_CALL(surface_graph_create(mesh->x, part->n, part->triangle, part->entity, &graph, err));
  const CastStatus status = partition_surface(graph, patch_size * patch_size, part->part, n_parts, err);
  surface_graph_destroy(&graph);
  return status;
}

static CastStatus add_surface(const TetMesh *mesh, const ReduceConfig *config, size_t surface, Patches *patches,
                              CastError *err)
{
  const bool of_cavity = surface < config->n_cavity;
  const double patch_size =
      of_cavity ? config->cavity[surface].patch_size : config->boundary[surface - config->n_cavity].patch_size;
  SurfacePart part = {0};
  size_t n_parts = 1;
  CastStatus status = pick_surface(mesh, surface, &part, err);
  if (status == CAST_OK) {
    memset(part.part, 0, part.n * sizeof *part.part);
    if (of_cavity || patch_size > 0) status = cut_surface(mesh, patch_size, &part, &n_parts, err);
  }
  if (status == CAST_OK) status = append(patches, reduce_config_surface_name(config, surface), &part, n_parts, err);
  free_part(&part);
  return status;
}

static void measure(const TetMesh *mesh, Patches *patches)
{
  for (size_t t = 0; t < mesh->n_triangles; t++) {
    const int32_t *triangle = mesh->triangle + 3 * t;
    RomPatch *patch = &patches->patch[patches->of_triangle[t]];
    double normal[3];
    tet_mesh_triangle_normal(mesh, triangle, normal);
    const double area = 0.5 * vec_norm(normal);
    patches->triangle_count[patches->of_triangle[t]]++;
    patch->area += area;
    for (size_t k = 0; k < 3; k++)
      for (size_t d = 0; d < 3; d++) patch->centroid[d] += area * mesh->x[3 * (size_t)triangle[k] + d] / 3.0;
  }
  for (size_t l = 0; l < patches->n; l++)
    for (int d = 0; d < 3; d++) patches->patch[l].centroid[d] /= patches->patch[l].area;
}

/* Over an element of size L conduction can carry kappa/L: L is outside_size, or in a ready mesh that of the mean
 * element. */
static double fixed_coefficient(const TetMesh *mesh, const ReduceConfig *config)
{
  double kappa = 0.0, volume = 0.0, length = config->outside_size;
  for (size_t i = 0; i < config->n_regions; i++) kappa = fmax(kappa, config->region[i].material.conductivity);
  for (size_t t = 0; t < mesh->n_tets; t++) volume += tet_mesh_tet_volume(mesh, mesh->tet + 4 * t);
  if (config->geometry_kind == GEOMETRY_MESH) length = cbrt(volume / (double)mesh->n_tets);
  return FIXED_BIOT * kappa / length;
}

static void set_walls(const TetMesh *mesh, const ReduceConfig *config, Patches *patches)
{
  size_t i = 0;
  for (size_t l = patches->n_cavity; l < patches->n; l++) {
    RomPatch *patch = &patches->patch[l];
    while (strcmp(config->boundary[i].name, patch->surface) != 0) i++; // patches stand in the order of the surfaces
    patch->outer = true;
    patch->fixed = config->boundary[i].kind == BOUNDARY_FIXED;
    patch->h = patch->fixed ? fixed_coefficient(mesh, config) : config->boundary[i].h;
  }
}

static CastStatus build(const TetMesh *mesh, const ReduceConfig *config, Patches *patches, CastError *err)
{
  patches->of_triangle = malloc((mesh->n_triangles + 1) * sizeof *patches->of_triangle);
  CAST_CHECK(patches->of_triangle, err, CAST_ERR_MEMORY, "no memory for the patches");
  for (size_t s = 0; s < config->n_cavity + config->n_boundaries; s++) {
    if (s == config->n_cavity) patches->n_cavity = patches->n;
    CAST_CALL(add_surface(mesh, config, s, patches, err));
  }
  measure(mesh, patches);
  set_walls(mesh, config, patches);
  return CAST_OK;
}

CastStatus patches_create(const TetMesh *mesh, const ReduceConfig *config, Patches **patches, CastError *err)
{
  *patches = calloc(1, sizeof **patches);
  CAST_CHECK(*patches, err, CAST_ERR_MEMORY, "no memory for the patches");
  const CastStatus status = build(mesh, config, *patches, err);
  if (status != CAST_OK) patches_destroy(patches);
  return status;
}

void patches_destroy(Patches **patches)
{
  if (!patches || !*patches) return;
  free((*patches)->patch);
  free((*patches)->triangle_count);
  free((*patches)->of_triangle);
  free(*patches);
  *patches = NULL;
}
