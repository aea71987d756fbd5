/* yaml_input_report.c - all that is wrong with an input file, in one go. */
#include "common/input/yaml_input_private.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void yaml_input_name(YamlNode node, char *buffer, size_t size)
{
  buffer[0] = '\0';
  if (node.index <= 1) return;
  const YamlInput *input = node.input;
  yaml_input_name((YamlNode){node.input, input->parent[node.index]}, buffer, size);
  const size_t used = strlen(buffer);
  if (input->name[node.index])
    snprintf(buffer + used, size - used, "%s%.100s", used ? "." : "", input->name[node.index]);
  else
    snprintf(buffer + used, size - used, "[%d]", input->position[node.index] + 1);
}

/* Takes `text`; NULL: there was no memory for it. */
static void add_problem(YamlInput *input, int line, char *text)
{
  YamlProblem *longer = text ? realloc(input->problem, (input->n_problems + 1) * sizeof *longer) : NULL;
  if (!longer) {
    free(text);
    input->problem_lost = true;
    return;
  }
  input->problem = longer;
  longer[input->n_problems++] = (YamlProblem){line, text};
}

void yaml_problem(YamlNode node, const char *format, ...)
{
  char name[512], text[sizeof((CastError *)NULL)->message];
  yaml_input_name(node, name, sizeof name);
  const int used = name[0] ? snprintf(text, sizeof text, "%s: ", name) : 0;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text + used, sizeof text - (size_t)used, format, arguments);
  va_end(arguments);
  add_problem(node.input, yaml_line(node), strdup(text));
}

/* Edit distance, for "did you mean"; words longer than 63 letters are not compared. */
static int distance(const char *a, const char *b)
{
  const size_t n = strlen(a), m = strlen(b);
  if (n > 63 || m > 63) return 99;
  int row[64];
  for (size_t j = 0; j <= m; j++) row[j] = (int)j;
  for (size_t i = 1; i <= n; i++) {
    int diagonal = row[0];
    row[0] = (int)i;
    for (size_t j = 1; j <= m; j++) {
      const int replaced = diagonal + (a[i - 1] != b[j - 1]);
      const int shorter = row[j] < row[j - 1] ? row[j] + 1 : row[j - 1] + 1;
      diagonal = row[j];
      row[j] = replaced < shorter ? replaced : shorter;
    }
  }
  return row[m];
}

static void unknown_key(YamlNode map, const yaml_node_t *key_node)
{
  const YamlInput *input = map.input;
  const char *key = (const char *)key_node->data.scalar.value;
  char name[512], allowed[1024] = "", text[2048];
  const char *closest = NULL;
  int best = 3;
  for (size_t i = 0; i < input->n_asked[map.index]; i++) {
    const char *candidate = input->asked[map.index][i];
    const int d = distance(key, candidate);
    if (d < best && 2 * (size_t)d <= strlen(key)) {
      best = d;
      closest = candidate;
    }
    const size_t used = strlen(allowed);
    snprintf(allowed + used, sizeof allowed - used, "%s%s", i ? ", " : "", candidate);
  }
  yaml_input_name(map, name, sizeof name);
  snprintf(text, sizeof text, "%s%sunknown key '%.200s'%s%.100s%s; allowed here: %s", name, name[0] ? ": " : "", key,
           closest ? " (did you mean '" : "", closest ? closest : "", closest ? "'?)" : "", allowed);
  add_problem(map.input, (int)key_node->start_mark.line + 1, strdup(text));
}

static void find_unknown_keys(YamlInput *input)
{
  for (int index = 1; index <= input->n_nodes; index++) {
    yaml_node_t *node = yaml_document_get_node(&input->document, index);
    // a map nobody asked anything of belongs to an unknown key, which is reported itself
    if (node->type != YAML_MAPPING_NODE || input->n_asked[index] == 0) continue;
    for (yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top; pair++) {
      const yaml_node_t *key = yaml_document_get_node(&input->document, pair->key);
      bool known = false;
      for (size_t i = 0; i < input->n_asked[index] && !known; i++)
        known = strcmp(input->asked[index][i], (const char *)key->data.scalar.value) == 0;
      if (!known) unknown_key((YamlNode){input, index}, key);
    }
  }
}

static int by_line(const void *a, const void *b)
{
  const YamlProblem *left = a, *right = b;
  if (left->line != right->line) return left->line < right->line ? -1 : 1;
  return strcmp(left->text, right->text);
}

static bool repeats_previous(const YamlInput *input, size_t i)
{
  return i > 0 && by_line(&input->problem[i], &input->problem[i - 1]) == 0;
}

/* One problem a line, as many as fit, and then how many did not. */
static void list_problems(const YamlInput *input, CastError *err)
{
  enum { RESERVE = 64 };
  size_t used = 0;
  for (size_t i = 0; i < input->n_problems; i++) {
    if (repeats_previous(input, i)) continue;
    const YamlProblem *problem = &input->problem[i];
    char line[32] = "";
    if (problem->line > 0) snprintf(line, sizeof line, ":%d", problem->line);
    const size_t room = sizeof err->message - RESERVE - used;
    const int length =
        snprintf(err->message + used, room, "%s%s%s: %s", used ? "\n" : "", input->path, line, problem->text);
    if (length < 0 || ((size_t)length >= room && used > 0)) {
      snprintf(err->message + used, RESERVE, "\n... and %zu more", input->n_problems - i);
      return;
    }
    used = strlen(err->message);
  }
}

CastStatus yaml_input_finish(YamlInput *input, CastError *err)
{
  find_unknown_keys(input);
  CAST_CHECK(!input->problem_lost, err, CAST_ERR_MEMORY, "no memory to list what is wrong with '%s'", input->path);
  if (input->n_problems == 0) return CAST_OK;
  qsort(input->problem, input->n_problems, sizeof *input->problem, by_line);
  const CastStatus status = cast_error_set(err, CAST_ERR_INPUT, "%s", "");
  if (err) list_problems(input, err);
  return status;
}
