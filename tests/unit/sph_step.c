/* The step: what limits it, what it does to one particle, the guard at the wall, and what stops a run. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "cast/kernel/pair.h"
#include "cast/physics/sph.h"
#include "tests/support/assert_close.h"
#include "tests/support/assert_ok.h"
#include "tests/support/lattice_tank.h"
#include "tests/support/shaped_mould.h"

static const double dx = 1e-3, capacity = 500.0;

/* A melt with constant properties and E = 500 T. */
static Material make_melt(double kappa, double mu)
{
  const double T[2] = {0.0, 3000.0}, E[2] = {0.0, 3000.0 * capacity}, at = 0.0;
  CastError err;
  Material melt = {.density = 7000.0};
  ok(table_create(2, T, E, &melt.enthalpy, &err), &err);
  ok(table_create(1, &at, &kappa, &melt.conductivity_of_t, &err), &err);
  ok(table_create(1, &at, &mu, &melt.viscosity_of_t, &err), &err);
  return melt;
}

static SphParameters parameters(const Material *melt)
{
  return (SphParameters){.kernel = KERNEL_WENDLAND_C2,
                         .h = 1.3e-3,
                         .spacing = dx,
                         .rho0 = 7000.0,
                         .c0 = 20.0,
                         .gamma = 7.0,
                         .delta = 0.1,
                         .melt = melt};
}

/* A few particles far apart: each is alone. */
static Particles lone_particles(ptrdiff_t n)
{
  static double x[3][8];
  for (ptrdiff_t i = 0; i < n; i++) x[0][i] = 1.0 + (double)i;
  double *const places[3] = {x[0], x[1], x[2]};
  Particles p;
  CastError err;
  ok(particles_create(n, places, dx, 7000.0, NULL, &p, &err), &err);
  return p;
}

static void the_tightest_limit_is_named(void **unused)
{
  (void)unused;
  const struct {
    double speed, acceleration, mu, kappa;
    const char *which;
  } cases[] = {{1.0, 9.81, 5e-3, 30.0, "sound"},
               {1.0, 1e6, 5e-3, 30.0, "force"},
               {1.0, 9.81, 500.0, 30.0, "viscosity"},
               {1.0, 9.81, 5e-3, 5e5, "conduction"}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    Material melt = make_melt(cases[k].kappa, cases[k].mu);
    SphParameters sph = parameters(&melt);
    Particles p = lone_particles(3);
    p.E[0] = p.E[1] = p.E[2] = 1000.0 * capacity;
    p.v[1][2] = cases[k].speed;
    p.a[2][1] = cases[k].acceleration;
    sph_initialise(&sph, &p);
    const SphLimits limits = sph_time_step(&sph, &p);
    assert_string_equal(limits.which, cases[k].which);
    assert_close(limits.sound, 0.3 * sph.h / (sph.c0 + cases[k].speed), 1e-12 * limits.sound);
    assert_close(limits.force, 0.25 * sqrt(sph.h / cases[k].acceleration), 1e-12 * limits.force);
    assert_close(limits.viscosity, 0.1 * sph.h * sph.h * 7000.0 / cases[k].mu, 1e-12 * limits.viscosity);
    assert_close(limits.conduction, 0.1 * sph.h * sph.h * 7000.0 * capacity / cases[k].kappa,
                 1e-12 * limits.conduction);
    assert_true(limits.step == fmin(fmin(limits.sound, limits.force), fmin(limits.viscosity, limits.conduction)));
    sph.frozen_flow = true;
    assert_string_equal(sph_time_step(&sph, &p).which, "conduction");
    particles_destroy(&p);
    material_destroy(&melt);
  }
}

/* Without neighbours a particle flies a parabola; velocity Verlet follows it exactly. */
static void a_lone_particle_falls_on_a_parabola(void **unused)
{
  (void)unused;
  SphParameters sph = parameters(NULL);
  sph.gravity[2] = -9.81;
  sph.extra[0] = 2.0;
  Particles p = lone_particles(1);
  Neighbours *nb = NULL;
  CastError err;
  ok(neighbours_create(2.6e-3, 0.2e-3, NULL, &nb, &err), &err);
  p.v[1][0] = 0.5;
  ok(neighbours_update(nb, &p, true, NULL, &err), &err);
  sph_rates(&sph, &p, nb); // forces at the start
  const double dt = 1e-3;
  for (int step = 0; step < 100; step++) {
    ok(sph_drift(&sph, &p, NULL, dt, NULL, &err), &err);
    ok(neighbours_update(nb, &p, false, NULL, &err), &err);
    sph_rates(&sph, &p, nb);
    ok(sph_finish(&sph, &p, dt, &err), &err);
  }
  assert_close(p.x[0][0], 1.0 + 0.5 * 2.0 * 0.01, 1e-14);
  assert_close(p.x[1][0], 0.5 * 0.1, 1e-14);
  assert_close(p.x[2][0], -0.5 * 9.81 * 0.01, 1e-14);
  assert_close(p.v[2][0], -0.981, 1e-14);
  assert_true(p.rho[0] == sph.rho0);
  neighbours_destroy(&nb);
  particles_destroy(&p);
}

static void heat_raises_enthalpy_and_temperature_follows(void **unused)
{
  (void)unused;
  Material melt = make_melt(30.0, 5e-3);
  const SphParameters sph = parameters(&melt);
  Particles p = lone_particles(2);
  CastError err;
  p.E[0] = p.E[1] = 1000.0 * capacity;
  sph_initialise(&sph, &p);
  assert_close(p.T[0], 1000.0, 1e-9);
  assert_true(p.kappa[0] == 30.0 && p.mu[0] == 5e-3);
  p.heat[1] = 0.7; // W
  ok(sph_finish(&sph, &p, 1e-3, &err), &err);
  assert_close(p.T[1], 1000.0 + 0.7e-3 / (7000.0 * 1e-9 * capacity), 1e-9);
  assert_close(p.T[0], 1000.0, 1e-9);
  assert_close(sph_enthalpy(&p), 7e-6 * 2e3 * capacity + 0.7e-3, 1e-12);
  particles_destroy(&p);
  material_destroy(&melt);
}

static void frozen_flow_moves_nothing(void **unused)
{
  (void)unused;
  SphParameters sph = parameters(NULL);
  sph.frozen_flow = true;
  Particles p = lone_particles(1);
  CastError err;
  p.v[0][0] = p.a[0][0] = p.drho[0] = 5.0;
  p.heat[0] = 1.0;
  ok(sph_drift(&sph, &p, NULL, 1e-3, NULL, &err), &err);
  ok(sph_finish(&sph, &p, 1e-3, &err), &err);
  assert_true(p.x[0][0] == 1.0 && p.v[0][0] == 5.0 && p.rho[0] == sph.rho0);
  assert_close(p.E[0], 1e-3 / 7e-6, 1e-9);
  particles_destroy(&p);
}

static void what_is_wrong_with_a_particle_is_told(void **unused)
{
  (void)unused;
  Material melt = make_melt(30.0, 5e-3);
  const SphParameters sph = parameters(&melt);
  const char *const told[] = {"speed", "density of -1 kg/m3", "enthalpy", "temperature of -",
                              "beyond the numerical sound"};
  for (int k = 0; k < 5; k++) {
    Particles p = lone_particles(4);
    CastError err = {0};
    for (int i = 0; i < 4; i++) p.E[i] = 1000.0 * capacity, p.id[i] = 100 + i;
    sph_initialise(&sph, &p);
    if (k == 0) p.v[1][2] = (double)NAN;
    if (k == 1) p.rho_start[2] = -1.0;
    if (k == 2) p.heat[2] = (double)INFINITY;
    if (k == 3) p.E[2] = -1e4;
    if (k == 4) p.v[0][2] = 1.01 * sph.c0;
    assert_int_equal(sph_finish(&sph, &p, 1e-6, &err), CAST_ERR_NUMERIC);
    assert_non_null(strstr(err.message, "particle 102 at (3, 0, 0) m"));
    assert_non_null(strstr(err.message, told[k]));
    particles_destroy(&p);
  }
  material_destroy(&melt);
}

static void a_place_that_is_not_finite_is_told(void **unused)
{
  (void)unused;
  const SphParameters sph = parameters(NULL);
  Particles p = lone_particles(4);
  CastError err = {0};
  p.a[1][3] = (double)INFINITY;
  assert_int_equal(sph_drift(&sph, &p, NULL, 1e-6, NULL, &err), CAST_ERR_NUMERIC);
  assert_non_null(strstr(err.message, "particle 3"));
  particles_destroy(&p);
}

typedef struct Basin {
  RomData *rom;
  Surface *surface;
} Basin;

/* Its floor lies at z = -10 mm. */
static Basin make_basin(void)
{
  const ShapedBox hollow = {{-0.01, -0.01, -0.01}, {0.01, 0.01, 0.001}, false};
  const ShapedMould shape = {
      .low = {-0.02, -0.02, -0.02}, .high = {0.02, 0.02, 0.0}, .n_boxes = 1, .box = &hollow, .cell = 5e-3};
  CastError err;
  Basin basin = {.rom = shaped_mould_create(&shape)};
  ok(surface_create(basin.rom, 3e-3, &basin.surface, &err), &err);
  return basin;
}

static void destroy_basin(Basin *basin)
{
  surface_destroy(&basin->surface);
  rom_destroy(&basin->rom);
}

/* Deeper than a tenth of a spacing: set back; less deep: left, without its velocity into the mould but for what the
 * film's implicit damping leaves, 1/(1 + 5 c0 dt/dx). */
static void the_guard_sets_back_what_is_in_the_mould(void **unused)
{
  (void)unused;
  Basin basin = make_basin();
  const SphParameters sph = parameters(NULL);
  double x[] = {0.0, 2e-3}, y[] = {0.0, 1e-3}, z[] = {-0.01 - 0.3 * dx, -0.01 - 0.05 * dx};
  double *const places[3] = {x, y, z};
  Particles p;
  CastError err;
  ok(particles_create(2, places, dx, 7000.0, NULL, &p, &err), &err);
  for (int i = 0; i < 2; i++) {
    p.v[0][i] = 0.3;
    p.v[2][i] = -0.1;
  }
  long guarded = -1;
  const double dt = 1e-9;
  ok(sph_drift(&sph, &p, basin.surface, dt, &guarded, &err), &err);
  assert_int_equal(guarded, 1);
  assert_close(p.x[2][0], -0.01, 1e-12);
  assert_close(p.v[2][0], 0.0, 1e-12);
  assert_close(p.x[2][1], z[1] - 0.1 * dt, 1e-12);
  assert_close(p.v[2][1], -0.1 / (1.0 + 5.0 * sph.c0 * dt / dx), 1e-12);
  for (int i = 0; i < 2; i++) assert_true(p.v[0][i] == 0.3);
  particles_destroy(&p);
  destroy_basin(&basin);
}

/* Melt flies at the floor: the film stops it within its fifth of a spacing, so that the guard has nothing to do. */
static void the_film_stops_melt_before_the_wall(void **unused)
{
  (void)unused;
  Basin basin = make_basin();
  const SphParameters sph = parameters(NULL);
  double x[] = {0.0, 2e-3, -3e-3}, y[] = {0.0, 1e-3, 2e-3}, z[] = {-0.0095, -0.005, -0.002};
  double *const places[3] = {x, y, z};
  Particles p;
  CastError err;
  ok(particles_create(3, places, dx, 7000.0, NULL, &p, &err), &err);
  for (int i = 0; i < 3; i++) {
    p.v[0][i] = 0.3;
    p.v[2][i] = -4.0;
  }
  for (int step = 0; step < 200; step++) { // 0.05 spacings a step, 1 ms in all: no other force acts
    long guarded = -1;
    ok(sph_drift(&sph, &p, basin.surface, 1.25e-5, &guarded, &err), &err);
    assert_int_equal(guarded, 0);
    for (int i = 0; i < 3; i++) assert_true(p.x[2][i] > -0.01);
  }
  for (int i = 0; i < 3; i++) {
    assert_true(p.x[2][i] < -0.01 + 0.2 * dx);
    assert_close(p.v[2][i], 0.0, 1e-3); // it decays as long as it approaches
    assert_close(p.v[0][i], 0.3, 1e-12);
  }
  particles_destroy(&p);
  destroy_basin(&basin);
}

/* At half a spacing from the wall, where melt settles, the film is not felt. */
static void the_film_leaves_settled_melt_alone(void **unused)
{
  (void)unused;
  Basin basin = make_basin();
  const SphParameters sph = parameters(NULL);
  double x[] = {0.0}, y[] = {0.0}, z[] = {-0.01 + 0.5 * dx};
  double *const places[3] = {x, y, z};
  Particles p;
  CastError err;
  ok(particles_create(1, places, dx, 7000.0, NULL, &p, &err), &err);
  p.v[2][0] = -0.1;
  for (int step = 0; step < 4; step++) ok(sph_drift(&sph, &p, basin.surface, 0.5 * dx, NULL, &err), &err);
  assert_true(p.v[2][0] == -0.1); // 0.3 spacings above the wall now
  particles_destroy(&p);
  destroy_basin(&basin);
}

/* ---- walls ---- */

static LatticeTank make_tank(void)
{
  LatticeTank tank = {.fluid = {8, 8, 10},
                      .box = {8, 8, 10},
                      .layers = 3,
                      .low = {false, false, true},
                      .high = {false, false, true},
                      .sph = parameters(NULL)};
  lattice_tank_create(&tank);
  CastError err;
  ok(neighbours_update(tank.neighbours, &tank.particles, true, NULL, &err), &err);
  return tank;
}

static bool wet(const LatticeTank *tank, ptrdiff_t k) // is melt within the kernel's reach of wall particle k?
{
  const double z = tank->particles.x[2][tank->particles.n_fluid + k];
  return z > -2.0 * dx && z < 12.0 * dx;
}

/* Hydrostatic pressure p = rho0 g (H - z) in melt of nearly rho0: the wall continues it. */
static void walls_continue_hydrostatic_pressure(void **unused)
{
  (void)unused;
  LatticeTank tank = make_tank();
  Particles *p = &tank.particles;
  tank.sph.c0 = 200.0; // density within 1e-5 of rho0
  tank.sph.gravity[2] = -9.81;
  const double top = 10.0 * dx, most = 7000.0 * 9.81 * top;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++)
    p->rho[i] = tait_density(7000.0 * 9.81 * (top - p->x[2][i]), 7000.0, tank.sph.c0, 7.0);
  sph_rates(&tank.sph, p, tank.neighbours);
  for (ptrdiff_t k = 0; k < p->n - p->n_fluid; k++)
    if (wet(&tank, k)) {
      const ptrdiff_t i = p->n_fluid + k;
      assert_close(p->p[i] / most, (top - p->x[2][i]) / top, 1e-4); // the density of the column varies by 1e-5
      assert_close(tait_pressure(p->rho[i], 7000.0, tank.sph.c0, 7.0) / most, p->p[i] / most, 1e-9);
    }
  lattice_tank_destroy(&tank);
}

static void a_wall_takes_the_mirrored_velocity(void **unused)
{
  (void)unused;
  LatticeTank tank = make_tank();
  Particles *p = &tank.particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) p->v[0][i] = 0.25;
  for (ptrdiff_t k = 0; k < p->n - p->n_fluid; k++) p->wall_v[1][k] = 0.5;
  sph_rates(&tank.sph, p, tank.neighbours);
  for (ptrdiff_t k = 0; k < p->n - p->n_fluid; k++)
    if (wet(&tank, k)) {
      assert_close(p->v[0][p->n_fluid + k], -0.25, 1e-14);
      assert_close(p->v[1][p->n_fluid + k], 1.0, 1e-14);
    }
  lattice_tank_destroy(&tank);
}

/* Between the walls the lattice fills all space; the sum misses its density by the kernel's lattice error alone. */
static void summation_density_is_that_of_the_lattice(void **unused)
{
  (void)unused;
  for (int kind = 0; kind < 4; kind++) {
    LatticeTank tank = {.fluid = {9, 9, 10},
                        .box = {9, 9, 10},
                        .layers = 4,
                        .low = {false, false, true},
                        .high = {false, false, true},
                        .sph = parameters(NULL)};
    tank.sph.kernel = (KernelKind)kind;
    tank.sph.h = 3.0 * dx / kernel_support(tank.sph.kernel);
    tank.sph.density = SPH_SUMMATION;
    lattice_tank_create(&tank);
    lattice_tank_step(&tank, 1e-7);
    const Particles *p = &tank.particles;
    for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
      assert_close(p->rho[i] / 7000.0, 1.0, 0.01);
      assert_close(p->rho[i], p->rho[0], 1e-4); // every place of the lattice is like the other
    }
    lattice_tank_destroy(&tank);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_tightest_limit_is_named),
      cmocka_unit_test(a_lone_particle_falls_on_a_parabola),
      cmocka_unit_test(heat_raises_enthalpy_and_temperature_follows),
      cmocka_unit_test(frozen_flow_moves_nothing),
      cmocka_unit_test(what_is_wrong_with_a_particle_is_told),
      cmocka_unit_test(a_place_that_is_not_finite_is_told),
      cmocka_unit_test(the_guard_sets_back_what_is_in_the_mould),
      cmocka_unit_test(the_film_stops_melt_before_the_wall),
      cmocka_unit_test(the_film_leaves_settled_melt_alone),
      cmocka_unit_test(walls_continue_hydrostatic_pressure),
      cmocka_unit_test(a_wall_takes_the_mirrored_velocity),
      cmocka_unit_test(summation_density_is_that_of_the_lattice),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
