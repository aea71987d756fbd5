/* material_enthalpy.c - E(T), the enthalpy curve of a melt, from any of the four ways to give it, and its inverse.
 *
 *   enthalpy: [[T, E], ...]                                        a table
 *   specific_heat {solid, liquid}, latent_heat, solidus, liquidus  (with solid_fraction [[T, fs], ...] or linear
 * between) cooling_curve {rate, curve: [[t, T], ...]}                     constant extraction, E = E_0 - rate t / rho
 *   identity: true                                                 E = c T with one constant c (the paper's
 * demonstration)
 *
 * Outside the table E(T) goes on with the slope of its end segments, so T(E) is defined everywhere. */
#include "common/material/material_private.h"

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

double material_temperature_of_fraction(const Material *material, double fraction)
{
  const Table *fs = &material->solid_fraction; // falls from 1 to 0
  size_t i = fs->n - 1;
  while (i > 0 && fs->y[i - 1] < fraction) i--;
  if (i == 0 || fs->y[i] >= fraction) return fs->x[i];
  return fs->x[i] - (fs->x[i] - fs->x[i - 1]) * ((fraction - fs->y[i]) / (fs->y[i - 1] - fs->y[i]));
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
  if (table_create(n, T, E, &material->enthalpy, &err) != CAST_OK) yaml_problem(where, "%s", err.message);
  const size_t last = n - 1;
  if (material->enthalpy.n && !isfinite(material->specific_heat))
    material->specific_heat = (E[last] - E[last - 1]) / (T[last] - T[last - 1]); // of the liquid
}

static void read_table_curve(YamlNode node, Material *material)
{
  Table table;
  if (!material_read_table(node, "K", "J/kg", YAML_ANY, &table)) return;
  bool good = table.n >= 2;
  if (!good) yaml_problem(node, "the enthalpy curve needs at least two points");
  for (size_t i = 1; i < table.n; i++)
    if (!(table.y[i] > table.y[i - 1])) {
      yaml_problem(yaml_item(node, i), "enthalpy must rise strictly with temperature");
      good = false;
    }
  if (good) set_curve(node, table.n, table.x, table.y, material);
  table_destroy(&table);
}

/* Heat is taken out at a constant rate per volume, so time is enthalpy read backwards: E(T) = rate (t_end - t)/rho. */
static void curve_of_cooling(YamlNode points, double rate, const Table *cooling, Material *material)
{
  const size_t n = cooling->n;
  double *T = malloc(n * sizeof *T), *E = malloc(n * sizeof *E);
  if (T && E) {
    for (size_t i = 0; i < n; i++) {
      T[i] = cooling->y[n - 1 - i];
      E[i] = rate * (cooling->x[n - 1] - cooling->x[n - 1 - i]) / material->density;
    }
    set_curve(points, n, T, E, material);
  } else {
    yaml_problem(points, "no memory for a curve of %zu points", n);
  }
  free(T);
  free(E);
}

/* As the microstructure simulator MICRESS gives it (the paper's Fig. 3). */
static void read_cooling_curve(YamlNode node, Material *material)
{
  const double rate = yaml_quantity(yaml_require(node, "rate"), "W/m^3", YAML_POSITIVE, NAN);
  const YamlNode points = yaml_require(node, "curve");
  if (yaml_is_map(node)) material_read_remarks(node);
  Table cooling;
  if (!yaml_exists(points) || !material_read_table(points, "s", "K", YAML_POSITIVE, &cooling)) return;
  bool good = cooling.n >= 2 && isfinite(rate) && isfinite(material->density);
  if (cooling.n < 2) yaml_problem(points, "the cooling curve needs at least two points");
  for (size_t i = 1; i < cooling.n; i++)
    if (!(cooling.y[i] < cooling.y[i - 1])) {
      yaml_problem(yaml_item(points, i),
                   "the temperature must fall strictly with time (tilt a plateau by 0.1 K, smooth a "
                   "recalescence away)");
      good = false;
    }
  if (good) curve_of_cooling(points, rate, &cooling, material);
  table_destroy(&cooling);
}

enum { STEPS_A_SEGMENT = 8 }; // c varies with fs between two points: E is quadratic there, followed by a polyline

/* dE = (fs c_s + (1 - fs) c_l) dT - L dfs, from E = 0 at absolute zero with the solid's specific heat. */
static void fill_curve(const Material *material, double c_solid, double c_liquid, double *T, double *E)
{
  const Table *fs = &material->solid_fraction;
  size_t k = 1;
  T[0] = E[0] = 0.0;
  T[1] = fs->x[0];
  E[1] = c_solid * T[1];
  for (size_t i = 0; i + 1 < fs->n; i++) {
    const double width = (fs->x[i + 1] - fs->x[i]) / STEPS_A_SEGMENT;
    const double dfs = (fs->y[i + 1] - fs->y[i]) / STEPS_A_SEGMENT;
    for (int step = 1; step <= STEPS_A_SEGMENT; step++, k++) {
      const double f = fs->y[i] + dfs * (step - 0.5); // at the step's middle, exact for c linear in fs
      T[k + 1] = step == STEPS_A_SEGMENT ? fs->x[i + 1] : fs->x[i] + width * step;
      E[k + 1] = E[k] + (f * c_solid + (1.0 - f) * c_liquid) * width - material->latent_heat * dfs;
    }
  }
  T[k + 1] = T[k] + 1000.0;
  E[k + 1] = E[k] + c_liquid * 1000.0;
}

static void build_from_solid_fraction(YamlNode where, double c_solid, double c_liquid, Material *material)
{
  const size_t n = (material->solid_fraction.n - 1) * STEPS_A_SEGMENT + 3;
  double *T = malloc(n * sizeof *T), *E = malloc(n * sizeof *E);
  if (T && E) {
    fill_curve(material, c_solid, c_liquid, T, E);
    set_curve(where, n, T, E, material);
  } else {
    yaml_problem(where, "no memory for a curve of %zu points", n);
  }
  free(T);
  free(E);
}

typedef struct SpecificHeat {
  bool given, two_phases;
  double solid, liquid; // J/(kg K); NAN if not given
} SpecificHeat;

/* A value, {value, source, ...} or {solid, liquid, source, ...}. */
static SpecificHeat read_specific_heat(YamlNode map)
{
  const YamlNode node = yaml_get(map, "specific_heat");
  SpecificHeat heat = {.given = yaml_exists(node), .solid = NAN, .liquid = NAN};
  if (!yaml_is_map(node)) {
    heat.solid = heat.liquid = yaml_quantity(node, "J/kg/K", YAML_POSITIVE, NAN);
    return heat;
  }
  material_read_remarks(node);
  const YamlNode solid = yaml_get(node, "solid"), liquid = yaml_get(node, "liquid"), value = yaml_get(node, "value");
  heat.two_phases = yaml_exists(solid) || yaml_exists(liquid);
  if (heat.two_phases == yaml_exists(value)) {
    yaml_problem(node, "either value, or solid and liquid, is expected");
  } else if (heat.two_phases) {
    heat.solid = yaml_quantity(yaml_require(node, "solid"), "J/kg/K", YAML_POSITIVE, NAN);
    heat.liquid = yaml_quantity(yaml_require(node, "liquid"), "J/kg/K", YAML_POSITIVE, NAN);
  } else {
    heat.solid = heat.liquid = yaml_quantity(value, "J/kg/K", YAML_POSITIVE, NAN);
  }
  return heat;
}

static void read_phase_change(YamlNode map, YamlNode latent, const SpecificHeat *heat, Material *material)
{
  CastError err;
  material->latent_heat = yaml_quantity(latent, "J/kg", YAML_POSITIVE, NAN);
  if (!heat->given) yaml_require(map, "specific_heat");
  if (!material_read_freezing(map, true, material)) return;
  if (!material->solid_fraction.n && material_fraction_linear(material, &err) != CAST_OK)
    yaml_problem(latent, "%s", err.message);
  else if (isfinite(heat->solid) && isfinite(heat->liquid) && isfinite(material->latent_heat))
    build_from_solid_fraction(latent, heat->solid, heat->liquid, material);
}

/* A curve given point by point: the specific heat is in it; the freezing range may be named beside it. */
static void read_whole_curve(YamlNode map, YamlNode table, YamlNode cooling, const SpecificHeat *heat,
                             Material *material)
{
  const YamlNode where = yaml_exists(table) ? table : cooling;
  if (heat->given) yaml_problem(yaml_get(map, "specific_heat"), "the enthalpy curve contains it: leave it out");
  material->specific_heat = NAN;
  if (yaml_exists(table))
    read_table_curve(table, material);
  else
    read_cooling_curve(cooling, material);
  CastError err;
  if (material_read_freezing(map, false, material) && material->enthalpy.n &&
      material_fraction_from_enthalpy(material, &err) != CAST_OK)
    yaml_problem(where, "%s", err.message);
}

/* A freezing range has no meaning without the heat that is released in it. */
static void refuse_freezing(YamlNode map)
{
  static const char *const FREEZING[] = {"solidus", "liquidus", "solid_fraction"};
  for (size_t i = 0; i < sizeof FREEZING / sizeof *FREEZING; i++) {
    const YamlNode node = yaml_get(map, FREEZING[i]);
    if (yaml_exists(node)) yaml_problem(node, "needs latent_heat, enthalpy or cooling_curve beside it");
  }
}

static void read_identity(YamlNode map, YamlNode identity, const SpecificHeat *heat, Material *material)
{
  refuse_freezing(map);
  if (!yaml_boolean(identity, false)) return;
  if (!heat->given) yaml_require(map, "specific_heat");
  const double T[2] = {0.0, 1000.0}, E[2] = {0.0, 1000.0 * heat->liquid};
  if (heat->two_phases)
    yaml_problem(identity, "needs one constant specific_heat");
  else if (isfinite(heat->liquid))
    set_curve(identity, 2, T, E, material);
}

static void read_without_melting(YamlNode map, const SpecificHeat *heat)
{
  refuse_freezing(map);
  if (!heat->given) yaml_require(map, "specific_heat");
  if (heat->two_phases) yaml_problem(yaml_get(map, "specific_heat"), "solid and liquid need latent_heat beside them");
}

/* Which of the ways counts cannot be known; the keys of all of them are. */
static void refuse_two_curves(YamlNode map)
{
  yaml_problem(map, "give one of enthalpy, cooling_curve, identity and latent_heat: each says the whole curve");
  yaml_get(map, "solidus");
  yaml_get(map, "liquidus");
  yaml_get(map, "solid_fraction");
}

void material_read_heat(YamlNode map, Material *material)
{
  const SpecificHeat heat = read_specific_heat(map);
  const YamlNode table = material_property(map, "enthalpy"), cooling = yaml_get(map, "cooling_curve");
  const YamlNode identity = yaml_get(map, "identity"), latent = material_property(map, "latent_heat");
  material->specific_heat = heat.liquid;
  if (yaml_exists(table) + yaml_exists(cooling) + yaml_exists(identity) + yaml_exists(latent) > 1)
    refuse_two_curves(map);
  else if (yaml_exists(latent))
    read_phase_change(map, latent, &heat, material);
  else if (yaml_exists(table) || yaml_exists(cooling))
    read_whole_curve(map, table, cooling, &heat, material);
  else if (yaml_exists(identity))
    read_identity(map, identity, &heat, material);
  else
    read_without_melting(map, &heat);
}
