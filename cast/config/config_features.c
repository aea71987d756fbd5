/* config_features.c - `features:` of cast.yaml, read and written: boxes whose filling is told beside that of the
 * cavity's named surfaces. features: [{ name: tips, low: [-4 mm, -4 mm, 8 mm], high: [4 mm, 4 mm, 9 mm] }] */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/config/config_private.h"

static void read_feature(YamlNode node, FeatureBox *box)
{
  const YamlNode name_node = yaml_require(node, "name"), low = yaml_require(node, "low"),
                 high = yaml_require(node, "high");
  const char *name = yaml_string(name_node, "");
  if (strlen(name) >= sizeof box->name || strpbrk(name, ",\"\n"))
    yaml_problem(name_node, "a name of at most %zu letters without commas, quotes and line ends is expected",
                 sizeof box->name - 1);
  if (strcmp(name, "part") == 0 || strcmp(name, "whole cavity") == 0)
    yaml_problem(name_node, "'%s' has a meaning of its own; take another name", name);
  snprintf(box->name, sizeof box->name, "%s", name);
  config_read_vector(low, "m", box->low);
  config_read_vector(high, "m", box->high);
  for (int d = 0; d < 3 && yaml_exists(low) && yaml_exists(high); d++) {
    if (box->low[d] < box->high[d]) continue;
    yaml_problem(high, "along %c it is %g m, which is not above low's %g m", "xyz"[d], box -> high[d], box -> low[d]);
    return;
  }
}

CastStatus config_read_features(YamlNode node, CastConfig *config, CastError *err)
{
  if (!yaml_exists(node)) return CAST_OK;
  if (!yaml_is_sequence(node) || yaml_count(node) == 0) {
    yaml_problem(node, "a list of boxes is expected: [{name: tips, low: [...], high: [...]}]");
    return CAST_OK;
  }
  config->feature = calloc(yaml_count(node), sizeof *config->feature);
  CAST_CHECK(config->feature, err, CAST_ERR_MEMORY, "no memory for %zu features", yaml_count(node));
  config->n_features = yaml_count(node);
  for (size_t i = 0; i < config->n_features; i++) {
    const YamlNode item = yaml_item(node, i);
    read_feature(item, &config->feature[i]);
    for (size_t k = 0; k < i; k++)
      if (config->feature[i].name[0] && strcmp(config->feature[k].name, config->feature[i].name) == 0)
        yaml_problem(item, "the name '%s' is used twice", config->feature[i].name);
  }
  return CAST_OK;
}

void config_put_features(FILE *out, const CastConfig *config)
{
  if (config->n_features == 0) return;
  fputs("features:\n", out);
  for (size_t i = 0; i < config->n_features; i++) {
    const FeatureBox *box = &config->feature[i];
    fputs("  - name: ", out);
    config_put_text(out, box->name);
    fputs("\n    low: ", out);
    config_put_vector(out, box->low, "m");
    fputs("\n    high: ", out);
    config_put_vector(out, box->high, "m");
    fputc('\n', out);
  }
}
