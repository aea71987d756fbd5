#define _GNU_SOURCE // ftruncate
#include "cast/io/csv.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct CsvFile {
  FILE *file;
  char *path;
  bool row_begun;
  long length;
};

static CastStatus open_file(const char *path, const char *mode, CsvFile **csv, CastError *err)
{
  *csv = calloc(1, sizeof **csv);
  CAST_CHECK(*csv, err, CAST_ERR_MEMORY, "no memory for '%s'", path);
  (*csv)->path = strdup(path);
  (*csv)->file = fopen(path, mode);
  const int reason = errno;
  if ((*csv)->path && (*csv)->file) return CAST_OK;
  csv_close(csv);
  return cast_error_set(err, CAST_ERR_IO, "%s: cannot be opened: %s", path, strerror(reason));
}

CastStatus csv_create(const char *path, const char *about, const char *header, const Provenance *provenance,
                      CsvFile **csv, CastError *err)
{
  CAST_CALL(open_file(path, "w", csv, err));
  FILE *out = (*csv)->file;
  fprintf(out, "# %s\n", about);
  provenance_print(out, "# ", provenance);
  fprintf(out, "%s", header);
  const CastStatus status = csv_end_row(*csv, err);
  if (status != CAST_OK) csv_close(csv);
  return status;
}

CastStatus csv_reopen(const char *path, long length, CsvFile **csv, CastError *err)
{
  CAST_CALL(open_file(path, "r+", csv, err));
  FILE *file = (*csv)->file;
  const bool long_enough = fseek(file, 0, SEEK_END) == 0 && ftell(file) >= length;
  CastStatus status = CAST_OK;
  if (!long_enough)
    status = cast_error_set(err, CAST_ERR_FORMAT, "%s: is shorter than when the checkpoint was written", path);
  else if (ftruncate(fileno(file), length) != 0 || fseek(file, length, SEEK_SET) != 0)
    status = cast_error_set(err, CAST_ERR_IO, "%s: cannot be cut: %s", path, strerror(errno));
  (*csv)->length = length;
  if (status != CAST_OK) csv_close(csv);
  return status;
}

void csv_number(CsvFile *csv, double value)
{
  if (csv->row_begun) fputc(',', csv->file);
  csv->row_begun = true;
  if (!isnan(value)) fprintf(csv->file, "%.9g", value);
}

void csv_word(CsvFile *csv, const char *text)
{
  if (csv->row_begun) fputc(',', csv->file);
  csv->row_begun = true;
  fputs(text, csv->file);
}

CastStatus csv_end_row(CsvFile *csv, CastError *err)
{
  fputc('\n', csv->file);
  csv->row_begun = false;
  CAST_CHECK(fflush(csv->file) == 0 && !ferror(csv->file), err, CAST_ERR_IO, "%s: cannot be written: %s", csv->path,
             strerror(errno));
  csv->length = ftell(csv->file);
  return CAST_OK;
}

long csv_length(const CsvFile *csv)
{
  return csv->length;
}

void csv_close(CsvFile **csv)
{
  if (!csv || !*csv) return;
  if ((*csv)->file) fclose((*csv)->file);
  free((*csv)->path);
  free(*csv);
  *csv = NULL;
}
