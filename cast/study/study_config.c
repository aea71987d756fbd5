/* study_config.c - study.yaml into StudyConfig. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/study/study.h"
#include "common/input/yaml_input.h"

/* "850 degC" -> 850 and "degC". What the unit means is for the case's input to say. */
static bool split_quantity(const char *text, double *number, char unit[32])
{
  char *end = NULL;
  *number = strtod(text, &end);
  if (end == text || !isfinite(*number)) return false;
  end += strspn(end, " ");
  snprintf(unit, 32, "%s", end);
  return strlen(end) < 32;
}

static void read_range(YamlNode node, StudyPlan plan, StudyKey *key)
{
  const YamlNode from = yaml_require(node, "from"), to = yaml_require(node, "to"), steps = yaml_get(node, "steps");
  char unit[32] = "";
  if (yaml_exists(from) && !split_quantity(yaml_string(from, ""), &key->from, key->unit))
    yaml_problem(from, "a number with its unit is expected, such as 700 degC");
  if (yaml_exists(to) && !split_quantity(yaml_string(to, ""), &key->to, unit))
    yaml_problem(to, "a number with its unit is expected, such as 900 degC");
  if (yaml_exists(from) && yaml_exists(to) && strcmp(unit, key->unit) != 0)
    yaml_problem(to, "the unit '%s' must be that of `from`, '%s'", unit, key->unit);
  if (yaml_exists(from) && yaml_exists(to) && key->from == key->to) yaml_problem(to, "a range has two ends");
  if (plan == STUDY_GRID) {
    key->steps = yaml_integer(yaml_require(node, "steps"), 2, STUDY_MOST_RUNS, 2);
  } else if (yaml_exists(steps)) {
    yaml_problem(steps, "belongs to plan: grid");
  }
}

static CastStatus read_values(YamlNode values, StudyPlan plan, StudyKey *key, CastError *err)
{
  if (plan != STUDY_GRID) yaml_problem(values, "a list of values belongs to plan: grid; here a range is expected");
  if (!yaml_is_sequence(values) || yaml_count(values) == 0) {
    yaml_problem(values, "a list of values is expected: [700 degC, 800 degC]");
    return CAST_OK;
  }
  key->value = calloc(yaml_count(values), sizeof *key->value);
  CAST_CHECK(key->value, err, CAST_ERR_MEMORY, "no memory");
  key->n = yaml_count(values);
  for (size_t i = 0; i < key->n; i++) {
    const YamlNode item = yaml_item(values, i);
    const char *text = yaml_string(item, "");
    if (strlen(text) >= sizeof key->value[i] || strchr(text, '"'))
      yaml_problem(item, "a value of at most %zu letters without quotes is expected", sizeof key->value[i] - 1);
    snprintf(key->value[i], sizeof key->value[i], "%s", text);
  }
  return CAST_OK;
}

static CastStatus read_keys(YamlNode node, StudyConfig *config, CastError *err)
{
  if (!yaml_exists(node)) return CAST_OK;
  if (!yaml_is_sequence(node) || yaml_count(node) == 0 || yaml_count(node) > STUDY_KEYS) {
    yaml_problem(node, "a list of 1 to %d keys is expected: [{key: preheat, from: 700 degC, to: 900 degC, steps: 5}]",
                 STUDY_KEYS);
    return CAST_OK;
  }
  config->n_keys = yaml_count(node);
  for (size_t k = 0; k < config->n_keys; k++) {
    const YamlNode item = yaml_item(node, k), path = yaml_require(item, "key"), values = yaml_get(item, "values");
    StudyKey *key = &config->key[k];
    snprintf(key->path, sizeof key->path, "%s", yaml_string(path, ""));
    if (yaml_exists(path) && (strlen(yaml_string(path, "")) >= sizeof key->path || strchr(key->path, '"')))
      yaml_problem(path, "no key of an input looks like this");
    if (yaml_exists(values))
      CAST_CALL(read_values(values, config->plan, key, err));
    else
      read_range(item, config->plan, key);
  }
  if (config->plan == STUDY_BISECTION && config->n_keys != 1)
    yaml_problem(node, "bisection varies one key, %zu were found", config->n_keys);
  return CAST_OK;
}

static void read_goal(YamlNode node, StudyConfig *config)
{
  const char *names[STUDY_QUANTITIES + 1] = {0};
  for (int q = 0; q < STUDY_QUANTITIES; q++) names[q] = study_quantities[q].name;
  StudyGoal *goal = &config->goal;
  goal->quantity = -1;
  const bool bisection = config->plan == STUDY_BISECTION;
  if (!yaml_exists(node)) return;
  goal->quantity = yaml_choice(yaml_require(node, "quantity"), names, 0);
  const char *unit = study_quantities[goal->quantity].unit;
  const YamlNode least = yaml_get(node, "at_least"), most = yaml_get(node, "at_most"), width = yaml_get(node, "within");
  if (yaml_exists(least) == yaml_exists(most)) yaml_problem(node, "exactly one of at_least and at_most is expected");
  goal->at_most = yaml_exists(most);
  goal->bound = yaml_quantity(goal->at_most ? most : least, unit, YAML_ANY, NAN);
  if (!bisection) {
    if (yaml_exists(width)) yaml_problem(width, "belongs to plan: bisection");
    return;
  }
  char text[32] = "";
  const YamlNode within = yaml_require(node, "within");
  if (!yaml_exists(within)) return;
  if (!split_quantity(yaml_string(within, ""), &goal->within, text) || !(goal->within > 0.0))
    yaml_problem(within, "a positive number is expected, such as 10 %s", config->key[0].unit);
  else if (strcmp(text, config->key[0].unit) != 0 &&
           !(strcmp(text, "K") == 0 && strcmp(config->key[0].unit, "degC") == 0))
    yaml_problem(within, "the unit '%s' must be that of the range, '%s'", text, config->key[0].unit);
}

static CastStatus read_root(YamlInput *input, StudyConfig *config, CastError *err)
{
  static const char *const PLANS[] = {"grid", "latin-hypercube", "bisection", NULL};
  const YamlNode root = yaml_root(input);
  const char *path = yaml_input_path(input);
  config->title = strdup(yaml_string(yaml_get(root, "title"), "study"));
  config->case_path = yaml_path_beside(path, yaml_string(yaml_require(root, "case"), ""));
  config->folder = yaml_path_beside(path, yaml_string(yaml_require(root, "folder"), ""));
  CAST_CHECK(config->title && config->case_path && config->folder, err, CAST_ERR_MEMORY, "no memory");
  config->plan = (StudyPlan)yaml_choice(yaml_get(root, "plan"), PLANS, STUDY_GRID);
  const YamlNode samples = yaml_get(root, "samples"), seed = yaml_get(root, "seed");
  if (config->plan == STUDY_LATIN_HYPERCUBE) {
    config->samples = yaml_integer(yaml_require(root, "samples"), 1, STUDY_MOST_RUNS, 1);
    config->seed = yaml_integer(seed, 0, 1000000000, 1);
  } else if (yaml_exists(samples) || yaml_exists(seed)) {
    yaml_problem(yaml_exists(samples) ? samples : seed, "belongs to plan: latin-hypercube");
  }
  CAST_CALL(read_keys(yaml_require(root, "vary"), config, err));
  read_goal(config->plan == STUDY_BISECTION ? yaml_require(root, "goal") : yaml_get(root, "goal"), config);
  config->threads = yaml_integer(yaml_get(root, "threads"), 1, 4096, 1);
  const long cores = omp_get_num_procs() / (int)config->threads;
  config->at_once = yaml_integer(yaml_get(root, "at_once"), 1, 4096, cores > 1 ? cores : 1);
  double runs = 1.0;
  for (size_t k = 0; k < config->n_keys && config->plan == STUDY_GRID; k++)
    runs *= (double)(config->key[k].n ? (long)config->key[k].n : config->key[k].steps);
  if (runs > STUDY_MOST_RUNS)
    yaml_problem(yaml_get(root, "vary"), "%.0f runs; at most %d are allowed", runs, STUDY_MOST_RUNS);
  return yaml_input_finish(input, err);
}

CastStatus study_config_read(const char *path, StudyConfig **config, CastError *err)
{
  *config = NULL;
  YamlInput *input = NULL;
  CAST_CALL(yaml_input_load(path, &input, err));
  StudyConfig *made = calloc(1, sizeof *made);
  CastStatus status = made ? read_root(input, made, err) : cast_error_set(err, CAST_ERR_MEMORY, "no memory");
  yaml_input_destroy(&input);
  if (status != CAST_OK) study_config_destroy(&made);
  *config = made;
  return status;
}

void study_config_destroy(StudyConfig **config)
{
  if (!config || !*config) return;
  for (size_t k = 0; k < STUDY_KEYS; k++) free((*config)->key[k].value);
  free((*config)->title);
  free((*config)->case_path);
  free((*config)->folder);
  free(*config);
  *config = NULL;
}
