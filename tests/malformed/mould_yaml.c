/* Every way in which mould.yaml and its geometry can be wrong: castreduce refuses each file of the folder mould_yaml
 * with what the file's first lines say ("# says: ..."), ends with code 1, shows no library's stack and leaves no ROM
 * file. */
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "cast_build_config.h"

static const char FOLDER[] = CAST_SHARE_SOURCE "/../tests/malformed/mould_yaml";
static const char ROM[] = "/tmp/malformed.rom.h5"; // which the inputs name
static const char *program;

typedef struct Expected {
  size_t n;
  char says[8][512];
} Expected;

static void read_expected(const char *path, Expected *expected)
{
  char line[512];
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  expected->n = 0;
  while (fgets(line, sizeof line, file) && strncmp(line, "# says: ", 8) == 0) {
    line[strcspn(line, "\n")] = '\0';
    assert_true(expected->n < 8);
    snprintf(expected->says[expected->n++], sizeof expected->says[0], "%s", line + 8);
  }
  fclose(file);
  if (expected->n == 0) fail_msg("%s does not begin with '# says: '", path);
}

/* Run `castreduce run path --quiet`; its exit code, and what it says on either stream. */
static int run_program(const char *path, char *said, size_t size)
{
  char command[3000];
  snprintf(command, sizeof command, "'%s' run '%s' --quiet 2>&1", program, path);
  FILE *pipe = popen(command, "r");
  assert_non_null(pipe);
  const size_t n = fread(said, 1, size - 1, pipe);
  said[n] = '\0';
  const int status = pclose(pipe);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static int count_faults(const char *name)
{
  static char said[65536];
  char path[1024];
  Expected expected;
  snprintf(path, sizeof path, "%s/%s", FOLDER, name);
  read_expected(path, &expected);
  const int code = run_program(path, said, sizeof said);
  const char *message = strstr(said, "castreduce: error: ");
  int faults = 0;
  if (code != 1 || !message || strstr(said, "PETSC ERROR") || strstr(said, " at line ")) {
    print_error("%s: exit code %d, 1 and a plain message are expected: %s\n", name, code, said);
    faults++;
  }
  for (size_t i = 0; i < expected.n; i++) {
    if (message && strstr(message, expected.says[i])) continue;
    print_error("%s: '%s' does not say '%s'\n", name, said, expected.says[i]);
    faults++;
  }
  if (access(ROM, F_OK) == 0) {
    print_error("%s: leaves a file under the ROM's name\n", name);
    faults++;
  }
  return faults;
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
  unlink(ROM);
  const int n = scandir(FOLDER, &names, is_yaml, alphasort);
  assert_true(n >= 40);
  int faults = 0;
  for (int i = 0; i < n; i++) {
    faults += count_faults(names[i]->d_name);
    free(names[i]);
  }
  free(names);
  unlink("/tmp/malformed.rom.h5.log");
  print_message("%d files\n", n);
  assert_int_equal(faults, 0);
}

static void a_missing_input_file_is_an_error(void **state)
{
  (void)state;
  char said[4096];
  assert_int_equal(run_program("/tmp/no-such-mould.yaml", said, sizeof said), 1);
  assert_non_null(
      strstr(said, "castreduce: error: '/tmp/no-such-mould.yaml' cannot be opened: No such file or directory"));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_malformed_input_is_refused_with_its_cause),
      cmocka_unit_test(a_missing_input_file_is_an_error),
  };
  if (argc != 2) return 99;
  program = realpath(argv[1], NULL);
  if (!program) return 99;
  return cmocka_run_group_tests(tests, NULL, NULL);
}
