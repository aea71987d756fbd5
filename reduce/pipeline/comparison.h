/* comparison.h - one mould, reduced by each method: the figures of each as a table, as CSV and as a plot. */
#ifndef REDUCE_PIPELINE_COMPARISON_H
#define REDUCE_PIPELINE_COMPARISON_H

#include <stdio.h>
#include "common/error.h"

enum { COMPARISON_MOST = 12 };

typedef struct ComparisonRow {
  char method[64], family[32]; // rows of one family are joined in the plot
  long states;
  double cpu_seconds;                   // reduction and certificate, all ranks
  double reduction_share;               // of them, the reduction's
  double peak_bytes;                    // largest resident memory, all ranks
  double step_error;                    // certified, of the largest rise
  double transfer_bound;                // largest relative bound of H(iw); NAN: not computed
  double second_stage;                  // K/W, a-priori bound or largest change; 0: no second stage
  double multiplications, step_seconds; // online, a step
} ComparisonRow;

typedef struct Comparison {
  const char *title; // borrowed
  long unknowns, patches;
  double tolerance, t_start, t_end;
  double full_dt, full_operations, full_seconds, full_iterations; // one implicit step of the full model
  size_t n;
  ComparisonRow row[COMPARISON_MOST];
} Comparison;

void comparison_print(const Comparison *comparison, FILE *out);
/* Errors: CAST_ERR_IO, CAST_ERR_MEMORY. Nothing is left under `path` after a failure. */
CastStatus comparison_write_csv(const Comparison *comparison, const char *path, CastError *err);
CastStatus comparison_draw(const Comparison *comparison, const char *path, CastError *err);

#endif
