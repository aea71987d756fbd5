/* The contact angle as particles see it: a wedge of melt on a wall, and a slot with a meniscus of the exact shape. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "cast/kernel/pair.h"
#include "cast/physics/tension.h"
#include "cast/physics/wedge.h"
#include "tests/support/lattice_tank.h"

static void ok(CastStatus status, const CastError *err)
{
  if (status != CAST_OK) fail_msg("%s", err->message);
}

static Wedge *make_wedge(double degrees)
{
  CastError err = {0};
  Wedge *w;
  ok(wedge_create(KERNEL_WENDLAND_C2, degrees * pair_pi / 180.0, &w, &err), &err);
  return w;
}

static void a_surface_across_the_wall_lacks_nothing(void **unused)
{
  (void)unused;
  Wedge *w = make_wedge(90.0);
  for (int k = 0; k < 20; k++) { // 1 %: of the grid that integrates the kernel
    const WedgePlace at = wedge_look(w, 0.02 * k, 0.7);
    assert_float_equal(at.lean, 0.0, 0.01);
    assert_float_equal(at.raise, 1.0, 0.01);
  }
  wedge_destroy(&w);
}

static void a_surface_out_of_reach_of_walls_lacks_nothing(void **unused)
{
  (void)unused;
  Wedge *w = make_wedge(130.0);
  const WedgePlace at = wedge_look(w, 0.0, 0.5);
  assert_float_equal(at.height, 2.0, 1e-12);
  assert_float_equal(at.depth, 0.0, 0.02); // half of the kernel is filled: on the surface
  assert_float_equal(at.lean, 0.0, 1e-3);
  assert_float_equal(at.raise, 1.0, 1e-3);
  wedge_destroy(&w);
}

static void close_to_a_wall_a_normal_seen_leans_towards_it(void **unused)
{
  (void)unused;
  static const double degrees[] = {60.0, 130.0};
  for (int k = 0; k < 2; k++) {
    Wedge *w = make_wedge(degrees[k]);
    const double cosine = cos(degrees[k] * pair_pi / 180.0);
    const WedgePlace near = wedge_look(w, 0.3, 0.7), far = wedge_look(w, 0.05, 0.7);
    assert_true(near.height < far.height);
    assert_true(fabs(near.lean) > 0.2 * fabs(cosine) &&
                fabs(near.lean) < fabs(cosine)); // seen between it and 90 degrees
    assert_true(near.lean * cosine < 0.0 && fabs(far.lean) < fabs(near.lean));
    wedge_destroy(&w);
  }
}

/* Columns of a slot 1 wide between walls along y, filled up to a circle that meets them at theta; twice as deep. */
static void make_meniscus(LatticeTank *tank, int wide, double theta)
{
  const double dx = 1.0 / wide, radius = 0.5 / fabs(cos(theta));
  *tank = (LatticeTank){
      .fluid = {12, wide, 2 * wide + 8},
      .box = {12, wide, 4 * wide + 40},
      .low = {false, true, false},
      .high = {false, true, false},
      .layers = 3,
      .sph = {.kernel = KERNEL_WENDLAND_C2, .h = 1.5 * dx, .spacing = dx, .rho0 = 1.0, .c0 = 30.0, .gamma = 7.0}};
  lattice_tank_create(tank);
  Particles *p = &tank->particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const double y = p->x[1][i] - 0.5, rise = radius - sqrt(radius * radius - y * y);
    p->x[2][i] += copysign(rise, cos(theta)) + (wide + 12) * dx;
  }
  CastError err = {0};
  sph_initialise(&tank->sph, p);
  ok(neighbours_update(tank->neighbours, p, true, NULL, &err), &err);
}

/* 2 sum V grad W of the melt around particle i, along the slot: what a uniform curvature of 1 pushes with. */
static double unit_push(const LatticeTank *tank, ptrdiff_t i)
{
  const Particles *p = &tank->particles;
  const PairList *list = neighbours_fluid_fluid(tank->neighbours);
  double sum = 0.0;
  for (ptrdiff_t k = list->start[i]; k < list->start[i + 1]; k++) {
    double d[3];
    const double r2 = particles_offset(p, i, list->index[k], neighbours_period(tank->neighbours), d);
    sum -= 2.0 * p->volume[list->index[k]] * d[2] * kernel_slope(tank->sph.kernel, sqrt(r2), tank->sph.h);
  }
  return sum;
}

typedef struct Meniscus { // over -2 cos(theta)/w
  double curvature;       // mean that it pushes with
  double force;           // of the stress, along the slot and over its width
} Meniscus;

static Meniscus find_meniscus(int wide, double degrees)
{
  const double theta = degrees * pair_pi / 180.0, at = 0.0, one = 1.0;
  CastError err = {0};
  LatticeTank tank;
  Table sigma;
  Tension *tension;
  make_meniscus(&tank, wide, theta);
  ok(table_create(1, &at, &one, &sigma, &err), &err);
  ok(tension_create(tank.sph.kernel, tank.sph.h, tank.sph.spacing, &sigma, theta, &tension, &err), &err);
  Particles *p = &tank.particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) p->a[2][i] = 0.0;
  ok(tension_push(tension, p, tank.neighbours, &err), &err);
  double force = 0.0, unit = 0.0, low = INFINITY, high = -INFINITY, stress = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    low = fmin(low, p->x[2][i]);
    high = fmax(high, p->x[2][i]);
  }
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    double of_stress[3];
    if (p->x[2][i] < 0.5 * (low + high)) continue; // there is another surface below, of another angle
    tension_stress_force(tension, p, tank.neighbours, i, of_stress);
    force += p->a[2][i] * p->mass[i];
    stress += of_stress[2] * p->volume[i];
    unit += unit_push(&tank, i) * p->volume[i];
  }
  tension_destroy(&tension);
  table_destroy(&sigma);
  lattice_tank_destroy(&tank);
  const double along = 12.0 / wide, exact = -2.0 * cos(theta); // periodic; sigma and the width are 1
  return (Meniscus){force / unit / exact, -stress / along / exact};
}

/* Whatever the meniscus is like and however few particles there are; 1 % is what lattice columns leave of the fill in a
 * layer, an integral at the start. */
static void contact_lines_add_up_to_sigma_cos_theta(void **unused)
{
  (void)unused;
  static const double degrees[] = {30.0, 60.0, 110.0, 130.0, 150.0};
  static const int wide[] = {4, 8, 12, 16};
  for (int k = 0; k < 5; k++)
    for (int l = 0; l < 4; l++) assert_float_equal(find_meniscus(wide[l], degrees[k]).force, 1.0, 0.01);
}

static void a_meniscus_of_the_contact_angle_pushes_with_its_curvature(void **unused)
{
  (void)unused;
  static const double degrees[] = {60.0, 120.0, 130.0, 150.0};
  for (int k = 0; k < 4; k++) {
    // measured up to .09, .25, .29 off: the stress of a surface that columns of a lattice make in steps is short of
    // sigma, curvature by least squares in its middle is not
    assert_float_equal(find_meniscus(4, degrees[k]).curvature, 1.0, 0.15);
    assert_float_equal(find_meniscus(8, degrees[k]).curvature, 1.0, 0.3);
    assert_float_equal(find_meniscus(16, degrees[k]).curvature, 1.0, 0.3);
  }
}

/* Melt with flat surfaces between walls along y, of patch 0 at the low end and patch 1 at the high one: its
 * accelerations where melt meets patch 1, and patch 0, at these angles. Lattice order.   a  [12 * wide * 12][3] */
static void push_between(int wide, double low, double high, double (*a)[3])
{
  const double dx = 1.0 / wide, at = 0.0, one = 1.0, low_angle = low * pair_pi / 180.0;
  const int32_t of_patch[] = {0};
  CastError err = {0};
  Table sigma;
  Tension *tension;
  LatticeTank tank = {
      .fluid = {12, wide, 12},
      .box = {12, wide, 60},
      .low = {false, true, false},
      .high = {false, true, false},
      .layers = 3,
      .sph = {.kernel = KERNEL_WENDLAND_C2, .h = 1.5 * dx, .spacing = dx, .rho0 = 1.0, .c0 = 30.0, .gamma = 7.0}};
  lattice_tank_create(&tank);
  Particles *p = &tank.particles;
  for (ptrdiff_t k = 0; k < p->n - p->n_fluid; k++) p->patch[k] = p->foot[1][k] > 0.5;
  sph_initialise(&tank.sph, p);
  ok(neighbours_update(tank.neighbours, p, true, NULL, &err), &err);
  ok(table_create(1, &at, &one, &sigma, &err), &err);
  ok(tension_create(tank.sph.kernel, tank.sph.h, tank.sph.spacing, &sigma, high * pair_pi / 180.0, &tension, &err),
     &err);
  if (low != high) ok(tension_set_angles(tension, 1, &low_angle, 1, of_patch, &err), &err);
  for (int d = 0; d < 3; d++)
    for (ptrdiff_t i = 0; i < p->n_fluid; i++) p->a[d][i] = 0.0;
  ok(tension_push(tension, p, tank.neighbours, &err), &err);
  for (ptrdiff_t i = 0; i < p->n_fluid; i++)
    for (int d = 0; d < 3; d++) a[p->id[i]][d] = p->a[d][i];
  tension_destroy(&tension);
  table_destroy(&sigma);
  lattice_tank_destroy(&tank);
}

enum { WIDE = 24, NARROW = 2, COLUMNS = 12 };

static void each_wall_has_the_contact_angle_of_its_own_surface(void **unused)
{
  (void)unused;
  static double both[COLUMNS * WIDE * COLUMNS][3], low[COLUMNS * WIDE * COLUMNS][3], high[COLUMNS * WIDE * COLUMNS][3];
  double apart = 0.0;
  push_between(WIDE, 60.0, 130.0, both);
  push_between(WIDE, 60.0, 60.0, low);
  push_between(WIDE, 130.0, 130.0, high);
  // a wall is felt through three kernels of three spacings each, so each half as if both walls were its own
  for (int i = 0; i < COLUMNS * WIDE * COLUMNS; i++)
    for (int d = 0; d < 3; d++) {
      const double alone = i / COLUMNS % WIDE < WIDE / 2 ? low[i][d] : high[i][d];
      assert_true(both[i][d] == alone);
      apart = fmax(apart, fabs(low[i][d] - high[i][d]));
    }
  assert_true(apart > 1.0); // sigma/(rho width^2)
}

/* Between walls so near that particles feel both the nearer one counts: melt rises at the wetted one and is held back
 * at the other. */
static void between_two_surfaces_the_nearest_counts(void **unused)
{
  (void)unused;
  static double a[COLUMNS * NARROW * COLUMNS][3];
  push_between(NARROW, 60.0, 130.0, a);
  for (int x = 0; x < COLUMNS; x++) {
    const int top = (COLUMNS - 1) * NARROW * COLUMNS + x;
    assert_true(a[top][2] > a[top + COLUMNS][2]); // up along z: beside patch 0, beside patch 1
    assert_true(a[x][2] < a[x + COLUMNS][2]);     // the other surface, below
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_surface_across_the_wall_lacks_nothing),
                                     cmocka_unit_test(a_surface_out_of_reach_of_walls_lacks_nothing),
                                     cmocka_unit_test(close_to_a_wall_a_normal_seen_leans_towards_it),
                                     cmocka_unit_test(contact_lines_add_up_to_sigma_cos_theta),
                                     cmocka_unit_test(a_meniscus_of_the_contact_angle_pushes_with_its_curvature),
                                     cmocka_unit_test(each_wall_has_the_contact_angle_of_its_own_surface),
                                     cmocka_unit_test(between_two_surfaces_the_nearest_counts)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
