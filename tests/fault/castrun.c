#define _GNU_SOURCE // popen, nanosleep, kill
/* What happens to a run that is killed, interrupted, has no room to write or finds its files damaged. The program
 * itself
 * ($CASTRUN) is run where it is about processes. */
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

#include "cast/io/vtk_series.h"
#include "cast/sim/sim.h"
#include "tests/support/assert_ok.h"
#include "tests/support/cast_case.h"
#include "tests/support/full_disk.h"
#include "tests/support/program.h"

static const char *program;

static int set_up(void **state)
{
  program = getenv("CASTRUN");
  if (!program) fprintf(stderr, "CASTRUN does not name the program\n");
  return !program || cast_case_set_up(state) != 0;
}

/* ---- the program ---- */

static char output_path[160]; // what the program last said

static pid_t start_program(const char *command, const char *target)
{
  snprintf(output_path, sizeof output_path, "%s/said.txt", casting.folder);
  return launch((const char *[]){program, command, target, NULL}, output_path);
}

static void expect_said_by_program(const char *part)
{
  run("cat %s", output_path);
  expect_said(part);
}

static size_t steps_written(const char *folder)
{
  CastError err = {0};
  char path[200];
  hid_t file = -1;
  size_t n = 0;
  VtkStep *steps = NULL;
  snprintf(path, sizeof path, "%s/results.vtkhdf", folder);
  if (access(path, R_OK) != 0 || h5_file_open(path, &file, &err) != CAST_OK) return 0;
  const CastStatus status = vtk_series_read_steps(file, &n, &steps, &err);
  free(steps);
  h5_file_close(&file, &err);
  return status == CAST_OK ? n : 0;
}

/* Until the run has written so many steps; gives up after a minute. */
static void wait_for_steps(const char *folder, size_t n)
{
  for (int k = 0; k < 1200 && steps_written(folder) < n; k++) nanosleep(&(struct timespec){0, 50000000}, NULL);
  assert_true(steps_written(folder) >= n);
}

static void make_input(const char *name, const char *time, char path[128], char folder[128])
{
  CastError err = {0};
  const CastCaseInput input = {.time = time, .output = "  curves_every: 0.2 ms\n"};
  ok(cast_case_input(&casting, name, &input, path, &err), &err);
  snprintf(folder, 128, "%.60s/%.60s", casting.folder, name);
}

static void a_killed_run_leaves_results_that_open(void **state)
{
  (void)state;
  char path[128], folder[128];
  make_input("killed", "{ end: 10 s }", path, folder);
  const pid_t child = start_program("run", path);
  wait_for_steps(folder, 3);
  kill(child, SIGKILL);
  assert_int_equal(exit_code(child), 128 + SIGKILL);
  assert_true(steps_written(folder) >= 3);
}

static void a_run_that_is_told_to_stop_leaves_a_checkpoint_and_is_resumed(void **state)
{
  (void)state;
  char path[128], folder[128], checkpoint[200];
  make_input("stopped", "{ end: 30 ms }", path, folder);
  const pid_t child = start_program("run", path);
  wait_for_steps(folder, 2);
  kill(child, SIGTERM);
  assert_int_equal(exit_code(child), 3);
  expect_said_by_program("castrun resume");
  snprintf(checkpoint, sizeof checkpoint, "%s/checkpoint.h5", folder);
  assert_int_equal(access(checkpoint, R_OK), 0);
  const size_t before = steps_written(folder);
  const pid_t again = start_program("resume", folder);
  wait_for_steps(folder, before + 1); // only then does it surely heed signals
  kill(again, SIGINT);
  assert_int_equal(exit_code(again), 3);
}

static void a_folder_without_a_checkpoint_and_a_damaged_one_are_refused(void **state)
{
  (void)state;
  char path[128], folder[128], checkpoint[200];
  make_input("damaged", "{ end: 10 s }", path, folder);
  const pid_t child = start_program("run", path);
  wait_for_steps(folder, 1);
  kill(child, SIGTERM);
  assert_int_equal(exit_code(child), 3);
  snprintf(checkpoint, sizeof checkpoint, "%s/checkpoint.h5", folder);
  struct stat info;
  assert_int_equal(stat(checkpoint, &info), 0);
  assert_int_equal(truncate(checkpoint, info.st_size / 2), 0);
  assert_int_equal(exit_code(start_program("resume", folder)), 1);
  expect_said_by_program("damaged or truncated");
  assert_int_equal(unlink(checkpoint), 0);
  assert_int_equal(exit_code(start_program("resume", folder)), 1);
  expect_said_by_program("checkpoint.h5: cannot be opened");
}

static void an_output_folder_that_is_a_file_is_refused(void **state)
{
  (void)state;
  char path[128], folder[128];
  make_input("occupied", NULL, path, folder);
  FILE *file = fopen(folder, "w");
  assert_non_null(file);
  fclose(file);
  assert_int_equal(exit_code(start_program("run", path)), 1);
  expect_said_by_program("is a file");
}

static void wrong_command_lines_exit_with_two(void **state)
{
  (void)state;
  assert_int_equal(exit_code(start_program("fly", "to the moon")), 2);
  expect_said_by_program("unknown command: fly");
  assert_int_equal(exit_code(start_program("run", "--thread")), 2);
  expect_said_by_program("unknown option");
  assert_int_equal(exit_code(start_program("run", "--threads")), 2);
  assert_int_equal(exit_code(start_program("run", NULL)), 2);
  expect_said_by_program("is expected after the command");
}

static void the_program_links_neither_petsc_nor_mpi(void **state)
{
  (void)state;
  char command[600], text[16384];
  snprintf(command, sizeof command, "ldd '%s'", program);
  FILE *pipe = popen(command, "r");
  assert_non_null(pipe);
  const size_t n = fread(text, 1, sizeof text - 1, pipe);
  text[n] = '\0';
  pclose(pipe);
  assert_non_null(strstr(text, "libhdf5")); // the list is one
  static const char *const absent[] = {"petsc", "slepc", "libmpi", "gmsh", "openmpi"};
  for (size_t k = 0; k < sizeof absent / sizeof *absent; k++)
    if (strstr(text, absent[k])) fail_msg("castrun links %s:\n%s", absent[k], text);
}

/* ---- a full disk ---- */

/* Run with room for so many writes; returns whether the disk was full before the run was done. */
static bool run_with_room(int writes)
{
  CastError err = {0};
  CastConfig *config = NULL;
  Sim *sim = NULL;
  SimEnd end;
  char path[128], folder[128];
  make_input("full", "{ end: 2 ms }", path, folder);
  mkdir(folder, 0777);
  ok(cast_config_read(path, NULL, &config, &err), &err);
  ok(sim_create(config, NULL, &sim, &err), &err);
  disk_fill_after(writes);
  CastStatus status = sim_open_output(sim, "test", &err);
  sim_request_checkpoint(sim);
  if (status == CAST_OK) status = sim_run(sim, NULL, &end, &err);
  const bool full = disk_was_full();
  disk_empty();
  if (full != (status != CAST_OK)) fail_msg("with room for %d writes: full %d, '%s'", writes, full, err.message);
  if (full) assert_int_equal(status, CAST_ERR_IO);
  if (full && !strstr(err.message, "No space left on device"))
    fail_msg("'%s' does not tell of the full disk", err.message);
  sim_destroy(&sim);
  cast_config_destroy(&config);
  return full;
}

static void a_full_disk_ends_the_run_with_the_system_s_reason_wherever_it_happens(void **state)
{
  (void)state;
  assert_false(run_with_room(1 << 30));
  bool full = true;
  for (int writes = 0; full; writes += writes / 3 + 1) full = run_with_room(writes);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_killed_run_leaves_results_that_open),
      cmocka_unit_test(a_run_that_is_told_to_stop_leaves_a_checkpoint_and_is_resumed),
      cmocka_unit_test(a_folder_without_a_checkpoint_and_a_damaged_one_are_refused),
      cmocka_unit_test(an_output_folder_that_is_a_file_is_refused),
      cmocka_unit_test(wrong_command_lines_exit_with_two),
      cmocka_unit_test(the_program_links_neither_petsc_nor_mpi),
      cmocka_unit_test(a_full_disk_ends_the_run_with_the_system_s_reason_wherever_it_happens),
  };
  return cmocka_run_group_tests(tests, set_up, cast_case_clean_up);
}
