/* The examples' inputs: each folder's mould.yaml is read and its geometry looked through by castreduce, each other
 * input is read, what a casting calls its part is there in the mould, and the README's pictures are there. */
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "cast/config/config.h"
#include "cast/study/study.h"
#include "cast_build_config.h"
#include "tests/support/assert_ok.h"
#include "tests/support/program.h"

static const char ROOT[] = CAST_SHARE_SOURCE "/../examples";
static const char *castreduce; // NULL where it is not built

static bool ends_with(const char *name, const char *end)
{
  const size_t n = strlen(name), m = strlen(end);
  return n >= m && strcmp(name + n - m, end) == 0;
}

/* Call `look` with each folder of the examples that holds a mould; `folder` is its path. */
static void each_example(void (*look)(const char *folder))
{
  DIR *root = opendir(ROOT);
  assert_non_null(root);
  int n = 0;
  for (struct dirent *entry; (entry = readdir(root));) {
    char folder[1024], mould[1040];
    snprintf(folder, sizeof folder, "%s/%s", ROOT, entry->d_name);
    snprintf(mould, sizeof mould, "%s/mould.yaml", folder);
    if (entry->d_name[0] == '.' || access(mould, R_OK) != 0) continue;
    look(folder);
    n++;
  }
  closedir(root);
  assert_true(n >= 5);
}

static void look_through_mould(const char *folder)
{
  if (run("'%s' check '%s/mould.yaml' 2>&1", castreduce, folder) != 0) fail_msg("%s: %s", folder, said);
}

static void castreduce_finds_nothing_wrong_with_the_moulds(void **state)
{
  (void)state;
  if (!castreduce) skip();
  each_example(look_through_mould);
}

static bool names_surface(const char *folder, const char *name)
{
  char path[1040];
  CastError err = {0};
  YamlInput *mould = NULL;
  snprintf(path, sizeof path, "%s/mould.yaml", folder);
  ok(yaml_input_load(path, &mould, &err), &err);
  const YamlNode cavity = yaml_get(yaml_root(mould), "cavity");
  const bool found = yaml_exists(yaml_get(yaml_get(cavity, "surfaces"), name));
  yaml_input_destroy(&mould);
  return found;
}

static void read_casting(const char *folder, const char *path)
{
  CastConfig *config = NULL;
  CastError err = {0};
  ok(cast_config_read(path, NULL, &config, &err), &err);
  for (size_t i = 0; i < config->n_part; i++) {
    bool found = names_surface(folder, config->part[i]);
    for (size_t k = 0; k < config->n_features; k++) found |= strcmp(config->feature[k].name, config->part[i]) == 0;
    if (!found) fail_msg("%s: part: '%s' is neither a cavity surface nor a feature", path, config->part[i]);
  }
  cast_config_destroy(&config);
}

static void read_study(const char *path)
{
  StudyConfig *config = NULL;
  CastError err = {0};
  ok(study_config_read(path, &config, &err), &err);
  study_config_destroy(&config);
}

static bool is_study(const char *path)
{
  CastError err = {0};
  YamlInput *input = NULL;
  ok(yaml_input_load(path, &input, &err), &err);
  const bool study = yaml_exists(yaml_get(yaml_root(input), "vary"));
  yaml_input_destroy(&input);
  return study;
}

static void read_inputs(const char *folder)
{
  DIR *dir = opendir(folder);
  assert_non_null(dir);
  int castings = 0;
  for (struct dirent *entry; (entry = readdir(dir));) {
    char path[2048];
    snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
    if (!ends_with(path, ".yaml") || strcmp(entry->d_name, "mould.yaml") == 0) continue;
    if (is_study(path)) {
      read_study(path);
    } else {
      read_casting(folder, path);
      castings++;
    }
  }
  closedir(dir);
  if (castings == 0) fail_msg("%s has nothing to cast", folder);
}

static void castrun_can_read_what_is_cast(void **state)
{
  (void)state;
  each_example(read_inputs);
}

static void look_for_pictures(const char *folder)
{
  char path[2048], line[4096];
  snprintf(path, sizeof path, "%s/README.md", folder);
  FILE *file = fopen(path, "r");
  if (!file) fail_msg("%s is missing", path);
  int n = 0;
  while (fgets(line, sizeof line, file)) {
    char *begin = strncmp(line, "![", 2) == 0 ? strstr(line, "](") : NULL;
    if (!begin) continue;
    begin[2 + strcspn(begin + 2, ")")] = '\0';
    snprintf(path, sizeof path, "%s/%s", folder, begin + 2);
    if (access(path, R_OK) != 0) fail_msg("%s/README.md shows '%s', which is not there", folder, begin + 2);
    n++;
  }
  fclose(file);
  if (n == 0) fail_msg("%s/README.md shows no picture", folder);
  snprintf(path, sizeof path, "%s/run.sh", folder);
  if (access(path, X_OK) != 0) fail_msg("%s cannot be run", path);
}

static void readmes_show_pictures_that_are_there_beside_a_script_that_runs(void **state)
{
  (void)state;
  each_example(look_for_pictures);
}

int main(int argc, char **argv)
{
  castreduce = argc > 1 ? argv[1] : NULL;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(castrun_can_read_what_is_cast),
      cmocka_unit_test(castreduce_finds_nothing_wrong_with_the_moulds),
      cmocka_unit_test(readmes_show_pictures_that_are_there_beside_a_script_that_runs),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
