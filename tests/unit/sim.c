/* Small castings from input to summary: the ledger closes, nothing leaks, what leaves is counted, what goes wrong is
 * told. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cast/draw/draw.h"
#include "cast/geometry/surface.h"
#include "cast/io/csv_read.h"
#include "cast/results/run_record.h"
#include "cast/sim/sim.h"
#include "tests/support/assert_close.h"
#include "tests/support/assert_ok.h"
#include "tests/support/cast_run.h"

/* fontconfig keeps what it found. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
  return "leak:libfontconfig";
}

static void assert_ledger_closes(const Sim *sim)
{
  const EnergyLedger e = sim_ledger(sim);
  assert_true(e.exchanged > 1e-3);
  assert_close(e.residual, 0.0, 1e-9 * e.exchanged); // R4; rounding alone gives about 1e-13
  assert_close(e.melt_start - e.melt_now, e.mould_now + e.lost + e.removed, 1e-9 * e.exchanged);
}

/* Depth of the deepest particle in the mould, in spacings; 0 if all are outside. */
static double deepest(const CastRun *run)
{
  CastError err = {0};
  RomData *rom = NULL;
  Surface *surface = NULL;
  ok(rom_read(run->config->rom_path, &rom, &err), &err);
  ok(surface_create(rom, 2e-3, &surface, &err), &err);
  const Particles *p = sim_particles(run->sim);
  double depth = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    SurfaceHit hit;
    const double x[3] = {p->x[0][i], p->x[1][i], p->x[2][i]};
    if (surface_nearest(surface, x, 2e-3, &hit))
      depth = fmax(depth, -hit.distance);
    else
      assert_false(surface_inside_mould(surface, x));
  }
  surface_destroy(&surface);
  rom_destroy(&rom);
  return depth / run->config->spacing;
}

static void check_run(const char *name, const CastCaseInput *input)
{
  CastRun run = cast_run_start(name, input, false);
  const ptrdiff_t n = sim_particles(run.sim)->n_fluid;
  assert_int_equal(cast_run_all(&run), SIM_FINISHED);
  assert_int_equal(sim_particles(run.sim)->n_fluid, n);
  const double end = run.config->cool.wanted ? run.config->cool.end : run.config->end;
  assert_close(sim_time(run.sim), end, 1e-12 * end);
  assert_ledger_closes(run.sim);
  assert_true(deepest(&run) < 0.15); // a tenth of a spacing is what the guard lets pass
  cast_run_finish(&run);
}

static void melt_that_falls_into_a_box_with_a_pin_neither_leaks_nor_loses_heat(void **state)
{
  (void)state;
  check_run("surface", &(CastCaseInput){.time = "{ end: 4 ms }"});
}

static void the_ledger_closes_with_embedded_coupling_and_perfect_contact(void **state)
{
  (void)state;
  check_run("embedded", &(CastCaseInput){
                            .coupling = "{ kind: embedded }", .contact = "{ perfect: true }", .time = "{ end: 2 ms }"});
}

static void the_ledger_closes_with_backward_euler_and_a_fixed_step(void **state)
{
  (void)state;
  check_run("euler", &(CastCaseInput){.time = "{ end: 2 ms, step: 8 us, scheme: backward-euler }"});
}

static void the_ledger_closes_with_summation_density_and_a_frozen_mould(void **state)
{
  (void)state;
  check_run("frozen", &(CastCaseInput){.coupling = "{ mould: frozen }",
                                       .sph = "{ spacing: 0.4 mm, density: summation, negative_pressure: cut }",
                                       .time = "{ end: 2 ms }"});
}

/* Of g L = 0.25 m2/s2 a pool that starts in its own hydrostatic pressure makes hardly any motion. */
static void a_pool_starts_at_rest(void **state)
{
  (void)state;
  const CastCaseInput pool = {.melt = "  material: cual10\n  temperature: 1150 degC\n  cavity_below: -1.6 mm\n",
                              .time = "{ end: 2 ms }"};
  CastRun run = cast_run_start("pool", &pool, false);
  assert_int_equal(cast_run_all(&run), SIM_FINISHED);
  const Particles *p = sim_particles(run.sim);
  const double free_fall = 0.5 * p->mass[0] * (double)p->n_fluid * pow(100.0 * 2e-3, 2.0);
  assert_true(sph_kinetic_energy(p) < 0.02 * free_fall);
  cast_run_finish(&run);
}

static void melt_that_leaves_is_counted_and_its_heat_stays_in_the_books(void **state)
{
  (void)state;
  const CastCaseInput thrown = {.melt = "  material: cual10\n  temperature: 1150 degC\n"
                                        "  blocks: [{ corner: [-1.6 mm, -1.6 mm, -4 mm], size: [3.2 mm, 3.2 mm, 2.4 "
                                        "mm], velocity: [0 m/s, 0 m/s, 8 m/s] }]\n",
                                .forces = "{ gravity: [0 m/s^2, 0 m/s^2, 0 m/s^2] }",
                                .sph = "{ spacing: 0.4 mm, sound_speed: 60 m/s }",
                                .time = "{ end: 8 ms }",
                                .output = "  curves_every: 1 ms\n"};
  CastRun run = cast_run_start("thrown", &thrown, true);
  assert_int_equal(cast_run_all(&run), SIM_EMPTY);
  assert_int_equal(sim_particles(run.sim)->n_fluid, 0);
  const EnergyLedger e = sim_ledger(run.sim);
  assert_true(e.removed > 0.99 * e.melt_start && e.melt_now == 0.0);
  assert_close(e.residual, 0.0, 1e-12 * e.melt_start);
  cast_run_finish(&run);
}

static void a_step_that_is_too_long_ends_in_an_error_that_tells_where_and_when(void **state)
{
  (void)state;
  CastError err = {0};
  SimEnd end;
  CastRun run = cast_run_start("too_long", &(CastCaseInput){.time = "{ end: 20 ms, step: 200 us }"}, true);
  assert_int_equal(sim_run(run.sim, NULL, &end, &err), CAST_ERR_NUMERIC);
  const char *const parts[] = {"step ", "t = ", "dt = 200 us", "particle ", " m"};
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
    if (!strstr(err.message, parts[k])) fail_msg("'%s' does not say '%s'", err.message, parts[k]);
  char path[160], *text = NULL;
  snprintf(path, sizeof path, "%s/checkpoint-failed.h5", run.folder);
  assert_int_equal(access(path, R_OK), 0); // the state for inspection
  snprintf(path, sizeof path, "%s/results.vtkhdf", run.folder);
  ok(run_record_read_summary(path, &text, &err), &err);
  assert_non_null(strstr(text, "step ")); // the summary tells how it ended
  free(text);
  cast_run_finish(&run);
}

/* ---- the second stage ---- */

static json_t *read_json(const char *folder)
{
  char path[160];
  json_error_t fault;
  snprintf(path, sizeof path, "%s/summary.json", folder);
  json_t *root = json_load_file(path, 0, &fault);
  if (!root) fail_msg("%s: %s", path, fault.text);
  return root;
}

static double number_at(const json_t *root, const char *group, const char *name)
{
  const json_t *value = json_object_get(json_object_get(root, group), name);
  if (!json_is_number(value)) fail_msg("%s.%s is no number", group, name);
  return json_number_value(value);
}

static void a_casting_fills_then_cools_until_it_is_solid(void **state)
{
  (void)state;
  const CastCaseInput input = {.time =
                                   "{ end: 3 ms, cool: { end: 60 s, until: solid, every: 0.5 s, tolerance: 2 K } }"};
  CastRun run = cast_run_start("stages", &input, true);
  assert_int_equal(cast_run_all(&run), SIM_FINISHED);
  const Particles *p = sim_particles(run.sim);
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    assert_true(p->T[i] <= run.config->melt.liquidus);
    assert_true(p->v[0][i] == 0.0 && p->v[1][i] == 0.0 && p->v[2][i] == 0.0);
  }
  assert_true(sim_time(run.sim) > 0.1 && sim_time(run.sim) < 60.0);
  assert_ledger_closes(run.sim);
  json_t *root = read_json(run.folder);
  assert_close(number_at(root, "stages", "switch_s"), 3e-3, 1e-12);
  const json_t *reason = json_object_get(json_object_get(root, "stages"), "switch_reason");
  assert_string_equal(json_string_value(reason), "time");
  assert_true(number_at(root, "stages", "cool_steps") > 5.0);
  assert_true(number_at(root, "stages", "solid_fraction") >= 0.999);
  const json_t *local = json_object_get(json_object_get(root, "freezing"), "solidification_time_s");
  const double least = json_number_value(json_object_get(local, "min")),
               most = json_number_value(json_object_get(local, "max"));
  assert_true(least > 0.0 && most > least && most < sim_time(run.sim));
  json_decref(root);
  CastError err = {0};
  char path[160];
  CsvTable table;
  snprintf(path, sizeof path, "%s/ledger.csv", run.folder);
  ok(csv_read(path, &table, &err), &err);
  assert_close(csv_value(&table, table.n_rows - 1, csv_column(&table, "time_s")), sim_time(run.sim),
               1e-6 * sim_time(run.sim)); // curves go on through both stages
  csv_table_free(&table);
  cast_run_finish(&run);
}

/* A pool that was dropped a little: its motion dies out long before the filling's time is up. */
static void cooling_begins_when_the_melt_is_at_rest(void **state)
{
  (void)state;
  const CastCaseInput input = {
      .melt = "  material: { density: 7000 kg/m^3, specific_heat: 500 J/kg/K, latent_heat: 200 kJ/kg, solidus: 1300 K, "
              "liquidus: 1310 K, conductivity: 30 W/m/K, viscosity: 2 Pa.s }\n  temperature: 1150 degC\n"
              "  blocks: [{ corner: [-2 mm, -2 mm, -3.9 mm], size: [4 mm, 4 mm, 2 mm] }]\n",
      .time = "{ end: 300 ms, cool: { end: 1 s, every: 1 s } }"};
  CastRun run = cast_run_start("rest", &input, false);
  assert_int_equal(cast_run_all(&run), SIM_FINISHED);
  double switched = 0.0;
  assert_string_equal(sim_switched(run.sim, &switched), "rest");
  assert_true(switched > 10e-3 && switched < 290e-3);
  assert_ledger_closes(run.sim);
  cast_run_finish(&run);
}

/* Radiation at 800 degC is a multiple of the ROM's 80 W/m2K; what it takes is in the books as lost. */
static void a_mould_that_radiates_cools_faster_and_the_books_close(void **state)
{
  (void)state;
  double held[2];
  for (int k = 0; k < 2; k++) {
    const CastCaseInput input = {.time = "{ end: 1 ms, cool: { end: 20 s, begin: at-end, tolerance: 2 K } }",
                                 .output = k ? "walls: { outside: { emissivity: 0.85 } }\n" : NULL};
    CastRun run = cast_run_start(k ? "radiating" : "plain", &input, false);
    assert_int_equal(cast_run_all(&run), SIM_FINISHED);
    assert_ledger_closes(run.sim);
    held[k] = sim_ledger(run.sim).mould_now;
    cast_run_finish(&run);
  }
  assert_true(held[1] < held[0] - 0.05 * fabs(held[0]));
}

static void embedded_coupling_cools_through_the_surface(void **state)
{
  (void)state;
  check_run("embedded-cool", &(CastCaseInput){.coupling = "{ kind: embedded }",
                                              .time = "{ end: 1 ms, cool: { end: 5 s, begin: at-end } }"});
}

/* ---- files ---- */

static void check_curves(const CastRun *run)
{
  CastError err = {0};
  char path[160];
  CsvTable table;
  snprintf(path, sizeof path, "%s/tracers.csv", run->folder);
  ok(csv_read(path, &table, &err), &err);
  assert_int_equal(table.n_rows, 2 * 31); // two tracers, 3 ms in steps of 0.1 ms, both ends
  assert_string_equal(table.cell[1], "low");
  assert_string_equal(table.cell[table.n_columns + 1], "high");
  const size_t z = csv_column(&table, "z_m");
  assert_close(csv_value(&table, 0, z), -3.8e-3, 1e-9); // the layer at the floor
  assert_true(csv_value(&table, 1, z) > csv_value(&table, 0, z));
  csv_table_free(&table);
  snprintf(path, sizeof path, "%s/probes.csv", run->folder);
  ok(csv_read(path, &table, &err), &err);
  assert_int_equal(table.n_columns, 5);
  const size_t last = table.n_rows - 1;
  assert_close(csv_value(&table, 0, 1), 1423.15, 1e-6); // in the melt from the start
  assert_true(isnan(csv_value(&table, 0, 2)));
  assert_close(csv_value(&table, 0, 4), 1073.15, 1e-6); // in the mould, below the floor
  assert_true(csv_value(&table, last, 4) > 1073.2);
  csv_table_free(&table);
}

static void a_run_leaves_frames_curves_pictures_and_a_summary_that_agree_with_it(void **state)
{
  (void)state;
  CastError err = {0};
  const CastCaseInput input = {.output = "  curves_every: 0.1 ms\n"
                                         "  probes: [{ name: melt, position: [0.8 mm, 0.8 mm, -3 mm] }, { name: floor, "
                                         "position: [1.5 mm, 1.5 mm, -4.1 mm] }]\n"
                                         "  tracers: [{ name: low, nearest: [1.2 mm, 1.2 mm, -4 mm] }, { name: high, "
                                         "nearest: [0 mm, 0 mm, -1 mm] }]\n"};
  CastRun run = cast_run_start("files", &input, true);
  assert_int_equal(cast_run_all(&run), SIM_FINISHED);
  check_curves(&run);
  json_t *root = read_json(run.folder);
  const EnergyLedger e = sim_ledger(run.sim);
  assert_close(number_at(root, "energy_J", "exchanged"), e.exchanged, 1e-12 * e.exchanged);
  assert_close(number_at(root, "work", "steps"), (double)sim_steps(run.sim), 0.0);
  assert_true(number_at(root, "work", "particle_steps_per_s") > 0.0);
  assert_close(json_number_value(json_object_get(root, "time_s")), 3e-3, 1e-12);
  assert_string_equal(json_string_value(json_object_get(root, "outcome")), "finished");
  assert_true(number_at(root, "cavity_wall_K", "max") > 1073.15);
  json_decref(root);
  ok(draw_folder(run.folder, NULL, &err), &err);
  static const char *const names[] = {"filling.png",   "speed.png",   "pressure.png", "curves.png",
                                      "resolved.yaml", "summary.txt", "results.xmf",  "mould.xmf"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    char path[160];
    struct stat info;
    snprintf(path, sizeof path, "%s/%s", run.folder, names[k]);
    if (stat(path, &info) != 0 || info.st_size < 500) fail_msg("%s is missing or nearly empty", path);
  }
  cast_run_finish(&run);
}

/* Writing must not change what is computed. */
static void a_run_that_writes_has_the_bits_of_one_that_does_not(void **state)
{
  (void)state;
  CastRun silent = cast_run_start("silent", NULL, false), writing = cast_run_start("writing", NULL, true);
  sim_request_checkpoint(writing.sim);
  cast_run_all(&silent);
  cast_run_all(&writing);
  const Particles *p = sim_particles(silent.sim), *q = sim_particles(writing.sim);
  assert_int_equal(p->n_fluid, q->n_fluid);
  assert_memory_equal(p->E, q->E, (size_t)p->n_fluid * sizeof(double));
  assert_memory_equal(p->x[2], q->x[2], (size_t)p->n_fluid * sizeof(double));
  cast_run_finish(&silent);
  cast_run_finish(&writing);
}

/* A block of 8 x 8 x 6 spacings is 384 particles wherever the lattice lies. */
static void a_block_holds_its_volume_s_worth_of_particles(void **state)
{
  (void)state;
  static const char *const corners[] = {"[-1.6 mm, -1.6 mm, -3.2 mm]", "[-1.4 mm, -1.5 mm, -3.0 mm]",
                                        "[-1.27 mm, -1.81 mm, -3.33 mm]"};
  for (int k = 0; k < 3; k++) {
    char melt[256];
    snprintf(
        melt, sizeof melt,
        "  material: cual10\n  temperature: 1150 degC\n  blocks: [{ corner: %s, size: [3.2 mm, 3.2 mm, 2.4 mm] }]\n",
        corners[k]);
    CastRun run = cast_run_start("block", &(CastCaseInput){.melt = melt}, false);
    assert_int_equal(sim_particles(run.sim)->n_fluid, 384);
    cast_run_finish(&run);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(melt_that_falls_into_a_box_with_a_pin_neither_leaks_nor_loses_heat),
      cmocka_unit_test(the_ledger_closes_with_embedded_coupling_and_perfect_contact),
      cmocka_unit_test(the_ledger_closes_with_backward_euler_and_a_fixed_step),
      cmocka_unit_test(the_ledger_closes_with_summation_density_and_a_frozen_mould),
      cmocka_unit_test(a_pool_starts_at_rest),
      cmocka_unit_test(melt_that_leaves_is_counted_and_its_heat_stays_in_the_books),
      cmocka_unit_test(a_step_that_is_too_long_ends_in_an_error_that_tells_where_and_when),
      cmocka_unit_test(a_casting_fills_then_cools_until_it_is_solid),
      cmocka_unit_test(cooling_begins_when_the_melt_is_at_rest),
      cmocka_unit_test(a_mould_that_radiates_cools_faster_and_the_books_close),
      cmocka_unit_test(embedded_coupling_cools_through_the_surface),
      cmocka_unit_test(a_run_leaves_frames_curves_pictures_and_a_summary_that_agree_with_it),
      cmocka_unit_test(a_run_that_writes_has_the_bits_of_one_that_does_not),
      cmocka_unit_test(a_block_holds_its_volume_s_worth_of_particles),
  };
  return cmocka_run_group_tests(tests, cast_case_set_up, cast_case_clean_up);
}
