/* mould_geometry_names.c - which surface and which volume bears which name. */
#include "reduce/mesh/geometry/mould_geometry_private.h"

#include <gmshc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "reduce/mesh/tets/faults.h"

typedef struct Resolver {
  MouldGeometry *geometry;
  Faults faults;
} Resolver;

static size_t count_names(const ReduceConfig *config, int dimension)
{
  return dimension == 3 ? config->n_regions : config->n_cavity + config->n_boundaries;
}

static const char *name_at(const ReduceConfig *config, int dimension, int name)
{
  return dimension == 3 ? config->region[name].name : reduce_config_surface_name(config, (size_t)name);
}

static int find_name(const ReduceConfig *config, int dimension, const char *text)
{
  for (size_t i = 0; i < count_names(config, dimension); i++)
    if (strcmp(name_at(config, dimension, (int)i), text) == 0) return (int)i;
  return NAME_NONE;
}

static GeometryEntity *find_entity(MouldGeometry *geometry, int dimension, int tag)
{
  GeometryEntity *entities = dimension == 3 ? geometry->volume : geometry->surface;
  const size_t n = dimension == 3 ? geometry->n_volumes : geometry->n_surfaces;
  for (size_t i = 0; i < n; i++)
    if (entities[i].tag == tag) return &entities[i];
  return NULL;
}

static const char *kind_of(int dimension)
{
  return dimension == 3 ? "volume" : "surface";
}

static void give_name(Resolver *resolver, int dimension, GeometryEntity *entity, int name)
{
  const ReduceConfig *config = resolver->geometry->config;
  char place[160];
  mould_geometry_place(resolver->geometry, entity, place, sizeof place);
  if (entity->name != NAME_NONE && entity->name != name)
    faults_add(&resolver->faults, "%s %d, %s, is in two groups, '%s' and '%s': one name is expected",
               kind_of(dimension), entity->tag, place, name_at(config, dimension, entity->name),
               name_at(config, dimension, name));
  entity->name = name;
}

/* --- names from geometry.groups --- */

static bool lies_within(const GeometryEntity *entity, const double box[6], double unit)
{
  double size = 0.0;
  for (int d = 0; d < 3; d++) size = fmax(size, (entity->box[d + 3] - entity->box[d]) * unit);
  const double slack = 1e-4 * size + 1e-6 * unit; // OpenCASCADE's boxes are a little larger than what is in them
  for (int d = 0; d < 3; d++)
    if (entity->box[d] * unit < box[d] - slack || entity->box[d + 3] * unit > box[d + 3] + slack) return false;
  return true;
}

static void resolve_group(Resolver *resolver, const GroupConfig *group)
{
  MouldGeometry *geometry = resolver->geometry;
  const int name = find_name(geometry->config, group->dimension, group->name);
  GeometryEntity *entities = group->dimension == 3 ? geometry->volume : geometry->surface;
  const size_t n = group->dimension == 3 ? geometry->n_volumes : geometry->n_surfaces;
  for (size_t i = 0; i < group->n_tags; i++) {
    GeometryEntity *entity = find_entity(geometry, group->dimension, group->tags[i]);
    if (entity)
      give_name(resolver, group->dimension, entity, name);
    else
      faults_add(&resolver->faults, "geometry.groups.%s: there is no %s %d; the geometry has %zu, numbered from %d",
                 group->name, kind_of(group->dimension), group->tags[i], n, n > 0 ? entities[0].tag : 0);
  }
  size_t found = 0;
  for (size_t i = 0; group->has_box && i < n; i++)
    if (lies_within(&entities[i], group->box, geometry->config->geometry_unit)) {
      give_name(resolver, group->dimension, &entities[i], name);
      found++;
    }
  if (group->has_box && found == 0)
    faults_add(&resolver->faults, "geometry.groups.%s: no %s lies wholly within the box (%g, %g, %g) to (%g, %g, %g) m",
               group->name, kind_of(group->dimension), group->box[0], group->box[1], group->box[2], group->box[3],
               group->box[4], group->box[5]);
}

static void resolve_rest(Resolver *resolver, const GroupConfig *group)
{
  MouldGeometry *geometry = resolver->geometry;
  GeometryEntity *entities = group->dimension == 3 ? geometry->volume : geometry->surface;
  const size_t n = group->dimension == 3 ? geometry->n_volumes : geometry->n_surfaces;
  const int name = find_name(geometry->config, group->dimension, group->name);
  size_t found = 0;
  for (size_t i = 0; i < n; i++) {
    if (entities[i].name != NAME_NONE || (group->dimension == 2 && entities[i].volumes == 2)) continue;
    entities[i].name = name;
    found++;
  }
  if (found == 0)
    faults_add(&resolver->faults, "geometry.groups.%s: the other groups leave no %s", group->name,
               kind_of(group->dimension));
}

static void resolve_config_groups(Resolver *resolver)
{
  const ReduceConfig *config = resolver->geometry->config;
  for (size_t i = 0; i < config->n_groups; i++) resolve_group(resolver, &config->group[i]);
  for (size_t i = 0; i < config->n_groups; i++)
    if (config->group[i].rest) resolve_rest(resolver, &config->group[i]);
}

/* --- names from the physical groups of the file --- */

static void physical_name(int dimension, int tag, char text[256])
{
  char *name = NULL;
  int ierr;
  gmshModelGetPhysicalName(dimension, tag, &name, &ierr);
  if (name && name[0])
    snprintf(text, 256, "%s", name);
  else
    snprintf(text, 256, "%d", tag);
  gmshFree(name);
}

static void resolve_physical_group(Resolver *resolver, int dimension, int tag, bool *seen)
{
  MouldGeometry *geometry = resolver->geometry;
  char text[256];
  physical_name(dimension, tag, text);
  const int name = find_name(geometry->config, dimension, text);
  if (name == NAME_NONE) {
    if (dimension == 3)
      faults_add(&resolver->faults,
                 "volume group '%s' of the geometry is no region of the input: "
                 "it has no material",
                 text);
    return;
  }
  if (seen[name])
    faults_add(&resolver->faults, "the geometry has two groups of %ss called '%s'", kind_of(dimension), text);
  seen[name] = true;
  int *tags = NULL, ierr;
  size_t n = 0;
  gmshModelGetEntitiesForPhysicalGroup(dimension, tag, &tags, &n, &ierr);
  for (size_t i = 0; i < n; i++) {
    GeometryEntity *entity = find_entity(geometry, dimension, abs(tags[i]));
    if (entity) give_name(resolver, dimension, entity, name);
  }
  gmshFree(tags);
}

static void report_missing(Resolver *resolver, int dimension, const bool *seen, const char *present)
{
  const ReduceConfig *config = resolver->geometry->config;
  for (size_t i = 0; i < count_names(config, dimension); i++)
    if (!seen[i])
      faults_add(&resolver->faults, "%s '%s': the geometry has no physical %s of this name; it has: %s",
                 dimension == 3         ? "region"
                 : i < config->n_cavity ? "cavity surface"
                                        : "boundary",
                 name_at(config, dimension, (int)i), kind_of(dimension), present[0] ? present : "none");
}

static CastStatus resolve_physical_groups(Resolver *resolver, int dimension, CastError *err)
{
  bool *seen = calloc(count_names(resolver->geometry->config, dimension) + 1, sizeof *seen);
  CAST_CHECK(seen, err, CAST_ERR_MEMORY, "no memory for the geometry");
  char present[768] = "";
  int *pairs = NULL, ierr;
  size_t n = 0;
  gmshModelGetPhysicalGroups(&pairs, &n, dimension, &ierr);
  for (size_t i = 0; i + 1 < n; i += 2) {
    char text[256];
    const size_t used = strlen(present);
    physical_name(dimension, pairs[i + 1], text);
    snprintf(present + used, sizeof present - used, "%s%s", used ? ", " : "", text);
    resolve_physical_group(resolver, dimension, pairs[i + 1], seen);
  }
  report_missing(resolver, dimension, seen, present);
  gmshFree(pairs);
  free(seen);
  return CAST_OK;
}

/* --- nothing may be without a name --- */

static void report_unnamed(Resolver *resolver)
{
  MouldGeometry *geometry = resolver->geometry;
  char place[160];
  for (size_t i = 0; i < geometry->n_volumes; i++) {
    if (geometry->volume[i].name != NAME_NONE || geometry->config->geometry_kind == GEOMETRY_MESH) continue;
    mould_geometry_place(geometry, &geometry->volume[i], place, sizeof place);
    faults_add(&resolver->faults, "volume %d, %s, is in no region: it has no material", geometry->volume[i].tag, place);
  }
  for (size_t i = 0; i < geometry->n_surfaces; i++) {
    const GeometryEntity *surface = &geometry->surface[i];
    mould_geometry_place(geometry, surface, place, sizeof place);
    if (surface->name == NAME_NONE && surface->volumes == 1)
      faults_add(&resolver->faults,
                 "surface %d, %s, is part of the mould's boundary, but no boundary and no cavity "
                 "surface of the input holds it",
                 surface->tag, place);
    if (surface->name != NAME_NONE && surface->volumes == 2)
      faults_add(&resolver->faults, "surface %d, %s, of '%s' lies inside the mould, between two volumes", surface->tag,
                 place, name_at(geometry->config, 2, surface->name));
    if (surface->name != NAME_NONE && surface->volumes == 0)
      faults_add(&resolver->faults, "surface %d, %s, of '%s' bounds no volume", surface->tag, place,
                 name_at(geometry->config, 2, surface->name));
  }
}

CastStatus mould_geometry_resolve(MouldGeometry *geometry, CastError *err)
{
  Resolver resolver = {geometry, {err, 0}};
  char heading[512];
  snprintf(heading, sizeof heading, "geometry '%.300s'", geometry->config->geometry_path);
  if (geometry->config->n_groups > 0) {
    resolve_config_groups(&resolver);
  } else {
    CAST_CALL(resolve_physical_groups(&resolver, 3, err));
    CAST_CALL(resolve_physical_groups(&resolver, 2, err));
  }
  report_unnamed(&resolver);
  return faults_finish(&resolver.faults, heading);
}
