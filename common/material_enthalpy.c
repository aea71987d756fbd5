/* material_enthalpy.c - E(T), the enthalpy curve of a melt, from any of the four ways to give it, and its inverse.
 *
 *   enthalpy: [[T, E], ...]                                        a table
 *   specific_heat {solid, liquid}, latent_heat, solidus, liquidus  (with solid_fraction [[T, fs], ...] or linear between)
 *   cooling_curve {rate, curve: [[t, T], ...]}                     constant extraction, E = E_0 - rate t / rho
 *   identity: true                                                 E = c T with one constant c (the paper's demonstration)
 *
 * Outside the table E(T) goes on with the slope of its end segments, so T(E) is defined everywhere. */
#include "common/material_private.h"

#include <math.h>
#include <stdlib.h>

double material_temperature(const Material *material, double enthalpy)
{
  const Table *curve = &material->enthalpy;
  return table_interpolate_open(curve->y, curve->x, curve->n, enthalpy);
}

double material_enthalpy(const Material *material, double temperature)
{
  const Table *curve = &material->enthalpy;
  return table_interpolate_open(curve->x, curve->y, curve->n, temperature);
}

double material_specific_heat_min(const Material *material)
{
  const Table *curve = &material->enthalpy;
  double least = INFINITY;
  for (size_t i = 0; i + 1 < curve->n; i++)
    least = fmin(least, (curve->y[i + 1] - curve->y[i]) / (curve->x[i + 1] - curve->x[i]));
  return least;
}

static void set_curve(YamlNode where, size_t n, const double *T, const double *E, Material *material)
{
  CastError err;
  if (n < 2) {
    yaml_problem(where, "the enthalpy curve needs at least two points");
    return;
  }
  for (size_t i = 1; i < n; i++)
    if (!(E[i] > E[i - 1])) {
      yaml_problem(where, "enthalpy must rise with temperature, point %zu is not above point %zu", i + 1, i);
      return;
    }
  if (table_create(n, T, E, &material->enthalpy, &err) != CAST_OK) yaml_problem(where, "%s", err.message);
}

static void read_table_curve(YamlNode node, Material *material)
{
  Table table;
  if (material_read_table(node, "K", "J/kg", &table)) set_curve(node, table.n, table.x, table.y, material);
  table_destroy(&table);
}

/* MICRESS style: heat is taken out at a constant rate, so time is enthalpy read backwards (the paper's Fig. 3). */
static void read_cooling_curve(YamlNode node, Material *material)
{
  const double rate = yaml_quantity(yaml_require(node, "rate"), "W/m^3", YAML_POSITIVE, NAN);
  Table curve = {0};
  const YamlNode points = yaml_require(node, "curve");
  if (yaml_exists(points) && material_read_table(points, "s", "K", &curve) && isfinite(rate) &&
      isfinite(material->density)) {
    double *T = malloc(curve.n * sizeof *T), *E = malloc(curve.n * sizeof *E);
    for (size_t i = 0; T && E && i < curve.n; i++) {
      const size_t from = curve.n - 1 - i;
      T[i] = curve.y[from];
      E[i] = rate * (curve.x[curve.n - 1] - curve.x[from]) / material->density;
    }
    if (T && E) set_curve(points, curve.n, T, E, material);
    free(T);
    free(E);
  }
  table_destroy(&curve);
}

/* fs(T): 1 at and below the solidus, 0 at and above the liquidus. */
static bool check_solid_fraction(YamlNode node, const Table *fs)
{
  for (size_t i = 0; i < fs->n; i++) {
    const bool rises = i > 0 && fs->y[i] > fs->y[i - 1];
    if (fs->y[i] < 0.0 || fs->y[i] > 1.0 || rises) {
      yaml_problem(yaml_item(node, i), "the solid fraction must fall from 1 to 0 as the temperature rises");
      return false;
    }
  }
  if (fs->n < 2 || fs->y[0] != 1.0 || fs->y[fs->n - 1] != 0.0) {
    yaml_problem(node, "the solid fraction must begin at 1 (solidus) and end at 0 (liquidus)");
    return false;
  }
  return true;
}

static bool read_solid_fraction(YamlNode map, Material *material)
{
  const YamlNode node = yaml_get(map, "solid_fraction");
  if (yaml_exists(node)) {
    if (!material_read_table(node, "K", "1", &material->solid_fraction)) return false;
    material->solidus = material->solid_fraction.x[0];
    material->liquidus = material->solid_fraction.x[material->solid_fraction.n - 1];
    return check_solid_fraction(node, &material->solid_fraction);
  }
  const YamlNode liquidus = yaml_require(map, "liquidus");
  material->solidus = yaml_quantity(yaml_require(map, "solidus"), "K", YAML_POSITIVE, NAN);
  material->liquidus = yaml_quantity(liquidus, "K", YAML_POSITIVE, NAN);
  if (!isfinite(material->solidus) || !isfinite(material->liquidus)) return false;
  if (!(material->liquidus > material->solidus)) {
    yaml_problem(liquidus, "the liquidus must lie above the solidus (for a pure metal leave a tenth of a kelvin)");
    return false;
  }
  const double T[2] = {material->solidus, material->liquidus}, fs[2] = {1.0, 0.0};
  CastError err;
  return table_create(2, T, fs, &material->solid_fraction, &err) == CAST_OK;
}

enum { STEPS_A_SEGMENT = 8 }; // c varies with fs between two points: E is quadratic there, followed by a polyline

/* dE = (fs c_s + (1 - fs) c_l) dT - L dfs, from E = 0 at absolute zero with the solid's specific heat. */
static void build_from_solid_fraction(YamlNode where, double c_solid, double c_liquid, Material *material)
{
  const Table *fs = &material->solid_fraction;
  const size_t n = (fs->n - 1) * STEPS_A_SEGMENT + 3;
  double *T = malloc(n * sizeof *T), *E = malloc(n * sizeof *E);
  if (T && E) {
    T[0] = 0.0;
    E[0] = 0.0;
    T[1] = fs->x[0];
    E[1] = c_solid * T[1];
    size_t k = 1;
    for (size_t i = 0; i + 1 < fs->n; i++)
      for (int step = 1; step <= STEPS_A_SEGMENT; step++, k++) {
        const double part = (double)step / STEPS_A_SEGMENT, width = (fs->x[i + 1] - fs->x[i]) / STEPS_A_SEGMENT;
        const double dfs = (fs->y[i + 1] - fs->y[i]) / STEPS_A_SEGMENT;
        const double f = fs->y[i] + (fs->y[i + 1] - fs->y[i]) * part - 0.5 * dfs; // at the step's middle
        T[k + 1] = step == STEPS_A_SEGMENT ? fs->x[i + 1] : fs->x[i] + width * step;
        E[k + 1] = E[k] + (f * c_solid + (1.0 - f) * c_liquid) * width - material->latent_heat * dfs;
      }
    T[k + 1] = T[k] + 1000.0;
    E[k + 1] = E[k] + c_liquid * 1000.0;
    set_curve(where, k + 2, T, E, material);
  }
  free(T);
  free(E);
}

static void read_phase_change(YamlNode map, YamlNode heat, Material *material)
{
  double solid = NAN, liquid = NAN;
  if (yaml_is_map(heat)) {
    solid = yaml_quantity(yaml_require(heat, "solid"), "J/kg/K", YAML_POSITIVE, NAN);
    liquid = yaml_quantity(yaml_require(heat, "liquid"), "J/kg/K", YAML_POSITIVE, NAN);
  } else {
    solid = liquid = yaml_quantity(heat, "J/kg/K", YAML_POSITIVE, NAN);
  }
  material->specific_heat = liquid;
  if (read_solid_fraction(map, material) && isfinite(solid) && isfinite(liquid) && isfinite(material->latent_heat))
    build_from_solid_fraction(heat, solid, liquid, material);
}

static void read_identity(YamlNode node, YamlNode heat, Material *material)
{
  if (!yaml_boolean(node, false)) return;
  if (!isfinite(material->specific_heat)) {
    yaml_problem(node, "needs a constant specific_heat%s", yaml_exists(heat) ? "" : ", which is missing");
    return;
  }
  const double T[2] = {0.0, 1000.0}, E[2] = {0.0, 1000.0 * material->specific_heat};
  set_curve(node, 2, T, E, material);
}

void material_read_heat(YamlNode map, Material *material)
{
  YamlNode heat = yaml_get(map, "specific_heat");
  if (yaml_is_map(heat)) { // {value, source, ...}, {solid, liquid, source, ...}
    static const char *const REMARKS[] = {"source", "doi", "range", "note", "quality"};
    for (size_t i = 0; i < 5; i++) yaml_string(yaml_get(heat, REMARKS[i]), NULL);
    if (yaml_exists(yaml_get(heat, "value"))) heat = yaml_get(heat, "value");
  }
  const YamlNode table = yaml_get(map, "enthalpy"), curve = yaml_get(map, "cooling_curve");
  const YamlNode identity = yaml_get(map, "identity"), latent = yaml_get(map, "latent_heat");
  const int ways = yaml_exists(table) + yaml_exists(curve) + yaml_exists(identity) + yaml_exists(latent);
  if (ways > 1) {
    yaml_problem(map, "give one of enthalpy, cooling_curve, identity, latent_heat: they say the same thing");
    return;
  }
  if (yaml_exists(latent)) {
    YamlNode value = latent;
    if (yaml_is_map(latent)) {
      yaml_string(yaml_get(latent, "source"), NULL);
      yaml_string(yaml_get(latent, "quality"), NULL);
      value = yaml_require(latent, "value");
    }
    material->latent_heat = yaml_quantity(value, "J/kg", YAML_POSITIVE, NAN);
    if (!yaml_exists(heat)) yaml_require(map, "specific_heat");
    else read_phase_change(map, heat, material);
    return;
  }
  if (yaml_is_scalar(heat)) material->specific_heat = yaml_quantity(heat, "J/kg/K", YAML_POSITIVE, NAN);
  if (yaml_exists(table)) read_table_curve(table, material);
  if (yaml_exists(curve)) read_cooling_curve(curve, material);
  if (yaml_exists(identity)) read_identity(identity, heat, material);
  if (ways == 0 && !yaml_exists(heat)) yaml_require(map, "specific_heat");
}
