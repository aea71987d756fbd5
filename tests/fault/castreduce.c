/* What castreduce leaves behind when the disk is full or a solver does not converge: a reason, a code, and nothing
 * under the names of its results. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "tests/support/matrix_mould.h"
#include "tests/support/program.h"

enum { CHAIN = 3000, CELLS = 8 };
static const char *program;
static char folder[] = "/tmp/castfault_XXXXXX";

static void write_text(const char *name, const char *text)
{
  char path[256];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fputs(text, file);
  assert_int_equal(fclose(file), 0);
}

/* A chain of nodes: without a preconditioner conjugate gradients need as many steps as it is long. */
static void write_chain(void)
{
  char path[3][256];
  static const char *const names[3] = {"E", "K", "B"};
  FILE *file[3];
  for (int k = 0; k < 3; k++) {
    snprintf(path[k], sizeof path[k], "%s/chain_%s.mtx", folder, names[k]);
    file[k] = fopen(path[k], "w");
    assert_non_null(file[k]);
    fprintf(file[k], "%%%%MatrixMarket matrix coordinate real %s\n%d %d %d\n", k == 2 ? "general" : "symmetric", CHAIN,
            k == 2 ? 1 : CHAIN,
            k == 0   ? CHAIN
            : k == 1 ? 2 * CHAIN - 1
                     : 1);
  }
  for (int i = 1; i <= CHAIN; i++) {
    fprintf(file[0], "%d %d 1e-3\n", i, i);
    fprintf(file[1], "%d %d %d\n", i, i, i == 1 ? 1000 : 2000);
    if (i > 1) fprintf(file[1], "%d %d -1000\n", i, i - 1);
  }
  fprintf(file[2], "1 1 1.0\n");
  for (int k = 0; k < 3; k++) assert_int_equal(fclose(file[k]), 0);
}

static int make_files(void **state)
{
  (void)state;
  char path[256];
  MatrixMould mould;
  if (!mkdtemp(folder)) return 1;
  matrix_mould_create(CELLS, 100.0, &mould);
  snprintf(path, sizeof path, "%s/E.mtx", folder);
  matrix_write(path, "coordinate real symmetric", mould.n, mould.n, mould.E, 1.0);
  snprintf(path, sizeof path, "%s/K.mtx", folder);
  matrix_write(path, "coordinate real symmetric", mould.n, mould.n, mould.K, 1.0);
  snprintf(path, sizeof path, "%s/B.mtx", folder);
  matrix_write(path, "coordinate real general", mould.n, mould.m, mould.B, 1.0);
  matrix_mould_destroy(&mould);
  write_chain();
  write_text("full.yaml", "matrices: { E: E.mtx, K: K.mtx, B: B.mtx }\nreduction: { times: [10 ms, 100 s] }\n"
                          "output: { file: small/full.rom.h5 }\n");
  write_text("chain.yaml", "matrices: { E: chain_E.mtx, K: chain_K.mtx, B: chain_B.mtx }\n"
                           "reduction: { times: [10 ms, 100 s], solver: iterative }\noutput: { file: chain.rom.h5 }\n");
  return run("mkdir %s/small", folder);
}

static int remove_files(void **state)
{
  (void)state;
  return run("rm -r %s", folder);
}

/* Anything of that name, the log apart? */
static bool is_left(const char *name)
{
  return run("ls %s/%s* 2>/dev/null | grep -v '\\.log$'", folder, name) == 0;
}

/* A file system of 24 KiB in a name space of its own; not every system lets its users have one. */
static void a_full_disk_leaves_no_rom(void **state)
{
  (void)state;
  if (run("unshare -rm mount -t tmpfs -o size=24k none %s/small 2>/dev/null", folder) != 0) skip();
  const int code = run("unshare -rm sh -c \"mount -t tmpfs -o size=24k none %s/small && '%s' run %s/full.yaml --quiet; "
                       "echo code \\$?; ls %s/small\" 2>&1",
                       folder, program, folder, folder);
  assert_int_equal(code, 0);
  if (!strstr(said, "No space left on device") || !strstr(said, "code 1")) fail_msg("%s", said);
  assert_null(strstr(strstr(said, "code 1"), "full.rom.h5\n")); // the log alone is there
  assert_null(strstr(strstr(said, "code 1"), ".part"));
}

static void a_solver_that_does_not_converge_says_so(void **state)
{
  (void)state;
  assert_int_equal(run("'%s' run %s/chain.yaml --quiet -mor_pc_type none 2>&1", program, folder), 1);
  if (!strstr(said, "castreduce: error: (s E + K) X = B at s = ") || !strstr(said, "relative residual"))
    fail_msg("%s", said);
  assert_null(strstr(said, " at line "));
  assert_false(is_left("chain.rom.h5"));
}

static void an_output_folder_that_is_not_there_is_known_before_the_work(void **state)
{
  (void)state;
  write_text("nowhere.yaml", "matrices: { E: E.mtx, K: K.mtx, B: B.mtx }\nreduction: { times: [10 ms, 100 s] }\n"
                             "output: { file: nowhere/full.rom.h5 }\n");
  assert_int_equal(run("'%s' run %s/nowhere.yaml 2>&1", program, folder), 1);
  if (!strstr(said, "cannot be written: folder ") || strstr(said, "unknowns")) fail_msg("%s", said);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_full_disk_leaves_no_rom),
      cmocka_unit_test(a_solver_that_does_not_converge_says_so),
      cmocka_unit_test(an_output_folder_that_is_not_there_is_known_before_the_work),
  };
  if (argc != 2) return 99;
  program = realpath(argv[1], NULL);
  if (!program) return 99;
  return cmocka_run_group_tests(tests, make_files, remove_files);
}
