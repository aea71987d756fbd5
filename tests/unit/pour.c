/* Inlets and outlets: what comes in is what was asked for, without a shock; the books close; resumed runs go on with
 * the same bits. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cast/kernel/pair.h"
#include "cast/pour/inlet.h"
#include "cast/pour/outlet.h"
#include "cast/sim/sim.h"
#include "tests/support/assert_close.h"
#include "tests/support/assert_ok.h"
#include "tests/support/cast_run.h"

/* ---- storage ---- */

static void particles_that_are_added_stand_between_melt_and_walls(void **state)
{
  (void)state;
  CastError err;
  double at[3][3] = {{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}, {7.0, 8.0, 9.0}};
  double *x[3] = {at[0], at[1], at[2]};
  double one[2] = {10.0, 20.0}, two[2] = {30.0, 40.0};
  int32_t patch[2] = {5, 6};
  WallSet walls = {.n = 2,
                   .x = {one, two, one},
                   .volume = one,
                   .foot = {one, one, one},
                   .normal = {one, one, one},
                   .depth = two,
                   .patch = patch};
  Particles p;
  ok(particles_create(3, x, 0.5, 8.0, &walls, &p, &err), &err);
  for (int round = 0; round < 40; round++) { // beyond any room there was
    ok(particles_add(&p, 7, &err), &err);
    const ptrdiff_t first = p.n_fluid - 7;
    for (ptrdiff_t i = first; i < p.n_fluid; i++) {
      assert_true(p.x[0][i] == 0.0 && p.rho[i] == 0.0 && p.drho_last[i] == 0.0 && p.id[i] == 0);
      p.x[0][i] = (double)i;
      p.id[i] = (int32_t)i;
    }
  }
  assert_int_equal(p.n_fluid, 283);
  assert_int_equal(p.n, 285);
  for (ptrdiff_t i = 3; i < 283; i++) assert_true(p.x[0][i] == (double)i && p.id[i] == i);
  for (int i = 0; i < 3; i++) assert_true(p.x[1][i] == at[1][i] && p.mass[i] == 1.0);
  for (int k = 0; k < 2; k++) {
    assert_true(p.x[0][283 + k] == one[k] && p.x[1][283 + k] == two[k] && p.volume[283 + k] == one[k]);
    assert_int_equal(p.patch[k], patch[k]);
  }
  particles_destroy(&p);
}

/* ---- an inlet ---- */

static Table table_of(size_t n, const double *x, const double *y)
{
  CastError err;
  Table table;
  ok(table_create(n, x, y, &table, &err), &err);
  return table;
}

static const SphParameters coarse = {
    .kernel = KERNEL_WENDLAND_C2, .h = 1.5e-3, .spacing = 1e-3, .rho0 = 1000.0, .c0 = 10.0, .gamma = 7.0};

static void the_way_of_a_buffer_is_the_integral_of_its_rate(void **state)
{
  (void)state;
  CastError err;
  InletConfig config = {.disc = true, .direction = {0.0, 0.0, -1.0}, .radius = 4e-3, .kind = INLET_MASS_FLOW};
  config.rate = table_of(4, (const double[]){0.0, 1.0, 2.0, 3.0}, (const double[]){0.0, 0.2, 0.2, 0.0});
  Inlet inlet;
  ok(inlet_create(&config, &coarse, NULL, &inlet, &err), &err);
  assert_int_equal(inlet.n, 52); // of a disc 8 spacings across: pi 16 = 50.3
  assert_int_equal(inlet.layers, 4);
  const double area = 52e-6;
  assert_close(inlet_speed(&inlet, 1.5), 0.2 / (1000.0 * area), 1e-12);
  assert_close(inlet_way(&inlet, 2.5), (0.1 + 0.2 + 0.075) / (1000.0 * area), 1e-12);
  assert_close(inlet_end(&config), 3.0, 0.0);
  assert_int_equal(inlet_most_layers(&inlet, 3.0), 4 + 7692 + 1); // 0.4 kg in layers of 52 mg
  table_destroy(&config.rate);
  config.rate = table_of(1, (const double[]){0.0}, (const double[]){0.1});
  assert_true(isinf(inlet_end(&config)));
  table_destroy(&config.rate);
  inlet_destroy(&inlet);
}

static void a_rectangle_lies_across_its_direction_with_its_width_along_the_axis_given(void **state)
{
  (void)state;
  CastError err;
  const double c = sqrt(0.5);
  InletConfig config = {
      .centre = {1.0, 2.0, 3.0}, .direction = {c, 0.0, -c}, .along = {0.0, 1.0, 0.0}, .width = 6e-3, .height = 2e-3};
  Inlet inlet;
  ok(inlet_create(&config, &coarse, NULL, &inlet, &err), &err);
  assert_int_equal(inlet.n, 12);
  double most[2] = {0.0, 0.0};
  for (ptrdiff_t k = 0; k < inlet.n; k++) {
    const double r[3] = {inlet.at[0][k] - 1.0, inlet.at[1][k] - 2.0, inlet.at[2][k] - 3.0};
    assert_close(r[0] * c - r[2] * c, 0.0, 1e-15);
    most[0] = fmax(most[0], fabs(r[1]));
    most[1] = fmax(most[1], fabs(r[0] * c + r[2] * c));
  }
  assert_close(most[0], 2.5e-3, 1e-15);
  assert_close(most[1], 0.5e-3, 1e-15);
  inlet_destroy(&inlet);
}

static void outlets_take_what_is_in_their_box_or_beyond_their_plane(void **state)
{
  (void)state;
  const OutletConfig box = {.kind = OUTLET_BOX, .corner = {0.0, 0.0, 0.0}, .size = {1.0, 2.0, 3.0}};
  const OutletConfig plane = {.kind = OUTLET_PLANE, .point = {0.0, 0.0, 1.0}, .normal = {0.0, 0.0, -1.0}};
  assert_true(outlet_takes(&box, NULL, NULL, 0.0, (const double[3]){0.5, 1.9, 2.9}));
  assert_false(outlet_takes(&box, NULL, NULL, 0.0, (const double[3]){0.5, 2.1, 2.9}));
  assert_true(outlet_takes(&plane, NULL, NULL, 0.0, (const double[3]){9.0, 9.0, 0.9}));
  assert_false(outlet_takes(&plane, NULL, NULL, 0.0, (const double[3]){9.0, 9.0, 1.1}));
}

/* ---- castings ---- */

static void assert_ledger_closes(const Sim *sim)
{
  const EnergyLedger e = sim_ledger(sim);
  assert_true(e.exchanged > 1e-4 && e.added > 0.0);
  assert_close(e.residual, 0.0, 1e-9 * e.exchanged); // R4
  assert_close(e.melt_start + e.added - e.melt_now, e.mould_now + e.lost + e.removed, 1e-9 * e.exchanged);
}

static double mean_temperature(const Particles *p)
{
  double sum = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) sum += p->T[i];
  return sum / (double)p->n_fluid;
}

/* A stream of 2.8 mm by 2.8 mm at 0.8 m/s falls into the cup: 7 x 7 particles, 5 layers in 2.5 ms. Free fall aside
 * nothing happens to it before it lands, so its pressure is that of a jet: none. Limit: a hundredth of what a particle
 * put into its place at rest would bring, rho c v. */
static void a_stream_comes_in_at_its_rate_and_without_pressure(void **state)
{
  (void)state;
  CastError err = {0};
  const CastCaseInput input = {
      .melt =
          "  material: cual10\n  temperature: 1150 degC\n  inlets:\n    - rectangle: { centre: [0 mm, 0 mm, 1 mm], "
          "along: [1, 0, 0], width: 2.8 mm, height: 2.8 mm }\n      direction: [0, 0, -1]\n      velocity: 0.8 m/s\n"
          "      temperature: [[0 s, 1150 degC], [2.5 ms, 1200 degC]]\n",
      .forces = "{ gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2] }",
      .time = "{ end: 2.5 ms }"};
  CastRun run = cast_run_start("stream", &input, false);
  const Particles *p = sim_particles(run.sim);
  const ptrdiff_t buffer = 4 * 49, before = p->n_fluid;
  assert_int_equal(before, buffer);
  double most = 0.0, rho0 = run.config->melt.density;
  while (sim_time(run.sim) < 2.5e-3 * (1.0 - 1e-9)) {
    ok(sim_step(run.sim, &err), &err);
    for (ptrdiff_t i = 0; i < p->n_fluid; i++)
      if (p->x[2][i] > -2e-3) most = fmax(most, fabs(p->p[i])); // the floor is at -4 mm
  }
  assert_int_equal(p->n_fluid, buffer + 5 * 49);
  // with gravity of 9.81 m/s2 and the cup as high as the buffer, c0 is 10 sqrt(0.8^2 + 2 9.81 0.007) m/s
  assert_true(most < 0.01 * rho0 * 10.0 * 0.88 * 0.8);
  assert_true(mean_temperature(p) > 1423.15); // what came last was hotter
  for (ptrdiff_t i = 0; i < p->n_fluid; i++)
    for (ptrdiff_t k = 0; k < i; k++) assert_int_not_equal(p->id[i], p->id[k]);
  const EnergyLedger e = sim_ledger(run.sim); // hardly anything has touched the mould
  assert_true(e.added > 0.0);
  assert_close(e.residual, 0.0, 1e-14 * e.added);
  cast_run_finish(&run);
}

/* A plug as wide as the cup (10 x 10 particles) rises in it like a piston, at 0.3 m/s against gravity of 100 m/s2: the
 * free melt weighs rho g h on it. */
static void melt_fed_from_below_rises_evenly(void **state)
{
  (void)state;
  CastError err = {0};
  const CastCaseInput input = {
      .melt = "  material: cual10\n  temperature: 1150 degC\n  inlets:\n    - rectangle: { centre: [0 mm, 0 mm, -2.4 "
              "mm], along: [1, 0, 0], width: 4 mm, height: 4 mm }\n      direction: [0, 0, 1]\n      flow: [[0 s, 0 "
              "mm^3/s], [3 ms, 4800 mm^3/s], [6 ms, 4800 mm^3/s], [12 ms, 0 mm^3/s]]\n      at_end: plug\n",
      .forces = "{ gravity: [0 m/s^2, 0 m/s^2, -100 m/s^2] }",
      .time = "{ end: 17 ms }"};
  CastRun run = cast_run_start("from_below", &input, false);
  const Particles *p = sim_particles(run.sim);
  const double rho0 = run.config->melt.density, inlet = -2.4e-3;
  double weight = 0.0, measured = 0.0, most = 0.0;
  while (sim_time(run.sim) < 17e-3 * (1.0 - 1e-9)) {
    ok(sim_step(run.sim, &err), &err);
    for (ptrdiff_t i = 0; i < p->n_fluid && sim_time(run.sim) < 12e-3; i++) most = fmax(most, fabs(p->p[i]));
    if (sim_time(run.sim) < 13e-3) continue;
    double top = -1.0, sum = 0.0;
    int n = 0;
    for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
      top = fmax(top, p->x[2][i]);
      if (p->x[2][i] < inlet || p->x[2][i] > inlet + 0.4e-3) continue;
      sum += p->p[i] - rho0 * 100.0 * (inlet - p->x[2][i]);
      n++;
    }
    weight += rho0 * 100.0 * (top + 0.2e-3 - inlet);
    measured += sum / n;
  }
  // 36 mm3 in whole layers of 100 particles of 0.064 mm3, behind the buffer's four
  assert_int_equal(p->n_fluid, 100 * (4 + 5));
  assert_true(most < 0.15 * rho0 * 9.0 * 0.3); // of what a particle put into its place would bring, rho c v
  assert_close(measured / weight, 1.0, 0.1);   // its top is not flat: it stands higher at the walls
  assert_ledger_closes(run.sim);
  cast_run_finish(&run);
}

/* A stream through the cup to an outlet in the pin; then the stream ends and its buffer goes. */
static const CastCaseInput through = {
    .melt = "  material: cual10\n  temperature: 1150 degC\n"
            "  blocks: [{ corner: [-1.6 mm, -1.6 mm, -4 mm], size: [3.2 mm, 3.2 mm, 0.8 mm] }]\n"
            "  inlets:\n    - disc: { centre: [0 mm, 0 mm, 0 mm], radius: 1.2 mm }\n      direction: [0, 0, -1]\n"
            "      mass_flow: [[0 s, 40 g/s], [2.4 ms, 40 g/s], [2.5 ms, 0 g/s]]\n"
            "  outlets:\n    - box: { corner: [-1 mm, -1 mm, -7 mm], size: [2 mm, 2 mm, 2.2 mm] }\n"
            "    - surface: pin\n    - plane: { point: [0 mm, 0 mm, -20 mm], normal: [0, 0, -1] }\n",
    .forces = "{ gravity: [0 m/s^2, 0 m/s^2, -300 m/s^2] }",
    .time = "{ end: 4 ms }",
    .output = "  curves_every: 0.1 ms\n"};

static void what_leaves_through_outlets_is_counted(void **state)
{
  (void)state;
  CastError err = {0};
  CastRun run = cast_run_start("through", &through, true);
  const Particles *p = sim_particles(run.sim);
  const double mass = p->mass[0], before = (double)p->n_fluid * mass;
  SimEnd end;
  ok(sim_run(run.sim, NULL, &end, &err), &err);
  const EnergyLedger e = sim_ledger(run.sim);
  assert_ledger_closes(run.sim);
  assert_true(e.removed > 0.0);
  char path[256];
  snprintf(path, sizeof path, "%s/summary.txt", run.folder);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  char line[256];
  double passed = NAN, left[3] = {NAN, NAN, NAN};
  while (fgets(line, sizeof line, file)) {
    sscanf(line, "  through inlet 1 %lf g", &passed);
    int which;
    double value;
    if (sscanf(line, "  through outlet %d %lf g", &which, &value) == 2 && which >= 1 && which <= 3)
      left[which - 1] = value;
  }
  fclose(file);
  // 40 g/s for 2.4 ms and half of that for 0.1 ms, in whole layers
  const double layer = 1e3 * mass * (double)run.config->n_inlets * 32.0;
  assert_close(passed, 98.0e-3, layer);
  assert_true(left[1] > 0.0);
  assert_true(left[2] == 0.0);
  // what was there, came and went is what is there: to the last particle. The buffer was there at the start and went
  const double buffer = 4.0 * layer;
  assert_close(1e3 * (double)p->n_fluid * mass, 1e3 * before - buffer + passed - left[0] - left[1], 1e-6);
  cast_run_finish(&run);
}

static void a_pouring_run_that_is_resumed_has_the_bits_of_an_unbroken_one(void **state)
{
  (void)state;
  CastError err = {0};
  SimEnd end;
  omp_set_num_threads(2);
  CastCaseInput all = through; // and all forces that change with time
  all.forces = "{ gravity: [[0 s, 0 0 -300 m/s^2], [4 ms, 0 100 -300 m/s^2]], "
               "spin: { point: [30 mm, 0 mm, 0 mm], axis: [1, 2, 3], speed: [[0 s, 500 rpm], [3 ms, 900 rpm]] }, "
               "gas: { pressure: [[0 s, 0 kPa], [2 ms, 5 kPa]], from: { corner: -2 -2 -1 mm, size: 4 4 2 mm } } }";
  CastRun whole = cast_run_start("pour_whole", &all, true), broken = cast_run_start("pour_broken", &all, true);
  ok(sim_run(whole.sim, NULL, &end, &err), &err);
  while (sim_time(broken.sim) < 1.5e-3) ok(sim_step(broken.sim, &err), &err);
  volatile sig_atomic_t stop = 1;
  ok(sim_run(broken.sim, &stop, &end, &err), &err);
  assert_int_equal(end, SIM_INTERRUPTED);
  cast_run_finish(&broken);
  omp_set_num_threads(1);
  ok(sim_resume(broken.folder, NULL, "test", &broken.config, &broken.sim, &err), &err);
  ok(sim_run(broken.sim, NULL, &end, &err), &err);
  cast_run_assert_same_melt(whole.sim, broken.sim);
  const EnergyLedger e = sim_ledger(whole.sim), g = sim_ledger(broken.sim);
  assert_memory_equal(&e, &g, sizeof e);
  cast_run_finish(&whole);
  cast_run_finish(&broken);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(particles_that_are_added_stand_between_melt_and_walls),
      cmocka_unit_test(the_way_of_a_buffer_is_the_integral_of_its_rate),
      cmocka_unit_test(a_rectangle_lies_across_its_direction_with_its_width_along_the_axis_given),
      cmocka_unit_test(outlets_take_what_is_in_their_box_or_beyond_their_plane),
      cmocka_unit_test(a_stream_comes_in_at_its_rate_and_without_pressure),
      cmocka_unit_test(melt_fed_from_below_rises_evenly),
      cmocka_unit_test(what_leaves_through_outlets_is_counted),
      cmocka_unit_test(a_pouring_run_that_is_resumed_has_the_bits_of_an_unbroken_one),
  };
  return cmocka_run_group_tests(tests, cast_case_set_up, cast_case_clean_up);
}
