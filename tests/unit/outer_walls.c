/* Outer walls under conditions of their own: what a ROM made with them gives, radiation to its exact steady state, and
 * every joule in the books. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cast/mould/rom_state.h"
#include "tests/support/assert_close.h"
#include "tests/support/synthetic_rom.h"

static const double PREHEAT = 973.0, AMBIENT = 300.0, SIGMA = 5.670374419e-8;

typedef struct Case {
  RomData *rom;
  RomState *state;
  OuterWalls *walls;
} Case;

/* A slab of 10 cm2 with its bottom as given in the ROM and, where n_walls is 1, otherwise in the run. */
static Case start(double h_bottom, size_t n_walls, const OuterWall *wall)
{
  const SyntheticSlab slab = {.size = {4e-2, 2.5e-2},
                              .depth = 5e-3,
                              .kappa = 1.0,
                              .rho = 1800.0,
                              .c = 1100.0,
                              .h_bottom = h_bottom,
                              .modes = 400};
  CastError err = {0};
  Case made = {NULL, NULL, NULL};
  if (synthetic_rom_slab(&slab, &made.rom, &err) != CAST_OK) fail_msg("%s", err.message);
  if (rom_state_create(made.rom, ROM_EXPONENTIAL, PREHEAT, AMBIENT, &made.state, &err) != CAST_OK)
    fail_msg("%s", err.message);
  if (n_walls == 0) return made;
  if (outer_walls_create(made.rom, n_walls, wall, NULL, AMBIENT, &made.walls, &err) != CAST_OK)
    fail_msg("%s", err.message);
  if (rom_state_set_walls(made.state, made.walls, &err) != CAST_OK) fail_msg("%s", err.message);
  return made;
}

static void finish(Case *made)
{
  rom_state_destroy(&made->state);
  outer_walls_destroy(&made->walls);
  rom_destroy(&made->rom);
}

/* Patches of the slab: top/1, bottom, sides. */
enum { TOP, BOTTOM, PATCHES = 3 };

static void run(Case *made, double watts, double t_end, double dt)
{
  const double q[PATCHES] = {watts, 0.0, 0.0};
  const long steps = lround(t_end / dt);
  for (long i = 0; i < steps; i++) rom_state_step(made->state, q, dt);
}

/* After 20 s of 20 W, against a ROM that has the condition in its K; relative to the largest change. */
static double error_against_made(double h_rom, double h_run, double dt)
{
  const OuterWall wall = {.surface = "bottom", .h = h_run, .ambient = (double)NAN};
  Case reference = start(h_run, 0, NULL), other = start(h_rom, 1, &wall);
  run(&reference, 20.0, 20.0, dt);
  run(&other, 20.0, 20.0, dt);
  const double *T = rom_state_patch_temperature(other.state), *exact = rom_state_patch_temperature(reference.state);
  const double scale = fmax(fabs(exact[TOP] - PREHEAT), fabs(exact[BOTTOM] - PREHEAT));
  const double error = fmax(fabs(T[TOP] - exact[TOP]), fabs(T[BOTTOM] - exact[BOTTOM])) / scale;
  finish(&reference);
  finish(&other);
  return error;
}

static void another_coefficient_is_as_if_the_rom_had_been_made_with_it(void **state)
{
  (void)state;
  assert_true(error_against_made(20.0, 100.0, 0.01) < 1e-3);
  assert_true(error_against_made(100.0, 20.0, 0.01) < 1e-3); // less cooling than in K
  assert_true(error_against_made(0.0, 100.0, 0.01) < 1e-3);  // insulated in K
}

static void the_error_is_of_first_order_in_the_time_step(void **state)
{
  (void)state;
  const double order = log2(error_against_made(20.0, 100.0, 0.2) / error_against_made(20.0, 100.0, 0.1));
  assert_true(order > 0.7 && order < 1.5); // one flow a step
}

/* Steady: q/A = eps sigma (T^4 - T_amb^4) at the bottom, and q depth/(kappa A) more on top. */
static void radiation_comes_to_its_exact_steady_state_by_long_steps(void **state)
{
  (void)state;
  const double area = 1e-3, q = 30.0, surroundings = 500.0, emissivity = 0.85;
  const OuterWall wall = {.surface = "bottom", .h = (double)NAN, .ambient = surroundings, .emissivity = emissivity};
  Case made = start(0.0, 1, &wall);
  run(&made, q, 20000.0, 20.0);
  const double *T = rom_state_patch_temperature(made.state);
  const double bottom = pow(pow(surroundings, 4.0) + q / (area * emissivity * SIGMA), 0.25);
  assert_close(T[BOTTOM], bottom, 1e-6 * bottom);              // the time constant is some 100 s
  assert_close(T[TOP], bottom + q * 5e-3 / (1.0 * area), 0.2); // 2 q depth/(kappa pi^2 modes) = 0.08 K of truncation
  finish(&made);
}

static void every_joule_is_in_the_books(void **state)
{
  (void)state;
  const OuterWall wall = {.surface = "bottom", .h = 150.0, .ambient = 400.0, .emissivity = 0.5};
  Case made = start(30.0, 1, &wall);
  double heat[PATCHES] = {0.0};
  run(&made, 25.0, 10.0, 0.03125);
  rom_state_take_wall_heat(made.state, heat);
  const double given = 25.0 * 10.0, held = rom_state_heat(made.state), lost = rom_state_lost(made.state);
  assert_close(given, held + lost, 1e-12 * (given + fabs(lost)));
  assert_true(lost > 100.0 && heat[BOTTOM] < 0.0 && heat[TOP] == 0.0);
  /* All that left: by the condition in K, lost without the difference, and by the difference. */
  double again[PATCHES] = {0.0};
  rom_state_take_wall_heat(made.state, again);
  assert_true(again[BOTTOM] == 0.0); // taken
  finish(&made);
}

static void a_restored_state_goes_on_with_the_same_bits(void **state)
{
  (void)state;
  const OuterWall wall = {.surface = "bottom", .h = 150.0, .ambient = (double)NAN, .emissivity = 0.5};
  Case one = start(30.0, 1, &wall), two = start(30.0, 1, &wall);
  run(&one, 25.0, 1.0, 0.03125);
  double *buffer = malloc(rom_state_size(one.state) * sizeof *buffer), heat[2] = {0.0};
  assert_non_null(buffer);
  rom_state_save(one.state, buffer);
  rom_state_restore(two.state, buffer);
  free(buffer);
  run(&one, 25.0, 1.0, 0.03125);
  run(&two, 25.0, 1.0, 0.03125);
  for (int k = 0; k < 2; k++) {
    double taken[PATCHES] = {0.0};
    rom_state_take_wall_heat(k == 0 ? one.state : two.state, taken);
    heat[k] = taken[BOTTOM];
  }
  assert_true(heat[0] == heat[1]);
  assert_memory_equal(rom_state_z(one.state), rom_state_z(two.state), one.rom->r * sizeof(double));
  assert_true(rom_state_lost(one.state) == rom_state_lost(two.state));
  finish(&one);
  finish(&two);
}

static void what_the_rom_cannot_have_is_refused(void **state)
{
  (void)state;
  OuterWall wall = {.surface = "lid", .h = 10.0, .ambient = (double)NAN};
  Case made = start(30.0, 0, NULL);
  OuterWalls *walls;
  CastError err = {0};
  assert_int_equal(outer_walls_create(made.rom, 1, &wall, NULL, AMBIENT, &walls, &err), CAST_ERR_INPUT);
  assert_null(walls);
  assert_string_equal(err.message, "walls.lid: the ROM has no outer surface of this name; it has bottom, sides");
  snprintf(wall.surface, sizeof wall.surface, "top"); // a cavity surface
  assert_int_equal(outer_walls_create(made.rom, 1, &wall, NULL, AMBIENT, &walls, &err), CAST_ERR_INPUT);
  made.rom->patch[BOTTOM].fixed = true;
  snprintf(wall.surface, sizeof wall.surface, "bottom");
  assert_int_equal(outer_walls_create(made.rom, 1, &wall, NULL, AMBIENT, &walls, &err), CAST_ERR_INPUT);
  assert_non_null(strstr(err.message, "fixed temperature"));
  finish(&made);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(another_coefficient_is_as_if_the_rom_had_been_made_with_it),
      cmocka_unit_test(the_error_is_of_first_order_in_the_time_step),
      cmocka_unit_test(radiation_comes_to_its_exact_steady_state_by_long_steps),
      cmocka_unit_test(every_joule_is_in_the_books),
      cmocka_unit_test(a_restored_state_goes_on_with_the_same_bits),
      cmocka_unit_test(what_the_rom_cannot_have_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
