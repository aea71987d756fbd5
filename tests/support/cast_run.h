/* cast_run.h - a run of the case of a group of tests (cast_case.h), from input to end. What fails aborts the test. */
#ifndef TESTS_SUPPORT_CAST_RUN_H
#define TESTS_SUPPORT_CAST_RUN_H

#include "cast/sim/sim.h"
#include "tests/support/cast_case.h"

typedef struct CastRun {
  CastConfig *config;
  Sim *sim;
  char folder[128]; // of its results
} CastRun;

/* A run named `name`, ready to go; with_output: its folder is made and its files are opened. */
CastRun cast_run_start(const char *name, const CastCaseInput *input, bool with_output);
SimEnd cast_run_all(const CastRun *run); // to its end
void cast_run_finish(CastRun *run);
/* Fields and ids of the melt, to the last bit. */
void cast_run_assert_same_melt(const Sim *a, const Sim *b);

#endif
