#include "reduce/io/matrix_market.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef struct Reader {
  FILE *file;
  const char *path;
  char *text; // the line in hand
  size_t capacity;
  long line;
  bool array, symmetric;
} Reader;

#define FORMAT_CHECK(condition, reader, err, ...)                                                                      \
  do {                                                                                                                 \
    if (!(condition)) return fail_at_line((reader), (err), __VA_ARGS__);                                               \
  } while (0)

static CastStatus fail_at_line(const Reader *reader, CastError *err, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static CastStatus fail_at_line(const Reader *reader, CastError *err, const char *format, ...)
{
  char message[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  return cast_error_set(err, CAST_ERR_FORMAT, "%s:%ld: %s", reader->path, reader->line, message);
}

/* The next line that is neither empty nor a comment; false at the file's end. */
static bool next_line(Reader *reader)
{
  while (getline(&reader->text, &reader->capacity, reader->file) >= 0) {
    reader->line++;
    const char *at = reader->text;
    while (isspace((unsigned char)*at)) at++;
    if (*at && (*at != '%' || reader->line == 1)) return true;
  }
  return false;
}

static bool only_space(const char *text)
{
  while (isspace((unsigned char)*text)) text++;
  return *text == '\0';
}

static CastStatus read_banner(Reader *reader, CastError *err)
{
  char banner[32] = "", object[32] = "", format[32] = "", field[32] = "", symmetry[32] = "";
  const bool there = next_line(reader);
  if (there) sscanf(reader->text, "%31s %31s %31s %31s %31s", banner, object, format, field, symmetry);
  FORMAT_CHECK(there && strcasecmp(banner, "%%MatrixMarket") == 0 && strcasecmp(object, "matrix") == 0, reader, err,
               "is no Matrix Market file: '%%%%MatrixMarket matrix coordinate real general' or the like is expected in "
               "line 1");
  reader->array = strcasecmp(format, "array") == 0;
  reader->symmetric = strcasecmp(symmetry, "symmetric") == 0;
  FORMAT_CHECK(reader->array || strcasecmp(format, "coordinate") == 0, reader, err,
               "format '%s': 'coordinate' or 'array' is expected", format);
  FORMAT_CHECK(strcasecmp(field, "real") == 0 || strcasecmp(field, "double") == 0 || strcasecmp(field, "integer") == 0,
               reader, err, "numbers that are '%s': 'real' is expected", field);
  FORMAT_CHECK(reader->symmetric || strcasecmp(symmetry, "general") == 0, reader, err,
               "symmetry '%s': 'general' or 'symmetric' is expected", symmetry);
  FORMAT_CHECK(!reader->array || !reader->symmetric, reader, err,
               "an array that is symmetric: 'array real general' or 'coordinate real symmetric' is expected");
  return CAST_OK;
}

static CastStatus read_sizes(Reader *reader, MarketMatrix *matrix, size_t *stored, CastError *err)
{
  enum { LARGEST = 2000000000 };
  long long rows = 0, columns = 0, n = 0;
  int used = 0;
  FORMAT_CHECK(next_line(reader), reader, err, "the file ends before the matrix's size");
  const int found = reader->array ? sscanf(reader->text, "%lld %lld %n", &rows, &columns, &used)
                                  : sscanf(reader->text, "%lld %lld %lld %n", &rows, &columns, &n, &used);
  FORMAT_CHECK(found == (reader->array ? 2 : 3) && only_space(reader->text + used), reader, err,
               "the matrix's size is expected: rows, columns%s", reader->array ? "" : ", number of entries");
  FORMAT_CHECK(rows >= 1 && columns >= 1 && rows <= LARGEST && columns <= LARGEST, reader, err,
               "%lld rows and %lld columns: 1 to %d are expected", rows, columns, (int)LARGEST);
  FORMAT_CHECK(!reader->symmetric || rows == columns, reader, err,
               "%lld rows and %lld columns: a symmetric matrix is square", rows, columns);
  if (reader->array) n = rows * columns;
  FORMAT_CHECK(n >= 0 && n <= LARGEST && n <= rows * columns, reader, err,
               "%lld entries in %lld rows and %lld columns cannot be", n, rows, columns);
  matrix->rows = (PetscInt)rows;
  matrix->columns = (PetscInt)columns;
  *stored = (size_t)n;
  return CAST_OK;
}

/* One number, and nothing else, from `at`. */
static CastStatus read_value(const Reader *reader, const char *at, double *value, CastError *err)
{
  char *end;
  *value = strtod(at, &end);
  FORMAT_CHECK(end != at && only_space(end), reader, err, "'%.60s': a number is expected", at);
  FORMAT_CHECK(isfinite(*value), reader, err, "the entry is %g: a finite number is expected", *value);
  return CAST_OK;
}

static CastStatus read_index(const Reader *reader, char **at, PetscInt limit, const char *what, PetscInt *index,
                             CastError *err)
{
  char *end;
  const long long found = strtoll(*at, &end, 10);
  FORMAT_CHECK(end != *at && isspace((unsigned char)*end), reader, err,
               "row, column and a number are expected, '%.60s' was found", reader->text);
  FORMAT_CHECK(found >= 1 && found <= (long long)limit, reader, err, "%s %lld: 1 to %lld are there", what, found,
               (long long)limit);
  *index = (PetscInt)(found - 1);
  *at = end;
  return CAST_OK;
}

static CastStatus read_entry(Reader *reader, const MarketMatrix *matrix, size_t i, MarketEntry *entry, CastError *err)
{
  char *at = reader->text;
  entry->line = reader->line;
  if (reader->array) { // column by column
    entry->row = (PetscInt)(i % (size_t)matrix->rows);
    entry->column = (PetscInt)(i / (size_t)matrix->rows);
    return read_value(reader, at, &entry->value, err);
  }
  CAST_CALL(read_index(reader, &at, matrix->rows, "row", &entry->row, err));
  CAST_CALL(read_index(reader, &at, matrix->columns, "column", &entry->column, err));
  FORMAT_CHECK(!reader->symmetric || entry->row >= entry->column, reader, err,
               "entry (%lld, %lld) lies above the diagonal: a symmetric file holds the lower triangle",
               (long long)entry->row + 1, (long long)entry->column + 1);
  return read_value(reader, at, &entry->value, err);
}

static CastStatus read_entries(Reader *reader, MarketMatrix *matrix, size_t stored, CastError *err)
{
  matrix->entry = malloc((stored + 1) * (reader->symmetric ? 2 : 1) * sizeof *matrix->entry);
  CAST_CHECK(matrix->entry, err, CAST_ERR_MEMORY, "%s: no memory for %zu entries", reader->path, stored);
  for (size_t i = 0; i < stored; i++) {
    MarketEntry *entry = &matrix->entry[matrix->n];
    FORMAT_CHECK(next_line(reader), reader, err, "the file ends after %zu of %zu entries", i, stored);
    CAST_CALL(read_entry(reader, matrix, i, entry, err));
    if (reader->array && entry->value == 0.0) continue;
    matrix->n++;
    if (!reader->symmetric || entry->row == entry->column) continue;
    matrix->entry[matrix->n++] = (MarketEntry){entry->column, entry->row, entry->value, entry->line};
  }
  FORMAT_CHECK(!next_line(reader), reader, err, "more than the %zu entries announced at its head", stored);
  CAST_CHECK(!ferror(reader->file), err, CAST_ERR_IO, "'%s' cannot be read: %s", reader->path, strerror(errno));
  return CAST_OK;
}

static int compare_entries(const void *left, const void *right)
{
  const MarketEntry *a = left, *b = right;
  if (a->row != b->row) return a->row < b->row ? -1 : 1;
  if (a->column != b->column) return a->column < b->column ? -1 : 1;
  return (a->line > b->line) - (a->line < b->line);
}

static CastStatus sort_entries(const MarketMatrix *matrix, CastError *err)
{
  qsort(matrix->entry, matrix->n, sizeof *matrix->entry, compare_entries);
  for (size_t i = 1; i < matrix->n; i++) {
    const MarketEntry *a = &matrix->entry[i - 1], *b = &matrix->entry[i];
    CAST_CHECK(a->row != b->row || a->column != b->column, err, CAST_ERR_FORMAT,
               "%s:%ld: entry (%lld, %lld) stands in line %ld already", matrix->path, b->line, (long long)b->row + 1,
               (long long)b->column + 1, a->line);
  }
  return CAST_OK;
}

static CastStatus read_contents(Reader *reader, MarketMatrix *matrix, CastError *err)
{
  size_t stored = 0;
  CAST_CALL(read_banner(reader, err));
  CAST_CALL(read_sizes(reader, matrix, &stored, err));
  CAST_CALL(read_entries(reader, matrix, stored, err));
  return sort_entries(matrix, err);
}

CastStatus market_read(const char *path, MarketMatrix *matrix, CastError *err)
{
  Reader reader = {.path = path};
  *matrix = (MarketMatrix){.path = strdup(path)};
  CAST_CHECK(matrix->path, err, CAST_ERR_MEMORY, "no memory for a matrix");
  reader.file = fopen(path, "r");
  CastStatus status = CAST_OK;
  if (!reader.file)
    status = cast_error_set(err, CAST_ERR_IO, "'%s' cannot be opened: %s", path, strerror(errno));
  else
    status = read_contents(&reader, matrix, err);
  if (reader.file) fclose(reader.file);
  free(reader.text);
  if (status != CAST_OK) market_free(matrix);
  return status;
}

MarketEntry *market_find(const MarketMatrix *matrix, PetscInt row, PetscInt column)
{
  size_t low = 0, high = matrix->n;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    MarketEntry *entry = &matrix->entry[middle];
    if (entry->row == row && entry->column == column) return entry;
    if (entry->row < row || (entry->row == row && entry->column < column))
      low = middle + 1;
    else
      high = middle;
  }
  return NULL;
}

void market_free(MarketMatrix *matrix)
{
  free(matrix->path);
  free(matrix->entry);
  *matrix = (MarketMatrix){0};
}
