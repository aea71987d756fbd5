/* config_private.h - what the files of the configuration share.
 *   config.c  reading                   config_resolved.c  writing
 *   config_contact.c  `contact:`        config_walls.c  `walls:`            config_forces.c  `forces:`
 *   config_pour.c  `melt.inlets:`, `melt.outlets:`                          config_features.c  `features:`
 *   config_tension.c  `surface_tension:`, each both ways                    config_values.c  values, both ways */
#ifndef CAST_CONFIG_CONFIG_PRIVATE_H
#define CAST_CONFIG_CONFIG_PRIVATE_H

#include <stdio.h>
#include "cast/config/config.h"

/* ---- sections ---- */

CastStatus config_read_contact(YamlNode node, CastConfig *config, CastError *err); // after the melt
void config_put_contact(FILE *out, const CastConfig *config);
CastStatus config_read_walls(YamlNode node, CastConfig *config, CastError *err); // after the coupling
void config_put_walls(FILE *out, const CastConfig *config);
CastStatus config_read_forces(YamlNode node, CastConfig *config, CastError *err);
void config_put_forces(FILE *out, const CastConfig *config);
CastStatus config_read_pour(YamlNode melt, CastConfig *config, CastError *err); // after the material and temperature
void config_destroy_pour(CastConfig *config);
void config_put_pour(FILE *out, const CastConfig *config);
CastStatus config_read_features(YamlNode node, CastConfig *config, CastError *err);
void config_put_features(FILE *out, const CastConfig *config);
CastStatus config_read_tension(YamlNode node, CastConfig *config, CastError *err); // after the melt
void config_put_tension(FILE *out, const CastConfig *config);

/* ---- values ---- */

/* A vector with its unit; zeros (and a problem) where it is none, nothing where there is no node. */
void config_read_vector(YamlNode node, const char *unit, double value[3]);
void config_read_box(YamlNode node, double corner[3], double size[3]); // m, of its keys corner and size
bool config_read_direction(YamlNode node, double unit[3]);             // a vector without unit, made to have length 1
/* A quantity, or pairs of time and quantity; false (with a problem, but for a node that is not there) if neither. */
bool config_read_timed(YamlNode node, const char *unit, YamlRange range, Table *table);
void config_put_vector(FILE *out, const double v[3], const char *unit);
void config_put_direction(FILE *out, const double v[3]);
void config_put_timed(FILE *out, const Table *table, const char *unit);
void config_put_text(FILE *out, const char *text); // quoted where YAML needs it

#endif
