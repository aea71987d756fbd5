/* yaml_input.h - input files: YAML whose every quantity carries its unit and every message its line.
 *
 * Reading never stops at the first fault: getters record a problem in the document and return the fallback, so that
 * the user sees all that is wrong in one go. yaml_input_finish() reports the problems and the keys nobody asked for.
 * Pattern:
 *   YamlNode sph = yaml_require(root, "sph");
 *   config->spacing = yaml_quantity(yaml_require(sph, "spacing"), "m", YAML_POSITIVE, NAN);
 *   config->delta = yaml_quantity(yaml_get(sph, "density_diffusion"), "1", (YamlRange){0, 1, false}, 0.1);
 * An absent node gives the fallback without a further problem. */
#ifndef COMMON_INPUT_YAML_INPUT_H
#define COMMON_INPUT_YAML_INPUT_H

#include <stdbool.h>
#include <stddef.h>
#include "common/error.h"

typedef struct YamlInput YamlInput;
typedef struct YamlNode {
  YamlInput *input;
  int index; // libyaml's node number; 0: absent
} YamlNode;

typedef struct YamlRange { // allowed values, in SI
  double min, max;
  bool min_excluded;
} YamlRange;
#define YAML_ANY ((YamlRange){-INFINITY, INFINITY, false})
#define YAML_POSITIVE ((YamlRange){0.0, INFINITY, true})
#define YAML_NON_NEGATIVE ((YamlRange){0.0, INFINITY, false})

/* Read the file: one document of plain YAML in UTF-8, at most 4 MiB and 32 levels deep, its root a map. Syntax errors,
 * duplicate keys, anchors, aliases and tags are refused with their line. The root's map `overrides`, if there is one,
 * holds paths of keys ("melt.temperature", "melt.blocks[1].size") and the values to take in place of those in the file;
 * getters see the result. Errors: CAST_ERR_IO, CAST_ERR_INPUT, CAST_ERR_MEMORY. */
CastStatus yaml_input_load(const char *path, YamlInput **input, CastError *err);
/* The same from text; `name` stands for the file in messages. */
CastStatus yaml_input_parse(const char *text, const char *name, YamlInput **input, CastError *err);
void yaml_input_destroy(YamlInput **input);
/* The text of a file, with the same limits; the caller owns it. Errors: CAST_ERR_IO, CAST_ERR_INPUT, CAST_ERR_MEMORY.
 */
CastStatus yaml_input_read_text(const char *path, char **text, CastError *err);

/* A path beside the input file, unless it is absolute; the caller owns it. NULL: no memory. */
char *yaml_path_beside(const char *input_path, const char *path);

const char *yaml_input_text(const YamlInput *input); // the bytes as read, for provenance
const char *yaml_input_path(const YamlInput *input);

YamlNode yaml_root(YamlInput *input);
bool yaml_exists(YamlNode node);
int yaml_line(YamlNode node);                                      // 1-based, of its key for a block; 0 if absent
void yaml_input_extent(YamlNode node, size_t *start, size_t *end); // bytes of the node in the text
YamlNode yaml_get(YamlNode map, const char *key);     // absent if there is no such key; the key counts as known
YamlNode yaml_require(YamlNode map, const char *key); // the same, but a missing key is a problem
size_t yaml_count(YamlNode node);                     // items of a sequence, entries of a map; 0 for others
YamlNode yaml_item(YamlNode sequence, size_t i);
const char *yaml_key(YamlNode map, size_t i); // the i-th entry of a map whose keys are the user's own names
YamlNode yaml_value(YamlNode map, size_t i);  // marks that key as known
bool yaml_is_map(YamlNode node);
bool yaml_is_sequence(YamlNode node);
bool yaml_is_scalar(YamlNode node);

/* Scalars. Strings are borrowed from the document. */
const char *yaml_string(YamlNode node, const char *fallback);
double yaml_quantity(YamlNode node, const char *si_unit, YamlRange range, double fallback);
long yaml_integer(YamlNode node, long min, long max, long fallback);
bool yaml_boolean(YamlNode node, bool fallback);
/* One of the NULL-terminated choices; returns its index. */
int yaml_choice(YamlNode node, const char *const *choices, int fallback);
/* A vector of three quantities: "[0 mm, 0 mm, 3 mm]" or one unit for all: "0 0 3 mm"; false (and a problem) if not. */
bool yaml_vector(YamlNode node, const char *si_unit, double value[3]);

/* Record a problem at the node's line: "mould.yaml:14: mesh.cavity_size: <message>". Items of a list count from 1. */
void yaml_problem(YamlNode node, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* CAST_OK, or CAST_ERR_INPUT with every problem on a line of its own, sorted by line, unknown keys (and the keys
 * allowed there) included; what does not fit into the message is counted at its end. */
CastStatus yaml_input_finish(YamlInput *input, CastError *err);

#endif
