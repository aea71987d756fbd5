/* bench.h - what benchmarks share: the clock that counts, and an end where something fails. */
#ifndef TESTS_BENCH_BENCH_H
#define TESTS_BENCH_BENCH_H

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "common/error.h"

static inline double bench_cpu_time(void) // s of processor time of all threads
{
  struct timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static inline void must(CastStatus status, const CastError *err)
{
  if (status == CAST_OK) return;
  fprintf(stderr, "%s\n", err->message);
  exit(1);
}

#endif
