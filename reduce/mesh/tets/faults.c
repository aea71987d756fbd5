#include "reduce/mesh/tets/faults.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { ROOM_FOR_HEADING = 512 };

void faults_add(Faults *faults, const char *format, ...)
{
  if (faults->count++ == 0) cast_error_set(faults->err, CAST_ERR_INPUT, "%s", "");
  const size_t used = strlen(faults->err->message), size = sizeof faults->err->message - ROOM_FOR_HEADING;
  char line[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  if (used + strlen(line) + 2 > size) return;
  snprintf(faults->err->message + used, size - used, "%s%s", used ? "\n" : "", line);
}

CastStatus faults_finish(const Faults *faults, const char *heading)
{
  if (faults->count == 0) return CAST_OK;
  char text[ROOM_FOR_HEADING];
  if (faults->count == 1)
    snprintf(text, sizeof text, "%.400s: ", heading);
  else
    snprintf(text, sizeof text, "%.400s, %zu faults:\n", heading, faults->count);
  char *message = faults->err->message;
  const size_t n = strlen(text), room = sizeof faults->err->message - n - 1;
  const size_t keep = strlen(message) < room ? strlen(message) : room;
  memmove(message + n, message, keep);
  memcpy(message, text, n);
  message[n + keep] = '\0';
  return faults->err->code;
}
