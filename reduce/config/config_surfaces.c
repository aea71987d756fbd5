/* config_surfaces.c - the named surfaces: the mould's outside and its cavity. */
#include "reduce/config/config_private.h"

#include <math.h>
#include <string.h>

enum { MOST_LAYERS = 60 };

static void read_boundary(YamlNode node, BoundaryConfig *boundary)
{
  static const char *const kinds[] = {"robin", "insulated", "fixed", NULL};
  const YamlNode type = yaml_require(node, "type"), patch_size = yaml_get(node, "patch_size");
  boundary->patch_size = yaml_quantity(patch_size, "m", YAML_POSITIVE, 0.0);
  boundary->kind = (BoundaryKind)yaml_choice(type, kinds, BOUNDARY_INSULATED);
  if (boundary->kind == BOUNDARY_ROBIN) {
    boundary->h = yaml_quantity(yaml_require(node, "h"), "W/m^2/K", YAML_POSITIVE, NAN);
    return;
  }
  if (boundary->kind == BOUNDARY_FIXED && yaml_exists(patch_size))
    yaml_problem(patch_size,
                 "a wall of fixed temperature cannot be changed in the run: patches of its own are of no use");
  const YamlNode h = yaml_get(node, "h");
  if (yaml_exists(h) && yaml_is_scalar(type))
    yaml_problem(h, "only a wall of type robin has a heat transfer coefficient, this one is %s", kinds[boundary->kind]);
}

static CastStatus read_boundaries(YamlNode boundaries, ReduceConfig *config, CastError *err)
{
  const size_t n = config_count_entries(boundaries, "outer surface");
  config->boundary = config_array(n, sizeof *config->boundary);
  CAST_CHECK(config->boundary, err, CAST_ERR_MEMORY, CONFIG_NO_MEMORY);
  config->n_boundaries = n;
  for (size_t i = 0; i < n; i++) {
    config_read_name(boundaries, i, config->boundary[i].name);
    read_boundary(yaml_value(boundaries, i), &config->boundary[i]);
  }
  return CAST_OK;
}

static const LayersConfig NO_LAYERS = {LAYERS_NONE, 0.0, 1.4, MOST_LAYERS};

static void read_given_layers(YamlNode node, LayersConfig *layers)
{
  layers->kind = LAYERS_GIVEN;
  layers->first = yaml_quantity(yaml_require(node, "first"), "m", YAML_POSITIVE, NAN);
  layers->growth = yaml_quantity(yaml_get(node, "growth"), "1", (YamlRange){1.0, 3.0, false}, NO_LAYERS.growth);
  layers->count = (int)yaml_integer(yaml_get(node, "count"), 1, MOST_LAYERS, MOST_LAYERS);
}

/* 'none', 'auto' or {first, growth, count}; absent: as the cavity as a whole has it. */
static LayersConfig read_layers(YamlNode node, LayersConfig fallback)
{
  LayersConfig layers = NO_LAYERS;
  if (!yaml_exists(node)) return fallback;
  if (yaml_is_map(node)) {
    read_given_layers(node, &layers);
    return layers;
  }
  const char *word = yaml_is_scalar(node) ? yaml_string(node, "") : "";
  if (strcmp(word, "auto") == 0)
    layers.kind = LAYERS_AUTO;
  else if (strcmp(word, "none") != 0)
    yaml_problem(node, "'auto', 'none' or {first: 5 um, growth: 1.4, count: 10} is expected");
  return layers;
}

static void read_cavity_surface(YamlNode node, bool ready_mesh, CavitySurfaceConfig *surface)
{
  const YamlNode patch_size = yaml_get(node, "patch_size"), one = yaml_get(node, "one_patch");
  const bool one_patch = yaml_boolean(one, false);
  surface->patch_size = one_patch ? 0.0 : yaml_quantity(patch_size, "m", YAML_POSITIVE, NAN);
  if (one_patch && yaml_exists(patch_size))
    yaml_problem(patch_size, "the surface is one patch already: either patch_size or 'one_patch: true'");
  if (!one_patch && !yaml_exists(patch_size) && yaml_is_map(node))
    yaml_problem(node, "either patch_size, for example '2 mm', or 'one_patch: true' is expected");
  // of itself a patch gets some 40 triangles
  const YamlNode mesh_size = one_patch && !ready_mesh ? yaml_require(node, "mesh_size") : yaml_get(node, "mesh_size");
  surface->mesh_size =
      yaml_quantity(mesh_size, "m", YAML_POSITIVE, ready_mesh ? (double)NAN : 0.25 * surface->patch_size);
  if (ready_mesh && yaml_exists(mesh_size))
    yaml_problem(mesh_size, "the geometry is a ready mesh: nothing is meshed, leave this out");
  if (surface->patch_size > 0 && surface->patch_size < surface->mesh_size)
    yaml_problem(patch_size, "patches of %g m are smaller than the mesh there, %g m", surface->patch_size,
                 surface->mesh_size);
}

static CastStatus read_cavity(YamlNode cavity, ReduceConfig *config, CastError *err)
{
  const YamlNode surfaces = yaml_require(cavity, "surfaces");
  const size_t n = config_count_entries(surfaces, "cavity surface");
  const LayersConfig layers = read_layers(yaml_get(cavity, "layers"), NO_LAYERS);
  config->contact = yaml_quantity(yaml_get(cavity, "contact"), "W/m^2/K", YAML_POSITIVE, 0.0);
  config->cavity = config_array(n, sizeof *config->cavity);
  CAST_CHECK(config->cavity, err, CAST_ERR_MEMORY, CONFIG_NO_MEMORY);
  config->n_cavity = n;
  for (size_t i = 0; i < n; i++) {
    config_read_name(surfaces, i, config->cavity[i].name);
    read_cavity_surface(yaml_value(surfaces, i), config->geometry_kind == GEOMETRY_MESH, &config->cavity[i]);
    config->cavity[i].layers = read_layers(yaml_get(yaml_value(surfaces, i), "layers"), layers);
  }
  return CAST_OK;
}

static void check_distinct(YamlNode cavity, YamlNode boundaries, const ReduceConfig *config)
{
  const YamlNode surfaces = yaml_get(cavity, "surfaces");
  for (size_t i = 0; i < config->n_cavity; i++)
    for (size_t k = 0; k < config->n_boundaries; k++)
      if (strcmp(config->cavity[i].name, config->boundary[k].name) == 0)
        yaml_problem(yaml_value(surfaces, i), "is an outer surface as well (line %d): a surface is one or the other",
                     yaml_line(yaml_value(boundaries, k)));
}

static bool is_used(const ReduceConfig *config, const GroupConfig *group)
{
  for (size_t i = 0; group->dimension == 3 && i < config->n_regions; i++)
    if (strcmp(config->region[i].name, group->name) == 0) return true;
  for (size_t i = 0; group->dimension == 2 && i < config->n_cavity + config->n_boundaries; i++)
    if (strcmp(reduce_config_surface_name(config, i), group->name) == 0) return true;
  return false;
}

static const GroupConfig *find_group(const ReduceConfig *config, int dimension, const char *name)
{
  for (size_t i = 0; i < config->n_groups; i++)
    if (config->group[i].dimension == dimension && strcmp(config->group[i].name, name) == 0) return &config->group[i];
  return NULL;
}

/* Where geometry.groups names the parts, it must name those that are used and no others. */
static void check_groups(YamlNode root, const ReduceConfig *config)
{
  if (config->n_groups == 0) return;
  const YamlNode groups = yaml_get(yaml_get(root, "geometry"), "groups"), regions = yaml_get(root, "regions");
  const YamlNode boundaries = yaml_get(root, "boundaries"), surfaces = yaml_get(yaml_get(root, "cavity"), "surfaces");
  for (size_t i = 0; i < config->n_groups; i++)
    if (config->group[i].dimension != 0 && !is_used(config, &config->group[i]))
      yaml_problem(yaml_value(groups, i), "no %s has this name",
                   config->group[i].dimension == 3 ? "region" : "boundary and no cavity surface");
  for (size_t i = 0; i < config->n_regions; i++)
    if (!find_group(config, 3, config->region[i].name))
      yaml_problem(yaml_value(regions, i), "geometry.groups has no volumes of this name");
  for (size_t i = 0; i < config->n_cavity + config->n_boundaries; i++)
    if (!find_group(config, 2, reduce_config_surface_name(config, i)))
      yaml_problem(i < config->n_cavity ? yaml_value(surfaces, i) : yaml_value(boundaries, i - config->n_cavity),
                   "geometry.groups has no surfaces of this name");
}

CastStatus config_read_surfaces(YamlNode root, ReduceConfig *config, CastError *err)
{
  const YamlNode boundaries = yaml_require(root, "boundaries"), cavity = yaml_require(root, "cavity");
  CAST_CALL(read_boundaries(boundaries, config, err));
  CAST_CALL(read_cavity(cavity, config, err));
  check_distinct(cavity, boundaries, config);
  check_groups(root, config);
  return CAST_OK;
}
