#define _GNU_SOURCE // nanosleep, kill
/* Studies as a user runs them ($CASTRUN sweep): bisection finds what it looks for, runs that are done are not repeated,
 * an interrupted study goes on, a run that fails does not stop the others. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "cast/io/csv_read.h"
#include "tests/support/cast_case.h"
#include "tests/support/program.h"
#include "tests/support/text_file.h"

static const char *program;

static int set_up(void **state)
{
  program = getenv("CASTRUN");
  if (!program) fprintf(stderr, "CASTRUN does not name the program\n");
  return !program || cast_case_set_up(state) != 0;
}

/* NAME.yaml, a case that ends after `end`, and NAME-study.yaml with `lines`, whose folder is NAME-study. */
static void make_study(const char *name, const char *end, const char *lines, char study[160])
{
  char path[128], time[64];
  CastError err = {0};
  snprintf(time, sizeof time, "{ end: %s }", end);
  const CastCaseInput input = {.time = time};
  if (cast_case_input(&casting, name, &input, path, &err) != CAST_OK) fail_msg("%s", err.message);
  snprintf(study, 160, "%.60s/%s-study.yaml", casting.folder, name);
  FILE *file = fopen(study, "w");
  assert_non_null(file);
  fprintf(file, "title: %s\ncase: %s.yaml\nfolder: %s-study\nat_once: 2\n%s", name, name, name, lines);
  fclose(file);
}

static pid_t sweep(const char *study, const char *only)
{
  return launch((const char *[]){program, "sweep", study, only ? "--only" : NULL, only, NULL}, "/dev/null");
}

static CsvTable read_table(const char *name)
{
  CastError err = {0};
  CsvTable table;
  char path[200];
  snprintf(path, sizeof path, "%.60s/%s-study/study.csv", casting.folder, name);
  if (csv_read(path, &table, &err) != CAST_OK) fail_msg("%s", err.message);
  return table;
}

static const char *cell(const CsvTable *table, size_t row, const char *column)
{
  return table->cell[row * table->n_columns + csv_column(table, column)];
}

/* The mould warms what lies in it: the colder melt's last temperature rises with the preheat, and the bound lies
 * between those of the two ends. */
static void bisection_closes_in_on_the_threshold_and_repeats_nothing(void **state)
{
  (void)state;
  char study[160], path[200];
  make_study("probe", "1 ms", "vary: [{ key: preheat, values: [700 degC, 1000 degC] }]\n", study);
  assert_int_equal(exit_code(sweep(study, NULL)), 0);
  CsvTable ends = read_table("probe");
  const size_t mean = csv_column(&ends, "melt_mean_K");
  const double low = csv_value(&ends, 0, mean), high = csv_value(&ends, 1, mean);
  assert_true(low < high);
  csv_table_free(&ends);
  char lines[300];
  snprintf(lines, sizeof lines,
           "plan: bisection\nvary: [{ key: preheat, from: 700 degC, to: 1000 degC }]\n"
           "goal: { quantity: melt_mean, at_least: %.12g K, within: 50 K }\n",
           low + 0.4 * (high - low));
  make_study("bisect", "1 ms", lines, study);
  assert_int_equal(exit_code(sweep(study, NULL)), 0);
  CsvTable table = read_table("bisect");
  // 700 missed, 1000 met, 850 met, 775 missed, 812.5 missed or met: 37.5 K are left
  static const char *const PREHEAT[] = {"700 degC", "1000 degC", "850 degC", "775 degC"};
  static const char *const MET[] = {"no", "yes", "yes", "no"};
  assert_int_equal(table.n_rows, 5);
  for (size_t row = 0; row < 4; row++) {
    assert_string_equal(cell(&table, row, "preheat"), PREHEAT[row]);
    assert_string_equal(cell(&table, row, "goal_met"), MET[row]);
  }
  assert_string_equal(cell(&table, 4, "preheat"), "812.5 degC");
  csv_table_free(&table);
  struct stat before, after;
  snprintf(path, sizeof path, "%.60s/bisect-study/run-0003/summary.json", casting.folder);
  assert_int_equal(stat(path, &before), 0);
  assert_int_equal(exit_code(sweep(study, NULL)), 0);
  assert_int_equal(stat(path, &after), 0);
  assert_true(before.st_mtim.tv_sec == after.st_mtim.tv_sec && before.st_mtim.tv_nsec == after.st_mtim.tv_nsec);
}

static void a_run_that_fails_is_told_and_the_others_are_done(void **state)
{
  (void)state;
  char study[160];
  make_study("fails", "0.5 ms", "vary: [{ key: sph.spacing, values: [0.4 mm, 3 s, 0.5 mm] }]\n", study);
  assert_int_equal(exit_code(sweep(study, NULL)), 0);
  CsvTable table = read_table("fails");
  assert_int_equal(table.n_rows, 3);
  assert_string_equal(cell(&table, 0, "outcome"), "finished");
  assert_non_null(strstr(cell(&table, 1, "outcome"), "a length is expected"));
  assert_string_equal(cell(&table, 2, "outcome"), "finished");
  csv_table_free(&table);
}

static void one_run_alone_does_for_a_job_array_and_the_rest_is_gathered_later(void **state)
{
  (void)state;
  char study[160], path[200];
  make_study("array", "0.5 ms", "vary: [{ key: preheat, from: 700 degC, to: 800 degC, steps: 2 }]\n", study);
  assert_int_equal(exit_code(sweep(study, "2")), 0);
  snprintf(path, sizeof path, "%.60s/array-study/run-0001", casting.folder);
  assert_int_not_equal(access(path, F_OK), 0);
  snprintf(path, sizeof path, "%.60s/array-study/run-0002/summary.json", casting.folder);
  assert_int_equal(access(path, F_OK), 0);
  assert_int_equal(exit_code(sweep(study, "3")), 1);
  assert_int_equal(exit_code(sweep(study, NULL)), 0);
  CsvTable table = read_table("array");
  for (size_t row = 0; row < 2; row++) assert_string_equal(cell(&table, row, "outcome"), "finished");
  csv_table_free(&table);
}

static void an_interrupted_study_goes_on_from_the_checkpoints(void **state)
{
  (void)state;
  char study[160], path[200], log[200];
  make_study("cut", "4 ms", "vary: [{ key: preheat, from: 700 degC, to: 800 degC, steps: 2 }]\n", study);
  const pid_t child = sweep(study, NULL);
  snprintf(path, sizeof path, "%.60s/cut-study/run-0001/ledger.csv", casting.folder);
  struct stat info = {0};
  for (int k = 0; k < 1200 && (stat(path, &info) != 0 || info.st_size < 1500); k++)
    nanosleep(&(struct timespec){0, 10000000}, NULL);
  kill(child, SIGTERM);
  assert_int_equal(exit_code(child), 3);
  snprintf(path, sizeof path, "%.60s/cut-study/run-0001/checkpoint.h5", casting.folder);
  assert_int_equal(access(path, R_OK), 0);
  assert_int_equal(exit_code(sweep(study, NULL)), 0);
  snprintf(log, sizeof log, "%.60s/cut-study/run-0001/castrun.log", casting.folder);
  char *text = text_file_read(log);
  assert_non_null(strstr(text, "resumed at t ="));
  free(text);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bisection_closes_in_on_the_threshold_and_repeats_nothing),
      cmocka_unit_test(a_run_that_fails_is_told_and_the_others_are_done),
      cmocka_unit_test(one_run_alone_does_for_a_job_array_and_the_rest_is_gathered_later),
      cmocka_unit_test(an_interrupted_study_goes_on_from_the_checkpoints),
  };
  return cmocka_run_group_tests(tests, set_up, cast_case_clean_up);
}
