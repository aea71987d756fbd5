/* config_tension.c - `surface_tension:` of cast.yaml, read and written.
 *   surface_tension: false  |  true  |  { contact_angle: 130 deg } */
#include <math.h>

#include "cast/config_private.h"

static const double half_turn = 3.14159265358979323846;

void config_read_tension(YamlNode node, CastConfig *config)
{
  if (!yaml_exists(node)) return;
  const bool map = yaml_is_map(node);
  config->tension = map || yaml_boolean(node, false);
  config->contact_angle = config->melt.contact_angle;
  if (map)
    config->contact_angle = yaml_quantity(yaml_get(node, "contact_angle"), "rad", (YamlRange){0.0, half_turn, false},
                                          config->contact_angle);
  if (!config->tension || !isfinite(config->melt.density)) return; // a material at fault is reported already
  if (config->melt.surface_tension_of_t.n == 0)
    yaml_problem(node, "the melt '%s' has no surface_tension", config->melt.name);
  if (isnan(config->contact_angle))
    yaml_problem(node, "the melt '%s' has no contact_angle; give one here: { contact_angle: 130 deg }",
                 config->melt.name);
}

void config_put_tension(FILE *out, const CastConfig *config)
{
  if (config->tension)
    fprintf(out, "surface_tension: { contact_angle: %.17g rad }\n", config->contact_angle);
  else
    fputs("surface_tension: false\n", out);
}
