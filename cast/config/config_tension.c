/* config_tension.c - `surface_tension:` of cast.yaml, read and written.
 *   surface_tension: false  |  true  |  { contact_angle: 130 deg, surfaces: { NAME: { contact_angle: 60 deg } } } */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/config/config_private.h"

static const double half_turn = 3.14159265358979323846;

static double read_angle(YamlNode node, double missing)
{
  return yaml_quantity(node, "rad", (YamlRange){0.0, half_turn, false}, missing);
}

static CastStatus read_surfaces(YamlNode node, CastConfig *config, CastError *err)
{
  if (!yaml_exists(node)) return CAST_OK;
  if (!yaml_is_map(node) || yaml_count(node) == 0) {
    yaml_problem(node, "cavity surfaces by name are expected: { pins: { contact_angle: 130 deg } }");
    return CAST_OK;
  }
  const size_t n = yaml_count(node);
  config->angle = calloc(n, sizeof *config->angle);
  CAST_CHECK(config->angle, err, CAST_ERR_MEMORY, "no memory for %zu surfaces", n);
  config->n_angles = n;
  for (size_t k = 0; k < n; k++) {
    const char *name = yaml_key(node, k);
    const YamlNode value = yaml_value(node, k);
    SurfaceAngle *angle = &config->angle[k];
    if (strlen(name) >= sizeof angle->surface)
      yaml_problem(value, "a name of at most %zu letters is expected", sizeof angle->surface - 1);
    snprintf(angle->surface, sizeof angle->surface, "%s", name);
    if (yaml_is_map(value))
      angle->contact_angle = read_angle(yaml_require(value, "contact_angle"), 0.5 * half_turn);
    else
      yaml_problem(value, "{ contact_angle: ... } is expected");
  }
  return CAST_OK;
}

CastStatus config_read_tension(YamlNode node, CastConfig *config, CastError *err)
{
  if (!yaml_exists(node)) return CAST_OK;
  const bool map = yaml_is_map(node);
  config->tension = map || yaml_boolean(node, false);
  config->contact_angle = config->melt.contact_angle;
  if (map) {
    config->contact_angle = read_angle(yaml_get(node, "contact_angle"), config->contact_angle);
    CAST_CALL(read_surfaces(yaml_get(node, "surfaces"), config, err));
  }
  if (!config->tension || !isfinite(config->melt.density)) return CAST_OK; // a material at fault is reported already
  if (config->melt.surface_tension_of_t.n == 0)
    yaml_problem(node, "the melt '%s' has no surface_tension", config->melt.name);
  if (isnan(config->contact_angle))
    yaml_problem(node, "the melt '%s' has no contact_angle; give one here: { contact_angle: 130 deg }",
                 config->melt.name);
  return CAST_OK;
}

void config_put_tension(FILE *out, const CastConfig *config)
{
  if (!config->tension) {
    fputs("surface_tension: false\n", out);
    return;
  }
  fprintf(out, "surface_tension:\n  contact_angle: %.17g rad\n", config->contact_angle);
  if (config->n_angles) fputs("  surfaces:\n", out);
  for (size_t k = 0; k < config->n_angles; k++) {
    fputs("    ", out);
    config_put_text(out, config->angle[k].surface);
    fprintf(out, ": { contact_angle: %.17g rad }\n", config->angle[k].contact_angle);
  }
}
