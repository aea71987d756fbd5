/* A run that was interrupted and resumed goes on with the bits of one that never was: particles, mould, ledger and
 * files. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cast/sim/sim.h"
#include "common/h5/h5.h"
#include "common/rom/heat_record.h"
#include "tests/support/assert_ok.h"
#include "tests/support/cast_run.h"
#include "tests/support/text_file.h"

/* A run named `name`, ready to go. Fast melt, so that lists are rebuilt often; a level and a tracer, so that all is
 * used. */
static CastRun start_in_stages(const char *name, const char *coupling, const char *time, const char *checkpoints)
{
  char output[512];
  snprintf(output, sizeof output, "%s%s", checkpoints,
           "  curves_every: 0.1 ms\n  record_every: 0.07 ms\n  record_triangles: true\n  "
           "probes: [{ name: pin, position: [0 mm, 0 mm, -5 mm] }]\n"
           "  tracers: [{ name: '1', nearest: [0 mm, 0 mm, -4 mm] }]\n");
  const CastCaseInput input = {.coupling = coupling, .time = time, .output = output};
  return cast_run_start(name, &input, true);
}

static CastRun start(const char *name, const char *coupling)
{
  return start_in_stages(name, coupling, "{ end: 1.2 ms }", "");
}

static void assert_same_state(const Sim *a, const Sim *b)
{
  assert_true(sim_time(a) == sim_time(b) && sim_steps(a) == sim_steps(b));
  cast_run_assert_same_melt(a, b);
  const size_t n = rom_state_size(sim_mould(a));
  double *z = malloc(2 * n * sizeof *z);
  assert_non_null(z);
  rom_state_save(sim_mould(a), z);
  rom_state_save(sim_mould(b), z + n);
  assert_memory_equal(z, z + n, n * sizeof *z);
  free(z);
  const EnergyLedger e = sim_ledger(a), g = sim_ledger(b);
  assert_memory_equal(&e, &g, sizeof e);
}

/* The bytes of a file after its '#' lines, which tell of host and time. */
static char *file_rows(const char *folder, const char *name)
{
  char path[256];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  char *text = text_file_read(path);
  char *rows = text;
  while (*rows == '#') rows = strchr(rows, '\n') + 1;
  memmove(text, rows, strlen(rows) + 1);
  return text;
}

static void assert_same_files(const CastRun *a, const CastRun *b)
{
  static const char *const names[] = {"probes.csv", "tracers.csv", "ledger.csv", "results.xmf", "mould.xmf"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    char *u = file_rows(a->folder, names[k]), *w = file_rows(b->folder, names[k]);
    if (strcmp(u, w) != 0) fail_msg("%s differs", names[k]);
    free(u);
    free(w);
  }
}

static void assert_same_set(const CastRun *a, const CastRun *b, const char *name, const char *set)
{
  CastError err = {0};
  char path[256];
  double *values[2];
  hsize_t n[2];
  const CastRun *const both[2] = {a, b};
  for (int k = 0; k < 2; k++) {
    hid_t file = -1;
    void *read = NULL;
    n[k] = 0;
    snprintf(path, sizeof path, "%.128s/%s", both[k]->folder, name);
    ok(h5_file_open(path, &file, &err), &err);
    ok(h5_read(file, set, H5T_NATIVE_DOUBLE, 1, &n[k], &read, &err), &err);
    ok(h5_file_close(&file, &err), &err);
    values[k] = read;
  }
  assert_int_equal(n[0], n[1]);
  if (memcmp(values[0], values[1], n[0] * sizeof(double)) != 0) fail_msg("%s: %s differs", name, set);
  bool any = false;
  for (hsize_t i = 0; i < n[0]; i++) any = any || values[0][i] >= 0.0; // not all NaN
  assert_true(any);
  free(values[0]);
  free(values[1]);
}

/* What a run gathers from its beginning and writes at its end. */
static void assert_same_maps(const CastRun *a, const CastRun *b)
{
  assert_same_set(a, b, "results.vtkhdf", "castrun/cavity/fill_time");
  assert_same_set(a, b, "results.vtkhdf", "castrun/cavity/front_temperature");
  assert_same_set(a, b, "results.vtkhdf", "castrun/cavity/misrun");
  assert_same_set(a, b, "mould.vtkhdf", "VTKHDF/CellData/fill_time");
  assert_same_set(a, b, "mould.vtkhdf", "VTKHDF/CellData/misrun");
}

static void assert_same_records(const CastRun *a, const CastRun *b)
{
  CastError err = {0};
  HeatRecord record[2];
  for (int k = 0; k < 2; k++) {
    char path[256];
    snprintf(path, sizeof path, "%s/heat.h5", k == 0 ? a->folder : b->folder);
    ok(heat_record_read(path, &record[k], &err), &err);
  }
  assert_int_equal(record[0].n, record[1].n);
  assert_memory_equal(record[0].time, record[1].time, record[0].n * sizeof(double));
  assert_memory_equal(record[0].heat, record[1].heat, record[0].n * record[0].m * sizeof(double));
  assert_memory_equal(record[0].triangle_heat, record[1].triangle_heat,
                      record[0].n * record[0].n_triangles * sizeof(double));
  for (int k = 0; k < 2; k++) heat_record_free(&record[k]);
}

/* Interrupted by the signal's flag after some steps; resumed with another number of threads. */
static void check_coupling(const char *kind, const char *coupling)
{
  CastError err = {0};
  char whole_name[32], broken_name[32];
  snprintf(whole_name, sizeof whole_name, "whole_%s", kind);
  snprintf(broken_name, sizeof broken_name, "broken_%s", kind);
  CastRun whole = start(whole_name, coupling), broken = start(broken_name, coupling);
  SimEnd end;
  omp_set_num_threads(2);
  ok(sim_run(whole.sim, NULL, &end, &err), &err);
  assert_int_equal(end, SIM_FINISHED);
  while (sim_time(broken.sim) < 0.55e-3) ok(sim_step(broken.sim, &err), &err);
  volatile sig_atomic_t stop = 1;
  ok(sim_run(broken.sim, &stop, &end, &err), &err);
  assert_int_equal(end, SIM_INTERRUPTED);
  assert_true(sim_time(broken.sim) < 1.0e-3);
  cast_run_finish(&broken);
  omp_set_num_threads(1);
  ok(sim_resume(broken.folder, NULL, "test", &broken.config, &broken.sim, &err), &err);
  ok(sim_run(broken.sim, NULL, &end, &err), &err);
  assert_int_equal(end, SIM_FINISHED);
  assert_same_state(whole.sim, broken.sim);
  assert_same_records(&whole, &broken);
  cast_run_finish(&whole);
  cast_run_finish(&broken);
}

static void a_resumed_run_has_the_bits_of_an_unbroken_one_with_surface_coupling(void **state)
{
  (void)state;
  check_coupling("surface", "{ kind: surface }");
}

static void a_resumed_run_has_the_bits_of_an_unbroken_one_with_embedded_coupling(void **state)
{
  (void)state;
  check_coupling("embedded", "{ kind: embedded }");
}

static void a_resumed_run_has_the_bits_of_an_unbroken_one_with_surface_tension(void **state)
{
  (void)state;
  check_coupling("tension", "{ kind: surface }\nsurface_tension: true");
}

/* The first steps are made with sim_run here, so that frames and rows are written; then what was written after the
 * checkpoint is cut off again. */
static void the_files_of_a_resumed_run_are_those_of_an_unbroken_one(void **state)
{
  (void)state;
  CastError err = {0};
  SimEnd end;
  CastRun whole = start("files_whole", NULL), broken = start("files_broken", NULL);
  ok(sim_run(whole.sim, NULL, &end, &err), &err);
  sim_request_checkpoint(broken.sim); // taken at the first rebuild; the run goes on beyond it to the end
  ok(sim_run(broken.sim, NULL, &end, &err), &err);
  cast_run_finish(&broken);
  ok(sim_resume(broken.folder, NULL, "test", &broken.config, &broken.sim, &err), &err);
  assert_true(sim_time(broken.sim) < 1.0e-3);
  ok(sim_run(broken.sim, NULL, &end, &err), &err);
  assert_same_state(whole.sim, broken.sim);
  assert_same_files(&whole, &broken);
  assert_same_maps(&whole, &broken);
  assert_same_records(&whole, &broken);
  cast_run_finish(&whole);
  cast_run_finish(&broken);
}

/* A run that leaves a checkpoint at every chance, so that its last is that before the last step but one of the cooling;
 * what was written after it is cut off again. */
static void check_cooling(const char *kind, const char *coupling)
{
  CastError err = {0};
  char whole_name[32], broken_name[32];
  snprintf(whole_name, sizeof whole_name, "cool_whole_%s", kind);
  snprintf(broken_name, sizeof broken_name, "cool_broken_%s", kind);
  const char *time = "{ end: 0.4 ms, cool: { end: 2 s, every: 0.3 s } }";
  CastRun whole = start_in_stages(whole_name, coupling, time, "");
  CastRun broken = start_in_stages(broken_name, coupling, time, "  checkpoint_every: 1 ns\n");
  SimEnd end;
  double switched;
  omp_set_num_threads(2);
  ok(sim_run(whole.sim, NULL, &end, &err), &err);
  ok(sim_run(broken.sim, NULL, &end, &err), &err);
  cast_run_finish(&broken);
  omp_set_num_threads(1);
  ok(sim_resume(broken.folder, NULL, "test", &broken.config, &broken.sim, &err), &err);
  assert_true(sim_time(broken.sim) > 0.1 && sim_time(broken.sim) < 2.0);
  assert_string_equal(sim_switched(broken.sim, &switched), "time");
  ok(sim_run(broken.sim, NULL, &end, &err), &err);
  assert_int_equal(end, SIM_FINISHED);
  assert_same_state(whole.sim, broken.sim);
  assert_same_files(&whole, &broken);
  assert_same_maps(&whole, &broken);
  assert_same_records(&whole, &broken);
  cast_run_finish(&whole);
  cast_run_finish(&broken);
}

static void a_run_resumed_while_it_cools_has_the_bits_and_files_of_an_unbroken_one(void **state)
{
  (void)state;
  check_cooling("surface", "{ kind: surface }");
  check_cooling("embedded", "{ kind: embedded }");
}

static void a_run_does_not_go_on_with_another_rom(void **state)
{
  (void)state;
  CastError err = {0};
  SimEnd end;
  volatile sig_atomic_t stop = 1;
  CastRun run = start("other_rom", NULL);
  ok(sim_run(run.sim, &stop, &end, &err), &err);
  cast_run_finish(&run);
  char path[160];
  snprintf(path, sizeof path, "%s/mould.rom.h5", casting.folder);
  FILE *rom = fopen(path, "ab"); // one byte behind the data: the same model, another file
  assert_non_null(rom);
  fputc(0, rom);
  fclose(rom);
  assert_int_equal(sim_resume(run.folder, NULL, "test", &run.config, &run.sim, &err), CAST_ERR_INPUT);
  assert_non_null(strstr(err.message, "mould.rom.h5 is not the one the run began with"));
  assert_null(run.sim);
  assert_null(run.config);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_resumed_run_has_the_bits_of_an_unbroken_one_with_surface_coupling),
      cmocka_unit_test(a_resumed_run_has_the_bits_of_an_unbroken_one_with_embedded_coupling),
      cmocka_unit_test(a_resumed_run_has_the_bits_of_an_unbroken_one_with_surface_tension),
      cmocka_unit_test(the_files_of_a_resumed_run_are_those_of_an_unbroken_one),
      cmocka_unit_test(a_run_resumed_while_it_cools_has_the_bits_and_files_of_an_unbroken_one),
      cmocka_unit_test(a_run_does_not_go_on_with_another_rom),
  };
  return cmocka_run_group_tests(tests, cast_case_set_up, cast_case_clean_up);
}
