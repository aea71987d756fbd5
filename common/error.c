#include "common/error.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

CastStatus cast_error_set(CastError *err, CastStatus code, const char *format, ...)
{
  if (err) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(err->message, sizeof err->message, format, arguments);
    va_end(arguments);
    err->code = code;
  }
  return code;
}

CastStatus cast_error_prefix(CastError *err, const char *text)
{
  char old[sizeof err->message];
  memcpy(old, err->message, sizeof old);
  if (snprintf(err->message, sizeof err->message, "%s: %s", text, old) < 0) err->message[0] = '\0';
  return err->code;
}
