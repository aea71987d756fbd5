/* yaml_input_override.c - the map `overrides` of an input file: "melt.temperature: 1100 degC" puts another value in
 * place of the one that stands elsewhere in the file, or adds it. Runs of a study differ in nothing else, and a run's
 * own text tells all there is to know about it. */
#include "common/input/yaml_input_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char OVERRIDES[] = "overrides";

static yaml_node_pair_t *find_pair(YamlInput *input, int map, const char *key, size_t length)
{
  const yaml_node_t *node = yaml_document_get_node(&input->document, map);
  if (!node || node->type != YAML_MAPPING_NODE) return NULL;
  for (yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top; pair++) {
    const yaml_node_t *name = yaml_document_get_node(&input->document, pair->key);
    if (name->type == YAML_SCALAR_NODE && name->data.scalar.length == length &&
        memcmp(name->data.scalar.value, key, length) == 0)
      return pair;
  }
  return NULL;
}

/* Where a path such as "melt.blocks[2].size" leads: the number of a node is kept in a pair or in an item. Missing maps
 * on the way, and the last key, are added. */
typedef struct Walk {
  YamlInput *input;
  const char *path; // whole, for messages
  size_t line;
  int node;  // where it has come to
  int *slot; // what holds its number; NULL at the root
} Walk;

static CastStatus enter_key(Walk *w, const char *key, size_t length, CastError *err)
{
  yaml_document_t *document = &w->input->document;
  CAST_CHECK(length > 0, err, CAST_ERR_INPUT, "%s:%zu: overrides: '%s' is no path of keys such as melt.temperature",
             w->input->path, w->line, w->path);
  if (w->node == 0) { // added on the way: make it a map
    w->node = yaml_document_add_mapping(document, NULL, YAML_BLOCK_MAPPING_STYLE);
    if (w->node) *w->slot = w->node;
  }
  yaml_node_pair_t *pair = find_pair(w->input, w->node, key, length);
  if (!pair) {
    const yaml_node_t *node = yaml_document_get_node(document, w->node);
    CAST_CHECK(node && node->type == YAML_MAPPING_NODE, err, CAST_ERR_INPUT,
               "%s:%zu: overrides: '%s' leads through something that has no keys", w->input->path, w->line, w->path);
    const int name =
        yaml_document_add_scalar(document, NULL, (const yaml_char_t *)key, (int)length, YAML_PLAIN_SCALAR_STYLE);
    // the name stands for the value until there is one
    const int added = name && yaml_document_append_mapping_pair(document, w->node, name, name);
    CAST_CHECK(added, err, CAST_ERR_MEMORY, "no memory for '%s'", w->path);
    yaml_document_get_node(document, name)->start_mark.line = w->line - 1;
    pair = yaml_document_get_node(document, w->node)->data.mapping.pairs.top - 1;
    pair->value = 0;
  }
  w->slot = &pair->value;
  w->node = pair->value;
  return CAST_OK;
}

static CastStatus enter_item(Walk *w, const char **rest, CastError *err)
{
  char *end = NULL;
  const long number = strtol(*rest + 1, &end, 10);
  const yaml_node_t *node = w->node ? yaml_document_get_node(&w->input->document, w->node) : NULL;
  const bool list = node && node->type == YAML_SEQUENCE_NODE;
  const long n = list ? (long)(node->data.sequence.items.top - node->data.sequence.items.start) : 0;
  CAST_CHECK(*end == ']' && number >= 1 && number <= n, err, CAST_ERR_INPUT,
             "%s:%zu: overrides: '%s' names item %ld of a list of %ld (items count from 1)", w->input->path, w->line,
             w->path, number, n);
  w->slot = node->data.sequence.items.start + (number - 1);
  w->node = *w->slot;
  *rest = end + 1;
  return CAST_OK;
}

static CastStatus override(YamlInput *input, const yaml_node_pair_t *from, CastError *err)
{
  const yaml_node_t *key = yaml_document_get_node(&input->document, from->key);
  CAST_CHECK(key->type == YAML_SCALAR_NODE, err, CAST_ERR_INPUT, "%s:%zu: overrides: a path of keys is expected",
             input->path, key->start_mark.line + 1);
  const int value = from->value; // `from` may move when nodes are added
  char *path = strdup((const char *)key->data.scalar.value);
  CAST_CHECK(path, err, CAST_ERR_MEMORY, "no memory for '%s'", input->path);
  Walk walk = {.input = input, .path = path, .line = key->start_mark.line + 1, .node = 1};
  CastStatus status = CAST_OK;
  for (const char *rest = path; status == CAST_OK && (*rest || rest == path);) {
    if (*rest == '[' && rest > path) {
      status = enter_item(&walk, &rest, err);
    } else {
      const size_t length = strcspn(rest, ".[");
      status = enter_key(&walk, rest, length, err);
      rest += length;
    }
    if (*rest == '.') rest++;
  }
  if (status == CAST_OK) *walk.slot = value;
  free(path);
  return status;
}

CastStatus yaml_input_apply_overrides(YamlInput *input, CastError *err)
{
  yaml_node_pair_t *pair = find_pair(input, 1, OVERRIDES, sizeof OVERRIDES - 1);
  if (!pair) return CAST_OK;
  const int map = pair->value;
  const yaml_node_t *node = yaml_document_get_node(&input->document, map);
  CAST_CHECK(node->type == YAML_MAPPING_NODE, err, CAST_ERR_INPUT,
             "%s:%zu: overrides: a map is expected, such as {melt.temperature: 1100 degC}", input->path,
             node->start_mark.line + 1);
  yaml_node_t *root = yaml_document_get_root_node(&input->document);
  memmove(pair, pair + 1, (size_t)((char *)root->data.mapping.pairs.top - (char *)(pair + 1)));
  root->data.mapping.pairs.top--;
  const ptrdiff_t n = node->data.mapping.pairs.top - node->data.mapping.pairs.start;
  for (ptrdiff_t k = 0; k < n; k++)
    CAST_CALL(override(input, yaml_document_get_node(&input->document, map)->data.mapping.pairs.start + k, err));
  return CAST_OK;
}
