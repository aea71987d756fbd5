/* study.h - many runs of one case that differ in a few values of its input, and what came of them.
 *   study_read -> study_run -> study_destroy            castrun sweep STUDY.yaml
 * Each run has a folder of its own (run-0001, ...) in the study's. A run that is done is never repeated; one that was
 * cut off goes on from its checkpoint. The ROM is read once: it serves all of them. */
#ifndef CAST_STUDY_STUDY_H
#define CAST_STUDY_STUDY_H

#include <signal.h>
#include <stdint.h>
#include "common/log.h"
#include "common/rom/rom.h"

enum { STUDY_KEYS = 8, STUDY_MOST_RUNS = 10000 };

typedef enum StudyPlan { STUDY_GRID, STUDY_LATIN_HYPERCUBE, STUDY_BISECTION } StudyPlan;

typedef struct StudyKey { // one value of the input that is varied
  char path[96];          // "melt.temperature"
  size_t n;               // values of a list; 0: a range
  char (*value)[64];      // [n] as text with unit
  double from, to;        // in `unit`
  char unit[32];
  long steps; // of a range in a grid, both ends included
} StudyKey;

typedef struct StudyGoal { // what a run has to reach
  int quantity;            // of study_quantities; -1: no goal
  bool at_most;            // else at least
  double bound;            // SI
  double within;           // bisection: width at which it ends, in the key's unit
} StudyGoal;

typedef struct StudyConfig {
  char *title, *case_path, *folder;
  StudyPlan plan;
  long samples, seed; // Latin hypercube
  size_t n_keys;
  StudyKey key[STUDY_KEYS];
  StudyGoal goal;
  long at_once, threads; // runs side by side; threads of each
} StudyConfig;

/* Errors: CAST_ERR_INPUT with all faults, one a line; CAST_ERR_IO. */
CastStatus study_config_read(const char *path, StudyConfig **config, CastError *err);
void study_config_destroy(StudyConfig **config);

typedef struct StudyPoint { // one run
  char value[STUDY_KEYS][64];
} StudyPoint;

/* The runs of a grid (the last key changes fastest) or of a Latin hypercube: each range is cut into `samples` equal
 * strata, each of which is met once (McKay, Beckman & Conover 1979), at a random place, in a random order.
 *   points  out, [*n], owned by the caller
 * Errors: CAST_ERR_MEMORY. */
CastStatus study_plan_points(const StudyConfig *config, size_t *n, StudyPoint **points, CastError *err);
/* "850 degC": a range's value at a fraction from 0 (from) to 1 (to). */
void study_range_value(const StudyKey *key, double fraction, char text[64]);

/* What a run's summary.json tells. */
typedef struct StudyQuantity {
  const char *name, *unit, *path[3]; // keys of the JSON object, one in the other
} StudyQuantity;
enum { STUDY_QUANTITIES = 11 };
extern const StudyQuantity study_quantities[STUDY_QUANTITIES];

typedef struct StudyResult {
  bool done;
  char outcome[256];
  double value[STUDY_QUANTITIES]; // NAN: not told
} StudyResult;

/* Read a run's summary; one that is absent or cannot be read leaves result->done false. */
void study_result_read(const char *folder, StudyResult *result);
bool study_goal_met(const StudyGoal *goal, const StudyResult *result);

/* folder/study.csv, made anew beside its place and renamed, and folder/study.png, the goal's quantity (or the filled
 * fraction) over each key. Errors: CAST_ERR_IO, CAST_ERR_MEMORY. */
CastStatus study_write_table(const StudyConfig *config, size_t n, const StudyPoint *points, const StudyResult *results,
                             CastError *err);
CastStatus study_draw(const StudyConfig *config, size_t n, const StudyPoint *points, const StudyResult *results,
                      CastError *err);

typedef struct StudyHow {
  const char *command; // for provenance
  Log *log;            // borrowed
  const volatile sig_atomic_t *stop;
  long only; // the only run wanted, from 1, for a cluster's job arrays; 0: all
} StudyHow;

/* Run what is not done yet and write the table after each run. *interrupted: a signal stopped it; the same command goes
 * on. Failed runs are told in the table and do not stop the others. Errors: CAST_ERR_IO, CAST_ERR_INPUT,
 * CAST_ERR_MEMORY; CAST_ERR_NUMERIC: no run came to its end. */
CastStatus study_run(const StudyConfig *config, const StudyHow *how, bool *interrupted, CastError *err);

#endif
