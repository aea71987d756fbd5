/* config_private.h - the readers of the sections of mould.yaml. Faults become problems of the input; what is returned
 * is only lack of memory. */
#ifndef REDUCE_CONFIG_CONFIG_PRIVATE_H
#define REDUCE_CONFIG_CONFIG_PRIVATE_H

#include "common/input/yaml_input.h"
#include "reduce/config/config.h"

CastStatus config_read_geometry(YamlNode geometry, ReduceConfig *config, CastError *err);
/* The section `matrices`, which takes the place of geometry, regions, boundaries, cavity and mesh. */
CastStatus config_read_matrices(YamlNode root, ReduceConfig *config, CastError *err);
void config_matrices_destroy(MatricesConfig **matrices);
CastStatus config_read_surfaces(YamlNode root, ReduceConfig *config, CastError *err);
CastStatus config_read_reduction(YamlNode reduction, ReductionConfig *config, CastError *err);

/* The i-th user-chosen key of a map, checked (length, no slash) and copied; returns false where it cannot be used. */
bool config_read_name(YamlNode map, size_t i, char name[NAME_LENGTH]);
/* Number of entries of a map that must be there and not be empty. */
size_t config_count_entries(YamlNode map, const char *what);
void *config_array(size_t n, size_t size); // calloc that gives a valid pointer for n = 0 as well
#define CONFIG_NO_MEMORY "no memory for the input"

#endif
