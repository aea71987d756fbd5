/* F7: melt at rest in a cup that spins about its axis.
 * Closed and square, full, without gravity: p = rho/2 w^2 r^2 + const, from melt of even pressure at the start.
 * Round and open under gravity: the free surface is a paraboloid, p = rho/2 w^2 r^2 - rho g z + const. That cup is a
 * mould's surface as castrun has it, its walls those of a run. Pressures are those of every single particle, at 50
 * instants. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#include "cast/geometry/walls.h"
#include "cast/kernel/pair.h"
#include "cast/physics/sph.h"
#include "tests/support/assert_ok.h"
#include "tests/support/lattice_tank.h"
#include "tests/support/shaped_mould.h"
#include "tests/support/validation.h"

static const double gravity = 9.81, rho0 = 1000.0;
static const double radius = 0.05, rise = 0.05, lowest = 0.015; // m: cup, surface from axis to rim, depth at the axis
static const double viscosity = 0.2; // Pa s: melt that settles onto the wall starts to turn, and comes to rest in 1 s
enum { CLOSED_FINE = 24, CLOSED_COARSE = 12 }; // particles across the closed cup
enum { FINE = 12, COARSE = 6 };                // particles along the radius

typedef struct Cup {
  RomData *rom;
  Surface *surface;
  SphParameters sph;
  Particles particles;
  Neighbours *neighbours;
} Cup;

typedef struct Rest {
  double worst, rms, constant; // of p - rho/2 w^2 r^2 + rho g z, over rho/2 w^2 R^2
  double speed;                // root mean square at the end, over w R
  ptrdiff_t n;
  long steps;
} Rest;

static double spin_rate(void)
{
  return sqrt(2.0 * gravity * rise) / radius;
}

/* rho/2 w^2 r^2 - rho g (z - lowest), z from the cup's floor. */
static double exact_pressure(const Particles *p, ptrdiff_t i)
{
  const double w = spin_rate(), r2 = p->x[0][i] * p->x[0][i] + p->x[1][i] * p->x[1][i];
  return rho0 * (0.5 * w * w * r2 - gravity * (p->x[2][i] - lowest));
}

/* Lattice points in the cup and below the paraboloid. */
static ptrdiff_t fill(double dx, double *x[3])
{
  const int across = (int)ceil(radius / dx), high = (int)ceil((lowest + rise) / dx);
  ptrdiff_t n = 0;
  for (int d = 0; d < 3; d++) x[d] = malloc((size_t)(4 * across * across * high) * sizeof *x[d]);
  for (int k = 0; k < high; k++)
    for (int j = -across; j < across; j++)
      for (int i = -across; i < across; i++) {
        const double at[3] = {(i + 0.5) * dx, (j + 0.5) * dx, (k + 0.5) * dx}, r = hypot(at[0], at[1]);
        if (r > radius - 0.4 * dx || at[2] > lowest + rise * r * r / (radius * radius)) continue;
        for (int d = 0; d < 3; d++) x[d][n] = at[d];
        n++;
      }
  return n;
}

static Cup make_cup(int across)
{
  CastError err;
  const double dx = radius / across, ab[2] = {radius, 1.3 * radius}, origin[3] = {0.0, 0.0, 0.0};
  const ShapedBox hollow = {{-radius, -radius, 0.0}, {radius, radius, 1.0}, false};
  const ShapedMould shape = {{-2.0 * radius, -2.0 * radius, -radius},
                             {2.0 * radius, 2.0 * radius, 2.0 * radius},
                             1,
                             &hollow,
                             0.25 * radius,
                             bend_cylinder,
                             ab};
  Cup cup = {.rom = shaped_mould_create(&shape),
             .sph = {.kernel = KERNEL_WENDLAND_C2,
                     .h = 1.5 * dx,
                     .spacing = dx,
                     .rho0 = rho0,
                     .c0 = 10.0 * sqrt(2.0 * gravity * (rise + lowest)),
                     .gamma = 7.0,
                     .delta = 0.1,
                     .alpha = 0.05,
                     .gravity = {0.0, 0.0, -gravity},
                     .spin = {.rate = {0.0, 0.0, spin_rate()}}}};
  double *x[3];
  WallSet walls;
  const ptrdiff_t n = fill(dx, x);
  ok(surface_create(cup.rom, neighbours_range(3.0 * dx, neighbours_skin(dx)), &cup.surface, &err), &err);
  ok(walls_generate(cup.surface, dx, 3.0 * dx, origin, &walls, &err), &err);
  ok(particles_create(n, x, dx, rho0, &walls, &cup.particles, &err), &err);
  walls_destroy(&walls);
  for (int d = 0; d < 3; d++) free(x[d]);
  Particles *p = &cup.particles;
  for (ptrdiff_t i = 0; i < n; i++) {
    p->rho[i] = tait_density(fmax(exact_pressure(p, i), 0.0), rho0, cup.sph.c0, 7.0);
    p->mu[i] = viscosity;
  }
  ok(neighbours_create(3.0 * dx, neighbours_skin(dx), cup.surface, &cup.neighbours, &err), &err);
  neighbours_suit_skin(cup.neighbours, dx, sph_sound_step(&cup.sph, 0.0));
  ok(neighbours_update(cup.neighbours, p, true, NULL, &err), &err);
  sph_initialise(&cup.sph, p);
  sph_rates(&cup.sph, p, cup.neighbours);
  return cup;
}

static double step(Cup *cup)
{
  CastError err;
  const double dt = sph_time_step(&cup->sph, &cup->particles).step;
  ok(sph_drift(&cup->sph, &cup->particles, cup->surface, dt, NULL, &err), &err);
  ok(neighbours_update(cup->neighbours, &cup->particles, false, NULL, &err), &err);
  sph_rates(&cup->sph, &cup->particles, cup->neighbours);
  ok(sph_finish(&cup->sph, &cup->particles, dt, &err), &err);
  return dt;
}

static void compare(const Particles *p, Rest *rest, int *instants)
{
  const double scale = rho0 * gravity * rise; // rho/2 w^2 R^2
  double mean = 0.0, sum2 = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) mean += (p->p[i] - exact_pressure(p, i)) / (double)p->n_fluid;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const double off = (p->p[i] - exact_pressure(p, i) - mean) / scale;
    rest->worst = fmax(rest->worst, fabs(off));
    sum2 += off * off / (double)p->n_fluid;
  }
  rest->constant += mean / scale;
  rest->rms += sum2;
  ++*instants;
}

static Rest spin_for_two_seconds(int across)
{
  Cup cup = make_cup(across);
  Rest rest = {.n = cup.particles.n_fluid};
  int instants = 0;
  for (double time = 0.0, next = 1.5; time < 2.0; rest.steps++) {
    time += step(&cup);
    if (time < next) continue;
    compare(&cup.particles, &rest, &instants);
    next += 0.01;
  }
  rest.constant /= instants;
  rest.rms = sqrt(rest.rms / instants);
  const Particles *p = &cup.particles;
  rest.speed = sqrt(2.0 * sph_kinetic_energy(p) / ((double)p->n_fluid * p->mass[0])) / (spin_rate() * radius);
  neighbours_destroy(&cup.neighbours);
  particles_destroy(&cup.particles);
  surface_destroy(&cup.surface);
  rom_destroy(&cup.rom);
  return rest;
}

/* ---- the closed cup: square, as long as one likes (it repeats along the axis) ---- */

typedef struct Closed {
  double worst, constant; // of p - rho/2 w^2 r^2, over rho/2 w^2 times the square of half its width
  ptrdiff_t n;
  long steps;
} Closed;

static Closed spin_closed_cup(int across)
{
  enum { LONG = 10, STEPS_ACROSS = 100 }; // a wave of sound crosses in two steps a particle: it has died away
  const double dx = 2.0 * radius / across, w = spin_rate(), scale = 0.5 * rho0 * w * w * radius * radius;
  const double c0 = 10.0 * w * radius * sqrt(2.0);
  LatticeTank tank = {.fluid = {across, across, LONG},
                      .box = {across, across, LONG},
                      .layers = 3,
                      .low = {true, true, false},
                      .high = {true, true, false},
                      .sph = {.kernel = KERNEL_WENDLAND_C2,
                              .h = 1.5 * dx,
                              .spacing = dx,
                              .rho0 = rho0,
                              .c0 = c0,
                              .gamma = 7.0,
                              .delta = 0.1,
                              .spin = {.point = {radius, radius, 0.0}, .rate = {0.0, 0.0, w}}}};
  lattice_tank_create(&tank);
  Particles *p = &tank.particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) { // the mean of rho/2 w^2 r^2 over the square
    p->rho[i] = tait_density(scale * 2.0 / 3.0, rho0, c0, 7.0);
    p->mu[i] = 0.2 * rho0 * c0 * dx;
  }
  Closed closed = {.n = p->n_fluid};
  for (; closed.steps < STEPS_ACROSS * across; closed.steps++) {
    lattice_tank_step(&tank, 0.0);
    if (closed.steps < STEPS_ACROSS * across - 50) continue;
    double mean = 0.0;
    for (int pass = 0; pass < 2; pass++)
      for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
        const double x = p->x[0][i] - radius, y = p->x[1][i] - radius;
        const double off = (p->p[i] - 0.5 * rho0 * w * w * (x * x + y * y)) / scale;
        if (pass == 0)
          mean += off / (double)p->n_fluid;
        else
          closed.worst = fmax(closed.worst, fabs(off - mean));
      }
    closed.constant = mean;
  }
  lattice_tank_destroy(&tank);
  return closed;
}

static void melt_in_a_closed_spinning_cup_is_pressed_outwards(void **unused)
{
  (void)unused;
  omp_set_num_threads(1);
  const Closed coarse = spin_closed_cup(CLOSED_COARSE);
  const double start = validation_cpu_time();
  const Closed fine = spin_closed_cup(CLOSED_FINE);
  const double cpu = validation_cpu_time() - start;
  validation_begin("F7");
  validation_write(
      &(ValidationRow){"F7", "closed square cup, any particle, over rho/2 w^2 (half width)^2", "rho/2 w^2 r^2 + const",
                       "", validation_text("%.2f %%", 100.0 * fine.worst), "2 %",
                       validation_text("%d particles across, %td in all, %ld steps; %d across: %.2f %%", CLOSED_FINE,
                                       fine.n, fine.steps, CLOSED_COARSE, 100.0 * coarse.worst),
                       cpu});
  assert_true(fine.worst < 0.02); // the target of the reference problem
  assert_true(coarse.worst < 0.02);
  assert_true(fabs(fine.constant) < 0.02);
}

static void melt_at_rest_in_a_spinning_cup_has_the_pressure_of_the_paraboloid(void **unused)
{
  (void)unused;
  omp_set_num_threads(1);
  const Rest coarse = spin_for_two_seconds(COARSE);
  const double start = validation_cpu_time();
  const Rest fine = spin_for_two_seconds(FINE);
  const double cpu = validation_cpu_time() - start;
  const char *resolution =
      validation_text("%d particles along the radius, %td in all, %ld steps", FINE, fine.n, fine.steps);
  validation_write(&(ValidationRow){"F7", "round open cup, root mean square of the particles, over rho/2 w^2 R^2",
                                    "rho/2 w^2 r^2 - rho g z + const", "", validation_text("%.2f %%", 100.0 * fine.rms),
                                    "2 %", validation_text("%s; %d: %.2f %%", resolution, COARSE, 100.0 * coarse.rms),
                                    cpu});
  validation_write(
      &(ValidationRow){"F7", "the same, of any particle, 1.5 s to 2 s (half a spacing at the free surface is 4 %)",
                       "rho/2 w^2 r^2 - rho g z + const", "", validation_text("%.2f %%", 100.0 * fine.worst),
                       fine.worst < 0.02 ? "2 %" : "2 % (missed)",
                       validation_text("%s; %d: %.2f %%", resolution, COARSE, 100.0 * coarse.worst), cpu});
  validation_write(&(ValidationRow){"F7", "root mean square speed at 2 s, over w R", "at rest", "",
                                    validation_text("%.1e", fine.speed), "-", resolution, cpu});
  assert_true(fine.rms < 0.02); // the target of the reference problem
  assert_true(fine.rms < coarse.rms);
  assert_true(fabs(fine.constant) < 0.02);
  assert_true(fine.speed < 1e-2);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(melt_in_a_closed_spinning_cup_is_pressed_outwards),
      cmocka_unit_test(melt_at_rest_in_a_spinning_cup_has_the_pressure_of_the_paraboloid)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
