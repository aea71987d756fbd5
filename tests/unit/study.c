/* Studies: which runs a plan makes, what is wrong in a study's file, what is read of a run. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cast/study/study.h"
#include "tests/support/assert_close.h"

static char path[64];

static void write_file(const char *text)
{
  snprintf(path, sizeof path, "/tmp/study_XXXXXX");
  const int file = mkstemp(path);
  assert_true(file >= 0);
  assert_int_equal(write(file, text, strlen(text)), strlen(text));
  close(file);
}

static StudyConfig *read_study(const char *text)
{
  StudyConfig *config = NULL;
  CastError err = {0};
  write_file(text);
  const CastStatus status = study_config_read(path, &config, &err);
  unlink(path);
  if (status != CAST_OK) fail_msg("%s", err.message);
  return config;
}

static void expect_fault(const char *text, const char *part)
{
  StudyConfig *config = NULL;
  CastError err = {0};
  write_file(text);
  assert_int_equal(study_config_read(path, &config, &err), CAST_ERR_INPUT);
  unlink(path);
  if (!strstr(err.message, part)) fail_msg("'%s' was expected in: %s", part, err.message);
}

#define HEAD "case: cast.yaml\nfolder: out\n"

static void a_grid_goes_through_all_combinations_the_last_key_fastest(void **state)
{
  (void)state;
  StudyConfig *config = read_study(HEAD "vary:\n  - {key: preheat, from: 700 degC, to: 900 degC, steps: 3}\n"
                                        "  - {key: contact.h, values: [500 W/m^2/K, 2000 W/m^2/K]}\n");
  static const char *const EXPECTED[6][2] = {{"700 degC", "500 W/m^2/K"}, {"700 degC", "2000 W/m^2/K"},
                                             {"800 degC", "500 W/m^2/K"}, {"800 degC", "2000 W/m^2/K"},
                                             {"900 degC", "500 W/m^2/K"}, {"900 degC", "2000 W/m^2/K"}};
  size_t n = 0;
  StudyPoint *points = NULL;
  CastError err = {0};
  assert_int_equal(study_plan_points(config, &n, &points, &err), CAST_OK);
  assert_int_equal(n, 6);
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < 2; k++) assert_string_equal(points[i].value[k], EXPECTED[i][k]);
  free(points);
  study_config_destroy(&config);
}

static void a_latin_hypercube_meets_every_stratum_once_and_is_the_same_again(void **state)
{
  (void)state;
  enum { N = 40 };
  StudyConfig *config = read_study(HEAD "plan: latin-hypercube\nsamples: 40\nseed: 7\nvary:\n"
                                        "  - {key: preheat, from: 700 degC, to: 900 degC}\n"
                                        "  - {key: melt.temperature, from: 1200 degC, to: 1100 degC}\n");
  size_t n = 0;
  StudyPoint *points = NULL, *again = NULL;
  CastError err = {0};
  assert_int_equal(study_plan_points(config, &n, &points, &err), CAST_OK);
  assert_int_equal(study_plan_points(config, &n, &again, &err), CAST_OK);
  assert_int_equal(n, N);
  assert_memory_equal(points, again, n * sizeof *points);
  double product = 0.0;
  for (size_t k = 0; k < 2; k++) {
    int met[N] = {0};
    for (size_t i = 0; i < n; i++) {
      const double at =
          (strtod(points[i].value[k], NULL) - config->key[k].from) / (config->key[k].to - config->key[k].from);
      assert_true(at >= 0.0 && at < 1.0);
      met[(int)(at * N)]++;
    }
    for (int s = 0; s < N; s++) assert_int_equal(met[s], 1);
  }
  for (size_t i = 0; i < n; i++)
    product += (strtod(points[i].value[0], NULL) - 800.0) / 100.0 * (strtod(points[i].value[1], NULL) - 1150.0) / 50.0;
  assert_true(fabs(product / N) <
              0.2); // the keys are shuffled apart: 1/3 if they went together, 1/3/sqrt(40) by chance
  free(points);
  free(again);
  study_config_destroy(&config);
}

static void faults_of_a_study_are_told_with_their_line(void **state)
{
  (void)state;
  expect_fault("folder: out\nvary: [{key: a, values: [1]}]\n", "case");
  expect_fault(HEAD "vary: [{key: a, from: 1 mm, to: 2 m, steps: 3}]\n",
               ":3: vary[1].to: the unit 'm' must be that of");
  expect_fault(HEAD "vary: [{key: a, from: x, to: 2 m, steps: 3}]\n", "a number with its unit is expected");
  expect_fault(HEAD "plan: bisection\nvary: [{key: a, from: 1, to: 2}, {key: b, from: 1, to: 2}]\n"
                    "goal: {quantity: filled, at_least: 0.9, within: 0.1}\n",
               "bisection varies one key, 2 were found");
  expect_fault(HEAD "plan: bisection\nvary: [{key: a, from: 1, to: 2}]\n", "goal");
  expect_fault(HEAD "plan: latin-hypercube\nsamples: 3\nvary: [{key: a, values: [1, 2]}]\n", "belongs to plan: grid");
  expect_fault(HEAD "vary: [{key: a, values: [1]}]\ngoal: {quantity: beauty, at_least: 1}\n", "filled");
  expect_fault(HEAD "vary: [{key: a, values: [1]}]\ngoal: {quantity: filled, at_least: 1, at_most: 2}\n",
               "exactly one of");
  expect_fault(HEAD "vary: [{key: a, from: 1, to: 2, steps: 5000}, {key: b, from: 1, to: 2, steps: 3}]\n",
               "15000 runs; at most 10000");
}

static void a_summary_gives_the_part_before_the_whole_cavity(void **state)
{
  (void)state;
  char folder[] = "/tmp/study_run_XXXXXX", name[80];
  assert_non_null(mkdtemp(folder));
  StudyResult result;
  study_result_read(folder, &result);
  assert_false(result.done);
  assert_false(study_goal_met(&(StudyGoal){.quantity = 0, .bound = 0.0}, &result));
  snprintf(name, sizeof name, "%s/summary.json", folder);
  FILE *file = fopen(name, "w");
  assert_non_null(file);
  fputs("{\"outcome\": \"finished\", \"filling\": {\"cup\": {\"fraction\": 0.1}, \"part\": {\"fraction\": 0.97, "
        "\"t99_s\": null}}, \"melt_K\": {\"min\": 1300.5}}",
        file);
  fclose(file);
  study_result_read(folder, &result);
  assert_true(result.done);
  assert_string_equal(result.outcome, "finished");
  assert_close(result.value[0], 0.97, 0.0);
  assert_true(isnan(result.value[1]));
  assert_close(result.value[2], 1300.5, 0.0);
  assert_true(study_goal_met(&(StudyGoal){.quantity = 0, .bound = 0.95}, &result));
  assert_false(study_goal_met(&(StudyGoal){.quantity = 0, .bound = 0.98}, &result));
  assert_true(study_goal_met(&(StudyGoal){.quantity = 2, .at_most = true, .bound = 1301.0}, &result));
  assert_false(study_goal_met(&(StudyGoal){.quantity = 1, .at_most = true, .bound = 1.0}, &result)); // never filled
  unlink(name);
  rmdir(folder);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_grid_goes_through_all_combinations_the_last_key_fastest),
      cmocka_unit_test(a_latin_hypercube_meets_every_stratum_once_and_is_the_same_again),
      cmocka_unit_test(faults_of_a_study_are_told_with_their_line),
      cmocka_unit_test(a_summary_gives_the_part_before_the_whole_cavity),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
