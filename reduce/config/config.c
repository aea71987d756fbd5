/* config.c - mould.yaml as a whole: its sections, and what must fit together across them. */
#include "reduce/config/config_private.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void *config_array(size_t n, size_t size)
{
  return calloc(n > 0 ? n : 1, size);
}

size_t config_count_entries(YamlNode map, const char *what)
{
  if (!yaml_exists(map)) return 0;
  if (!yaml_is_map(map) || yaml_count(map) == 0) {
    yaml_problem(map, "at least one %s is expected here, as 'name: {...}'", what);
    return 0;
  }
  return yaml_count(map);
}

bool config_read_name(YamlNode map, size_t i, char name[NAME_LENGTH])
{
  enum { LONGEST = NAME_LENGTH - 16 }; // room for "/12345", the patch's number
  const char *key = yaml_key(map, i);
  const YamlNode value = yaml_value(map, i);
  if (strlen(key) == 0 || strlen(key) > LONGEST || strchr(key, '/')) {
    yaml_problem(value, "a name has 1 to %d characters and no '/'", (int)LONGEST);
    return false;
  }
  snprintf(name, NAME_LENGTH, "%s", key);
  return true;
}

static CastStatus read_regions(YamlNode regions, ReduceConfig *config, CastError *err)
{
  const size_t n = config_count_entries(regions, "region");
  config->region = config_array(n, sizeof *config->region);
  CAST_CHECK(config->region, err, CAST_ERR_MEMORY, CONFIG_NO_MEMORY);
  for (size_t i = 0; i < n; i++) {
    const YamlNode region = yaml_value(regions, i);
    RegionConfig *read = &config->region[i];
    config->n_regions = i + 1;
    config_read_name(regions, i, read->name);
    const YamlNode material = yaml_require(region, "material");
    if (!yaml_exists(material)) continue;
    CastError fault = {CAST_OK, ""};
    const CastStatus status = material_read(material, &read->material, &fault);
    if (status == CAST_ERR_MEMORY) {
      if (err) *err = fault;
      return status;
    }
    // without a text there is no material, and that is a problem already
    const bool unfit =
        status == CAST_OK && read->material.text && material_check_mould(&read->material, &fault) != CAST_OK;
    if (status != CAST_OK || unfit) yaml_problem(material, "%s", fault.message);
  }
  return CAST_OK;
}

static void read_sizes(YamlNode mesh, ReduceConfig *config)
{
  config->outside_size = yaml_quantity(yaml_require(mesh, "outside_size"), "m", YAML_POSITIVE, NAN);
  config->growth = yaml_quantity(yaml_get(mesh, "growth"), "1", (YamlRange){0.0, 2.0, false}, 0.3);
  for (size_t i = 0; i < config->n_cavity; i++)
    if (config->cavity[i].mesh_size > config->outside_size)
      yaml_problem(yaml_get(mesh, "outside_size"), "%g m is finer than %g m on the cavity surface '%s'",
                   config->outside_size, config->cavity[i].mesh_size, config->cavity[i].name);
  for (size_t i = 0; i < config->n_boundaries; i++)
    if (config->boundary[i].patch_size > 0 && config->boundary[i].patch_size < config->outside_size)
      yaml_problem(yaml_get(mesh, "outside_size"), "%g m is coarser than the patches of %g m on the outer surface '%s'",
                   config->outside_size, config->boundary[i].patch_size, config->boundary[i].name);
}

/* Of a ready mesh only the order of the elements is open. */
static void refuse_sizes(YamlNode mesh)
{
  static const char *const keys[] = {"outside_size", "growth"};
  for (size_t i = 0; i < 2; i++) {
    const YamlNode size = yaml_get(mesh, keys[i]);
    if (yaml_exists(size)) yaml_problem(size, "the geometry is a ready mesh: nothing is meshed, leave this out");
  }
}

static void read_mesh(YamlNode root, ReduceConfig *config)
{
  const bool ready = config->geometry_kind == GEOMETRY_MESH;
  const YamlNode mesh = ready ? yaml_get(root, "mesh") : yaml_require(root, "mesh");
  config->order = (int)yaml_integer(yaml_get(mesh, "order"), 1, 2, 1);
  if (ready)
    refuse_sizes(mesh);
  else
    read_sizes(mesh, config);
}

static const double BASIS_BUDGET = 1e9; // bytes

static bool ends_with(const char *text, const char *end)
{
  const size_t n = strlen(text), k = strlen(end);
  return n > k && strcmp(text + n - k, end) == 0;
}

static CastStatus read_output(YamlNode output, ReduceConfig *config, CastError *err)
{
  const YamlNode file = yaml_require(output, "file");
  const char *name = yaml_string(file, NULL);
  const YamlNode band = config->matrices ? yaml_get(output, "band") : yaml_require(output, "band");
  if (config->matrices && yaml_exists(band)) yaml_problem(band, "matrices have no cavity wall: leave this out");
  config->band = yaml_quantity(band, "m", YAML_POSITIVE, NAN);
  if (config->matrices) config->band = 0.0;
  const YamlNode budget = yaml_get(output, "basis_budget");
  if (config->matrices && yaml_exists(budget)) yaml_problem(budget, "matrices have no cavity wall: leave this out");
  config->basis_budget = yaml_quantity(budget, "byte", YAML_POSITIVE, BASIS_BUDGET);
  if (!name) return CAST_OK;
  if (!ends_with(name, ".rom.h5")) yaml_problem(file, "'%s': a name that ends in '.rom.h5' is expected", name);
  config->rom_path = yaml_path_beside(config->input_path, name);
  CAST_CHECK(config->rom_path, err, CAST_ERR_MEMORY, CONFIG_NO_MEMORY);
  config->reduction.scratch = config_array(strlen(config->rom_path) + sizeof ".shifts", 1);
  CAST_CHECK(config->reduction.scratch, err, CAST_ERR_MEMORY, CONFIG_NO_MEMORY);
  sprintf(config->reduction.scratch, "%s.shifts", config->rom_path);
  return CAST_OK;
}

static CastStatus read_mould(YamlNode root, ReduceConfig *config, CastError *err)
{
  CAST_CALL(config_read_geometry(yaml_require(root, "geometry"), config, err));
  CAST_CALL(read_regions(yaml_require(root, "regions"), config, err));
  CAST_CALL(config_read_surfaces(root, config, err));
  read_mesh(root, config);
  return CAST_OK;
}

static CastStatus read_sections(YamlInput *input, ReduceConfig *config, CastError *err)
{
  const YamlNode root = yaml_root(input);
  const char *slash = strrchr(config->input_path, '/');
  config->title = strdup(yaml_string(yaml_get(root, "title"), slash ? slash + 1 : config->input_path));
  CAST_CHECK(config->title, err, CAST_ERR_MEMORY, CONFIG_NO_MEMORY);
  const bool matrices = yaml_exists(yaml_get(root, "matrices"));
  CAST_CALL(matrices ? config_read_matrices(root, config, err) : read_mould(root, config, err));
  CAST_CALL(config_read_reduction(yaml_require(root, "reduction"), &config->reduction, err));
  return read_output(yaml_require(root, "output"), config, err);
}

static CastStatus read_document(YamlInput *input, ReduceConfig *config, CastError *err)
{
  config->input_path = strdup(yaml_input_path(input));
  config->input_text = strdup(yaml_input_text(input));
  CAST_CHECK(config->input_path && config->input_text, err, CAST_ERR_MEMORY, CONFIG_NO_MEMORY);
  CAST_CALL(read_sections(input, config, err));
  return yaml_input_finish(input, err);
}

CastStatus reduce_config_read(const char *path, const char *text, ReduceConfig **config, CastError *err)
{
  *config = NULL;
  YamlInput *input = NULL;
  CAST_CALL(text ? yaml_input_parse(text, path, &input, err) : yaml_input_load(path, &input, err));
  ReduceConfig *made = calloc(1, sizeof *made);
  const CastStatus status =
      made ? read_document(input, made, err) : cast_error_set(err, CAST_ERR_MEMORY, CONFIG_NO_MEMORY);
  yaml_input_destroy(&input);
  if (status != CAST_OK) reduce_config_destroy(&made);
  *config = made;
  return status;
}

void reduce_config_destroy(ReduceConfig **config)
{
  if (!config || !*config) return;
  ReduceConfig *old = *config;
  for (size_t i = 0; i < old->n_regions; i++) material_destroy(&old->region[i].material);
  for (size_t i = 0; i < old->n_groups; i++) free(old->group[i].tags);
  free(old->group);
  free(old->region);
  free(old->boundary);
  free(old->cavity);
  free(old->reduction.shifts);
  free(old->reduction.scratch);
  config_matrices_destroy(&old->matrices);
  free(old->title);
  free(old->geometry_path);
  free(old->rom_path);
  free(old->input_path);
  free(old->input_text);
  free(old);
  *config = NULL;
}

const char *reduce_config_surface_name(const ReduceConfig *config, size_t surface)
{
  return surface < config->n_cavity ? config->cavity[surface].name : config->boundary[surface - config->n_cavity].name;
}
