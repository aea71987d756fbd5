/* config_geometry.c - the geometry's file, its unit, and names for a geometry that has none. */
#include "reduce/config/config_private.h"

#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "common/hash.h"
#include "common/units.h"

typedef struct Extension {
  const char *text;
  GeometryKind kind;
} Extension;

static const Extension EXTENSIONS[] = {{".geo", GEOMETRY_GEO},   {".step", GEOMETRY_STEP}, {".stp", GEOMETRY_STEP},
                                       {".brep", GEOMETRY_BREP}, {".msh", GEOMETRY_MESH},  {".stl", GEOMETRY_STL}};

static bool find_kind(const char *file, GeometryKind *kind)
{
  const char *dot = strrchr(file, '.');
  for (size_t i = 0; dot && i < sizeof EXTENSIONS / sizeof *EXTENSIONS; i++) {
    size_t k = 0;
    while (dot[k] && tolower((unsigned char)dot[k]) == EXTENSIONS[i].text[k]) k++;
    if (dot[k] || EXTENSIONS[i].text[k]) continue;
    *kind = EXTENSIONS[i].kind;
    return true;
  }
  return false;
}

/* The unit's name, as in "mm", or a length. STEP files carry their own; gmsh is asked for millimetres. */
static void read_unit(YamlNode geometry, ReduceConfig *config)
{
  config->geometry_unit = 1e-3;
  if (config->geometry_kind == GEOMETRY_STEP) {
    const YamlNode unit = yaml_get(geometry, "unit");
    if (yaml_exists(unit)) yaml_problem(unit, "a STEP file says its unit itself, leave this out");
    return;
  }
  const YamlNode unit = yaml_require(geometry, "unit");
  const char *name = yaml_string(unit, NULL);
  if (!name) return;
  CastError fault;
  char one[128];
  snprintf(one, sizeof one, "%s%.120s", isdigit((unsigned char)name[0]) || name[0] == '.' ? "" : "1 ", name);
  if (units_convert(one, "m", &config->geometry_unit, &fault) != CAST_OK)
    yaml_problem(unit, "'%s' is no unit of length: 'mm' or 'm', for example, is expected", name);
  else if (!(config->geometry_unit > 0))
    yaml_problem(unit, "'%s' is %g m: a length is expected", name, config->geometry_unit);
}

static CastStatus read_file_name(YamlNode geometry, ReduceConfig *config, CastError *err)
{
  const YamlNode stl = yaml_get(geometry, "stl"), node = yaml_exists(stl) ? stl : yaml_require(geometry, "file");
  if (yaml_exists(stl) && yaml_exists(yaml_get(geometry, "file")))
    yaml_problem(yaml_get(geometry, "file"), "there is an STL file already: either 'file' or 'stl'");
  const char *file = yaml_string(node, NULL);
  if (!file) return CAST_OK;
  if (!find_kind(file, &config->geometry_kind)) {
    yaml_problem(node, "'%s' is of no kind that can be read: .geo, .step, .stp, .brep or .msh is expected", file);
    return CAST_OK;
  }
  if (yaml_exists(stl) != (config->geometry_kind == GEOMETRY_STL))
    yaml_problem(node, "'%s': %s", file,
                 yaml_exists(stl) ? "an .stl file is expected here; other geometry is 'file'"
                                  : "the STL file of a cavity is 'stl', with a 'flask'");
  config->geometry_path = yaml_path_beside(config->input_path, file);
  CAST_CHECK(config->geometry_path, err, CAST_ERR_MEMORY, CONFIG_NO_MEMORY);
  CastError fault;
  if (hash_file(config->geometry_path, config->geometry_sha256, &fault) != CAST_OK)
    yaml_problem(node, "%s", fault.message);
  return CAST_OK;
}

static void read_block(YamlNode block, FlaskConfig *flask)
{
  flask->kind = FLASK_BLOCK;
  yaml_vector(yaml_require(block, "corner"), "m", flask->corner);
  const YamlNode size = yaml_require(block, "size");
  if (!yaml_vector(size, "m", flask->size)) return;
  for (int d = 0; d < 3; d++)
    if (!(flask->size[d] > 0))
      yaml_problem(size, "%g m along %c: a length above zero is expected", flask->size[d], "xyz"[d]);
}

static void read_cylinder(YamlNode cylinder, FlaskConfig *flask)
{
  flask->kind = FLASK_CYLINDER;
  yaml_vector(yaml_require(cylinder, "base"), "m", flask->base);
  flask->radius = yaml_quantity(yaml_require(cylinder, "radius"), "m", YAML_POSITIVE, NAN);
  flask->height = yaml_quantity(yaml_require(cylinder, "height"), "m", YAML_POSITIVE, NAN);
}

static void read_flask(YamlNode geometry, ReduceConfig *config)
{
  static const double SPLIT = 40.0 * M_PI / 180.0;
  const YamlNode flask = yaml_get(geometry, "flask"), angle = yaml_get(geometry, "split_angle");
  config->split_angle = yaml_quantity(angle, "rad", (YamlRange){0.02, 1.5, false}, SPLIT);
  if (config->geometry_kind != GEOMETRY_STL) {
    if (yaml_exists(flask)) yaml_problem(flask, "only the STL file of a cavity is put into a flask");
    if (yaml_exists(angle)) yaml_problem(angle, "only an STL file is split at angles");
    return;
  }
  const YamlNode of = yaml_require(geometry, "flask"), block = yaml_get(of, "block"),
                 cylinder = yaml_get(of, "cylinder");
  if (yaml_exists(of) && yaml_exists(block) == yaml_exists(cylinder))
    yaml_problem(of, "either 'block: {corner, size}' or 'cylinder: {base, radius, height}' is expected");
  else if (yaml_exists(block))
    read_block(block, &config->flask);
  else if (yaml_exists(cylinder))
    read_cylinder(cylinder, &config->flask);
}

static void read_box(YamlNode box, GroupConfig *group)
{
  const YamlNode low = yaml_require(box, "low"), high = yaml_require(box, "high");
  group->has_box = yaml_vector(low, "m", group->box);
  group->has_box = yaml_vector(high, "m", group->box + 3) && group->has_box;
  if (!group->has_box) return;
  for (int d = 0; d < 3; d++)
    if (group->box[d] > group->box[d + 3]) yaml_problem(high, "lies below 'low' along %c", "xyz"[d]);
}

static CastStatus read_members(YamlNode members, GroupConfig *group, CastError *err)
{
  if (yaml_is_map(members)) {
    read_box(members, group);
  } else if (yaml_is_sequence(members) && yaml_count(members) > 0) {
    group->tags = config_array(yaml_count(members), sizeof *group->tags);
    CAST_CHECK(group->tags, err, CAST_ERR_MEMORY, CONFIG_NO_MEMORY);
    group->n_tags = yaml_count(members);
    for (size_t i = 0; i < group->n_tags; i++) group->tags[i] = (int)yaml_integer(yaml_item(members, i), 1, INT_MAX, 1);
  } else if (strcmp(yaml_is_scalar(members) ? yaml_string(members, "") : "", "rest") == 0) {
    group->rest = true;
  } else {
    yaml_problem(members, "a list of numbers, a box ({low: [..], high: [..]}) or the word 'rest' is expected");
  }
  return CAST_OK;
}

static CastStatus read_group(YamlNode node, GroupConfig *group, CastError *err)
{
  const YamlNode surfaces = yaml_get(node, "surfaces"), volumes = yaml_get(node, "volumes");
  if (yaml_exists(surfaces) == yaml_exists(volumes)) {
    if (yaml_is_map(node)) yaml_problem(node, "either 'surfaces' or 'volumes' is expected");
    return CAST_OK;
  }
  group->dimension = yaml_exists(surfaces) ? 2 : 3;
  return read_members(yaml_exists(surfaces) ? surfaces : volumes, group, err);
}

static CastStatus read_groups(YamlNode groups, ReduceConfig *config, CastError *err)
{
  const size_t n = config_count_entries(groups, "group");
  int rests[4] = {0};
  config->group = config_array(n, sizeof *config->group);
  CAST_CHECK(config->group, err, CAST_ERR_MEMORY, CONFIG_NO_MEMORY);
  config->n_groups = n;
  for (size_t i = 0; i < n; i++) {
    GroupConfig *group = &config->group[i];
    config_read_name(groups, i, group->name);
    CAST_CALL(read_group(yaml_value(groups, i), group, err));
    if (group->rest && rests[group->dimension]++)
      yaml_problem(yaml_value(groups, i), "only one group can hold the rest of the %s",
                   group->dimension == 2 ? "surfaces" : "volumes");
  }
  return CAST_OK;
}

CastStatus config_read_geometry(YamlNode geometry, ReduceConfig *config, CastError *err)
{
  CAST_CALL(read_file_name(geometry, config, err));
  read_unit(geometry, config);
  read_flask(geometry, config);
  return read_groups(yaml_get(geometry, "groups"), config, err);
}
