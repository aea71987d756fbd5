/* material_private.h - between material.c (reading), material_find.c (where the file is), material_enthalpy.c (the
 * enthalpy curve) and material_freezing.c (solid fraction). */
#ifndef COMMON_MATERIAL_MATERIAL_PRIVATE_H
#define COMMON_MATERIAL_MATERIAL_PRIVATE_H

#include "common/material/material.h"

/* The value of a property: the node itself, or the `value` of a map {value, source, quality, doi, range, note}. */
YamlNode material_property(YamlNode map, const char *key);
/* Where a property comes from, for keys beside the value; the text itself travels with every ROM and result. */
void material_read_remarks(YamlNode map);

/* specific heat, latent heat, solid fraction, enthalpy: fills those fields of the material. */
void material_read_heat(YamlNode map, Material *material);

/* solidus and liquidus, or the table solid_fraction: fills solidus, liquidus and, if a table is given, solid_fraction.
 * False, with a problem unless nothing is given and nothing `required`, if the material then has no freezing range. */
bool material_read_freezing(YamlNode map, bool required, Material *material);
/* Solid fraction falling linearly with temperature between solidus and liquidus. */
CastStatus material_fraction_linear(Material *material, CastError *err);
/* Solid fraction and latent heat from the enthalpy curve, which must reach beyond solidus and liquidus:
 * fs = (E(T_l) - E)/(E(T_l) - E(T_s)), L = E(T_l) - E(T_s) - (c_s + c_l)/2 (T_l - T_s). A given fraction is kept. */
CastStatus material_fraction_from_enthalpy(Material *material, CastError *err);

/* The file that a material's name or path means; false, with a problem, if there is none. */
bool material_find_file(YamlNode node, const char *name, char *path, size_t size);

#endif
