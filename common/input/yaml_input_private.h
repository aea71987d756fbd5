/* yaml_input_private.h - the document behind yaml_input.h: shared by its reader, its getters and its report. */
#ifndef COMMON_INPUT_YAML_INPUT_PRIVATE_H
#define COMMON_INPUT_YAML_INPUT_PRIVATE_H

#include <yaml.h>
#include "common/input/yaml_input.h"

typedef struct YamlProblem {
  int line;
  char *text; // without file and line
} YamlProblem;

struct YamlInput {
  char *path, *text;
  yaml_document_t document;
  bool has_document;
  int n_nodes;       // nodes are numbered 1..n_nodes
  int *parent;       // [n_nodes + 1] map or sequence that holds the node; 0: root
  const char **name; // [n_nodes + 1] key under which a map holds the node; NULL in a sequence
  int *key_line;     // [n_nodes + 1] line of that key, 1-based; 0 in a sequence
  int *position;     // [n_nodes + 1] place in a sequence
  char ***asked;     // [n_nodes + 1] for each map the keys asked for (owned strings)
  size_t *n_asked;   // [n_nodes + 1]
  size_t n_problems;
  YamlProblem *problem;
  bool problem_lost; // for want of memory
};

/* What libyaml's loader cannot tell, on the bare events: syntax, UTF-8, depth, one document, no anchors, aliases, tags
 * or NUL characters. Afterwards input->text is safe to load. Errors: CAST_ERR_INPUT with the line; CAST_ERR_MEMORY. */
CastStatus yaml_input_scan(const YamlInput *input, CastError *err);
CastStatus yaml_input_syntax_error(const YamlInput *input, const yaml_parser_t *parser, CastError *err);
/* A parser on the text; false without memory. */
bool yaml_input_open_parser(const YamlInput *input, yaml_parser_t *parser);

/* Put the values of the root's map `overrides` in their places and take that map out. Before nodes are linked.
 * Errors: CAST_ERR_INPUT, CAST_ERR_MEMORY. */
CastStatus yaml_input_apply_overrides(YamlInput *input, CastError *err);

yaml_node_t *yaml_input_node(YamlNode node);
void yaml_input_ask(YamlNode map, const char *key);
/* "mesh.cavity_size", "melt.blocks[2].size"; empty for the root. */
void yaml_input_name(YamlNode node, char *buffer, size_t size);

#endif
