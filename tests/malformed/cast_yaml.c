/* Every way in which cast.yaml and what it names can be wrong: each file of the folder cast_yaml is refused with what
 * its first lines say ("# says: ..."), before anything is written. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cast/sim/sim.h"
#include "cast_build_config.h"
#include "tests/support/cast_case.h"
#include "tests/support/text_file.h"

static const char FOLDER[] = CAST_SHARE_SOURCE "/../tests/malformed/cast_yaml";

static int set_up(void **state)
{
  (void)state;
  CastError err = {0};
  if (cast_case_create(&casting, &err) != CAST_OK) return 1;
  char path[128];
  snprintf(path, sizeof path, "%s/text.rom.h5", casting.folder);
  FILE *file = fopen(path, "w");
  if (!file) return 1;
  fputs("this is not a ROM file\n", file);
  return fclose(file);
}

static int clean_up(void **state)
{
  (void)state;
  cast_case_remove(&casting);
  return 0;
}

static char *read_text(const char *name)
{
  char path[1024];
  snprintf(path, sizeof path, "%s/%s", FOLDER, name);
  return text_file_read(path);
}

/* Read the input as `castrun check` does; what goes wrong first ends up in err. */
static CastStatus check(const char *name, const char *text, CastError *err)
{
  char path[256];
  snprintf(path, sizeof path, "%s/%s", casting.folder, name);
  CastConfig *config = NULL;
  Sim *sim = NULL;
  CAST_CALL(cast_config_read(path, text, &config, err));
  const CastStatus status = sim_create(config, NULL, &sim, err);
  if (status == CAST_OK) sim_destroy(&sim);
  assert_null(sim);
  cast_config_destroy(&config);
  return status;
}

static void check_file(const char *name)
{
  char *text = read_text(name);
  CastError err = {0};
  const CastStatus status = check(name, text, &err);
  if (status != CAST_ERR_INPUT && status != CAST_ERR_IO && status != CAST_ERR_FORMAT)
    fail_msg("%s is not refused: status %d, '%s'", name, (int)status, err.message);
  int n = 0;
  for (char *line = text; strncmp(line, "# says: ", 8) == 0; n++) {
    char *end = strchr(line, '\n');
    *end = '\0';
    if (!strstr(err.message, line + 8)) fail_msg("%s: '%s' does not say '%s'", name, err.message, line + 8);
    line = end + 1;
  }
  if (n == 0) fail_msg("%s does not begin with '# says: '", name);
  free(text);
}

static int is_yaml(const struct dirent *entry)
{
  const char *dot = strrchr(entry->d_name, '.');
  return dot && strcmp(dot, ".yaml") == 0;
}

static void each_malformed_input_is_refused_with_its_cause(void **state)
{
  (void)state;
  struct dirent **names = NULL;
  const int n = scandir(FOLDER, &names, is_yaml, alphasort);
  assert_true(n >= 30);
  for (int i = 0; i < n; i++) {
    check_file(names[i]->d_name);
    free(names[i]);
  }
  free(names);
}

static void a_good_input_beside_them_is_taken(void **state)
{
  (void)state;
  CastError err = {0};
  char path[128];
  CastConfig *config = NULL;
  Sim *sim = NULL;
  assert_int_equal(cast_case_input(&casting, "good", NULL, path, &err), CAST_OK);
  assert_int_equal(cast_config_read(path, NULL, &config, &err), CAST_OK);
  if (sim_create(config, NULL, &sim, &err) != CAST_OK) fail_msg("%s", err.message);
  if (sim_report(sim, &err) != CAST_OK) fail_msg("%s", err.message);
  sim_destroy(&sim);
  cast_config_destroy(&config);
  assert_int_not_equal(access("results", F_OK), 0); // checking writes nothing
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_malformed_input_is_refused_with_its_cause),
      cmocka_unit_test(a_good_input_beside_them_is_taken),
  };
  return cmocka_run_group_tests(tests, set_up, clean_up);
}
