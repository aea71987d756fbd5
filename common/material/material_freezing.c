/* material_freezing.c - between solidus and liquidus: the solid fraction fs(T), 1 below and 0 above. */
#include "common/material/material_private.h"

#include <math.h>
#include <stdlib.h>

static bool check_fraction(YamlNode node, const Table *fs)
{
  for (size_t i = 1; i < fs->n; i++)
    if (fs->y[i] > fs->y[i - 1]) {
      yaml_problem(yaml_item(node, i), "the solid fraction must fall from 1 to 0 as the temperature rises");
      return false;
    }
  if (fs->n >= 2 && fs->y[0] == 1.0 && fs->y[fs->n - 1] == 0.0) return true;
  yaml_problem(node, "the solid fraction must begin at 1 (at the solidus) and end at 0 (at the liquidus)");
  return false;
}

static bool read_fraction(YamlNode node, Material *material)
{
  Table *fs = &material->solid_fraction;
  if (!material_read_table(node, "K", "1", (YamlRange){0.0, 1.0, false}, fs)) return false;
  if (!check_fraction(node, fs)) {
    table_destroy(fs);
    return false;
  }
  material->solidus = fs->x[0];
  material->liquidus = fs->x[fs->n - 1];
  return true;
}

bool material_read_freezing(YamlNode map, bool required, Material *material)
{
  const YamlNode fraction = material_property(map, "solid_fraction"), solidus = material_property(map, "solidus"),
                 liquidus = material_property(map, "liquidus");
  if (yaml_exists(fraction)) {
    if (yaml_exists(solidus) || yaml_exists(liquidus))
      yaml_problem(yaml_exists(solidus) ? solidus : liquidus, "the first and last point of solid_fraction say this");
    return read_fraction(fraction, material);
  }
  if (!yaml_exists(solidus) && !yaml_exists(liquidus) && !required) return false;
  if (!yaml_exists(solidus)) yaml_require(map, "solidus");
  if (!yaml_exists(liquidus)) yaml_require(map, "liquidus");
  material->solidus = yaml_quantity(solidus, "K", YAML_POSITIVE, NAN);
  material->liquidus = yaml_quantity(liquidus, "K", YAML_POSITIVE, NAN);
  if (!isfinite(material->solidus) || !isfinite(material->liquidus)) return false;
  if (material->liquidus > material->solidus) return true;
  yaml_problem(liquidus, "the liquidus must lie above the solidus (for a pure metal leave a tenth of a kelvin)");
  return false;
}

CastStatus material_fraction_linear(Material *material, CastError *err)
{
  const double T[2] = {material->solidus, material->liquidus}, fs[2] = {1.0, 0.0};
  return table_create(2, T, fs, &material->solid_fraction, err);
}

/* Points of the enthalpy curve strictly between solidus and liquidus, and these two themselves. */
static CastStatus fraction_of_curve(Material *material, double E_solidus, double E_liquidus, CastError *err)
{
  const Table *curve = &material->enthalpy;
  double *T = malloc((curve->n + 2) * sizeof *T), *fs = malloc((curve->n + 2) * sizeof *fs);
  CastStatus status = CAST_ERR_MEMORY;
  if (T && fs) {
    size_t n = 0;
    T[n] = material->solidus;
    fs[n++] = 1.0;
    for (size_t i = 0; i < curve->n; i++) {
      if (!(curve->x[i] > material->solidus && curve->x[i] < material->liquidus)) continue;
      T[n] = curve->x[i];
      fs[n++] = (E_liquidus - curve->y[i]) / (E_liquidus - E_solidus);
    }
    T[n] = material->liquidus;
    fs[n++] = 0.0;
    status = table_create(n, T, fs, &material->solid_fraction, err);
  } else {
    cast_error_set(err, status, "no memory for the solid fraction of '%s'", material->name);
  }
  free(T);
  free(fs);
  return status;
}

CastStatus material_fraction_from_enthalpy(Material *material, CastError *err)
{
  const Table *curve = &material->enthalpy;
  const double T_s = material->solidus, T_l = material->liquidus;
  CAST_CHECK(curve->x[0] < T_s && curve->x[curve->n - 1] > T_l, err, CAST_ERR_INPUT,
             "the curve reaches from %g to %g K: it must begin below the solidus %g K and end above the liquidus %g K",
             curve->x[0], curve->x[curve->n - 1], T_s, T_l);
  size_t below = 0, above = curve->n - 1; // the points next to the freezing range, outside
  while (curve->x[below + 1] < T_s) below++;
  while (curve->x[above - 1] > T_l) above--;
  const double E_s = material_enthalpy(material, T_s), E_l = material_enthalpy(material, T_l);
  const double c_s = (E_s - curve->y[below]) / (T_s - curve->x[below]);
  const double c_l = (curve->y[above] - E_l) / (curve->x[above] - T_l);
  material->latent_heat = E_l - E_s - 0.5 * (c_s + c_l) * (T_l - T_s);
  CAST_CHECK(material->latent_heat > 0.0, err, CAST_ERR_INPUT,
             "between solidus %g K and liquidus %g K the curve rises no faster than beside them: no latent heat there",
             T_s, T_l);
  return material->solid_fraction.n ? CAST_OK : fraction_of_curve(material, E_s, E_l, err);
}
