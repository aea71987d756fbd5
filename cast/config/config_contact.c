/* config_contact.c - `contact:` of cast.yaml, read and written.
 *   contact: { h: 2000 W/m^2/K }  |  { perfect: true }  |  { h: { temperature: [[T, h], ...] } }
 *          | { h: { solid_fraction: [[fs, h], ...] } }, each with surfaces: { NAME: one of these } beside it */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/config/config_private.h"

static void read_table(YamlNode h, ContactLaw *law)
{
  const YamlNode temperature = yaml_get(h, "temperature"), fraction = yaml_get(h, "solid_fraction");
  if (yaml_exists(temperature) == yaml_exists(fraction)) {
    yaml_problem(h, "a heat transfer coefficient, or one table of it, temperature or solid_fraction, is expected");
    return;
  }
  const bool of_temperature = yaml_exists(temperature);
  law->basis = of_temperature ? CONTACT_OF_TEMPERATURE : CONTACT_OF_SOLID_FRACTION;
  const YamlNode points = of_temperature ? temperature : fraction;
  if (!material_read_table(points, of_temperature ? "K" : "1", "W/m^2/K", YAML_POSITIVE, &law->table)) return;
  if (of_temperature) return;
  for (size_t i = 0; i < law->table.n; i++)
    if (law->table.x[i] < 0.0 || law->table.x[i] > 1.0)
      yaml_problem(yaml_item(points, i), "a solid fraction from 0 to 1 is expected, %g was found", law->table.x[i]);
}

static void read_law(YamlNode node, const Material *melt, ContactLaw *law)
{
  const YamlNode h = yaml_get(node, "h"), perfect = yaml_get(node, "perfect");
  law->h = INFINITY;
  if (yaml_is_map(h))
    read_table(h, law);
  else if (yaml_exists(h))
    law->h = yaml_quantity(h, "W/m^2/K", YAML_POSITIVE, NAN);
  if (yaml_is_map(node) && yaml_exists(h) == yaml_boolean(perfect, false))
    yaml_problem(node, "exactly one of h (a heat transfer coefficient or a table of it) and perfect: true is expected");
  if (law->basis == CONTACT_OF_SOLID_FRACTION && isfinite(melt->density) && melt->solid_fraction.n == 0)
    yaml_problem(h, "depends on the solid fraction, and the melt '%s' has none (solidus, liquidus or solid_fraction)",
                 melt->name);
}

static CastStatus read_surfaces(YamlNode node, CastConfig *config, CastError *err)
{
  if (!yaml_exists(node)) return CAST_OK;
  if (!yaml_is_map(node) || yaml_count(node) == 0) {
    yaml_problem(node, "cavity surfaces by name are expected: { pins: { h: ... } }");
    return CAST_OK;
  }
  ContactLaws *laws = &config->contact;
  laws->surface = calloc(yaml_count(node), sizeof *laws->surface);
  CAST_CHECK(laws->surface, err, CAST_ERR_MEMORY, "no memory for %zu surfaces", yaml_count(node));
  laws->n = yaml_count(node);
  for (size_t k = 0; k < laws->n; k++) {
    const char *name = yaml_key(node, k);
    const YamlNode value = yaml_value(node, k);
    if (strlen(name) >= sizeof laws->surface->surface)
      yaml_problem(value, "a name of at most %zu letters is expected", sizeof laws->surface->surface - 1);
    snprintf(laws->surface[k].surface, sizeof laws->surface->surface, "%s", name);
    if (!yaml_is_map(value)) yaml_problem(value, "{ h: ... } or { perfect: true } is expected");
    read_law(value, &config->melt, &laws->surface[k].law);
  }
  return CAST_OK;
}

CastStatus config_read_contact(YamlNode node, CastConfig *config, CastError *err)
{
  read_law(node, &config->melt, &config->contact.elsewhere);
  CAST_CALL(read_surfaces(yaml_get(node, "surfaces"), config, err));
  const ContactLaw *all = &config->contact.elsewhere;
  config->coupling.h_contact = all->basis == CONTACT_CONSTANT ? all->h : (double)NAN;
  config->coupling.contact = &config->contact;
  return CAST_OK;
}

/* ---- the resolved input ---- */

static void put_law(FILE *out, const ContactLaw *law)
{
  if (law->basis == CONTACT_CONSTANT) {
    if (isinf(law->h))
      fputs("perfect: true", out);
    else
      fprintf(out, "h: %.17g W/m^2/K", law->h);
    return;
  }
  const bool of_temperature = law->basis == CONTACT_OF_TEMPERATURE;
  fprintf(out, "h: { %s: [", of_temperature ? "temperature" : "solid_fraction");
  for (size_t i = 0; i < law->table.n; i++)
    fprintf(out, "%s[%.17g%s, %.17g W/m^2/K]", i ? ", " : "", law->table.x[i], of_temperature ? " K" : "",
            law->table.y[i]);
  fputs("] }", out);
}

void config_put_contact(FILE *out, const CastConfig *config)
{
  fputs("contact:\n  ", out);
  put_law(out, &config->contact.elsewhere);
  if (config->contact.n) fputs("\n  surfaces:", out);
  for (size_t k = 0; k < config->contact.n; k++) {
    fputs("\n    ", out);
    config_put_text(out, config->contact.surface[k].surface);
    fputs(": { ", out);
    put_law(out, &config->contact.surface[k].law);
    fputs(" }", out);
  }
  fputc('\n', out);
}
