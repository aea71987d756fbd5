/* yaml_input_scan.c - is the text one plain YAML document? Seen event by event, before it is loaded: libyaml's loader
 * neither limits the depth (its time grows with the square of it) nor remembers where an alias stood. */
#include "common/input/yaml_input_private.h"

#include <string.h>

enum { MAX_DEPTH = 32 };

bool yaml_input_open_parser(const YamlInput *input, yaml_parser_t *parser)
{
  if (!yaml_parser_initialize(parser)) return false;
  yaml_parser_set_encoding(parser, YAML_UTF8_ENCODING);
  yaml_parser_set_input_string(parser, (const unsigned char *)input->text, strlen(input->text));
  return true;
}

static size_t line_at(const char *text, size_t offset)
{
  size_t line = 1;
  for (size_t i = 0; i < offset && text[i]; i++) line += text[i] == '\n';
  return line;
}

static bool has_tab(const char *text, size_t line)
{
  for (size_t i = 1; i < line && text; i++) text = (text = strchr(text, '\n')) ? text + 1 : NULL;
  return text && memchr(text, '\t', strcspn(text, "\n"));
}

CastStatus yaml_input_syntax_error(const YamlInput *input, const yaml_parser_t *parser, CastError *err)
{
  if (parser->error == YAML_MEMORY_ERROR)
    return cast_error_set(err, CAST_ERR_MEMORY, "no memory to parse '%s'", input->path);
  if (parser->error == YAML_READER_ERROR)
    return cast_error_set(err, CAST_ERR_INPUT, "%s:%zu: not a text in UTF-8: %s", input->path,
                          line_at(input->text, parser->problem_offset), parser->problem);
  const size_t line = parser->problem_mark.line + 1, begun = parser->context_mark.line + 1;
  CastStatus status = cast_error_set(err, CAST_ERR_INPUT, "%s:%zu: not YAML: %s%s", input->path, line, parser->problem,
                                     has_tab(input->text, line) ? " (a tab; YAML is indented by spaces)" : "");
  const size_t used = err ? strlen(err->message) : 0;
  if (err && parser->context)
    snprintf(err->message + used, sizeof err->message - used, ", %s that begins in line %zu", parser->context, begun);
  return status;
}

static CastStatus check_scalar(const YamlInput *input, const yaml_event_t *event, CastError *err)
{
  const char *value = (const char *)event->data.scalar.value;
  CAST_CHECK(strlen(value) == event->data.scalar.length, err, CAST_ERR_INPUT, "%s:%zu: a NUL character is not allowed",
             input->path, event->start_mark.line + 1);
  return CAST_OK;
}

static CastStatus check_plain(const YamlInput *input, const yaml_event_t *event, CastError *err)
{
  const yaml_char_t *anchor = NULL, *tag = NULL;
  if (event->type == YAML_SCALAR_EVENT) {
    anchor = event->data.scalar.anchor;
    tag = event->data.scalar.tag;
  } else if (event->type == YAML_SEQUENCE_START_EVENT) {
    anchor = event->data.sequence_start.anchor;
    tag = event->data.sequence_start.tag;
  } else if (event->type == YAML_MAPPING_START_EVENT) {
    anchor = event->data.mapping_start.anchor;
    tag = event->data.mapping_start.tag;
  } else if (event->type == YAML_ALIAS_EVENT) {
    anchor = event->data.alias.anchor;
  }
  const size_t line = event->start_mark.line + 1;
  CAST_CHECK(!anchor, err, CAST_ERR_INPUT, "%s:%zu: '%s': anchors (&) and aliases (*) are not used in these files",
             input->path, line, anchor);
  CAST_CHECK(!tag, err, CAST_ERR_INPUT, "%s:%zu: '%s': tags (!) are not used in these files", input->path, line, tag);
  return CAST_OK;
}

typedef struct Scan {
  int depth, documents;
} Scan;

static CastStatus check_event(const YamlInput *input, const yaml_event_t *event, Scan *scan, CastError *err)
{
  const size_t line = event->start_mark.line + 1;
  CAST_CALL(check_plain(input, event, err));
  switch ((int)event->type) {
  case YAML_DOCUMENT_START_EVENT:
    CAST_CHECK(++scan->documents == 1, err, CAST_ERR_INPUT, "%s:%zu: a second document ('---') is not allowed here",
               input->path, line);
    break;
  case YAML_SCALAR_EVENT:
    CAST_CALL(check_scalar(input, event, err));
    break;
  case YAML_SEQUENCE_START_EVENT:
  case YAML_MAPPING_START_EVENT:
    CAST_CHECK(++scan->depth <= MAX_DEPTH, err, CAST_ERR_INPUT, "%s:%zu: nested more than %d deep", input->path, line,
               MAX_DEPTH);
    break;
  case YAML_SEQUENCE_END_EVENT:
  case YAML_MAPPING_END_EVENT:
    scan->depth--;
    break;
  default:
    break;
  }
  return CAST_OK;
}

CastStatus yaml_input_scan(const YamlInput *input, CastError *err)
{
  yaml_parser_t parser;
  CAST_CHECK(yaml_input_open_parser(input, &parser), err, CAST_ERR_MEMORY, "no memory to parse '%s'", input->path);
  CastStatus status = CAST_OK;
  Scan scan = {0, 0};
  bool ended = false;
  while (status == CAST_OK && !ended) {
    yaml_event_t event;
    if (!yaml_parser_parse(&parser, &event)) {
      status = yaml_input_syntax_error(input, &parser, err);
      break;
    }
    ended = event.type == YAML_STREAM_END_EVENT;
    status = check_event(input, &event, &scan, err);
    yaml_event_delete(&event);
  }
  yaml_parser_delete(&parser);
  return status;
}
