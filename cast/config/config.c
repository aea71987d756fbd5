/* config.c - cast.yaml into CastConfig. Faults are gathered by yaml_input and reported in one go. */
#include "cast/config/config_private.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- melt ---- */

static void read_block(YamlNode node, const CastConfig *config, BlockConfig *block)
{
  block->temperature = yaml_quantity(yaml_get(node, "temperature"), "K", YAML_POSITIVE, config->melt_temperature);
  config_read_box(node, block->corner, block->size);
  config_read_vector(yaml_get(node, "velocity"), "m/s", block->velocity);
}

static CastStatus read_blocks(YamlNode node, CastConfig *config, CastError *err)
{
  if (!yaml_exists(node)) return CAST_OK;
  if (!yaml_is_sequence(node) || yaml_count(node) == 0) {
    yaml_problem(node, "a list of blocks is expected: [{corner: [...], size: [...]}]");
    return CAST_OK;
  }
  config->block = calloc(yaml_count(node), sizeof *config->block);
  CAST_CHECK(config->block, err, CAST_ERR_MEMORY, "no memory for %zu blocks", yaml_count(node));
  config->n_blocks = yaml_count(node);
  for (size_t i = 0; i < config->n_blocks; i++) read_block(yaml_item(node, i), config, &config->block[i]);
  return CAST_OK;
}

static CastStatus read_material(YamlNode node, CastConfig *config, CastError *err)
{
  const CastStatus status = material_read(node, &config->melt, err);
  if (status == CAST_ERR_MEMORY) return status;
  if (status != CAST_OK) yaml_problem(node, "%s", err->message);
  CastError fault;
  const bool complete = status == CAST_OK && isfinite(config->melt.density);
  if (complete && material_check_melt(&config->melt, &fault) != CAST_OK) yaml_problem(node, "%s", fault.message);
  if (yaml_is_scalar(node)) {
    const char *name = yaml_string(node, "");
    const bool is_path = strchr(name, '/') || strstr(name, ".yaml");
    config->melt_reference = is_path ? yaml_path_beside(config->input_path, name) : strdup(name);
    CAST_CHECK(config->melt_reference, err, CAST_ERR_MEMORY, "no memory");
  }
  return CAST_OK;
}

static CastStatus read_melt(YamlNode node, CastConfig *config, CastError *err)
{
  CAST_CALL(read_material(yaml_require(node, "material"), config, err));
  config->melt_temperature = yaml_quantity(yaml_require(node, "temperature"), "K", YAML_POSITIVE, NAN);
  const YamlNode blocks = yaml_get(node, "blocks"), level = yaml_get(node, "cavity_below");
  CAST_CALL(read_blocks(blocks, config, err));
  CAST_CALL(config_read_pour(node, config, err));
  config->has_level = yaml_exists(level);
  config->level = yaml_quantity(level, "m", YAML_ANY, NAN);
  if (yaml_is_map(node) && !yaml_exists(blocks) && !config->has_level && !yaml_exists(yaml_get(node, "inlets")))
    yaml_problem(
        node, "where is the melt? Give blocks, or cavity_below: the height up to which the cavity is full, or inlets");
  return CAST_OK;
}

/* ---- the rest ---- */

/* "auto", "each" (step of the melt) or the longest time between two. */
static double read_mould_step(YamlNode node, const CouplingParameters *coupling)
{
  const bool alone = coupling->kind == COUPLING_SURFACE;
  if (!yaml_exists(node)) return alone ? (double)INFINITY : 0.0;
  if (!alone) yaml_problem(node, "belongs to kind: surface; embedded wall particles take part in each step");
  if (coupling->mould_frozen) yaml_problem(node, "a mould that is frozen takes no steps");
  const char *word = yaml_is_scalar(node) ? yaml_string(node, "") : "";
  if (strcmp(word, "auto") == 0) return INFINITY;
  if (strcmp(word, "each") == 0) return 0.0;
  return yaml_quantity(node, "s", YAML_POSITIVE, INFINITY);
}

static void read_coupling(YamlNode node, CastConfig *config)
{
  static const char *const KINDS[] = {"surface", "embedded", NULL};
  static const char *const MOULDS[] = {"live", "frozen", NULL};
  config->coupling.kind = (CouplingKind)yaml_choice(yaml_get(node, "kind"), KINDS, COUPLING_SURFACE);
  config->coupling.mould_frozen = yaml_choice(yaml_get(node, "mould"), MOULDS, 0) == 1;
  config->coupling.mould_interval = read_mould_step(yaml_get(node, "mould_step"), &config->coupling);
}

/* "auto" or a quantity; 0 stands for auto. */
static double read_auto(YamlNode node, const char *unit)
{
  if (!yaml_exists(node)) return 0.0;
  if (yaml_is_scalar(node) && strcmp(yaml_string(node, ""), "auto") == 0) return 0.0;
  return yaml_quantity(node, unit, YAML_POSITIVE, 0.0);
}

static void read_sph(YamlNode node, CastConfig *config)
{
  const char *const KERNELS[] = {kernel_name(KERNEL_WENDLAND_C2), kernel_name(KERNEL_CUBIC_SPLINE),
                                 kernel_name(KERNEL_QUINTIC_SPLINE), kernel_name(KERNEL_LUCY), NULL};
  static const char *const DENSITIES[] = {"continuity", "summation", NULL};
  static const char *const TENSIONS[] = {"keep", "cut", NULL};
  config->spacing = yaml_quantity(yaml_require(node, "spacing"), "m", YAML_POSITIVE, NAN);
  config->kernel = (KernelKind)yaml_choice(yaml_get(node, "kernel"), KERNELS, KERNEL_WENDLAND_C2);
  // whatever the kernel, its support is three spacings unless said otherwise
  const double support = kernel_support(config->kernel);
  config->smoothing =
      yaml_quantity(yaml_get(node, "smoothing"), "1", (YamlRange){2.0 / support, 5.0 / support, false}, 3.0 / support);
  config->sound_speed = read_auto(yaml_get(node, "sound_speed"), "m/s");
  config->density = (SphDensity)yaml_choice(yaml_get(node, "density"), DENSITIES, SPH_CONTINUITY);
  const YamlNode diffusion = yaml_get(node, "density_diffusion");
  config->density_diffusion =
      yaml_quantity(diffusion, "1", (YamlRange){0.0, 1.0, false}, config->density == SPH_CONTINUITY ? 0.1 : 0.0);
  if (config->density == SPH_SUMMATION && yaml_exists(diffusion))
    yaml_problem(diffusion, "belongs to density: continuity");
  config->artificial_viscosity =
      yaml_quantity(yaml_get(node, "artificial_viscosity"), "1", (YamlRange){0.0, 1.0, false}, 0.02);
  config->cut_tension = yaml_choice(yaml_get(node, "negative_pressure"), TENSIONS, 0) == 1;
}

static void read_cool(YamlNode node, CastConfig *config)
{
  static const char *const STARTS[] = {"at-rest", "at-end", NULL}, *const STOPS[] = {"end", "solid", NULL};
  CoolConfig *cool = &config->cool;
  cool->wanted = yaml_exists(node);
  if (!cool->wanted) return;
  const YamlNode end = yaml_require(node, "end"), until = yaml_get(node, "until");
  cool->end = yaml_quantity(end, "s", YAML_POSITIVE, NAN);
  cool->at_end = yaml_choice(yaml_get(node, "begin"), STARTS, 0) == 1;
  cool->until_solid = yaml_choice(until, STOPS, 0) == 1;
  cool->tolerance = yaml_quantity(yaml_get(node, "tolerance"), "K", YAML_POSITIVE, 0.5);
  cool->every = yaml_quantity(yaml_get(node, "every"), "s", YAML_POSITIVE, 0.05 * cool->end);
  cool->curves_every = yaml_quantity(yaml_get(node, "curves_every"), "s", YAML_POSITIVE, 0.0);
  if (cool->end <= config->end) yaml_problem(end, "%g s is not after the filling's end, %g s", cool->end, config->end);
  if (cool->until_solid && isfinite(config->melt.density) && config->melt.solid_fraction.n == 0)
    yaml_problem(until, "the melt '%s' has no solidus", config->melt.name);
}

static void read_time(YamlNode node, CastConfig *config)
{
  static const char *const SCHEMES[] = {"exponential", "backward-euler", NULL};
  config->end = yaml_quantity(yaml_require(node, "end"), "s", YAML_POSITIVE, NAN);
  read_cool(yaml_get(node, "cool"), config);
  config->step = read_auto(yaml_get(node, "step"), "s");
  config->scheme = (RomScheme)yaml_choice(yaml_get(node, "scheme"), SCHEMES, ROM_EXPONENTIAL);
}

/* A list of {name, <where>: [x, y, z]}. */
static CastStatus read_points(YamlNode node, const char *where, size_t *n, PointConfig **points, CastError *err)
{
  if (!yaml_exists(node)) return CAST_OK;
  if (!yaml_is_sequence(node)) {
    yaml_problem(node, "a list is expected: [{name: ..., %s: [...]}]", where);
    return CAST_OK;
  }
  PointConfig *made = calloc(yaml_count(node) + 1, sizeof *made);
  CAST_CHECK(made, err, CAST_ERR_MEMORY, "no memory");
  *points = made;
  *n = yaml_count(node);
  for (size_t i = 0; i < *n; i++) {
    const YamlNode item = yaml_item(node, i), name_node = yaml_require(item, "name");
    const char *name = yaml_string(name_node, "");
    if (strlen(name) >= sizeof made->name || strpbrk(name, ",\"\n"))
      yaml_problem(name_node, "a name of at most %zu letters without commas, quotes and line ends is expected",
                   sizeof made->name - 1);
    snprintf(made[i].name, sizeof made->name, "%s", name);
    for (size_t k = 0; k < i; k++)
      if (name[0] && strcmp(made[k].name, made[i].name) == 0)
        yaml_problem(name_node, "the name '%s' is used twice", name);
    config_read_vector(yaml_require(item, where), "m", made[i].x);
  }
  return CAST_OK;
}

/* The named surfaces of the cavity that are wanted as metal: what "filled" is about. */
static CastStatus read_part(YamlNode node, CastConfig *config, CastError *err)
{
  if (!yaml_exists(node)) return CAST_OK;
  if (!yaml_is_sequence(node) || yaml_count(node) == 0) {
    yaml_problem(node, "a list of the cavity surfaces and features that make up the part is expected: [disc, pins]");
    return CAST_OK;
  }
  config->part = calloc(yaml_count(node), sizeof *config->part);
  CAST_CHECK(config->part, err, CAST_ERR_MEMORY, "no memory");
  config->n_part = yaml_count(node);
  for (size_t i = 0; i < config->n_part; i++) {
    const YamlNode item = yaml_item(node, i);
    const char *name = yaml_string(item, "");
    snprintf(config->part[i], sizeof config->part[i], "%s", name);
    if (strlen(name) >= sizeof config->part[i]) yaml_problem(item, "no surface has a name that long");
    for (size_t k = 0; k < i; k++)
      if (strcmp(config->part[k], config->part[i]) == 0) yaml_problem(item, "'%s' is named twice", name);
  }
  return CAST_OK;
}

static CastStatus read_output(YamlNode node, CastConfig *config, CastError *err)
{
  OutputConfig *output = &config->output;
  const char *folder = yaml_string(yaml_require(node, "folder"), NULL);
  if (folder) {
    output->folder = yaml_path_beside(config->input_path, folder);
    CAST_CHECK(output->folder, err, CAST_ERR_MEMORY, "no memory");
  }
  output->every = yaml_quantity(yaml_require(node, "every"), "s", YAML_POSITIVE, NAN);
  output->curves_every = yaml_quantity(yaml_get(node, "curves_every"), "s", YAML_POSITIVE, 0.1 * output->every);
  output->checkpoint_every = yaml_quantity(yaml_get(node, "checkpoint_every"), "s", YAML_POSITIVE, 600.0);
  const YamlNode record = yaml_get(node, "record_every"), triangles = yaml_get(node, "record_triangles");
  output->record_every = yaml_quantity(record, "s", YAML_POSITIVE, 0.0);
  output->record_triangles = yaml_boolean(triangles, false);
  if (output->record_triangles && !yaml_exists(record))
    yaml_problem(triangles, "record_every is missing: the interval of the heat record");
  output->mould_fields = yaml_boolean(yaml_get(node, "mould_fields"), true);
  CAST_CALL(read_points(yaml_get(node, "probes"), "position", &output->n_probes, &output->probe, err));
  return read_points(yaml_get(node, "tracers"), "nearest", &output->n_tracers, &output->tracer, err);
}

static void check_sound_speed(YamlNode root, const CastConfig *config)
{
  const Drive *forces = &config->drive;
  double drive = forces->speed.n || config->n_inlets || config->gas.pressure.n ? 1.0 : 0.0;
  for (int d = 0; d < 3; d++)
    for (size_t i = 0; i < forces->n; i++) drive += fabs(forces->gravity[i][d] + forces->acceleration[d]);
  for (size_t i = 0; i < config->n_blocks; i++)
    for (int d = 0; d < 3; d++) drive += fabs(config->block[i].velocity[d]);
  const YamlNode sph = yaml_get(root, "sph");
  if (config->sound_speed == 0.0 && drive == 0.0 && yaml_exists(sph))
    yaml_problem(sph, "nothing drives the melt, so sound_speed: auto has nothing to go by; give a value in m/s");
}

static CastStatus read_root(YamlInput *input, CastConfig *config, CastError *err)
{
  const YamlNode root = yaml_root(input);
  config->input_path = strdup(yaml_input_path(input));
  config->input_text = strdup(yaml_input_text(input));
  config->title = strdup(yaml_string(yaml_get(root, "title"), "casting"));
  CAST_CHECK(config->input_path && config->input_text && config->title, err, CAST_ERR_MEMORY, "no memory");
  const char *rom = yaml_string(yaml_require(root, "rom"), NULL);
  if (rom) {
    config->rom_path = yaml_path_beside(config->input_path, rom);
    CAST_CHECK(config->rom_path, err, CAST_ERR_MEMORY, "no memory");
  }
  config->preheat = yaml_quantity(yaml_require(root, "preheat"), "K", YAML_POSITIVE, NAN);
  config->ambient = yaml_quantity(yaml_require(root, "ambient"), "K", YAML_POSITIVE, NAN);
  CAST_CALL(read_melt(yaml_require(root, "melt"), config, err));
  CAST_CALL(config_read_forces(yaml_require(root, "forces"), config, err));
  CAST_CALL(config_read_contact(yaml_require(root, "contact"), config, err));
  read_coupling(yaml_get(root, "coupling"), config);
  CAST_CALL(config_read_walls(yaml_get(root, "walls"), config, err));
  CAST_CALL(config_read_tension(yaml_get(root, "surface_tension"), config, err));
  read_sph(yaml_require(root, "sph"), config);
  read_time(yaml_require(root, "time"), config);
  CAST_CALL(config_read_features(yaml_get(root, "features"), config, err));
  CAST_CALL(read_part(yaml_get(root, "part"), config, err));
  CAST_CALL(read_output(yaml_require(root, "output"), config, err));
  check_sound_speed(root, config);
  return yaml_input_finish(input, err);
}

CastStatus cast_config_read(const char *path, const char *text, CastConfig **config, CastError *err)
{
  *config = NULL;
  YamlInput *input = NULL;
  CAST_CALL(text ? yaml_input_parse(text, path, &input, err) : yaml_input_load(path, &input, err));
  CastConfig *made = calloc(1, sizeof *made);
  CastStatus status = made ? read_root(input, made, err) : cast_error_set(err, CAST_ERR_MEMORY, "no memory");
  yaml_input_destroy(&input);
  if (status != CAST_OK) cast_config_destroy(&made);
  *config = made;
  return status;
}

void cast_config_destroy(CastConfig **config)
{
  if (!config || !*config) return;
  CastConfig *old = *config;
  material_destroy(&old->melt);
  contact_laws_destroy(&old->contact);
  free(old->angle);
  drive_destroy(&old->drive);
  table_destroy(&old->gas.pressure);
  config_destroy_pour(old);
  char *texts[] = {old->title,         old->rom_path,   old->melt_reference,
                   old->output.folder, old->input_path, old->input_text};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) free(texts[i]);
  free(old->block);
  free(old->wall);
  free(old->feature);
  free(old->part);
  free(old->output.probe);
  free(old->output.tracer);
  free(old);
  *config = NULL;
}
