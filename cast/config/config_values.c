/* config_values.c - kinds of values that several sections of cast.yaml have: vectors, boxes, directions, values over
 * time, texts. */
#include "cast/config/config_private.h"

#include <math.h>

/* ---- reading ---- */

void config_read_vector(YamlNode node, const char *unit, double value[3])
{
  if (yaml_exists(node) && !yaml_vector(node, unit, value)) value[0] = value[1] = value[2] = 0.0;
}

void config_read_box(YamlNode node, double corner[3], double size[3])
{
  config_read_vector(yaml_require(node, "corner"), "m", corner);
  const YamlNode size_node = yaml_require(node, "size");
  if (!yaml_exists(size_node) || !yaml_vector(size_node, "m", size)) return;
  for (int d = 0; d < 3; d++)
    if (!(size[d] > 0.0)) {
      yaml_problem(size_node, "each of the three lengths must be above 0 m, %g m was found", size[d]);
      return;
    }
}

bool config_read_direction(YamlNode node, double unit[3])
{
  unit[0] = unit[1] = unit[2] = 0.0;
  if (!yaml_vector(node, "1", unit)) return false;
  const double size = sqrt(unit[0] * unit[0] + unit[1] * unit[1] + unit[2] * unit[2]);
  if (!(size > 0.0)) {
    yaml_problem(node, "a direction is expected, such as [0, 0, 1]; its length does not matter, but must not be 0");
    return false;
  }
  for (int d = 0; d < 3; d++) unit[d] /= size;
  return true;
}

bool config_read_timed(YamlNode node, const char *unit, YamlRange range, Table *table)
{
  *table = (Table){0};
  if (!yaml_exists(node)) return false;
  if (yaml_is_sequence(node)) return material_read_table(node, "s", unit, range, table);
  const double always = 0.0, value = yaml_quantity(node, unit, range, NAN);
  CastError err;
  if (isnan(value)) return false;
  if (table_create(1, &always, &value, table, &err) == CAST_OK) return true;
  yaml_problem(node, "%s", err.message);
  return false;
}

/* ---- writing ---- */

void config_put_vector(FILE *out, const double v[3], const char *unit)
{
  fprintf(out, "[%.17g %s, %.17g %s, %.17g %s]", v[0], unit, v[1], unit, v[2], unit);
}

void config_put_direction(FILE *out, const double v[3])
{
  fprintf(out, "[%.17g, %.17g, %.17g]", v[0], v[1], v[2]);
}

void config_put_timed(FILE *out, const Table *table, const char *unit)
{
  if (table->n == 1) {
    fprintf(out, "%.17g %s", table->y[0], unit);
    return;
  }
  for (size_t i = 0; i < table->n; i++)
    fprintf(out, "%s[%.17g s, %.17g %s]", i ? ", " : "[", table->x[i], table->y[i], unit);
  fputc(']', out);
}

void config_put_text(FILE *out, const char *text)
{
  fputc('"', out);
  for (; *text; text++) {
    if (*text == '"' || *text == '\\') fputc('\\', out);
    if (*text == '\n')
      fputs("\\n", out);
    else
      fputc(*text, out);
  }
  fputc('"', out);
}
