/* The record of the heat that the mould received: its joules are those of the books, by patch and by triangle, however
 * the steps fall into its intervals. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "cast/results/heat_recorder.h"
#include "cast/sim/sim.h"
#include "common/h5/h5.h"
#include "tests/support/assert_close.h"
#include "tests/support/assert_ok.h"
#include "tests/support/cast_case.h"

static void check_triangles(const HeatRecord *record, const RomData *rom)
{
  double *sum = calloc(record->m, sizeof *sum);
  assert_non_null(sum);
  for (size_t i = 0; i < record->n; i++) {
    double largest = 0.0;
    for (size_t l = 0; l < record->m; l++) {
      sum[l] = 0.0;
      largest = fmax(largest, fabs(record->heat[i * record->m + l]));
    }
    for (size_t t = 0; t < record->n_triangles; t++)
      sum[rom->triangle_patch[record->triangle[t]]] += record->triangle_heat[i * record->n_triangles + t];
    for (size_t l = 0; l < record->m && !rom->patch[l].outer; l++)
      assert_close(sum[l], record->heat[i * record->m + l], 1e-12 * largest); // rounding of some hundred terms
  }
  free(sum);
}

static void check_run(const char *name, const char *coupling, const char *contact, const char *walls)
{
  char output[256];
  snprintf(output, sizeof output, "  record_every: 0.37 ms\n  record_triangles: true\n%s", walls);
  const CastCaseInput input = {.coupling = coupling, .contact = contact, .output = output};
  CastError err = {0};
  CastConfig *config = NULL;
  Sim *sim = NULL;
  RomData *rom = NULL;
  HeatRecord record;
  SimEnd end;
  char path[128], folder[124];
  ok(cast_case_input(&casting, name, &input, path, &err), &err);
  snprintf(folder, sizeof folder, "%.60s/%.60s", casting.folder, name);
  mkdir(folder, 0777);
  ok(cast_config_read(path, NULL, &config, &err), &err);
  ok(sim_create(config, NULL, &sim, &err), &err);
  ok(sim_open_output(sim, "test", &err), &err);
  ok(sim_run(sim, NULL, &end, &err), &err);
  ok(rom_read(config->rom_path, &rom, &err), &err);
  snprintf(path, sizeof path, "%.110s/heat.h5", folder);
  ok(heat_record_read(path, &record, &err), &err);
  const EnergyLedger e = sim_ledger(sim);
  double total = 0.0, through_walls = 0.0, largest = 0.0;
  for (size_t i = 0; i < record.n * record.m; i++)
    *(rom->patch[i % record.m].outer ? &through_walls : &total) += record.heat[i];
  for (size_t i = 0; i < record.n * record.n_triangles; i++) largest = fmax(largest, record.triangle_heat[i]);
  assert_true(e.exchanged > 1e-3 && largest > 0.0);
  assert_close(total, e.mould_now + e.lost, 1e-9 * e.exchanged); // R4: the melt's heat; what left is in `lost`
  assert_true(walls[0] ? through_walls < -1e-3 * total : through_walls == 0.0);
  assert_int_equal(record.n, 9); // 3 ms: eight intervals and a part
  assert_close(record.time[0], 0.37e-3, 1e-18);
  assert_close(record.time[8], 3e-3, 1e-15);
  assert_true(record.preheat == config->preheat && record.ambient == config->ambient);
  check_triangles(&record, rom);
  heat_record_free(&record);
  rom_destroy(&rom);
  sim_destroy(&sim);
  cast_config_destroy(&config);
}

static void its_joules_are_the_ledger_s_with_surface_coupling(void **state)
{
  (void)state;
  check_run("surface", "{ kind: surface }", "{ h: 2000 W/m^2/K }", "");
}

static void its_joules_are_the_ledger_s_where_the_exchange_takes_sub_steps(void **state)
{
  (void)state;
  check_run("embedded", "{ kind: embedded }", "{ perfect: true }", "");
}

static void heat_through_outer_walls_is_recorded_and_lost(void **state)
{
  (void)state;
  check_run("walls", "{ kind: surface }", "{ h: 2000 W/m^2/K }",
            "walls: { outside: { h: 20 W/m^2/K, emissivity: 0.9 }, rim: { ambient: 300 K, h: 500 W/m^2/K } }\n");
}

/* Flows of 2 W and -1 W for 2.5 intervals, then none for one: 0.5 of the third is left open. */
static void a_step_is_divided_between_the_intervals_it_reaches(void **state)
{
  (void)state;
  static const double flow[2] = {2.0, -1.0}, none[2] = {0.0, 0.0};
  const HeatRecorderSetup setup = {.every = 0.1, .rom_sha256 = "none", .preheat = 900.0, .ambient = 300.0, .m = 2};
  HeatRecorder *recorder;
  HeatRecord record;
  CastError err = {0};
  char path[128];
  double buffer[5];
  ok(heat_recorder_open(casting.folder, &setup, NULL, &recorder, &err), &err);
  assert_int_equal(heat_recorder_size(recorder), 5);
  ok(heat_recorder_add(recorder, 0.0, 0.25, flow, NULL, &err), &err);
  heat_recorder_save(recorder, buffer);
  assert_int_equal(heat_recorder_saved_rows(buffer), 2);
  ok(heat_recorder_add(recorder, 0.25, 0.2, flow, NULL, &err), &err); // written, then taken back
  heat_recorder_close(&recorder);
  const size_t rows = heat_recorder_saved_rows(buffer);
  ok(heat_recorder_open(casting.folder, &setup, &rows, &recorder, &err), &err);
  heat_recorder_restore(recorder, buffer);
  ok(heat_recorder_add(recorder, 0.25, 0.1, none, NULL, &err), &err);
  ok(heat_recorder_finish(recorder, &err), &err);
  heat_recorder_close(&recorder);
  snprintf(path, sizeof path, "%s/heat.h5", casting.folder);
  ok(heat_record_read(path, &record, &err), &err);
  static const double time[4] = {0.1, 0.2, 0.3, 0.35}, joules[4] = {0.2, 0.2, 0.1, 0.0};
  assert_int_equal(record.n, 4);
  for (int i = 0; i < 4; i++) {
    assert_close(record.time[i], time[i], 1e-15);
    assert_close(record.heat[2 * i], joules[i], 1e-15);
    assert_close(record.heat[2 * i + 1], -0.5 * joules[i], 1e-15);
  }
  heat_record_free(&record);
}

static void another_file_is_no_record(void **state)
{
  (void)state;
  HeatRecord record;
  CastError err = {0};
  char path[128];
  snprintf(path, sizeof path, "%s/mould.rom.h5", casting.folder);
  assert_int_equal(heat_record_read(path, &record, &err), CAST_ERR_FORMAT);
  assert_non_null(strstr(err.message, "is no record of heat flows"));
  snprintf(path, sizeof path, "%s/nothing.h5", casting.folder);
  assert_int_equal(heat_record_read(path, &record, &err), CAST_ERR_IO);
}

/* A run that is cut off between the sets of a row leaves the rows before it. */
static void a_row_that_was_not_finished_is_dropped(void **state)
{
  (void)state;
  static const double flow[2] = {2.0, -1.0};
  const HeatRecorderSetup setup = {.every = 0.1, .rom_sha256 = "none", .preheat = 900.0, .ambient = 300.0, .m = 2};
  HeatRecorder *recorder;
  HeatRecord record;
  CastError err = {0};
  char path[128];
  ok(heat_recorder_open(casting.folder, &setup, NULL, &recorder, &err), &err);
  ok(heat_recorder_add(recorder, 0.0, 0.3, flow, NULL, &err), &err);
  heat_recorder_close(&recorder);
  snprintf(path, sizeof path, "%s/heat.h5", casting.folder);
  const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), set = H5Dopen2(file, HEAT_RECORD_TIME, H5P_DEFAULT);
  const hsize_t shorter[1] = {2};
  assert_true(H5Dset_extent(set, shorter) >= 0);
  H5Dclose(set);
  H5Fclose(file);
  ok(heat_record_read(path, &record, &err), &err);
  assert_int_equal(record.n, 2);
  heat_record_free(&record);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(its_joules_are_the_ledger_s_with_surface_coupling),
      cmocka_unit_test(its_joules_are_the_ledger_s_where_the_exchange_takes_sub_steps),
      cmocka_unit_test(heat_through_outer_walls_is_recorded_and_lost),
      cmocka_unit_test(a_step_is_divided_between_the_intervals_it_reaches),
      cmocka_unit_test(another_file_is_no_record),
      cmocka_unit_test(a_row_that_was_not_finished_is_dropped),
  };
  return cmocka_run_group_tests(tests, cast_case_set_up, cast_case_clean_up);
}
