/* material.h - what the mould and the melt are made of; from share/materials/NAME.yaml or inline in an input file.
 * All SI. A mould material needs density, specific heat and conductivity (constant: the ROM is linear). A melt needs
 * in addition its enthalpy and viscosity. */
#ifndef COMMON_MATERIAL_MATERIAL_H
#define COMMON_MATERIAL_MATERIAL_H

#include "common/input/yaml_input.h"
#include "common/table.h"

typedef struct Material {
  char name[64];
  char *text;           // the YAML it came from (owned), for provenance
  char sha256[65];      // of text
  double density;       // kg/m3 (melt: liquid)
  double specific_heat; // J/(kg K), constant (mould); melts: of the liquid, from the curve's last segment if given so
  double conductivity;  // W/(m K), constant (mould); melts: of the liquid
  double reference_temperature; // K at which the constants were taken; NAN if the source does not say
  double solidus, liquidus;     // K; NAN if the material does not melt
  double latent_heat;           // J/kg; 0 if none or if a curve is given without its freezing range
  Table enthalpy;               // T [K] -> E [J/kg], strictly increasing in both; n = 0 for a mould material
  Table solid_fraction;         // T [K] -> solid fraction [1], decreasing; n = 0 if the material does not melt
  Table conductivity_of_t;      // T [K] -> W/(m K); n >= 1 for a melt
  Table viscosity_of_t;         // T [K] -> Pa s; n >= 1 for a melt
  Table surface_tension_of_t;   // T [K] -> N/m; n = 0 if not given
  double surface_tension;       // N/m, at the highest temperature given; NAN if not given
  double contact_angle;         // rad, on the mould; NAN if not given
  double coherency_fraction;    // solid fraction at which flow stops; NAN if not given
  double dendrite_arm_spacing;  // m, of the mush that drags on the flow; NAN if not given: none does
  double arm_spacing_at_1s;     // m, of secondary arms after a local solidification time of 1 s; NAN if not given
  double arm_spacing_exponent;  // 1, their spacing grows with that power of it
} Material;

/* Read the material that `node` names: a scalar is the name of a file share/materials/NAME.yaml (searched in
 * $CAST_SHARE, the installed and the source share folder) or a path relative to the input file; a map is the material
 * itself. Faults in an inline map become problems of the input; faults in a file are returned.
 * Errors: CAST_ERR_INPUT, CAST_ERR_IO. */
CastStatus material_read(YamlNode node, Material *material, CastError *err);
void material_destroy(Material *material);

/* Pairs [[x, y], ...] with x strictly rising into a table; false, with a problem at the line, if that is not what
 * stands there. Absolute temperatures (unit "K") must be above 0. */
bool material_read_table(YamlNode node, const char *x_unit, const char *y_unit, YamlRange y_range, Table *table);

/* Does the material have what a mould (constant specific heat and conductivity) or a melt (enthalpy, viscosity) needs?
 * Errors: CAST_ERR_INPUT, naming the material and what it lacks. */
CastStatus material_check_mould(const Material *material, CastError *err);
CastStatus material_check_melt(const Material *material, CastError *err);

double material_temperature(const Material *material, double enthalpy); // T(E), K; extrapolates with the end slopes
double material_enthalpy(const Material *material, double temperature); // E(T), J/kg; the exact inverse
double material_temperature_of_fraction(const Material *material, double fraction); // K, the highest that has it
double material_specific_heat_min(const Material *material); // smallest dE/dT, J/(kg K): limits conduction steps
#endif
