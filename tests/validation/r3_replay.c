/* R3: patch temperatures under the heat that a run recorded, ROM against full model; R7: what lumping that heat on
 * patches costs, on the ROM's own patches, halved and quartered. Both by the programs, as a user runs them: castreduce
 * makes the ROM, castrun pours into it and records, castreduce replays. */
#include <ctype.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmocka.h>

#include "tests/support/mould_files.h"
#include "tests/support/program.h"
#include "tests/support/validation.h"

static const char *castreduce, *castrun, *mpiexec;

static void must_run(const char *what)
{
  if (run("cd '%s' && %s 2>&1", mould_files.folder, what) != 0) fail_msg("%s: %s", what, said);
}

/* The text with one piece replaced. */
static void replace(char *text, size_t size, const char *from, const char *to)
{
  static char copy[10000];
  char *at = strstr(text, from);
  assert_non_null(at);
  snprintf(copy, sizeof copy, "%s%s", to, at + strlen(from));
  snprintf(at, size - (size_t)(at - text), "%s", copy);
}

/* Ten milliseconds of melt that drops into the basin and its pin. */
static int make_case(void **state)
{
  (void)state;
  static char text[10000];
  char command[600];
  mould_files_create(&mould_files);
  snprintf(text, sizeof text, "%s", mould_files_yaml("mould.geo", "  unit: mm\n"));
  replace(text, sizeof text, "tolerance: 1e-2", "tolerance: 1e-3");
  mould_files_write(&mould_files, "mould.yaml", text);
  mould_files_write(&mould_files, "cast.yaml",
                    "rom: mould.rom.h5\npreheat: 800 degC\nambient: 25 degC\n"
                    "melt: { material: cual10, temperature: 1150 degC,\n"
                    "  blocks: [{ corner: [-4 mm, -3 mm, 8 mm], size: [8 mm, 6 mm, 3 mm] }] }\n"
                    "forces: { gravity: [0 m/s^2, 0 m/s^2, -100 m/s^2] }\ncontact: { h: 2000 W/m^2/K }\n"
                    "sph: { spacing: 0.4 mm }\ntime: { end: 10 ms }\n"
                    "output: { folder: results, every: 10 ms, record_every: 0.5 ms, record_triangles: true }\n");
  snprintf(command, sizeof command, "'%s' run mould.yaml --quiet", castreduce);
  must_run(command);
  snprintf(command, sizeof command, "'%s' run cast.yaml --quiet", castrun);
  must_run(command);
  return 0;
}

static int remove_case(void **state)
{
  (void)state;
  char command[300];
  snprintf(command, sizeof command, "rm -r '%s/results' '%s/second'", mould_files.folder,
           mould_files.folder); // which mould_files knows nothing of
  if (system(command) != 0) return 1;
  mould_files_remove(&mould_files);
  return 0;
}

/* The number behind `label` in what the program said. */
static double number_after(const char *label)
{
  const char *at = strstr(said, label);
  if (!at) fail_msg("'%s' is not in: %s", label, said);
  return strtod(at + strlen(label), NULL);
}

/* The first percentage behind `label`. */
static double percent_after(const char *label)
{
  const char *at = strstr(said, label);
  if (!at) fail_msg("'%s' is not in: %s", label, said);
  const char *sign = strstr(at, " %");
  assert_non_null(sign);
  while (sign > at && !isspace((unsigned char)sign[-1])) sign--;
  return strtod(sign, NULL);
}

static double children_cpu(void)
{
  struct rusage use;
  getrusage(RUSAGE_CHILDREN, &use);
  return (double)(use.ru_utime.tv_sec + use.ru_stime.tv_sec) +
         1e-6 * (double)(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
}

/* Replay a record; *rise K, the largest of a patch. returns  the ROM's error over it, % */
static double replay_error(const char *rom, const char *record, const char *elements, double *rise)
{
  char command[600];
  const double begin = children_cpu();
  snprintf(command, sizeof command, "'%s' replay %s %s --quiet", castreduce, rom, record);
  must_run(command);
  const double error = percent_after("ROM against the full model"), scheme = percent_after("of it from the time steps");
  *rise = number_after("largest rise of a cavity patch");
  validation_write(&(ValidationRow){
      .id = "R3",
      .quantity = validation_text("patch temperatures under the heat of 10 ms of pouring, %s", elements),
      .reference = validation_text("full model, own error %.1g %%", scheme),
      .ours = validation_text("largest rise %.3g K", *rise),
      .error = validation_text("%.3g %% of it", error),
      .target = "0.1 %",
      .resolution = "20 intervals of 0.5 ms, tolerance 1e-3",
      .cpu_seconds = children_cpu() - begin});
  assert_true(scheme < 0.01);
  return error;
}

static void the_rom_keeps_a_thousandth_on_a_recorded_run(void **state)
{
  (void)state;
  static char text[10000];
  char command[600];
  double rise, rise_quadratic;
  validation_begin("R3");
  const double error = replay_error("mould.rom.h5", "results/heat.h5", "linear elements", &rise);
  snprintf(text, sizeof text, "%s", mould_files_yaml("mould.geo", "  unit: mm\n"));
  replace(text, sizeof text, "tolerance: 1e-2", "tolerance: 1e-3");
  replace(text, sizeof text, "growth: 0.4", "growth: 0.4, order: 2");
  replace(text, sizeof text, "mould.rom.h5", "quadratic.rom.h5");
  mould_files_write(&mould_files, "quadratic.yaml", text);
  snprintf(command, sizeof command,
           "'%s' run quadratic.yaml --quiet && '%s' run cast.yaml --quiet --set rom=quadratic.rom.h5 --set "
           "output.folder=second",
           castreduce, castrun);
  must_run(command);
  const double quadratic = replay_error("quadratic.rom.h5", "second/heat.h5", "quadratic elements", &rise_quadratic);
  assert_true(rise > 1.0 && rise_quadratic > rise); // linear elements are too thick to warm as they should
  assert_true(error <= 0.1 && quadratic <= 0.1);
}

static void lumping_costs_less_on_finer_patches(void **state)
{
  (void)state;
  static const char *const labels[] = {"lumping the heat on patches", "on patches refined 2x", "on patches refined 4x"};
  static const char *const names[] = {"3 mm, the basin's patch size", "1.5 mm", "0.75 mm"};
  double lumping[3];
  char command[600];
  const double begin = children_cpu();
  snprintf(command, sizeof command, "'%s' replay mould.rom.h5 results/heat.h5 --resolved --quiet", castreduce);
  must_run(command);
  validation_begin("R7");
  for (int level = 0; level < 3; level++) {
    lumping[level] = percent_after(labels[level]);
    validation_write(
        &(ValidationRow){.id = "R7",
                         .quantity = validation_text("heat lumped on patches of %s", names[level]),
                         .reference = "full model with the heat of each wall triangle",
                         .ours = "the same full model with the patches' heat",
                         .error = validation_text("%.3g %% of the largest rise of a patch", lumping[level]),
                         .target = level > 0 ? "stated" : lumping[0] > 1.0 ? "1 % (missed)" : "1 %",
                         .resolution = "0.8 mm elements at the wall, particles 0.4 mm apart",
                         .cpu_seconds = children_cpu() - begin});
  }
  assert_true(lumping[0] > 0.0);
  assert_true(lumping[2] < lumping[0]); // towards nothing, as patches become triangles
}

/* The rows of a CSV file's last line. */
static void two_ranks_replay_the_same(void **state)
{
  (void)state;
  char command[900];
  snprintf(command, sizeof command, "'%s' replay mould.rom.h5 results/heat.h5 --quiet", castreduce);
  must_run(command);
  const double one = number_after("largest rise of a cavity patch"),
               error = percent_after("ROM against the full model");
  snprintf(command, sizeof command,
           "'%s' --allow-run-as-root --oversubscribe -n 2 '%s' replay mould.rom.h5 results/heat.h5 --quiet", mpiexec,
           castreduce);
  must_run(command);
  assert_true(number_after("largest rise of a cavity patch") == one); // to the six digits printed
  assert_true(percent_after("ROM against the full model") - error < 1e-2 * error);
}

static void a_changed_input_or_another_rom_is_refused(void **state)
{
  (void)state;
  static char text[10000];
  snprintf(text, sizeof text, "%s", mould_files_yaml("mould.geo", "  unit: mm\n"));
  mould_files_write(&mould_files, "other.yaml", text); // its tolerance is another
  assert_int_equal(run("cd '%s' && '%s' replay mould.rom.h5 results/heat.h5 --mould other.yaml 2>&1",
                       mould_files.folder, castreduce),
                   1);
  assert_non_null(strstr(said, "other.yaml is not what the ROM was made from"));
  must_run("cp mould.rom.h5 second.rom.h5 && printf x >> second.rom.h5"); // the same model, another file
  assert_int_equal(run("cd '%s' && '%s' replay second.rom.h5 results/heat.h5 2>&1", mould_files.folder, castreduce), 1);
  assert_non_null(strstr(said, "results/heat.h5 was recorded with another ROM file"));
  must_run("cp mould.geo kept.geo && echo '// moved' >> mould.geo");
  assert_int_equal(run("cd '%s' && '%s' replay mould.rom.h5 results/heat.h5 2>&1", mould_files.folder, castreduce), 1);
  assert_non_null(strstr(said, "mould.geo has changed since the ROM was made"));
  must_run("mv kept.geo mould.geo");
  assert_int_equal(run("cd '%s' && '%s' replay mould.rom.h5 mould.rom.h5 2>&1", mould_files.folder, castreduce), 1);
  assert_non_null(strstr(said, "is no record of heat flows"));
  assert_int_equal(
      run("cd '%s' && '%s' replay mould.rom.h5 results/heat.h5 --fields '20 ms' 2>&1", mould_files.folder, castreduce),
      1);
  assert_non_null(strstr(said, "ascending times up to the record's end"));
  assert_int_equal(
      run("cd '%s' && '%s' replay mould.rom.h5 results/heat.h5 --speed 2>&1", mould_files.folder, castreduce), 2);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_rom_keeps_a_thousandth_on_a_recorded_run),
      cmocka_unit_test(lumping_costs_less_on_finer_patches),
      cmocka_unit_test(two_ranks_replay_the_same),
      cmocka_unit_test(a_changed_input_or_another_rom_is_refused),
  };
  if (argc != 4) return 99;
  castreduce = realpath(argv[1], NULL); // commands change the folder
  castrun = realpath(argv[2], NULL);
  mpiexec = argv[3];
  if (!castreduce || !castrun) return 99;
  return cmocka_run_group_tests(tests, make_case, remove_case);
}
