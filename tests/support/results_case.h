/* results_case.h - the small casting of cast_case.h with its ROM and its alloy read, and melt to write results of, for
 * tests of what a run writes. */
#ifndef TESTS_SUPPORT_RESULTS_CASE_H
#define TESTS_SUPPORT_RESULTS_CASE_H

#include "cast/results/melt_results.h"
#include "tests/support/cast_case.h"

extern RomData *results_rom;
extern Material results_melt;
int results_case_set_up(void **state); // for cmocka's group
int results_case_clean_up(void **state);

/* 24 particles, and the results of melt in the case's folder opened for them. The caller closes and destroys both. */
MeltResults *results_case_begin(Particles *particles);
/* Three steps, 0.5 s apart, of the 24 particles, of 24 and of 23: one leaves. They are shuffled in between, as the
 * neighbour search does. */
void results_case_three_steps(MeltResults *results, Particles *particles);

/* A data set of `expected` rows of integers; the caller frees it. */
long long *results_case_integers(hid_t file, const char *name, hsize_t expected);

#endif
