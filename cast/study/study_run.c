/* study_run.c - the runs as processes of their own, as many at once as there are cores for. A process is a copy of this
 * one (fork), so the ROM that was read here is shared by all; nothing here may have started threads before. */
#define _GNU_SOURCE // open_memstream
#include <errno.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cast/results/run_record.h"
#include "cast/sim/run_case.h"
#include "cast/study/study.h"
#include "common/hash.h"
#include "common/input/yaml_input.h"

typedef struct Running {
  pid_t process; // 0: none
  size_t run;
  double begun; // s
} Running;

typedef struct Work {
  const StudyConfig *config;
  const StudyHow *how;
  RomData *rom;
  char rom_path[4300], identity[160]; // of ROM and case: what a run that is done must have been made with
  size_t n, capacity;
  StudyPoint *point;
  StudyResult *result;
  Running *running; // [at_once]
} Work;

static void folder_of(const Work *w, size_t run, char path[4200])
{
  snprintf(path, 4200, "%.4000s/run-%04zu", w->config->folder, run + 1);
}

/* The lines of `overrides` of a run. The caller owns the text; NULL: no memory. */
static char *overrides_of(const Work *w, size_t run)
{
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  if (!out) return NULL;
  for (size_t k = 0; k < w->config->n_keys; k++)
    fprintf(out, "  \"%s\": %s\n", w->config->key[k].path, w->point[run].value[k]);
  char *absolute = realpath(w->config->folder, NULL);
  fprintf(out, "  output.folder: \"%s/run-%04zu\"\n", absolute ? absolute : w->config->folder, run + 1);
  free(absolute);
  fclose(out);
  return text;
}

/* ---- what a run was made of ---- */

static CastStatus identify(Work *w, CastError *err)
{
  char *text = NULL, rom[65], input[65];
  CAST_CALL(yaml_input_read_text(w->config->case_path, &text, err));
  hash_bytes(text, strlen(text), input);
  free(text);
  CAST_CALL(hash_file(w->rom_path, rom, err));
  snprintf(w->identity, sizeof w->identity, "case %s rom %s", input, rom);
  return CAST_OK;
}

/* The text that stands in a run's folder while and after it runs; the caller owns it. */
static char *label_of(const Work *w, size_t run)
{
  char *overrides = overrides_of(w, run), *text = NULL;
  const size_t size = overrides ? strlen(overrides) + sizeof w->identity + 16 : 0;
  text = overrides ? malloc(size) : NULL;
  if (text) snprintf(text, size, "# %s\n%s", w->identity, overrides);
  free(overrides);
  return text;
}

/* Does the folder hold this very run? */
static bool same_run(const Work *w, size_t run)
{
  char folder[4200], path[4300], *text = NULL, *label = label_of(w, run);
  CastError ignored;
  folder_of(w, run, folder);
  snprintf(path, sizeof path, "%s/point.yaml", folder);
  bool same = label && access(path, R_OK) == 0 && yaml_input_read_text(path, &text, &ignored) == CAST_OK;
  same = same && strcmp(text, label) == 0;
  free(text);
  free(label);
  return same;
}

static CastStatus write_label(const Work *w, size_t run, CastError *err)
{
  char folder[4200], path[4300];
  folder_of(w, run, folder);
  CAST_CALL(run_case_make_folder(folder, err));
  static const char *const OLD[] = {"summary.json", "summary.txt", "checkpoint.h5"};
  for (int k = 0; k < 3; k++) { // of another run: they would pass for this one's
    snprintf(path, sizeof path, "%s/%s", folder, OLD[k]);
    unlink(path);
  }
  snprintf(path, sizeof path, "%s/point.yaml", folder);
  char *label = label_of(w, run);
  CAST_CHECK(label, err, CAST_ERR_MEMORY, "no memory");
  const CastStatus status = run_record_write_text(path, label, err);
  free(label);
  return status;
}

/* ---- one run, in its own process ---- */

static CastStatus compute(const Work *w, size_t run, bool resume, SimEnd *end, CastError *err)
{
  char folder[4200];
  folder_of(w, run, folder);
  const RunCase how = {w->how->command, true, w->how->stop};
  if (resume) return run_case_resume(folder, &how, end, err);
  CAST_CALL(write_label(w, run, err));
  char *overrides = overrides_of(w, run);
  CastConfig *config = NULL;
  CastStatus status = overrides ? run_case_read(w->config->case_path, overrides, &config, err)
                                : cast_error_set(err, CAST_ERR_MEMORY, "no memory");
  if (status == CAST_OK && strcmp(config->rom_path, w->rom_path) == 0) config->loaded_rom = w->rom;
  if (status == CAST_OK) status = run_case(config, &how, end, err);
  cast_config_destroy(&config);
  free(overrides);
  return status;
}

/* begun: the folder holds this run's beginning */
static void launch(Work *w, Running *slot, size_t run, bool begun)
{
  char folder[4200], path[4300];
  folder_of(w, run, folder);
  snprintf(path, sizeof path, "%s/checkpoint.h5", folder);
  const bool resume = begun && access(path, R_OK) == 0;
  fflush(NULL);
  *slot = (Running){fork(), run, log_wall_time()};
  if (slot->process != 0) return;
  setpgid(0, 0); // signals of the terminal come by way of the parent, once
  CastError err = {0};
  SimEnd end = SIM_FINISHED;
  omp_set_num_threads((int)w->config->threads);
  const CastStatus status = compute(w, run, resume, &end, &err);
  if (status != CAST_OK) { // where the parent looks for the reason
    CastError other;
    snprintf(path, sizeof path, "%s/failure.txt", folder);
    if (run_record_write_text(path, err.message, &other) != CAST_OK) fprintf(stderr, "%s\n", err.message);
  }
  fflush(NULL);
  _exit(status != CAST_OK ? 1 : end == SIM_INTERRUPTED ? 3 : 0);
}

/* ---- all of them ---- */

static void describe(const Work *w, size_t run, char text[512])
{
  size_t used = 0;
  for (size_t k = 0; k < w->config->n_keys && used < 480; k++)
    used += (size_t)snprintf(text + used, 512 - used, "%s%s = %s", k ? ", " : "", w->config->key[k].path,
                             w->point[run].value[k]);
}

static void tell(const Work *w, size_t run, const char *how, double seconds)
{
  char what[512], value[128] = "";
  const StudyResult *r = &w->result[run];
  describe(w, run, what);
  const int q = w->config->goal.quantity >= 0 ? w->config->goal.quantity : 0;
  if (r->done)
    snprintf(value, sizeof value, ", %s %.6g %s", study_quantities[q].name, r->value[q],
             strcmp(study_quantities[q].unit, "1") == 0 ? "" : study_quantities[q].unit);
  log_info(w->how->log, "run-%04zu: %s: %s%s (%.0f s)", run + 1, what, r->done ? r->outcome : how, value, seconds);
}

/* Wait for one run to end, or for a signal. */
static void collect_one(Work *w)
{
  int status = 0;
  const pid_t process = waitpid(-1, &status, 0);
  if (process < 0) return;
  for (long k = 0; k < w->config->at_once; k++) {
    Running *slot = &w->running[k];
    if (slot->process != process) continue;
    char folder[4200], path[4300], *reason = NULL;
    CastError ignored;
    folder_of(w, slot->run, folder);
    StudyResult *result = &w->result[slot->run];
    study_result_read(folder, result);
    snprintf(path, sizeof path, "%s/failure.txt", folder);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) result->done = false;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 1 && yaml_input_read_text(path, &reason, &ignored) == CAST_OK)
      snprintf(result->outcome, sizeof result->outcome, "failed: %.240s", reason);
    else if (WIFSIGNALED(status))
      snprintf(result->outcome, sizeof result->outcome, "ended by signal %d", WTERMSIG(status));
    else if (!result->done)
      snprintf(result->outcome, sizeof result->outcome, "interrupted");
    free(reason);
    unlink(path);
    tell(w, slot->run, result->outcome, log_wall_time() - slot->begun);
    slot->process = 0;
  }
}

static bool any_running(const Work *w)
{
  for (long k = 0; k < w->config->at_once; k++)
    if (w->running[k].process > 0) return true;
  return false;
}

static Running *free_slot(const Work *w)
{
  for (long k = 0; k < w->config->at_once; k++)
    if (w->running[k].process == 0) return &w->running[k];
  return NULL;
}

static bool stopping(const Work *w)
{
  return w->how->stop && *w->how->stop;
}

static void pass_on_signal(const Work *w)
{
  for (long k = 0; k < w->config->at_once; k++)
    if (w->running[k].process > 0) kill(w->running[k].process, SIGTERM);
}

/* Run what is not done of the runs first..end-1; the table is brought up to date after each. */
static CastStatus run_range(Work *w, size_t first, size_t end, CastError *err)
{
  bool passed = false;
  for (size_t next = first; next < end || any_running(w);) {
    if (stopping(w) && !passed) {
      pass_on_signal(w);
      passed = true;
    }
    Running *slot = passed ? NULL : free_slot(w);
    if (passed) next = end;
    if (slot && next < end) {
      char folder[4200];
      folder_of(w, next, folder);
      const bool begun = same_run(w, next);
      if (begun) study_result_read(folder, &w->result[next]);
      if (w->result[next].done)
        tell(w, next, "", 0.0);
      else
        launch(w, slot, next, begun);
      CAST_CHECK(slot->process >= 0, err, CAST_ERR_MEMORY, "no process can be started: %s", strerror(errno));
      next++;
      continue;
    }
    if (!any_running(w)) continue;
    collect_one(w);
    CAST_CALL(study_write_table(w->config, w->n, w->point, w->result, err));
  }
  return study_write_table(w->config, w->n, w->point, w->result, err);
}

static CastStatus add_point(Work *w, double fraction, CastError *err)
{
  if (w->n == w->capacity) {
    const size_t capacity = 2 * w->capacity + 4;
    StudyPoint *point = realloc(w->point, capacity * sizeof *point);
    if (point) w->point = point;
    StudyResult *result = realloc(w->result, capacity * sizeof *result);
    if (result) w->result = result;
    CAST_CHECK(point && result, err, CAST_ERR_MEMORY, "no memory for %zu runs", capacity);
    w->capacity = capacity;
  }
  w->result[w->n] = (StudyResult){0};
  study_range_value(&w->config->key[0], fraction, w->point[w->n].value[0]);
  w->n++;
  return CAST_OK;
}

/* One run at a fraction of the range; *met: the goal. */
static CastStatus try_fraction(Work *w, double fraction, bool *met, CastError *err)
{
  CAST_CALL(add_point(w, fraction, err));
  CAST_CALL(run_range(w, w->n - 1, w->n, err));
  *met = study_goal_met(&w->config->goal, &w->result[w->n - 1]);
  CAST_CHECK(w->result[w->n - 1].done || stopping(w), err, CAST_ERR_NUMERIC, "run-%04zu: %s", w->n,
             w->result[w->n - 1].outcome);
  return CAST_OK;
}

/* Both ends first, side by side where there are cores for it; then the middle of what is left. */
static CastStatus bisect(Work *w, CastError *err)
{
  const StudyKey *key = &w->config->key[0];
  CAST_CALL(add_point(w, 0.0, err));
  CAST_CALL(add_point(w, 1.0, err));
  CAST_CALL(run_range(w, 0, 2, err));
  if (stopping(w)) return CAST_OK;
  for (size_t i = 0; i < 2; i++)
    CAST_CHECK(w->result[i].done, err, CAST_ERR_NUMERIC, "run-%04zu: %s", i + 1, w->result[i].outcome);
  const bool met[2] = {study_goal_met(&w->config->goal, &w->result[0]),
                       study_goal_met(&w->config->goal, &w->result[1])};
  if (met[0] == met[1]) {
    log_warn(w->how->log, "the goal is %s at both ends of the range, %s and %s: the threshold lies elsewhere",
             met[0] ? "met" : "missed", w->point[0].value[0], w->point[1].value[0]);
    return CAST_OK;
  }
  double good = met[0] ? 0.0 : 1.0, bad = 1.0 - good;
  while (fabs(good - bad) * fabs(key->to - key->from) > w->config->goal.within) {
    bool here = false;
    const double middle = 0.5 * (good + bad);
    CAST_CALL(try_fraction(w, middle, &here, err));
    if (stopping(w)) return CAST_OK;
    *(here ? &good : &bad) = middle;
  }
  char good_text[64], bad_text[64];
  study_range_value(key, good, good_text);
  study_range_value(key, bad, bad_text);
  log_info(w->how->log, "the goal is met at %s = %s and missed at %s", key->path, good_text, bad_text);
  return CAST_OK;
}

static CastStatus run_points(Work *w, CastError *err)
{
  if (w->config->plan == STUDY_BISECTION) return bisect(w, err);
  CAST_CALL(study_plan_points(w->config, &w->n, &w->point, err));
  w->capacity = w->n;
  w->result = calloc(w->n, sizeof *w->result);
  CAST_CHECK(w->result, err, CAST_ERR_MEMORY, "no memory for %zu runs", w->n);
  const size_t only = (size_t)w->how->only;
  CAST_CHECK(only <= w->n, err, CAST_ERR_INPUT, "run %zu is asked for, the study has %zu", only, w->n);
  log_info(w->how->log, "%zu runs, %ld at once on %ld thread%s each", w->n, w->config->at_once, w->config->threads,
           w->config->threads == 1 ? "" : "s");
  return run_range(w, only ? only - 1 : 0, only ? only : w->n, err);
}

/* Read the case once as it is: its faults are told before anything runs, and it names the ROM. */
static CastStatus prepare(Work *w, CastError *err)
{
  CastConfig *config = NULL;
  CAST_CALL(cast_config_read(w->config->case_path, NULL, &config, err));
  snprintf(w->rom_path, sizeof w->rom_path, "%s", config->rom_path);
  cast_config_destroy(&config);
  CAST_CALL(identify(w, err));
  CAST_CALL(rom_read(w->rom_path, &w->rom, err));
  w->running = calloc((size_t)w->config->at_once, sizeof *w->running);
  CAST_CHECK(w->running, err, CAST_ERR_MEMORY, "no memory");
  return run_case_make_folder(w->config->folder, err);
}

CastStatus study_run(const StudyConfig *config, const StudyHow *how, bool *interrupted, CastError *err)
{
  Work w = {.config = config, .how = how};
  log_info(how->log, "%s", config->title);
  CastStatus status =
      config->plan == STUDY_BISECTION && how->only
          ? cast_error_set(err, CAST_ERR_INPUT, "a bisection's runs depend on each other: --only cannot be")
          : prepare(&w, err);
  if (status == CAST_OK) status = run_points(&w, err);
  *interrupted = stopping(&w);
  size_t done = 0;
  for (size_t i = 0; i < w.n && w.result; i++) done += w.result[i].done;
  if (status == CAST_OK && done > 0 && !how->only) status = study_draw(config, w.n, w.point, w.result, err);
  if (status == CAST_OK && done == 0 && !*interrupted)
    status = cast_error_set(err, CAST_ERR_NUMERIC, "no run came to its end; see %s/study.csv", config->folder);
  if (status == CAST_OK) log_info(how->log, "%zu of %zu runs done: %s/study.csv", done, w.n, config->folder);
  rom_destroy(&w.rom);
  free(w.point);
  free(w.result);
  free(w.running);
  return status;
}
