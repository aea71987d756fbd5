#include "cast/io/csv_read.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static CastStatus read_all(const char *path, char **text, CastError *err)
{
  FILE *file = fopen(path, "rb");
  CAST_CHECK(file, err, CAST_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
  long size = -1;
  if (fseek(file, 0, SEEK_END) == 0) size = ftell(file);
  rewind(file);
  *text = size >= 0 ? calloc((size_t)size + 1, 1) : NULL;
  const bool read = *text && fread(*text, 1, (size_t)size, file) == (size_t)size;
  fclose(file);
  if (!read) {
    free(*text);
    *text = NULL;
  }
  CAST_CHECK(read, err, CAST_ERR_IO, "%s: cannot be read", path);
  return CAST_OK;
}

static size_t count(const char *text, char c, const char *end)
{
  size_t n = 0;
  for (; text < end; text++) n += *text == c;
  return n;
}

/* Cut a line at its commas into n cells. */
static void cut_line(char *line, char *end, size_t n, char **cell)
{
  *end = '\0';
  for (size_t k = 0; k < n; k++) {
    cell[k] = line;
    char *comma = strchr(line, ',');
    if (!comma) continue;
    *comma = '\0';
    line = comma + 1;
  }
}

static CastStatus cut_rows(const char *path, char *at, CsvTable *table, CastError *err)
{
  char *end = strchr(at, '\n');
  CAST_CHECK(end, err, CAST_ERR_FORMAT, "%s: has no line of column names", path);
  table->n_columns = count(at, ',', end) + 1;
  const size_t most = count(end + 1, '\n', end + 1 + strlen(end + 1));
  table->name = calloc(table->n_columns, sizeof *table->name);
  table->cell = calloc(most * table->n_columns + 1, sizeof *table->cell);
  CAST_CHECK(table->name && table->cell, err, CAST_ERR_MEMORY, "%s: no memory", path);
  char *row = end + 1;
  cut_line(at, end, table->n_columns, table->name);
  for (; (end = strchr(row, '\n')) != NULL; row = end + 1) {
    CAST_CHECK(count(row, ',', end) + 1 == table->n_columns, err, CAST_ERR_FORMAT,
               "%s: row %zu has %zu cells, %zu are expected", path, table->n_rows + 1, count(row, ',', end) + 1,
               table->n_columns);
    cut_line(row, end, table->n_columns, &table->cell[table->n_rows++ * table->n_columns]);
  }
  return CAST_OK;
}

CastStatus csv_read(const char *path, CsvTable *table, CastError *err)
{
  *table = (CsvTable){0};
  CAST_CALL(read_all(path, &table->buffer, err));
  char *at = table->buffer;
  while (*at == '#') {
    char *end = strchr(at, '\n');
    at = end ? end + 1 : at + strlen(at);
  }
  const CastStatus status = cut_rows(path, at, table, err);
  if (status != CAST_OK) csv_table_free(table);
  return status;
}

void csv_table_free(CsvTable *table)
{
  free(table->name);
  free(table->cell);
  free(table->buffer);
  *table = (CsvTable){0};
}

size_t csv_column(const CsvTable *table, const char *name)
{
  size_t k = 0;
  while (k < table->n_columns && strcmp(table->name[k], name) != 0) k++;
  return k;
}

double csv_value(const CsvTable *table, size_t row, size_t column)
{
  const char *text = table->cell[row * table->n_columns + column];
  char *end = NULL;
  const double value = strtod(text, &end);
  return end == text ? (double)NAN : value;
}
