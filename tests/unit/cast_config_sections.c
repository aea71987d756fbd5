/* Sections of cast.yaml with lists and tables - contact, walls, forces, inlets and outlets - arrive, and are the same
 * when they are written resolved and read again. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>

#include "tests/support/assert_close.h"
#include "tests/support/config_case.h"

static const char LEAST_CONTACT[] = "{ h: 2000 W/m^2/K }";

static void contact_tables_and_surfaces_arrive_and_are_written_again(void **state)
{
  (void)state;
  CastConfig *config =
      config_case_with(LEAST_CONTACT, "{ h: { solid_fraction: [[0.3, 2000 W/m^2/K], [0.9, 200 W/m^2/K]] }, surfaces: "
                                      "{ pins: { h: { temperature: [[700 degC, 0.5 kW/m^2/K]] } }, cup: { perfect: "
                                      "true } } }");
  for (int turn = 0; turn < 2; turn++) {
    const ContactLaws *c = config->coupling.contact;
    assert_int_equal(c->elsewhere.basis, CONTACT_OF_SOLID_FRACTION);
    assert_close(contact_law_at(&c->elsewhere, &config->melt, config->melt.solidus), 200.0, 1e-9);
    assert_close(contact_law_at(&c->elsewhere, &config->melt, config->melt.liquidus), 2000.0, 1e-9);
    assert_int_equal(c->n, 2);
    assert_string_equal(c->surface[0].surface, "pins");
    assert_close(c->surface[0].law.table.x[0], 973.15, 1e-9);
    assert_close(contact_law_most(&c->surface[0].law), 500.0, 1e-9);
    assert_true(isinf(c->surface[1].law.h) && isinf(contact_laws_most(c)));
    CastConfig *again = config_case_again(config);
    cast_config_destroy(&config);
    config = again;
  }
  cast_config_destroy(&config);
}

static void outer_walls_arrive_and_are_written_again(void **state)
{
  (void)state;
  CastConfig *config =
      config_case_with(LEAST_CONTACT, "{ perfect: true }\nwalls: { side: { h: 20 W/m^2/K, ambient: 25 degC, "
                                      "emissivity: 0.85 }, rim: { emissivity: 0.3 } }");
  for (int turn = 0; turn < 2; turn++) {
    assert_int_equal(config->n_walls, 2);
    assert_string_equal(config->wall[0].surface, "side");
    assert_close(config->wall[0].h, 20.0, 0.0);
    assert_close(config->wall[0].ambient, 298.15, 1e-9);
    assert_close(config->wall[0].emissivity, 0.85, 0.0);
    assert_true(isnan(config->wall[1].h) && isnan(config->wall[1].ambient)); // the ROM's, the run's
    CastConfig *again = config_case_again(config);
    cast_config_destroy(&config);
    config = again;
  }
  cast_config_destroy(&config);
}

static void forces_that_change_with_time_arrive_and_are_written_again(void **state)
{
  (void)state;
  static const char *const forces[] = {
      "{ gravity: [[0 s, [0 m/s^2, 0 m/s^2, -9.81 m/s^2]], [1.7 s, 9.81 0 0.1 m/s^2]] }",
      "{ gravity: 0 0 -9.81 m/s^2, tilt: { axis: [0, 3, 1], angle: [[0.1 s, 0 deg], [2 s, 77 deg]] } }",
      "{ gravity: 0 0 -9.81 m/s^2, spin: { point: [-150 mm, 0 mm, 1 mm], axis: [0, 1, 2], "
      "speed: [[0 s, 0 rpm], [0.3 s, 600 rpm]] } }",
      "{ gravity: 0 0 -9.81 m/s^2, spin: { point: 0 0 0 m, axis: [0, 0, 1], speed: 300 rpm } }",
      "{ gravity: 0 0 -9.81 m/s^2, gas: { pressure: [[0 s, 0 kPa], [50 ms, 33 kPa]], "
      "from: { corner: -1 -2 3 mm, size: 2 4 1 mm } } }"};
  for (int k = 0; k < 5; k++) {
    CastConfig *first = config_case_with("{ gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2] }", forces[k]);
    CastConfig *second = config_case_again(first);
    config_case_same_drive(&first->drive, &second->drive);
    config_case_same_table(&first->gas.pressure, &second->gas.pressure);
    assert_memory_equal(first->gas.corner, second->gas.corner, sizeof first->gas.corner);
    assert_memory_equal(first->gas.size, second->gas.size, sizeof first->gas.size);
    if (k == 4) assert_close(first->gas.pressure.y[1], 33e3, 1e-9);
    if (k == 0) assert_close(first->drive.gravity[1][0], 9.81, 1e-15);
    if (k == 1) assert_close(first->drive.tilt.y[1], 77.0 * M_PI / 180.0, 1e-15);
    if (k == 1) assert_close(first->drive.tilt_axis[1], 3.0 / sqrt(10.0), 1e-15);
    if (k == 2) assert_close(first->drive.speed.y[1], 20.0 * M_PI, 1e-13);
    if (k == 3) assert_close(table_evaluate(&first->drive.speed, 5.0), 10.0 * M_PI, 1e-13);
    cast_config_destroy(&first);
    cast_config_destroy(&second);
  }
}

static void inlets_and_outlets_arrive_and_are_written_again(void **state)
{
  (void)state;
  CastConfig *config =
      config_case_with("  blocks: [{ corner: [0 mm, 0 mm, 0 mm], size: [1 mm, 2 mm, 3 mm] }]\n",
                       "  inlets:\n"
                       "    - { disc: { centre: 1 2 3 mm, radius: 4 mm }, direction: [0, 0, -2], velocity: 0.3 m/s }\n"
                       "    - rectangle: { centre: 0 0 9 mm, along: [1, 1, 0], width: 5 mm, height: 6 mm }\n"
                       "      direction: [0, 0, 1]\n"
                       "      mass_flow: [[0 s, 3.3 g/s], [1.1 s, 0 g/s]]\n"
                       "      temperature: [[0 s, 1150 degC], [1 s, 1160 degC]]\n"
                       "      at_end: plug\n"
                       "  outlets: [{ surface: a vent }, { box: { corner: 1 2 3 mm, size: 4 5 6 mm } }, "
                       "{ plane: { point: 1 2 3 m, normal: [0, 3, 4] } }]\n");
  for (int turn = 0; turn < 2; turn++) {
    assert_int_equal(config->n_inlets, 2);
    const InletConfig *disc = &config->inlet[0], *rectangle = &config->inlet[1];
    assert_true(disc->disc && !disc->stays && disc->kind == INLET_VELOCITY);
    assert_close(disc->radius, 4e-3, 1e-17);
    assert_close(disc->direction[2], -1.0, 0.0);
    assert_close(table_evaluate(&disc->temperature, 9.0), 1423.15, 1e-9); // the melt's
    assert_true(!rectangle->disc && rectangle->stays && rectangle->kind == INLET_MASS_FLOW);
    assert_close(rectangle->along[1], sqrt(0.5), 1e-15);
    assert_close(rectangle->rate.y[0], 3.3e-3, 1e-17);
    assert_close(rectangle->rate.x[1], 1.1, 0.0);
    assert_close(rectangle->temperature.y[1], 1433.15, 1e-9);
    assert_close(rectangle->height, 6e-3, 1e-17);
    assert_int_equal(config->n_outlets, 3);
    assert_string_equal(config->outlet[0].surface, "a vent");
    assert_int_equal(config->outlet[1].kind, OUTLET_BOX);
    assert_close(config->outlet[1].size[2], 6e-3, 1e-17);
    assert_int_equal(config->outlet[2].kind, OUTLET_PLANE);
    assert_close(config->outlet[2].normal[1], 0.6, 1e-15);
    CastConfig *again = config_case_again(config);
    cast_config_destroy(&config);
    config = again;
  }
  cast_config_destroy(&config);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(contact_tables_and_surfaces_arrive_and_are_written_again),
      cmocka_unit_test(outer_walls_arrive_and_are_written_again),
      cmocka_unit_test(forces_that_change_with_time_arrive_and_are_written_again),
      cmocka_unit_test(inlets_and_outlets_arrive_and_are_written_again),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
