/* yaml_input.c - reading and releasing the document. */
#include "common/input/yaml_input_private.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_FILE_BYTES = 4 << 20, MAX_KEYS = 1000 }; // keys are searched one by one

/* All of the file, `n` bytes and a NUL; no more than MAX_FILE_BYTES + 1 of them. Caller owns; NULL: no memory. */
static char *read_bytes(FILE *file, size_t *n)
{
  size_t capacity = 1 << 14;
  char *bytes = malloc(capacity + 1);
  *n = 0;
  while (bytes) {
    *n += fread(bytes + *n, 1, capacity - *n, file);
    if (*n < capacity || *n > MAX_FILE_BYTES) break;
    capacity *= 2;
    char *larger = realloc(bytes, capacity + 1);
    if (!larger) free(bytes);
    bytes = larger;
  }
  if (bytes) bytes[*n] = '\0';
  return bytes;
}

static CastStatus check_bytes(const char *path, const char *bytes, size_t n, CastError *err)
{
  CAST_CHECK(n <= MAX_FILE_BYTES, err, CAST_ERR_INPUT, "'%s' is larger than %d MiB: no input file", path,
             MAX_FILE_BYTES >> 20);
  const char *nul = memchr(bytes, '\0', n);
  if (!nul) return CAST_OK;
  int line = 1;
  for (const char *c = bytes; c < nul; c++) line += *c == '\n';
  return cast_error_set(err, CAST_ERR_INPUT, "%s:%d: holds a NUL byte; text in UTF-8 is expected, not UTF-16 or binary",
                        path, line);
}

static CastStatus read_file(const char *path, char **text, CastError *err)
{
  FILE *file = fopen(path, "rb");
  CAST_CHECK(file, err, CAST_ERR_IO, "'%s' cannot be opened: %s", path, strerror(errno));
  size_t n = 0;
  char *bytes = read_bytes(file, &n);
  const int failure = ferror(file) ? errno : 0;
  fclose(file);
  CAST_CHECK(bytes, err, CAST_ERR_MEMORY, "no memory to read '%s'", path);
  CastStatus status = failure ? cast_error_set(err, CAST_ERR_IO, "'%s' cannot be read: %s", path, strerror(failure))
                              : check_bytes(path, bytes, n, err);
  if (status == CAST_OK)
    *text = bytes;
  else
    free(bytes);
  return status;
}

/* The text has passed yaml_input_scan(). */
static CastStatus load_document(YamlInput *input, CastError *err)
{
  yaml_parser_t parser;
  CAST_CHECK(yaml_input_open_parser(input, &parser), err, CAST_ERR_MEMORY, "no memory to parse '%s'", input->path);
  CastStatus status = CAST_OK;
  if (yaml_parser_load(&parser, &input->document))
    input->has_document = true;
  else
    status = yaml_input_syntax_error(input, &parser, err);
  yaml_parser_delete(&parser);
  return status;
}

static const char *scalar_text(YamlInput *input, int index)
{
  const yaml_node_t *node = yaml_document_get_node(&input->document, index);
  return node && node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : NULL;
}

static CastStatus link_children(YamlInput *input, int index, CastError *err);

/* yaml_input_scan() has limited the depth and refused aliases, so the recursion ends. */
static CastStatus link_map(YamlInput *input, int index, CastError *err)
{
  const yaml_node_t *node = yaml_document_get_node(&input->document, index);
  const yaml_node_pair_t *first = node->data.mapping.pairs.start, *end = node->data.mapping.pairs.top;
  CAST_CHECK(end - first <= MAX_KEYS, err, CAST_ERR_INPUT, "%s:%zu: a map of more than %d keys", input->path,
             node->start_mark.line + 1, MAX_KEYS);
  for (const yaml_node_pair_t *pair = first; pair < end; pair++) {
    const char *key = scalar_text(input, pair->key);
    const size_t line = yaml_document_get_node(&input->document, pair->key)->start_mark.line + 1;
    CAST_CHECK(key && key[0], err, CAST_ERR_INPUT, "%s:%zu: a key must be a plain word", input->path, line);
    for (const yaml_node_pair_t *other = first; other < pair; other++)
      CAST_CHECK(strcmp(scalar_text(input, other->key), key) != 0, err, CAST_ERR_INPUT,
                 "%s:%zu: key '%s' appears a second time", input->path, line, key);
    input->parent[pair->value] = index;
    input->name[pair->value] = key;
    input->key_line[pair->value] = (int)line;
    CAST_CALL(link_children(input, pair->value, err));
  }
  return CAST_OK;
}

static CastStatus link_children(YamlInput *input, int index, CastError *err)
{
  const yaml_node_t *node = yaml_document_get_node(&input->document, index);
  if (node->type == YAML_MAPPING_NODE) return link_map(input, index, err);
  if (node->type != YAML_SEQUENCE_NODE) return CAST_OK;
  int position = 0;
  for (yaml_node_item_t *item = node->data.sequence.items.start; item < node->data.sequence.items.top; item++) {
    input->parent[*item] = index;
    input->position[*item] = position++;
    CAST_CALL(link_children(input, *item, err));
  }
  return CAST_OK;
}

static CastStatus build(YamlInput *input, CastError *err)
{
  CAST_CALL(yaml_input_scan(input, err));
  CAST_CALL(load_document(input, err));
  const yaml_node_t *root = yaml_document_get_root_node(&input->document);
  CAST_CHECK(root, err, CAST_ERR_INPUT, "'%s' is empty", input->path);
  if (root->type == YAML_MAPPING_NODE) CAST_CALL(yaml_input_apply_overrides(input, err));
  root = yaml_document_get_root_node(&input->document); // nodes may have moved
  input->n_nodes = (int)(input->document.nodes.top - input->document.nodes.start);
  const size_t n = (size_t)input->n_nodes + 1;
  input->parent = calloc(n, sizeof *input->parent);
  input->name = calloc(n, sizeof *input->name);
  input->key_line = calloc(n, sizeof *input->key_line);
  input->position = calloc(n, sizeof *input->position);
  input->asked = calloc(n, sizeof *input->asked);
  input->n_asked = calloc(n, sizeof *input->n_asked);
  CAST_CHECK(input->parent && input->name && input->key_line && input->position && input->asked && input->n_asked, err,
             CAST_ERR_MEMORY, "no memory for '%s'", input->path);
  CAST_CHECK(root->type == YAML_MAPPING_NODE, err, CAST_ERR_INPUT,
             "%s:%zu: a map of keys and values is expected ('key: value')", input->path, root->start_mark.line + 1);
  return link_children(input, 1, err);
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

CastStatus yaml_input_read_text(const char *path, char **text, CastError *err)
{
  *text = NULL;
  return read_file(path, text, err);
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
  free(old->key_line);
  free(old->position);
  free(old->asked);
  free(old->n_asked);
  free(old->path);
  free(old->text);
  free(old);
  *input = NULL;
}

char *yaml_path_beside(const char *input_path, const char *path)
{
  const char *slash = strrchr(input_path, '/');
  const int folder = slash && path[0] != '/' ? (int)(slash - input_path) + 1 : 0;
  const size_t size = (size_t)folder + strlen(path) + 1;
  char *joined = malloc(size);
  if (joined) snprintf(joined, size, "%.*s%s", folder, input_path, path);
  return joined;
}

const char *yaml_input_text(const YamlInput *input)
{
  return input->text;
}

const char *yaml_input_path(const YamlInput *input)
{
  return input->path;
}
