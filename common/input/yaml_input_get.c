/* yaml_input_get.c - walking the document and reading its scalars. */
#include "common/input/yaml_input_private.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "common/units.h"

yaml_node_t *yaml_input_node(YamlNode node)
{
  return node.index > 0 ? yaml_document_get_node(&node.input->document, node.index) : NULL;
}

YamlNode yaml_root(YamlInput *input)
{
  return (YamlNode){input, 1};
}

bool yaml_exists(YamlNode node)
{
  return node.index > 0;
}

static bool is_block(const yaml_node_t *node)
{
  return (node->type == YAML_MAPPING_NODE && node->data.mapping.style == YAML_BLOCK_MAPPING_STYLE) ||
         (node->type == YAML_SEQUENCE_NODE && node->data.sequence.style == YAML_BLOCK_SEQUENCE_STYLE);
}

/* A block's own mark stands at its first entry, lines below the key that holds it, where people look. */
int yaml_line(YamlNode node)
{
  const yaml_node_t *found = yaml_input_node(node);
  if (!found) return 0;
  const int key_line = node.input->key_line[node.index];
  return key_line && is_block(found) ? key_line : (int)found->start_mark.line + 1;
}

/* libyaml's marks count characters, and a block's end mark stands behind the comments that follow it. */
static size_t end_character(YamlInput *input, int index)
{
  const yaml_node_t *node = yaml_document_get_node(&input->document, index);
  const size_t n = yaml_count((YamlNode){input, index});
  if (n == 0 || !is_block(node)) return node->end_mark.index;
  return end_character(input, node->type == YAML_MAPPING_NODE ? node->data.mapping.pairs.start[n - 1].value
                                                              : node->data.sequence.items.start[n - 1]);
}

static size_t byte_of_character(const char *text, size_t character)
{
  size_t byte = 0;
  while (text[byte] && character > 0)
    if (((unsigned char)text[++byte] & 0xc0) != 0x80) character--; // not a continuation byte of UTF-8
  return byte;
}

void yaml_input_extent(YamlNode node, size_t *start, size_t *end)
{
  *start = *end = 0;
  const yaml_node_t *found = yaml_input_node(node);
  if (!found) return;
  *start = byte_of_character(node.input->text, found->start_mark.index);
  *end = byte_of_character(node.input->text, end_character(node.input, node.index));
  while (*end > *start && isspace((unsigned char)node.input->text[*end - 1])) --*end;
}

static bool has_type(YamlNode node, yaml_node_type_t type)
{
  const yaml_node_t *found = yaml_input_node(node);
  return found && found->type == type;
}

bool yaml_is_map(YamlNode node)
{
  return has_type(node, YAML_MAPPING_NODE);
}

bool yaml_is_sequence(YamlNode node)
{
  return has_type(node, YAML_SEQUENCE_NODE);
}

bool yaml_is_scalar(YamlNode node)
{
  return has_type(node, YAML_SCALAR_NODE);
}

void yaml_input_ask(YamlNode map, const char *key)
{
  YamlInput *input = map.input;
  const size_t n = input->n_asked[map.index];
  for (size_t i = 0; i < n; i++)
    if (strcmp(input->asked[map.index][i], key) == 0) return;
  char **longer = realloc(input->asked[map.index], (n + 1) * sizeof *longer);
  if (!longer) return; // then a known key may be reported as unknown: harmless beside being out of memory
  input->asked[map.index] = longer;
  longer[n] = strdup(key);
  if (longer[n]) input->n_asked[map.index] = n + 1;
}

YamlNode yaml_get(YamlNode map, const char *key)
{
  const YamlNode absent = {map.input, 0};
  const yaml_node_t *node = yaml_input_node(map);
  if (!node) return absent;
  if (node->type != YAML_MAPPING_NODE) {
    yaml_problem(map, "a map of keys and values is expected here");
    return absent;
  }
  yaml_input_ask(map, key);
  for (yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top; pair++) {
    const yaml_node_t *name = yaml_document_get_node(&map.input->document, pair->key);
    if (strcmp((const char *)name->data.scalar.value, key) == 0) return (YamlNode){map.input, pair->value};
  }
  return absent;
}

YamlNode yaml_require(YamlNode map, const char *key)
{
  const YamlNode found = yaml_get(map, key);
  if (!yaml_exists(found) && yaml_is_map(map)) yaml_problem(map, "key '%s' is missing", key);
  return found;
}

size_t yaml_count(YamlNode node)
{
  const yaml_node_t *found = yaml_input_node(node);
  if (found && found->type == YAML_SEQUENCE_NODE)
    return (size_t)(found->data.sequence.items.top - found->data.sequence.items.start);
  if (found && found->type == YAML_MAPPING_NODE)
    return (size_t)(found->data.mapping.pairs.top - found->data.mapping.pairs.start);
  return 0;
}

YamlNode yaml_item(YamlNode sequence, size_t i)
{
  const yaml_node_t *node = yaml_input_node(sequence);
  if (!node || node->type != YAML_SEQUENCE_NODE || i >= yaml_count(sequence)) return (YamlNode){sequence.input, 0};
  return (YamlNode){sequence.input, node->data.sequence.items.start[i]};
}

const char *yaml_key(YamlNode map, size_t i)
{
  const yaml_node_t *node = yaml_input_node(map);
  if (!node || node->type != YAML_MAPPING_NODE || i >= yaml_count(map)) return NULL;
  const int key = node->data.mapping.pairs.start[i].key;
  return (const char *)yaml_document_get_node(&map.input->document, key)->data.scalar.value;
}

YamlNode yaml_value(YamlNode map, size_t i)
{
  const char *key = yaml_key(map, i);
  if (!key) return (YamlNode){map.input, 0};
  yaml_input_ask(map, key);
  return (YamlNode){map.input, yaml_input_node(map)->data.mapping.pairs.start[i].value};
}

const char *yaml_string(YamlNode node, const char *fallback)
{
  if (!yaml_exists(node)) return fallback;
  const yaml_node_t *found = yaml_input_node(node);
  if (found->type == YAML_SCALAR_NODE && found->data.scalar.length > 0) return (const char *)found->data.scalar.value;
  yaml_problem(node, "a single value is expected here, %s",
               found->type == YAML_SCALAR_NODE    ? "there is none"
               : found->type == YAML_MAPPING_NODE ? "not a map"
                                                  : "not a list");
  return fallback;
}

static void range_problem(YamlNode node, const char *text, const char *unit, YamlRange range)
{
  const char *shown = strcmp(unit, "1") == 0 ? "" : unit, *space = shown[0] ? " " : "";
  const char *least = range.min_excluded ? "above" : "of at least";
  if (isinf(range.max))
    yaml_problem(node, "'%s' is not allowed: a value %s %g%s%s is expected", text, least, range.min, space, shown);
  else if (isinf(range.min))
    yaml_problem(node, "'%s' is not allowed: a value of at most %g%s%s is expected", text, range.max, space, shown);
  else
    yaml_problem(node, "'%s' is not allowed: a value %s %g and of at most %g%s%s is expected", text, least, range.min,
                 range.max, space, shown);
}

static bool in_range(double value, YamlRange range)
{
  return value <= range.max && (range.min_excluded ? value > range.min : value >= range.min);
}

double yaml_quantity(YamlNode node, const char *si_unit, YamlRange range, double fallback)
{
  const char *text = yaml_string(node, NULL);
  if (!text) return fallback;
  CastError err;
  double value = fallback;
  if (units_convert(text, si_unit, &value, &err) != CAST_OK) {
    yaml_problem(node, "%s", err.message);
    return fallback;
  }
  if (!in_range(value, range)) {
    range_problem(node, text, si_unit, range);
    return fallback;
  }
  return value;
}

long yaml_integer(YamlNode node, long min, long max, long fallback)
{
  const char *text = yaml_string(node, NULL);
  if (!text) return fallback;
  char *end = NULL;
  errno = 0;
  const long value = strtol(text, &end, 10);
  if (end == text || *end != '\0' || errno != 0) {
    yaml_problem(node, "'%s' is not a whole number", text);
    return fallback;
  }
  if (value < min || value > max) {
    if (max == LONG_MAX)
      yaml_problem(node, "%ld is not allowed: a whole number of at least %ld is expected", value, min);
    else
      yaml_problem(node, "%ld is not allowed: a whole number from %ld to %ld is expected", value, min, max);
    return fallback;
  }
  return value;
}

bool yaml_boolean(YamlNode node, bool fallback)
{
  const char *text = yaml_string(node, NULL);
  if (!text) return fallback;
  if (strcmp(text, "true") == 0 || strcmp(text, "yes") == 0) return true;
  if (strcmp(text, "false") == 0 || strcmp(text, "no") == 0) return false;
  yaml_problem(node, "'%s' is neither true nor false", text);
  return fallback;
}

int yaml_choice(YamlNode node, const char *const *choices, int fallback)
{
  const char *text = yaml_string(node, NULL);
  if (!text) return fallback;
  char allowed[512] = "";
  for (int i = 0; choices[i]; i++) {
    if (strcmp(text, choices[i]) == 0) return i;
    const size_t used = strlen(allowed);
    snprintf(allowed + used, sizeof allowed - used, "%s%s", i ? ", " : "", choices[i]);
  }
  yaml_problem(node, "'%s' is not allowed here; allowed: %s", text, allowed);
  return fallback;
}

/* "0 0 3 mm": three numbers and one unit for all. */
static bool vector_of_text(YamlNode node, const char *si_unit, double value[3])
{
  const char *text = yaml_string(node, NULL);
  if (!text) return false;
  const char *rest = text;
  char number[3][64];
  for (int d = 0; d < 3; d++) {
    char *end = NULL;
    strtod(rest, &end);
    const size_t length = (size_t)(end - rest);
    if (length == 0 || length >= sizeof number[0]) {
      yaml_problem(node, "'%s' is not a vector: '[0 mm, 0 mm, 3 mm]' or '0 0 3 mm' is expected", text);
      return false;
    }
    memcpy(number[d], rest, length);
    number[d][length] = '\0';
    rest = end;
  }
  for (int d = 0; d < 3; d++) {
    char quantity[512];
    CastError err;
    snprintf(quantity, sizeof quantity, "%s%.256s", number[d], rest);
    if (units_convert(quantity, si_unit, &value[d], &err) != CAST_OK) {
      yaml_problem(node, "%s", err.message);
      return false;
    }
  }
  return true;
}

bool yaml_vector(YamlNode node, const char *si_unit, double value[3])
{
  if (!yaml_exists(node)) return false;
  if (yaml_is_scalar(node)) return vector_of_text(node, si_unit, value);
  if (!yaml_is_sequence(node) || yaml_count(node) != 3) {
    yaml_problem(node, "a vector of three quantities is expected: '[0 mm, 0 mm, 3 mm]'");
    return false;
  }
  for (size_t d = 0; d < 3; d++) {
    value[d] = yaml_quantity(yaml_item(node, d), si_unit, YAML_ANY, NAN);
    if (isnan(value[d])) return false;
  }
  return true;
}
