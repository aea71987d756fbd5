/* What freezing does to the flow: thickening, drag of a mush, locked particles that are walls and may remelt. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "cast/physics/solidification.h"
#include "cast/physics/sph.h"
#include "tests/support/assert_close.h"
#include "tests/support/assert_ok.h"
#include "tests/support/lattice_tank.h"

static const double dx = 1e-3;

/* Freezes from 1100 to 1000 K, conducts next to nothing. `more`: further keys. */
static Material read_melt(const char *more)
{
  char text[1024];
  snprintf(text, sizeof text,
           "melt: { density: 7000 kg/m^3, specific_heat: 500 J/kg/K, latent_heat: 200 kJ/kg, solidus: 1000 K, "
           "liquidus: 1100 K, conductivity: 1e-6 W/m/K, viscosity: 5 mPa.s%s }\n",
           more);
  CastError err;
  YamlInput *input = NULL;
  Material melt;
  ok(yaml_input_parse(text, "melt.yaml", &input, &err), &err);
  ok(material_read(yaml_get(yaml_root(input), "melt"), &melt, &err), &err);
  ok(yaml_input_finish(input, &err), &err);
  yaml_input_destroy(&input);
  return melt;
}

static SphParameters parameters(const Material *melt)
{
  return (SphParameters){.kernel = KERNEL_WENDLAND_C2,
                         .h = 1.5e-3,
                         .spacing = dx,
                         .rho0 = 7000.0,
                         .c0 = 10.0,
                         .gamma = 7.0,
                         .delta = 0.1,
                         .alpha = 0.02,
                         .melt = melt};
}

static double enthalpy_at(const Material *melt, double fraction)
{
  return material_enthalpy(melt, material_temperature_of_fraction(melt, fraction));
}

static void the_temperature_of_a_fraction_is_the_highest_that_has_it(void **unused)
{
  (void)unused;
  double T[4] = {1000.0, 1050.0, 1060.0, 1100.0}, fs[4] = {1.0, 0.4, 0.4, 0.0};
  const Material melt = {.solid_fraction = {4, T, fs}};
  assert_close(material_temperature_of_fraction(&melt, 0.4), 1060.0, 1e-9);
  assert_close(material_temperature_of_fraction(&melt, 0.1), 1090.0, 1e-9);
  assert_close(material_temperature_of_fraction(&melt, 0.7), 1025.0, 1e-9);
  assert_close(material_temperature_of_fraction(&melt, 1.0), 1000.0, 1e-9);
  assert_close(material_temperature_of_fraction(&melt, 0.0), 1100.0, 1e-9);
}

static void melt_thickens_towards_the_coherency_fraction(void **unused)
{
  (void)unused;
  Material melt = read_melt(", coherency_fraction: 0.4");
  SphParameters sph = parameters(&melt);
  double x[3][4] = {{0.0, 1.0, 2.0, 3.0}};
  double *const places[3] = {x[0], x[1], x[2]};
  Particles p;
  CastError err;
  ok(particles_create(4, places, dx, 7000.0, NULL, &p, &err), &err);
  const double fraction[4] = {0.0, 0.05, 0.3, 0.9};
  for (int i = 0; i < 4; i++) p.E[i] = enthalpy_at(&melt, fraction[i]);
  sph_initialise(&sph, &p);
  assert_close(p.mu[0], 5e-3, 1e-12);
  assert_close(p.mu[1] / 5e-3, 1.0 + 2.5 * 0.05, 0.02); // Einstein's law of dilute suspensions; next term 3.5 fs^2/2..
  assert_close(p.mu[2] / 5e-3, pow(0.25, -1.0), 1e-6);  // (1 - 0.3/0.4)^(-2.5 0.4)
  assert_close(p.mu[3] / 5e-3, 1e3, 1e-6);
  assert_int_equal(solidification_count_locked(&melt, 4, p.E), 1);
  particles_destroy(&p);
  material_destroy(&melt);
}

/* One particle alone under gravity, melt of fraction `fraction`; its speed after n steps of dt. */
static double fall(const Material *melt, double fraction, int n, double dt)
{
  SphParameters sph = parameters(melt);
  sph.gravity[2] = -9.81;
  double x[3][1] = {{0.0}, {0.0}, {0.0}};
  double *const places[3] = {x[0], x[1], x[2]};
  Particles p;
  CastError err;
  Neighbours *nb = NULL;
  ok(particles_create(1, places, dx, 7000.0, NULL, &p, &err), &err);
  ok(neighbours_create(3e-3, 0.2e-3, NULL, &nb, &err), &err);
  p.E[0] = enthalpy_at(melt, fraction);
  sph_initialise(&sph, &p);
  ok(neighbours_update(nb, &p, true, NULL, &err), &err);
  sph_rates(&sph, &p, nb);
  for (int k = 0; k < n; k++) {
    ok(sph_drift(&sph, &p, NULL, dt, NULL, &err), &err);
    ok(neighbours_update(nb, &p, false, NULL, &err), &err);
    sph_rates(&sph, &p, nb);
    ok(sph_finish(&sph, &p, dt, &err), &err);
  }
  const double speed = -p.v[2][0];
  neighbours_destroy(&nb);
  particles_destroy(&p);
  return speed;
}

static void a_mush_of_known_arm_spacing_lets_melt_through_as_darcy_says(void **unused)
{
  (void)unused;
  Material plain = read_melt(""), mush = read_melt(", dendrite_arm_spacing: 50 um");
  assert_close(fall(&plain, 0.2, 100, 1e-4), 9.81 * 100e-4, 1e-9); // nothing holds it
  const double K = 2.5e-9 * pow(0.8, 3.0) / (180.0 * 0.04);        // 1.8e-10 m2: rho K/mu = 0.25 ms
  assert_close(fall(&mush, 0.2, 200, 1e-4), 9.81 * 7000.0 * K / 5e-3, 0.01 * 9.81 * 7000.0 * K / 5e-3);
  assert_close(fall(&mush, 0.0, 100, 1e-4), 9.81 * 100e-4, 1e-9);
  material_destroy(&plain);
  material_destroy(&mush);
}

static void without_a_coherency_fraction_nothing_is_ever_locked(void **unused)
{
  (void)unused;
  Material melt = read_melt("");
  assert_close(fall(&melt, 1.0, 100, 1e-4), 9.81 * 100e-4, 1e-9);
  material_destroy(&melt);
}

/* Melt on a floor of frozen melt five layers thick, under gravity. */
static LatticeTank frozen_floor(const Material *melt)
{
  LatticeTank tank = {
      .fluid = {9, 9, 14}, .box = {9, 9, 14}, .low = {false, false, true}, .layers = 3, .sph = parameters(melt)};
  tank.sph.gravity[2] = -9.81;
  lattice_tank_create(&tank);
  Particles *p = &tank.particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) p->E[i] = enthalpy_at(melt, p->x[2][i] < 5.0 * dx ? 1.0 : 0.0);
  return tank;
}

static void melt_stands_on_frozen_melt_as_on_a_wall(void **unused)
{
  (void)unused;
  Material melt = read_melt(", coherency_fraction: 0.3");
  LatticeTank tank = frozen_floor(&melt);
  const Particles *p = &tank.particles;
  const double kick = 0.3; // m/s, downwards: as if it had fallen 4.6 mm
  for (ptrdiff_t i = 0; i < p->n_fluid; i++)
    if (p->x[2][i] > 5.0 * dx) p->v[2][i] = -kick;
  while (tank.time < 0.1) lattice_tank_step(&tank, 0.0);
  double lowest = 1.0, highest = 0.0, pressure = 0.0, n = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    if (p->E[i] < enthalpy_at(&melt, 0.3)) { // id counts places from below
      assert_close(p->x[2][i], ((double)(p->id[i] / 81) + 0.5) * dx, 1e-15);
      assert_true(p->v[0][i] == 0.0 && p->v[1][i] == 0.0 && p->v[2][i] == 0.0);
      assert_true(p->id[i] < 5 * 81);
      continue;
    }
    lowest = fmin(lowest, p->x[2][i]);
    highest = fmax(highest, p->x[2][i]);
    if (p->x[2][i] > 7.0 * dx && p->x[2][i] < 9.0 * dx) {
      pressure += p->p[i] / (7000.0 * 9.81 * (14.0 * dx - p->x[2][i]));
      n += 1.0;
    }
  }
  assert_true(lowest > 5.2 * dx); // nothing sank in
  assert_close(highest, 13.5 * dx, 0.5 * dx);
  assert_close(pressure / n, 1.0, 0.1); // a free surface and one free period of sloshing
  lattice_tank_destroy(&tank);
  material_destroy(&melt);
}

static void remelted_melt_flows_again(void **unused)
{
  (void)unused;
  Material melt = read_melt(", coherency_fraction: 0.3");
  SphParameters sph = parameters(&melt);
  sph.gravity[2] = -9.81;
  double x[3][1] = {{0.0}, {0.0}, {0.0}};
  double *const places[3] = {x[0], x[1], x[2]};
  Particles p;
  CastError err;
  ok(particles_create(1, places, dx, 7000.0, NULL, &p, &err), &err);
  p.E[0] = enthalpy_at(&melt, 0.5);
  p.a[2][0] = -9.81;
  sph_initialise(&sph, &p);
  for (int k = 0; k < 10; k++) {
    ok(sph_drift(&sph, &p, NULL, 1e-3, NULL, &err), &err);
    ok(sph_finish(&sph, &p, 1e-3, &err), &err);
  }
  assert_true(p.x[2][0] == 0.0 && p.v[2][0] == 0.0);
  p.E[0] = enthalpy_at(&melt, 0.1);
  for (int k = 0; k < 10; k++) {
    ok(sph_drift(&sph, &p, NULL, 1e-3, NULL, &err), &err);
    ok(sph_finish(&sph, &p, 1e-3, &err), &err);
  }
  assert_close(p.v[2][0], -9.81 * 1e-2, 1e-12);
  particles_destroy(&p);
  material_destroy(&melt);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_temperature_of_a_fraction_is_the_highest_that_has_it),
      cmocka_unit_test(melt_thickens_towards_the_coherency_fraction),
      cmocka_unit_test(a_mush_of_known_arm_spacing_lets_melt_through_as_darcy_says),
      cmocka_unit_test(without_a_coherency_fraction_nothing_is_ever_locked),
      cmocka_unit_test(melt_stands_on_frozen_melt_as_on_a_wall),
      cmocka_unit_test(remelted_melt_flows_again),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
