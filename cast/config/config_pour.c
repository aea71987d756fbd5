/* config_pour.c - `melt.inlets:` and `melt.outlets:` of cast.yaml, read and written.
 *   inlets:
 *     - disc: { centre: [..], radius: 3 mm }  |  rectangle: { centre: [..], along: [1, 0, 0], width: .., height: .. }
 *       direction: [0, 0, -1]
 *       velocity: 0.5 m/s  |  flow: 2 cm^3/s  |  mass_flow: 14 g/s         each, like the temperature, also over time:
 *       temperature: 1150 degC                                             [[0 s, 14 g/s], [0.8 s, 14 g/s], [1 s, 0
 * g/s]] at_end: taken-away  |  plug outlets:
 *     - box: { corner: [..], size: [..] }  |  plane: { point: [..], normal: [..] }  |  surface: vent */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/config/config_private.h"

static const char *const RATES[] = {"velocity", "flow", "mass_flow"};
static const char *const RATE_UNITS[] = {"m/s", "m^3/s", "kg/s"};
static const char *const ENDS[] = {"taken-away", "plug", NULL};

/* ---- inlets ---- */

static void read_rectangle(YamlNode node, InletConfig *inlet)
{
  config_read_vector(yaml_require(node, "centre"), "m", inlet->centre);
  const YamlNode along = yaml_require(node, "along");
  inlet->width = yaml_quantity(yaml_require(node, "width"), "m", YAML_POSITIVE, 1.0);
  inlet->height = yaml_quantity(yaml_require(node, "height"), "m", YAML_POSITIVE, 1.0);
  if (!config_read_direction(along, inlet->along)) return;
  double dot = 0.0;
  for (int d = 0; d < 3; d++) dot += inlet->along[d] * inlet->direction[d];
  if (fabs(dot) > 1e-6) yaml_problem(along, "must be across the inlet's direction");
}

static void read_rate(YamlNode node, InletConfig *inlet)
{
  int given = 0;
  for (int k = 0; k < 3; k++) {
    const YamlNode rate = yaml_get(node, RATES[k]);
    if (!yaml_exists(rate)) continue;
    if (given++ == 0) {
      inlet->kind = (InletRate)k;
      config_read_timed(rate, RATE_UNITS[k], YAML_NON_NEGATIVE, &inlet->rate);
    }
  }
  if (given != 1) yaml_problem(node, "exactly one of velocity, flow and mass_flow is expected");
}

/* Melt that is locked does not come in. */
static void check_flows(YamlNode node, const InletConfig *inlet, const Material *melt)
{
  if (!isfinite(melt->density) || melt->solid_fraction.n == 0 || !(melt->coherency_fraction > 0.0)) return;
  const double least = material_temperature_of_fraction(melt, melt->coherency_fraction);
  for (size_t i = 0; i < inlet->temperature.n; i++)
    if (inlet->temperature.y[i] <= least) {
      yaml_problem(node, "melt of %g K does not flow: '%s' is a skeleton of solid below %g K", inlet->temperature.y[i],
                   melt->name, least);
      return;
    }
}

static CastStatus read_inlet(YamlNode node, const CastConfig *config, InletConfig *inlet, CastError *err)
{
  const YamlNode disc = yaml_get(node, "disc"), rectangle = yaml_get(node, "rectangle"),
                 temperature = yaml_get(node, "temperature");
  config_read_direction(yaml_require(node, "direction"), inlet->direction);
  inlet->disc = yaml_exists(disc);
  if (inlet->disc) {
    config_read_vector(yaml_require(disc, "centre"), "m", inlet->centre);
    inlet->radius = yaml_quantity(yaml_require(disc, "radius"), "m", YAML_POSITIVE, 1.0);
  }
  if (yaml_exists(rectangle)) read_rectangle(rectangle, inlet);
  if (yaml_is_map(node) && yaml_exists(disc) == yaml_exists(rectangle))
    yaml_problem(node, "exactly one of disc and rectangle is expected");
  read_rate(node, inlet);
  inlet->stays = yaml_choice(yaml_get(node, "at_end"), ENDS, 0) == 1;
  const double always = 0.0, same = config->melt_temperature;
  if (yaml_exists(temperature))
    config_read_timed(temperature, "K", YAML_POSITIVE, &inlet->temperature);
  else if (isfinite(same))
    CAST_CALL(table_create(1, &always, &same, &inlet->temperature, err));
  check_flows(yaml_exists(temperature) ? temperature : node, inlet, &config->melt);
  return CAST_OK;
}

/* ---- outlets ---- */

static void read_outlet(YamlNode node, OutletConfig *outlet)
{
  const YamlNode box = yaml_get(node, "box"), plane = yaml_get(node, "plane"), surface = yaml_get(node, "surface");
  outlet->kind = yaml_exists(box) ? OUTLET_BOX : yaml_exists(plane) ? OUTLET_PLANE : OUTLET_SURFACE;
  if (yaml_is_map(node) && yaml_exists(box) + yaml_exists(plane) + yaml_exists(surface) != 1)
    yaml_problem(node, "exactly one of box, plane and surface is expected");
  if (yaml_exists(box)) config_read_box(box, outlet->corner, outlet->size);
  if (yaml_exists(plane)) {
    config_read_vector(yaml_require(plane, "point"), "m", outlet->point);
    config_read_direction(yaml_require(plane, "normal"), outlet->normal);
  }
  const char *name = yaml_string(surface, "");
  if (strlen(name) >= sizeof outlet->surface) yaml_problem(surface, "no surface has a name that long");
  snprintf(outlet->surface, sizeof outlet->surface, "%s", name);
}

/* ---- both ---- */

static bool is_list(YamlNode node, const char *what)
{
  if (!yaml_exists(node)) return false;
  if (yaml_is_sequence(node) && yaml_count(node) > 0) return true;
  yaml_problem(node, "a list is expected: [{ %s }]", what);
  return false;
}

CastStatus config_read_pour(YamlNode melt, CastConfig *config, CastError *err)
{
  const YamlNode inlets = yaml_get(melt, "inlets"), outlets = yaml_get(melt, "outlets");
  if (is_list(inlets, "disc: {...}, direction: [...], flow: ...")) {
    config->inlet = calloc(yaml_count(inlets), sizeof *config->inlet);
    CAST_CHECK(config->inlet, err, CAST_ERR_MEMORY, "no memory for %zu inlets", yaml_count(inlets));
    config->n_inlets = yaml_count(inlets);
    for (size_t i = 0; i < config->n_inlets; i++)
      CAST_CALL(read_inlet(yaml_item(inlets, i), config, &config->inlet[i], err));
  }
  if (is_list(outlets, "surface: ...")) {
    config->outlet = calloc(yaml_count(outlets), sizeof *config->outlet);
    CAST_CHECK(config->outlet, err, CAST_ERR_MEMORY, "no memory for %zu outlets", yaml_count(outlets));
    config->n_outlets = yaml_count(outlets);
    for (size_t i = 0; i < config->n_outlets; i++) read_outlet(yaml_item(outlets, i), &config->outlet[i]);
  }
  return CAST_OK;
}

void config_destroy_pour(CastConfig *config)
{
  for (size_t i = 0; i < config->n_inlets; i++) {
    table_destroy(&config->inlet[i].rate);
    table_destroy(&config->inlet[i].temperature);
  }
  free(config->inlet);
  free(config->outlet);
}

/* ---- the resolved input ---- */

static void put_inlet(FILE *out, const InletConfig *inlet)
{
  fprintf(out, "    - %s:\n        centre: ", inlet->disc ? "disc" : "rectangle");
  config_put_vector(out, inlet->centre, "m");
  if (inlet->disc) {
    fprintf(out, "\n        radius: %.17g m\n", inlet->radius);
  } else {
    fputs("\n        along: ", out);
    config_put_direction(out, inlet->along);
    fprintf(out, "\n        width: %.17g m\n        height: %.17g m\n", inlet->width, inlet->height);
  }
  fputs("      direction: ", out);
  config_put_direction(out, inlet->direction);
  fprintf(out, "\n      %s: ", RATES[inlet->kind]);
  config_put_timed(out, &inlet->rate, RATE_UNITS[inlet->kind]);
  fputs("\n      temperature: ", out);
  config_put_timed(out, &inlet->temperature, "K");
  fprintf(out, "\n      at_end: %s\n", ENDS[inlet->stays]);
}

static void put_outlet(FILE *out, const OutletConfig *outlet)
{
  if (outlet->kind == OUTLET_SURFACE) {
    fputs("    - surface: ", out);
    config_put_text(out, outlet->surface);
  } else if (outlet->kind == OUTLET_BOX) {
    fputs("    - box:\n        corner: ", out);
    config_put_vector(out, outlet->corner, "m");
    fputs("\n        size: ", out);
    config_put_vector(out, outlet->size, "m");
  } else {
    fputs("    - plane:\n        point: ", out);
    config_put_vector(out, outlet->point, "m");
    fputs("\n        normal: ", out);
    config_put_direction(out, outlet->normal);
  }
  fputc('\n', out);
}

void config_put_pour(FILE *out, const CastConfig *config)
{
  if (config->n_inlets) fputs("  inlets:\n", out);
  for (size_t i = 0; i < config->n_inlets; i++) put_inlet(out, &config->inlet[i]);
  if (config->n_outlets) fputs("  outlets:\n", out);
  for (size_t i = 0; i < config->n_outlets; i++) put_outlet(out, &config->outlet[i]);
}
