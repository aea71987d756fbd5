/* csv_read.h - reading back a table that csv.h wrote. */
#ifndef CAST_IO_CSV_READ_H
#define CAST_IO_CSV_READ_H

#include <stddef.h>
#include "common/error.h"

typedef struct CsvTable {
  size_t n_columns, n_rows;
  char **name;  // [n_columns]
  char **cell;  // [n_rows*n_columns] texts, empty where there is no value
  char *buffer; // what they point into
} CsvTable;

/* A last row that is not finished is left out. Errors: CAST_ERR_IO; CAST_ERR_FORMAT for rows of different length. */
CastStatus csv_read(const char *path, CsvTable *table, CastError *err);
void csv_table_free(CsvTable *table);
size_t csv_column(const CsvTable *table, const char *name);         // n_columns if there is none
double csv_value(const CsvTable *table, size_t row, size_t column); // NAN for an empty cell

#endif
