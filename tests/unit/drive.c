/* Forces over time: gravity that turns, a mould that tilts and spins; a free particle's path in the turning frame. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "cast/physics/drive.h"
#include "tests/support/assert_close.h"
#include "tests/support/assert_ok.h"

static Table table_of(size_t n, const double *x, const double *y)
{
  CastError err;
  Table table;
  ok(table_create(n, x, y, &table, &err), &err);
  return table;
}

/* ---- over time ---- */

static void gravity_turns_evenly_between_its_points(void **state)
{
  (void)state;
  double time[3] = {0.0, 2.0, 3.0}, gravity[3][3] = {{0.0, 0.0, -10.0}, {10.0, 0.0, 0.0}, {12.0, 0.0, 0.0}};
  const Drive drive = {.n = 3, .time = time, .gravity = gravity};
  SphParameters sph = {.rho0 = 1.0};
  drive_at(&drive, 0.5, &sph); // a quarter of the way: 22.5 degrees
  assert_close(sph.gravity[0], 10.0 * sin(M_PI / 8.0), 1e-14);
  assert_close(sph.gravity[2], -10.0 * cos(M_PI / 8.0), 1e-14);
  drive_at(&drive, 2.5, &sph);
  assert_close(sph.gravity[0], 11.0, 1e-14);
  drive_at(&drive, -1.0, &sph);
  assert_close(sph.gravity[2], -10.0, 0.0);
  drive_at(&drive, 9.0, &sph);
  assert_close(sph.gravity[0], 12.0, 0.0);
  assert_true(spin_is_none(&sph.spin));
}

/* Turned by 90 degrees about y (z towards x), the mould's own +z points along x; gravity, still down, is its +x. */
static void a_mould_tilted_about_y_feels_gravity_along_its_own_x(void **state)
{
  (void)state;
  double time = 0.0, gravity[1][3] = {{0.0, 0.0, -9.81}};
  Drive drive = {.n = 1, .time = &time, .gravity = gravity, .tilt_axis = {0.0, 1.0, 0.0}};
  drive.tilt = table_of(2, (const double[]){1.0, 3.0}, (const double[]){0.0, 0.5 * M_PI});
  SphParameters sph = {.rho0 = 1.0};
  drive_at(&drive, 3.0, &sph);
  assert_close(sph.gravity[0], 9.81, 1e-14);
  assert_close(sph.gravity[2], 0.0, 1e-14);
  drive_at(&drive, 2.0, &sph);
  assert_close(sph.gravity[0], 9.81 * sqrt(0.5), 1e-14);
  assert_close(sph.gravity[2], -9.81 * sqrt(0.5), 1e-14);
  assert_true(spin_is_none(&sph.spin));
  assert_false(drive_is_steady(&drive));
  table_destroy(&drive.tilt);
}

static void a_spinning_mould_turns_away_from_gravity_by_the_angle_it_has_gone_through(void **state)
{
  (void)state;
  double time = 0.0, gravity[1][3] = {{0.0, 0.0, -9.81}};
  Drive drive = {
      .n = 1, .time = &time, .gravity = gravity, .spin_axis = {1.0, 0.0, 0.0}, .spin_point = {0.0, 2.0, 0.0}};
  drive.speed = table_of(2, (const double[]){0.0, 1.0}, (const double[]){0.0, 3.0});
  SphParameters sph = {.rho0 = 1.0};
  drive_at(&drive, 0.5, &sph); // angle 3/8 rad
  assert_close(sph.gravity[1], -9.81 * sin(0.375), 1e-14);
  assert_close(sph.gravity[2], -9.81 * cos(0.375), 1e-14);
  assert_close(sph.spin.rate[0], 1.5, 1e-15);
  assert_close(sph.spin.spin_up[0], 3.0, 1e-15);
  drive_at(&drive, 2.0, &sph); // 1.5 rad + 3 rad
  assert_close(sph.gravity[1], -9.81 * sin(4.5), 1e-13);
  assert_close(sph.spin.rate[0], 3.0, 0.0);
  assert_close(sph.spin.spin_up[0], 0.0, 0.0);
  table_destroy(&drive.speed);
}

/* The slope of the potential is the acceleration without Euler's. */
static void the_potential_s_slope_is_the_centrifugal_acceleration(void **state)
{
  (void)state;
  const Spin spin = {{0.1, -0.2, 0.3}, {20.0, -5.0, 11.0}, {0.0, 0.0, 0.0}};
  const double x[3] = {0.35, 0.21, -0.17}, d = 1e-4;
  double a[3] = {0.0, 0.0, 0.0};
  spin_add_acceleration(&spin, x, a);
  for (int k = 0; k < 3; k++) {
    double up[3], down[3];
    memcpy(up, x, sizeof up);
    memcpy(down, x, sizeof down);
    up[k] += d;
    down[k] -= d;
    const double slope =
        (spin_potential(&spin, up[0], up[1], up[2]) - spin_potential(&spin, down[0], down[1], down[2])) / (2.0 * d);
    assert_close(slope, a[k], 1e-8); // exact for a quadratic but for rounding, 1e-16 of 100 over 1e-4
  }
}

/* ---- a free particle ---- */

typedef struct Path {
  double x[3];
} Path;

/* A lone particle of melt in the frame of a mould that spins, with n steps to the time `end`. */
static Path free_path(const Drive *drive, const double x0[3], const double v0[3], double end, int n)
{
  CastError err;
  Particles p;
  Neighbours *nb = NULL;
  double place[3] = {x0[0], x0[1], x0[2]};
  double *const x[3] = {&place[0], &place[1], &place[2]};
  SphParameters sph = {
      .kernel = KERNEL_WENDLAND_C2, .h = 1.5e-3, .spacing = 1e-3, .rho0 = 1000.0, .c0 = 100.0, .gamma = 7.0};
  ok(particles_create(1, x, sph.spacing, sph.rho0, NULL, &p, &err), &err);
  ok(neighbours_create(3e-3, 1e-3, NULL, &nb, &err), &err);
  ok(neighbours_update(nb, &p, true, NULL, &err), &err);
  for (int d = 0; d < 3; d++) p.v[d][0] = v0[d];
  drive_at(drive, 0.0, &sph);
  sph_initialise(&sph, &p);
  sph_rates(&sph, &p, nb);
  for (int k = 1; k <= n; k++) {
    ok(sph_drift(&sph, &p, NULL, end / n, NULL, &err), &err);
    drive_at(drive, end * k / n, &sph);
    sph_rates(&sph, &p, nb);
    ok(sph_finish(&sph, &p, end / n, &err), &err);
  }
  const Path path = {{p.x[0][0], p.x[1][0], p.x[2][0]}};
  neighbours_destroy(&nb);
  particles_destroy(&p);
  return path;
}

/* Seen from outside it goes straight; the frame has turned by `angle` about the z axis through `point`. */
static double path_error(const Drive *drive, double speed0, double angle, double end, int n)
{
  const double x0[3] = {0.17, -0.04, 0.02}, v0[3] = {0.3, -0.2, 0.1}, *o = drive->spin_point;
  const double r[2] = {x0[0] - o[0], x0[1] - o[1]};
  const double u[2] = {v0[0] - speed0 * r[1], v0[1] + speed0 * r[0]};
  const double X = r[0] + u[0] * end, Y = r[1] + u[1] * end, c = cos(angle), s = sin(angle);
  const double exact[3] = {o[0] + c * X + s * Y, o[1] - s * X + c * Y, x0[2] + v0[2] * end};
  const Path path = free_path(drive, x0, v0, end, n);
  double error2 = 0.0;
  for (int d = 0; d < 3; d++) error2 += (path.x[d] - exact[d]) * (path.x[d] - exact[d]);
  return sqrt(error2);
}

static void check_order(const Drive *drive, double speed0, double angle, double end)
{
  const double coarse = path_error(drive, speed0, angle, end, 200), fine = path_error(drive, speed0, angle, end, 400);
  assert_close(log2(coarse / fine), 2.0, 0.05); // velocity Verlet's order
  assert_true(fine < 2e-4 * 0.2);               // of a path of some 0.2 m
}

static Drive spinning(size_t n, const double *time, const double *speed)
{
  Drive drive = {.spin_point = {0.02, 0.01, 0.0}, .spin_axis = {0.0, 0.0, 1.0}};
  drive.speed = table_of(n, time, speed);
  return drive;
}

static void a_free_particle_goes_straight_for_one_who_does_not_spin(void **state)
{
  (void)state;
  Drive drive = spinning(1, (const double[]){0.0}, (const double[]){12.0});
  check_order(&drive, 12.0, 12.0 * 0.1, 0.1);
  table_destroy(&drive.speed);
}

/* Spun up from rest at 100 rad/s2: without Euler's acceleration it would be off by alpha r t^2/2, 75 mm. */
static void a_free_particle_goes_straight_while_the_mould_is_spun_up(void **state)
{
  (void)state;
  Drive drive = spinning(2, (const double[]){0.0, 1.0}, (const double[]){0.0, 100.0});
  check_order(&drive, 0.0, 0.5, 0.1);
  table_destroy(&drive.speed);
}

/* A circle of inertia: Coriolis' acceleration alone (the centrifugal one is taken off by hand) turns the velocity and
 * must not change its size, however long it goes on. */
static void coriolis_acceleration_does_no_work(void **state)
{
  (void)state;
  CastError err;
  Particles p;
  Neighbours *nb = NULL;
  double zero[3] = {0.0, 0.0, 0.0};
  double *const x[3] = {&zero[0], &zero[1], &zero[2]};
  SphParameters sph = {.kernel = KERNEL_WENDLAND_C2,
                       .h = 1.5e-3,
                       .spacing = 1e-3,
                       .rho0 = 1000.0,
                       .c0 = 100.0,
                       .gamma = 7.0,
                       .spin = {.rate = {30.0, -40.0, 120.0}}};
  ok(particles_create(1, x, sph.spacing, sph.rho0, NULL, &p, &err), &err);
  ok(neighbours_create(3e-3, 1.0, NULL, &nb, &err), &err);
  ok(neighbours_update(nb, &p, true, NULL, &err), &err);
  p.v[0][0] = 3.0;
  p.v[1][0] = 4.0;
  sph_initialise(&sph, &p);
  for (int k = 0; k < 20000; k++) { // 83 turns of 2 w
    for (int d = 0; d < 3; d++) p.a[d][0] = 0.0;
    ok(sph_drift(&sph, &p, NULL, 1e-4, NULL, &err), &err);
    ok(sph_finish(&sph, &p, 1e-4, &err), &err);
  }
  // but for rounding, 20000 times 1e-16; explicit steps would gain a factor of 800
  assert_close(hypot(hypot(p.v[0][0], p.v[1][0]), p.v[2][0]) / 5.0, 1.0, 1e-11);
  neighbours_destroy(&nb);
  particles_destroy(&p);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(gravity_turns_evenly_between_its_points),
      cmocka_unit_test(a_mould_tilted_about_y_feels_gravity_along_its_own_x),
      cmocka_unit_test(a_spinning_mould_turns_away_from_gravity_by_the_angle_it_has_gone_through),
      cmocka_unit_test(the_potential_s_slope_is_the_centrifugal_acceleration),
      cmocka_unit_test(a_free_particle_goes_straight_for_one_who_does_not_spin),
      cmocka_unit_test(a_free_particle_goes_straight_while_the_mould_is_spun_up),
      cmocka_unit_test(coriolis_acceleration_does_no_work),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
