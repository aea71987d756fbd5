/* config_walls.c - `walls:` of cast.yaml, read and written.
 *   walls: { NAME of an outer surface: { h: 20 W/m^2/K, ambient: 25 degC, emissivity: 0.85 } } */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/config/config_private.h"

static void read_wall(YamlNode node, OuterWall *wall)
{
  const YamlNode h = yaml_get(node, "h"), ambient = yaml_get(node, "ambient"),
                 emissivity = yaml_get(node, "emissivity");
  wall->h = yaml_quantity(h, "W/m^2/K", YAML_NON_NEGATIVE, NAN);
  wall->ambient = yaml_quantity(ambient, "K", YAML_POSITIVE, NAN);
  wall->emissivity = yaml_quantity(emissivity, "1", (YamlRange){0.0, 1.0, false}, 0.0);
  wall->line = yaml_line(node);
  if (!yaml_exists(h) && !yaml_exists(ambient) && !yaml_exists(emissivity))
    yaml_problem(node, "h, ambient or emissivity is expected: { h: 20 W/m^2/K, ambient: 25 degC, emissivity: 0.85 }");
}

CastStatus config_read_walls(YamlNode node, CastConfig *config, CastError *err)
{
  if (!yaml_exists(node)) return CAST_OK;
  if (!yaml_is_map(node) || yaml_count(node) == 0) {
    yaml_problem(node, "outer surfaces by name are expected: { side: { h: 20 W/m^2/K } }");
    return CAST_OK;
  }
  if (config->coupling.mould_frozen) yaml_problem(node, "a mould that is frozen (coupling.mould) feels no walls");
  config->wall = calloc(yaml_count(node), sizeof *config->wall);
  CAST_CHECK(config->wall, err, CAST_ERR_MEMORY, "no memory for %zu walls", yaml_count(node));
  config->n_walls = yaml_count(node);
  for (size_t i = 0; i < config->n_walls; i++) {
    const char *name = yaml_key(node, i);
    const YamlNode value = yaml_value(node, i);
    if (strlen(name) >= sizeof config->wall->surface)
      yaml_problem(value, "a name of at most %zu letters is expected", sizeof config->wall->surface - 1);
    snprintf(config->wall[i].surface, sizeof config->wall[i].surface, "%s", name);
    read_wall(value, &config->wall[i]);
  }
  return CAST_OK;
}

void config_put_walls(FILE *out, const CastConfig *config)
{
  if (config->n_walls == 0) return;
  fputs("walls:\n", out);
  for (size_t i = 0; i < config->n_walls; i++) {
    const OuterWall *wall = &config->wall[i];
    fputs("  ", out);
    config_put_text(out, wall->surface);
    fprintf(out, ": { emissivity: %.17g", wall->emissivity);
    if (!isnan(wall->h)) fprintf(out, ", h: %.17g W/m^2/K", wall->h);
    if (!isnan(wall->ambient)) fprintf(out, ", ambient: %.17g K", wall->ambient);
    fputs(" }\n", out);
  }
}
