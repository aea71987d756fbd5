/* run_record.h - the group /castrun of results.vtkhdf: what went in, who computed it, how it ended. VTK ignores it. */
#ifndef CAST_RESULTS_RUN_RECORD_H
#define CAST_RESULTS_RUN_RECORD_H

#include "cast/io/provenance.h"
#include "common/error.h"

typedef struct RunInputs {
  const char *title, *input, *material, *resolved;
  double spacing; // m
} RunInputs;

/* Write inputs and provenance. Errors: CAST_ERR_IO. */
CastStatus run_record_begin(const char *results, const RunInputs *inputs, const Provenance *provenance, CastError *err);
/* Write (or replace) the summary for people and the one for programs. */
CastStatus run_record_end(const char *results, const char *summary_text, const char *summary_json, CastError *err);
/* The summary for people of a results file. Caller frees. Errors: CAST_ERR_FORMAT. */
CastStatus run_record_read_summary(const char *results, char **text, CastError *err);

/* A text file, written to a temporary name and renamed. Errors: CAST_ERR_IO. */
CastStatus run_record_write_text(const char *path, const char *text, CastError *err);

#endif
