/* csv.h - tables that grow during a run: '#' lines with what they hold, one line of column names, then rows.
 * A value that is not a number becomes an empty cell. Rows are flushed, so a table can be read while it grows. */
#ifndef CAST_IO_CSV_H
#define CAST_IO_CSV_H

#include "cast/io/provenance.h"
#include "common/error.h"

typedef struct CsvFile CsvFile;

/*  about   one line on what the table is
 *  header  column names, separated by commas
 * Errors: CAST_ERR_IO. */
CastStatus csv_create(const char *path, const char *about, const char *header, const Provenance *provenance,
                      CsvFile **csv, CastError *err);
/* Go on with a table after its first `length` bytes; what follows is dropped. Errors: CAST_ERR_IO, CAST_ERR_FORMAT. */
CastStatus csv_reopen(const char *path, long length, CsvFile **csv, CastError *err);
void csv_number(CsvFile *csv, double value);
void csv_word(CsvFile *csv, const char *text);
/* Errors: CAST_ERR_IO with the system's reason. */
CastStatus csv_end_row(CsvFile *csv, CastError *err);
long csv_length(const CsvFile *csv); // bytes of whole rows
void csv_close(CsvFile **csv);

#endif
