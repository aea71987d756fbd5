/* material.c - reading materials; the enthalpy curve is built in material_enthalpy.c. */
#include "common/material/material_private.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "common/hash.h"

/* A temperature is above absolute zero, whatever else is allowed. */
static YamlRange range_of(const char *unit, YamlRange range)
{
  return strcmp(unit, "K") == 0 ? YAML_POSITIVE : range;
}

static bool read_pairs(YamlNode node, const char *x_unit, const char *y_unit, YamlRange y_range, size_t n, double *x,
                       double *y)
{
  bool good = true;
  for (size_t i = 0; i < n; i++) {
    const YamlNode pair = yaml_item(node, i);
    x[i] = y[i] = NAN;
    if (!yaml_is_sequence(pair) || yaml_count(pair) != 2) {
      yaml_problem(pair, "a pair of quantities is expected, in %s and %s", x_unit, y_unit);
    } else {
      x[i] = yaml_quantity(yaml_item(pair, 0), x_unit, range_of(x_unit, YAML_ANY), NAN);
      y[i] = yaml_quantity(yaml_item(pair, 1), y_unit, range_of(y_unit, y_range), NAN);
      if (i > 0 && x[i] <= x[i - 1])
        yaml_problem(pair, "%g %s follows %g %s: the first of the pairs must rise strictly", x[i], x_unit, x[i - 1],
                     x_unit);
    }
    good = good && isfinite(x[i]) && isfinite(y[i]) && (i == 0 || x[i] > x[i - 1]);
  }
  return good;
}

bool material_read_table(YamlNode node, const char *x_unit, const char *y_unit, YamlRange y_range, Table *table)
{
  *table = (Table){0};
  const size_t n = yaml_count(node);
  if (!yaml_is_sequence(node) || n < 1) {
    yaml_problem(node, "a list of pairs is expected: [[..., ...], [..., ...]], in %s and %s", x_unit, y_unit);
    return false;
  }
  double *x = malloc(n * sizeof *x), *y = malloc(n * sizeof *y);
  bool good = x && y;
  CastError err;
  if (!good) yaml_problem(node, "no memory for a table of %zu points", n);
  if (good) good = read_pairs(node, x_unit, y_unit, y_range, n, x, y);
  if (good && table_create(n, x, y, table, &err) != CAST_OK) {
    yaml_problem(node, "%s", err.message);
    good = false;
  }
  free(x);
  free(y);
  return good;
}

/* A property of a temperature: one quantity, or pairs. The constant is its value at the highest temperature given. */
static void read_function(YamlNode node, const char *unit, YamlRange range, Table *table, double *constant)
{
  if (!yaml_exists(node)) return;
  if (yaml_is_scalar(node)) {
    const double value = yaml_quantity(node, unit, range, NAN), at = 0.0;
    CastError err;
    if (isfinite(value) && table_create(1, &at, &value, table, &err) != CAST_OK) yaml_problem(node, "%s", err.message);
  } else {
    material_read_table(node, "K", unit, range, table);
  }
  if (table->n && constant) *constant = table->y[table->n - 1];
}

void material_read_remarks(YamlNode map)
{
  static const char *const QUALITIES[] = {"measured", "data sheet", "textbook estimate", "ours", NULL};
  static const char *const TEXTS[] = {"source", "doi", "range", "note"};
  for (size_t i = 0; i < sizeof TEXTS / sizeof *TEXTS; i++) yaml_string(yaml_get(map, TEXTS[i]), NULL);
  yaml_choice(yaml_get(map, "quality"), QUALITIES, 0);
}

YamlNode material_property(YamlNode map, const char *key)
{
  const YamlNode node = yaml_get(map, key);
  if (!yaml_is_map(node)) return node;
  material_read_remarks(node);
  return yaml_require(node, "value");
}

static YamlNode required_property(YamlNode map, const char *key)
{
  return yaml_exists(yaml_require(map, key)) ? material_property(map, key) : yaml_get(map, key);
}

static const double HALF_TURN = 3.1415926536; // rad, above pi: 180 deg is allowed however it is rounded

/* Secondary arms coarsen with the cube root of time where diffusion limits it (Kattamis, Coughlin & Flemings 1967). */
static void read_arms(YamlNode map, Material *material)
{
  const YamlNode spacing = material_property(map, "arm_spacing_at_1s"),
                 exponent = material_property(map, "arm_spacing_exponent");
  material->arm_spacing_at_1s = yaml_quantity(spacing, "m", YAML_POSITIVE, NAN);
  material->arm_spacing_exponent = yaml_quantity(exponent, "1", (YamlRange){0.1, 0.6, false}, 1.0 / 3.0);
  if (yaml_exists(exponent) && !yaml_exists(spacing)) yaml_problem(exponent, "belongs to arm_spacing_at_1s");
}

static void read_flow(YamlNode map, Material *material)
{
  read_function(material_property(map, "viscosity"), "Pa.s", YAML_POSITIVE, &material->viscosity_of_t, NULL);
  read_function(material_property(map, "surface_tension"), "N/m", YAML_NON_NEGATIVE, &material->surface_tension_of_t,
                &material->surface_tension);
  material->contact_angle =
      yaml_quantity(material_property(map, "contact_angle"), "rad", (YamlRange){0.0, HALF_TURN, false}, NAN);
  material->coherency_fraction =
      yaml_quantity(material_property(map, "coherency_fraction"), "1", (YamlRange){0.0, 1.0, true}, NAN);
  material->dendrite_arm_spacing =
      yaml_quantity(material_property(map, "dendrite_arm_spacing"), "m", YAML_POSITIVE, NAN);
  read_arms(map, material);
}

static void read_name(YamlNode map, const char *fallback, Material *material)
{
  const YamlNode node = yaml_get(map, "name");
  const char *name = yaml_string(node, fallback);
  if (yaml_exists(node) && strlen(name) >= sizeof material->name)
    yaml_problem(node, "the name is longer than %zu letters", sizeof material->name - 1);
  snprintf(material->name, sizeof material->name, "%s", name);
}

static void read_map(YamlNode map, const char *name, Material *material)
{
  read_name(map, name, material);
  material_read_remarks(map);
  material->density = yaml_quantity(required_property(map, "density"), "kg/m^3", YAML_POSITIVE, NAN);
  read_function(required_property(map, "conductivity"), "W/m/K", YAML_POSITIVE, &material->conductivity_of_t,
                &material->conductivity);
  material->reference_temperature = yaml_quantity(yaml_get(map, "reference_temperature"), "K", YAML_POSITIVE, NAN);
  read_flow(map, material);
  material_read_heat(map, material);
}

static void clear(Material *material)
{
  *material = (Material){.density = NAN,
                         .specific_heat = NAN,
                         .conductivity = NAN,
                         .reference_temperature = NAN,
                         .solidus = NAN,
                         .liquidus = NAN,
                         .surface_tension = NAN,
                         .contact_angle = NAN,
                         .coherency_fraction = NAN,
                         .dendrite_arm_spacing = NAN,
                         .arm_spacing_at_1s = NAN,
                         .arm_spacing_exponent = 1.0 / 3.0};
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

/* The file's own name without folder and ending, unless it says `name`. */
static CastStatus read_file_material(const char *path, Material *material, CastError *err)
{
  YamlInput *input = NULL;
  CAST_CALL(yaml_input_load(path, &input, err));
  const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path, *ending = strstr(base, ".yaml");
  char name[sizeof material->name];
  snprintf(name, sizeof name, "%.*s", (int)(ending ? ending - base : (ptrdiff_t)strlen(base)), base);
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
    if (name[0] && material_find_file(node, name, path, sizeof path)) status = read_file_material(path, material, err);
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
  table_destroy(&material->surface_tension_of_t);
  clear(material);
}

CastStatus material_check_mould(const Material *material, CastError *err)
{
  CAST_CHECK(
      isnan(material->solidus), err, CAST_ERR_INPUT,
      "material '%s' melts at %g K and its constants are those of the liquid: a mould needs a material of its own",
      material->name, material->solidus);
  CAST_CHECK(isfinite(material->density), err, CAST_ERR_INPUT, "material '%s' has no density", material->name);
  CAST_CHECK(isfinite(material->specific_heat), err, CAST_ERR_INPUT,
             "material '%s' has no specific_heat: a mould needs one constant value", material->name);
  CAST_CHECK(material->conductivity_of_t.n == 1, err, CAST_ERR_INPUT,
             "material '%s': the conductivity of a mould must be one constant value, the reduced model is linear",
             material->name);
  return CAST_OK;
}

CastStatus material_check_melt(const Material *material, CastError *err)
{
  CAST_CHECK(
      material->enthalpy.n >= 2, err, CAST_ERR_INPUT,
      "material '%s' is no melt: it has neither enthalpy, cooling_curve or identity, nor latent_heat with solidus "
      "and liquidus",
      material->name);
  CAST_CHECK(isfinite(material->density) && material->conductivity_of_t.n >= 1, err, CAST_ERR_INPUT,
             "material '%s' has no density or no conductivity", material->name);
  CAST_CHECK(material->viscosity_of_t.n >= 1, err, CAST_ERR_INPUT, "material '%s' is no melt: it has no viscosity",
             material->name);
  return CAST_OK;
}
