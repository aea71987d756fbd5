/* material_private.h - between material.c (reading) and material_enthalpy.c (the enthalpy curve). */
#ifndef COMMON_MATERIAL_PRIVATE_H
#define COMMON_MATERIAL_PRIVATE_H

#include "common/material.h"

/* Pairs [[x, y], ...] into a table; false, with a problem at the line, if that is not what stands there. */
bool material_read_table(YamlNode node, const char *x_unit, const char *y_unit, Table *table);
/* specific heat, latent heat, solid fraction, enthalpy: fills those fields of the material. */
void material_read_heat(YamlNode map, Material *material);

#endif
