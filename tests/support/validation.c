#include "tests/support/validation.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

static FILE *open_rows(const char *id, const char *mode)
{
  const char *folder = getenv("VALIDATION_DIR");
  if (!folder) return NULL;
  mkdir(folder, 0777); // the rows are a by-product: a folder that exists is fine, one that cannot be made is skipped
  char path[4096];
  snprintf(path, sizeof path, "%s/%s.md", folder, id);
  return fopen(path, mode);
}

void validation_begin(const char *id)
{
  FILE *rows = open_rows(id, "w");
  if (rows) fclose(rows);
}

void validation_write(const ValidationRow *row)
{
  printf("%s: %s: reference %s, ours %s, error %s (target %s), %s, %.2f s CPU\n", row->id, row->quantity,
         row->reference, row->ours, row->error, row->target, row->resolution, row->cpu_seconds);
  FILE *rows = open_rows(row->id, "a");
  if (!rows) return;
  fprintf(rows, "| %s | %s | %s | %s | %s | %s | %s | %.2f |\n", row->id, row->quantity, row->reference, row->ours,
          row->error, row->target, row->resolution, row->cpu_seconds);
  fclose(rows);
}

double validation_cpu_time(void)
{
  return (double)clock() / (double)CLOCKS_PER_SEC;
}

const char *validation_text(const char *format, ...)
{
  static char buffers[16][256];
  static unsigned next = 0;
  char *buffer = buffers[next++ % 16];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(buffer, sizeof buffers[0], format, arguments);
  va_end(arguments);
  return buffer;
}
