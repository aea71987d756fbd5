/* material.c - reading materials; the enthalpy curve is built in material_enthalpy.c. */
#include "common/material_private.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include "cast_build_config.h"
#include "common/hash.h"

static void read_pairs(YamlNode node, const char *x_unit, const char *y_unit, size_t n, double *x, double *y)
{
  for (size_t i = 0; i < n; i++) {
    const YamlNode pair = yaml_item(node, i);
    x[i] = y[i] = NAN;
    if (yaml_count(pair) != 2 || !yaml_is_sequence(pair)) {
      yaml_problem(pair, "a pair of quantities is expected: [900 degC, 30 W/m/K]");
      continue;
    }
    x[i] = yaml_quantity(yaml_item(pair, 0), x_unit, YAML_ANY, NAN);
    y[i] = yaml_quantity(yaml_item(pair, 1), y_unit, YAML_ANY, NAN);
  }
}

bool material_read_table(YamlNode node, const char *x_unit, const char *y_unit, Table *table)
{
  *table = (Table){0};
  const size_t n = yaml_count(node);
  if (!yaml_is_sequence(node) || n < 1) {
    yaml_problem(node, "a list of pairs is expected");
    return false;
  }
  double *x = malloc(n * sizeof *x), *y = malloc(n * sizeof *y);
  bool good = x && y;
  if (good) {
    read_pairs(node, x_unit, y_unit, n, x, y);
    for (size_t i = 0; i < n; i++) good = good && isfinite(x[i]) && isfinite(y[i]);
    CastError err;
    if (good && table_create(n, x, y, table, &err) != CAST_OK) {
      yaml_problem(node, "%s", err.message);
      good = false;
    }
  }
  free(x);
  free(y);
  return good;
}

/* A property of a temperature: one quantity, or pairs. The constant is its value at the highest temperature given. */
static void read_function(YamlNode node, const char *unit, Table *table, double *constant)
{
  if (!yaml_exists(node)) return;
  if (yaml_is_scalar(node)) {
    const double value = yaml_quantity(node, unit, YAML_POSITIVE, NAN), at = 0.0;
    CastError err;
    if (isfinite(value)) table_create(1, &at, &value, table, &err);
  } else if (material_read_table(node, "K", unit, table)) {
    for (size_t i = 0; i < table->n; i++)
      if (!(table->y[i] > 0.0)) yaml_problem(yaml_item(node, i), "a value above 0 %s is expected", unit);
  }
  if (table->n && constant) *constant = table->y[table->n - 1];
}

/* Each property may carry where it comes from; the text itself travels with every ROM and result. */
static void read_remarks(YamlNode map)
{
  static const char *const QUALITIES[] = {"measured", "data sheet", "textbook estimate", "ours", NULL};
  yaml_string(yaml_get(map, "source"), NULL);
  yaml_string(yaml_get(map, "doi"), NULL);
  yaml_string(yaml_get(map, "range"), NULL);
  yaml_string(yaml_get(map, "note"), NULL);
  yaml_choice(yaml_get(map, "quality"), QUALITIES, 0);
}

/* A property is a bare value or a map {value, source, quality, ...}. */
static YamlNode property(YamlNode map, const char *key)
{
  const YamlNode node = yaml_get(map, key);
  if (!yaml_is_map(node)) return node;
  read_remarks(node);
  return yaml_require(node, "value");
}

static void read_flow(YamlNode map, Material *material)
{
  read_function(property(map, "viscosity"), "Pa.s", &material->viscosity_of_t, NULL);
  material->surface_tension = yaml_quantity(property(map, "surface_tension"), "N/m", YAML_NON_NEGATIVE, NAN);
  material->contact_angle =
      yaml_quantity(property(map, "contact_angle"), "rad", (YamlRange){0.0, 3.14159265358979, false}, NAN);
  material->coherency_fraction =
      yaml_quantity(property(map, "coherency_fraction"), "1", (YamlRange){0.0, 1.0, true}, NAN);
}

static void read_map(YamlNode map, const char *name, Material *material)
{
  snprintf(material->name, sizeof material->name, "%s", yaml_string(yaml_get(map, "name"), name));
  read_remarks(map);
  material->density = yaml_quantity(property(map, "density"), "kg/m^3", YAML_POSITIVE, NAN);
  if (!yaml_exists(yaml_get(map, "density"))) yaml_require(map, "density");
  if (!yaml_exists(yaml_get(map, "conductivity"))) yaml_require(map, "conductivity");
  read_function(property(map, "conductivity"), "W/m/K", &material->conductivity_of_t, &material->conductivity);
  material->reference_temperature = yaml_quantity(yaml_get(map, "reference_temperature"), "K", YAML_POSITIVE, NAN);
  read_flow(map, material);
  material_read_heat(map, material);
}

static void clear(Material *material)
{
  *material = (Material){.density = NAN, .specific_heat = NAN, .conductivity = NAN, .reference_temperature = NAN,
                         .solidus = NAN, .liquidus = NAN, .surface_tension = NAN, .contact_angle = NAN,
                         .coherency_fraction = NAN};
}

static bool file_exists(const char *path)
{
  struct stat info;
  return stat(path, &info) == 0 && S_ISREG(info.st_mode);
}

/* A name is looked up in the share folders; anything with a slash or .yaml is a path beside the input file. */
static bool find_file(YamlNode node, const char *name, char *path, size_t size)
{
  if (strchr(name, '/') || strstr(name, ".yaml")) {
    const char *input = yaml_input_path(node.input);
    const char *slash = strrchr(input, '/');
    const int folder = slash && name[0] != '/' ? (int)(slash - input) + 1 : 0;
    snprintf(path, size, "%.*s%s", folder, input, name);
    return file_exists(path);
  }
  const char *const folders[] = {getenv("CAST_SHARE"), CAST_SHARE_INSTALLED, CAST_SHARE_SOURCE};
  for (size_t i = 0; i < 3; i++) {
    if (!folders[i]) continue;
    snprintf(path, size, "%s/materials/%s.yaml", folders[i], name);
    if (file_exists(path)) return true;
  }
  return false;
}

static CastStatus keep_text(const char *text, size_t n, Material *material, CastError *err)
{
  material->text = malloc(n + 1);
  CAST_CHECK(material->text, err, CAST_ERR_MEMORY, "no memory for a material's text");
  memcpy(material->text, text, n);
  material->text[n] = '\0';
  hash_bytes(text, n, material->sha256);
  return CAST_OK;
}

static CastStatus read_file_material(const char *path, const char *name, Material *material, CastError *err)
{
  YamlInput *input = NULL;
  CAST_CALL(yaml_input_load(path, &input, err));
  read_map(yaml_root(input), name, material);
  CastStatus status = yaml_input_finish(input, err);
  if (status == CAST_OK) status = keep_text(yaml_input_text(input), strlen(yaml_input_text(input)), material, err);
  yaml_input_destroy(&input);
  return status;
}

CastStatus material_read(YamlNode node, Material *material, CastError *err)
{
  clear(material);
  if (!yaml_exists(node)) return CAST_OK; // the missing key is a problem already
  CastStatus status = CAST_OK;
  if (yaml_is_map(node)) {
    size_t start, end;
    yaml_input_extent(node, &start, &end);
    read_map(node, "inline", material);
    status = keep_text(yaml_input_text(node.input) + start, end - start, material, err);
  } else {
    const char *name = yaml_string(node, "");
    char path[4096];
    if (name[0] && !find_file(node, name, path, sizeof path))
      yaml_problem(node, "there is no material '%s': neither beside this file nor in share/materials", name);
    else if (name[0])
      status = read_file_material(path, name, material, err);
  }
  if (status != CAST_OK) material_destroy(material);
  return status;
}

void material_destroy(Material *material)
{
  if (!material) return;
  free(material->text);
  table_destroy(&material->enthalpy);
  table_destroy(&material->solid_fraction);
  table_destroy(&material->conductivity_of_t);
  table_destroy(&material->viscosity_of_t);
  clear(material);
}

CastStatus material_check_mould(const Material *material, CastError *err)
{
  CAST_CHECK(isfinite(material->specific_heat), err, CAST_ERR_INPUT,
             "material '%s' has no specific_heat: a mould needs one constant value", material->name);
  CAST_CHECK(material->conductivity_of_t.n == 1, err, CAST_ERR_INPUT,
             "material '%s': the conductivity of a mould must be one constant value, the reduced model is linear",
             material->name);
  return CAST_OK;
}

CastStatus material_check_melt(const Material *material, CastError *err)
{
  CAST_CHECK(material->enthalpy.n >= 2, err, CAST_ERR_INPUT,
             "material '%s' is no melt: it has neither an enthalpy nor latent_heat with solidus and liquidus",
             material->name);
  CAST_CHECK(material->viscosity_of_t.n >= 1, err, CAST_ERR_INPUT, "material '%s' is no melt: it has no viscosity",
             material->name);
  return CAST_OK;
}
