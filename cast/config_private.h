/* config_private.h - what the files of the configuration share.
 *   config.c  reading   config_contact.c  `contact:`, both ways   config_walls.c  `walls:`, both ways
 *   config_resolved.c  writing */
#ifndef CAST_CONFIG_PRIVATE_H
#define CAST_CONFIG_PRIVATE_H

#include <stdio.h>
#include "cast/config.h"

CastStatus config_read_contact(YamlNode node, CastConfig *config, CastError *err); // after the melt
void config_put_contact(FILE *out, const CastConfig *config);
CastStatus config_read_walls(YamlNode node, CastConfig *config, CastError *err); // after the coupling
void config_put_walls(FILE *out, const CastConfig *config);
void config_put_text(FILE *out, const char *text); // quoted where YAML needs it

#endif
