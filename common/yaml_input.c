/* yaml_input.c - reading and releasing the document. */
#include "common/yaml_input_private.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_FILE_BYTES = 16 << 20, MAX_DEPTH = 64 };

static CastStatus read_file(const char *path, char **text, CastError *err)
{
  FILE *file = fopen(path, "rb");
  CAST_CHECK(file, err, CAST_ERR_IO, "'%s' cannot be opened: %s", path, strerror(errno));
  size_t n = 0, capacity = 1 << 14;
  char *bytes = malloc(capacity + 1);
  while (bytes) {
    n += fread(bytes + n, 1, capacity - n, file);
    if (n < capacity || capacity > MAX_FILE_BYTES) break;
    capacity *= 2;
    char *larger = realloc(bytes, capacity + 1);
    if (!larger) free(bytes);
    bytes = larger;
  }
  const int failed = ferror(file);
  fclose(file);
  CAST_CHECK(bytes, err, CAST_ERR_MEMORY, "no memory to read '%s'", path);
  bytes[n] = '\0';
  if (failed || n > MAX_FILE_BYTES || memchr(bytes, '\0', n)) {
    free(bytes);
    return failed ? cast_error_set(err, CAST_ERR_IO, "'%s' cannot be read: %s", path, strerror(errno))
                  : cast_error_set(err, CAST_ERR_INPUT, "'%s' is not a text file of YAML", path);
  }
  *text = bytes;
  return CAST_OK;
}

static CastStatus parse_document(YamlInput *input, CastError *err)
{
  yaml_parser_t parser;
  CAST_CHECK(yaml_parser_initialize(&parser), err, CAST_ERR_MEMORY, "no memory to parse '%s'", input->path);
  yaml_parser_set_input_string(&parser, (const unsigned char *)input->text, strlen(input->text));
  CastStatus status = CAST_OK;
  if (!yaml_parser_load(&parser, &input->document)) {
    const size_t line = parser.problem_mark.line ? parser.problem_mark.line : parser.context_mark.line;
    status = cast_error_set(err, CAST_ERR_INPUT, "%s:%zu: not YAML: %s%s%s", input->path, line + 1,
                            parser.problem ? parser.problem : "unreadable", parser.context ? ", " : "",
                            parser.context ? parser.context : "");
  } else {
    input->has_document = true;
    yaml_document_t next;
    if (!yaml_parser_load(&parser, &next)) {
      status = cast_error_set(err, CAST_ERR_INPUT, "%s:%zu: not YAML: %s", input->path, parser.problem_mark.line + 1,
                              parser.problem ? parser.problem : "unreadable");
    } else {
      const yaml_node_t *second = yaml_document_get_root_node(&next);
      if (second)
        status = cast_error_set(err, CAST_ERR_INPUT, "%s:%zu: a second document ('---') is not allowed here",
                                input->path, second->start_mark.line + 1);
      yaml_document_delete(&next);
    }
  }
  yaml_parser_delete(&parser);
  return status;
}

static const char *scalar_text(YamlInput *input, int index)
{
  const yaml_node_t *node = yaml_document_get_node(&input->document, index);
  return node && node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : NULL;
}

static CastStatus link_children(YamlInput *input, int index, int depth, CastError *err);

static CastStatus link_child(YamlInput *input, int index, int child, int depth, CastError *err)
{
  const yaml_node_t *node = yaml_document_get_node(&input->document, child);
  CAST_CHECK(input->parent[child] == 0 && child != 1, err, CAST_ERR_INPUT,
             "%s:%zu: anchors and aliases are not used in these files", input->path, node->start_mark.line + 1);
  CAST_CHECK(depth < MAX_DEPTH, err, CAST_ERR_INPUT, "%s:%zu: nested too deeply", input->path,
             node->start_mark.line + 1);
  input->parent[child] = index;
  return link_children(input, child, depth + 1, err);
}

static CastStatus link_map(YamlInput *input, int index, int depth, CastError *err)
{
  const yaml_node_t *node = yaml_document_get_node(&input->document, index);
  for (yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top; pair++) {
    const char *key = scalar_text(input, pair->key);
    const yaml_node_t *key_node = yaml_document_get_node(&input->document, pair->key);
    CAST_CHECK(key, err, CAST_ERR_INPUT, "%s:%zu: a key must be a plain word", input->path,
               key_node->start_mark.line + 1);
    for (yaml_node_pair_t *other = node->data.mapping.pairs.start; other < pair; other++) {
      const char *earlier = scalar_text(input, other->key);
      CAST_CHECK(strcmp(earlier, key) != 0, err, CAST_ERR_INPUT, "%s:%zu: key '%s' appears a second time",
                 input->path, key_node->start_mark.line + 1, key);
    }
    CAST_CALL(link_child(input, index, pair->value, depth, err));
    input->name[pair->value] = key;
  }
  return CAST_OK;
}

static CastStatus link_children(YamlInput *input, int index, int depth, CastError *err)
{
  const yaml_node_t *node = yaml_document_get_node(&input->document, index);
  if (node->type == YAML_MAPPING_NODE) return link_map(input, index, depth, err);
  if (node->type != YAML_SEQUENCE_NODE) return CAST_OK;
  int position = 0;
  for (yaml_node_item_t *item = node->data.sequence.items.start; item < node->data.sequence.items.top; item++) {
    CAST_CALL(link_child(input, index, *item, depth, err));
    input->position[*item] = position++;
  }
  return CAST_OK;
}

static CastStatus build(YamlInput *input, CastError *err)
{
  CAST_CALL(parse_document(input, err));
  CAST_CHECK(yaml_document_get_root_node(&input->document), err, CAST_ERR_INPUT, "'%s' is empty", input->path);
  input->n_nodes = (int)(input->document.nodes.top - input->document.nodes.start);
  const size_t n = (size_t)input->n_nodes + 1;
  input->parent = calloc(n, sizeof *input->parent);
  input->name = calloc(n, sizeof *input->name);
  input->position = calloc(n, sizeof *input->position);
  input->asked = calloc(n, sizeof *input->asked);
  input->n_asked = calloc(n, sizeof *input->n_asked);
  CAST_CHECK(input->parent && input->name && input->position && input->asked && input->n_asked, err, CAST_ERR_MEMORY,
             "no memory for '%s'", input->path);
  CAST_CHECK(yaml_document_get_root_node(&input->document)->type == YAML_MAPPING_NODE, err, CAST_ERR_INPUT,
             "%s:1: a map of keys and values is expected ('key: value')", input->path);
  return link_children(input, 1, 0, err);
}

/* Takes `text`. */
static CastStatus create(char *text, const char *path, YamlInput **input, CastError *err)
{
  YamlInput *made = calloc(1, sizeof *made);
  if (made) made->path = strdup(path);
  if (!made || !made->path) {
    free(text);
    free(made);
    return cast_error_set(err, CAST_ERR_MEMORY, "no memory for '%s'", path);
  }
  made->text = text;
  const CastStatus status = build(made, err);
  if (status != CAST_OK) yaml_input_destroy(&made);
  *input = made;
  return status;
}

CastStatus yaml_input_load(const char *path, YamlInput **input, CastError *err)
{
  *input = NULL;
  char *text = NULL;
  CAST_CALL(read_file(path, &text, err));
  return create(text, path, input, err);
}

CastStatus yaml_input_parse(const char *text, const char *name, YamlInput **input, CastError *err)
{
  *input = NULL;
  char *copy = strdup(text);
  CAST_CHECK(copy, err, CAST_ERR_MEMORY, "no memory for '%s'", name);
  return create(copy, name, input, err);
}

void yaml_input_destroy(YamlInput **input)
{
  if (!input || !*input) return;
  YamlInput *old = *input;
  for (int i = 0; old->asked && old->n_asked && i <= old->n_nodes; i++) {
    for (size_t k = 0; k < old->n_asked[i]; k++) free(old->asked[i][k]);
    free(old->asked[i]);
  }
  for (size_t i = 0; i < old->n_problems; i++) free(old->problem[i].text);
  if (old->has_document) yaml_document_delete(&old->document);
  free(old->problem);
  free(old->parent);
  free(old->name);
  free(old->position);
  free(old->asked);
  free(old->n_asked);
  free(old->path);
  free(old->text);
  free(old);
  *input = NULL;
}

const char *yaml_input_text(const YamlInput *input)
{
  return input->text;
}

const char *yaml_input_path(const YamlInput *input)
{
  return input->path;
}
