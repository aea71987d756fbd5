/* Gradients between particles: exact for linear fields wherever the neighbours stand. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "cast/physics/gradient.h"
#include "tests/support/assert_close.h"
#include "tests/support/lattice_tank.h"
#include "tests/support/random_numbers.h"

static const double DX = 1e-4;

/* Melt 6 deep on a floor and against a wall on the left, free on top and on the right, periodic in y; places jittered
 * by up to a fifth of the spacing, volumes by up to a tenth, so that nothing cancels by symmetry. */
static LatticeTank disordered_pool(int depth)
{
  LatticeTank tank = {
      .fluid = {8, 10, depth},
      .box = {12, 10, 10},
      .low = {true, false, true},
      .high = {true, false, true},
      .layers = 4,
      .sph = {.kernel = KERNEL_WENDLAND_C2, .h = 1.5 * DX, .spacing = DX, .rho0 = 7000.0, .c0 = 10.0, .gamma = 7.0}};
  lattice_tank_create(&tank);
  uint64_t seed = 7;
  Particles *p = &tank.particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    for (int d = 0; d < 3 && depth > 1; d++) p->x[d][i] += 0.4 * DX * (random_unit(&seed) - 0.5);
    p->volume[i] *= 0.9 + 0.2 * random_unit(&seed);
  }
  CastError err;
  assert_int_equal(neighbours_update(tank.neighbours, p, true, NULL, &err), CAST_OK);
  return tank;
}

static void set_linear(Particles *p, const double slope[3])
{
  for (ptrdiff_t i = 0; i < p->n_fluid; i++)
    p->T[i] = 1200.0 + slope[0] * p->x[0][i] + slope[1] * p->x[1][i] + slope[2] * p->x[2][i];
}

static void linear_fields_have_their_slope_inside_at_walls_and_at_free_surfaces(void **state)
{
  (void)state;
  LatticeTank tank = disordered_pool(6);
  Particles *p = &tank.particles;
  const double slope[3] = {3e4, 0.0, -5e4}; // K/m; not across the period
  set_linear(p, slope);
  double worst = 0.0, corner = 1.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const double *const fields[1] = {p->T};
    double found[1][3];
    gradient_at(&tank.sph, p, tank.neighbours, i, 1, fields, found);
    for (int d = 0; d < 3; d++) worst = fmax(worst, fabs(found[0][d] - slope[d]));
    corner = fmin(corner, fmax(p->x[0][i], p->x[2][i]) / DX); // the one in the corner was among them
  }
  assert_true(corner < 1.0);
  assert_true(worst < 1e-9 * 5e4 + 1e-12 * 1200.0 / DX); // rounding of T over a spacing, and of M's inverse
  lattice_tank_destroy(&tank);
}

static void two_fields_at_once_are_each_by_itself(void **state)
{
  (void)state;
  LatticeTank tank = disordered_pool(6);
  Particles *p = &tank.particles;
  set_linear(p, (const double[3]){1e4, 0.0, 2e4});
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) p->E[i] = sin(p->x[0][i] / (3.0 * DX)) + p->x[2][i] * p->x[2][i] / DX;
  for (ptrdiff_t i = 0; i < p->n_fluid; i += 17) {
    const double *const both[2] = {p->T, p->E}, *const alone[1] = {p->E};
    double found[2][3], single[1][3];
    gradient_at(&tank.sph, p, tank.neighbours, i, 2, both, found);
    gradient_at(&tank.sph, p, tank.neighbours, i, 1, alone, single);
    for (int d = 0; d < 3; d++) assert_true(found[1][d] == single[0][d]);
  }
  lattice_tank_destroy(&tank);
}

static void a_film_one_particle_thick_has_its_slope_along_the_film_and_none_across(void **state)
{
  (void)state;
  LatticeTank tank = disordered_pool(1);
  Particles *p = &tank.particles;
  set_linear(p, (const double[3]){3e4, 0.0, 7e4});
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const double *const fields[1] = {p->T};
    double found[1][3];
    gradient_at(&tank.sph, p, tank.neighbours, i, 1, fields, found);
    assert_close(found[0][0], 3e4, 1e-4);
    assert_close(found[0][2], 0.0, 1e-4);
  }
  lattice_tank_destroy(&tank);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(linear_fields_have_their_slope_inside_at_walls_and_at_free_surfaces),
      cmocka_unit_test(two_fields_at_once_are_each_by_itself),
      cmocka_unit_test(a_film_one_particle_thick_has_its_slope_along_the_film_and_none_across),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
