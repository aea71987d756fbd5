/* Sums over pairs: what they conserve, what leaves the melt alone, and that the fast path computes the formulas. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cast/kernel/pair.h"
#include "cast/physics/sph.h"
#include "tests/support/assert_close.h"
#include "tests/support/assert_ok.h"
#include "tests/support/lattice_tank.h"
#include "tests/support/random_numbers.h"

enum { SIDE = 9, N = SIDE * SIDE * SIDE, KINDS = 4 };
static const double spacing = 1e-3;

/* Smoothing length that gives each kernel the same support, 2.6 spacings. */
static SphParameters melt_parameters(KernelKind kernel)
{
  return (SphParameters){.kernel = kernel,
                         .h = 2.6 * spacing / kernel_support(kernel),
                         .spacing = spacing,
                         .rho0 = 6900.0,
                         .c0 = 30.0,
                         .gamma = 7.0,
                         .delta = 0.1,
                         .alpha = 0.05};
}

typedef struct Cloud {
  SphParameters sph;
  Particles p;
  Neighbours *nb;
} Cloud;

/* A free cube of melt: particles off their lattice by up to a fifth of a spacing. */
static Cloud make_cloud(KernelKind kernel)
{
  Cloud cloud = {.sph = melt_parameters(kernel)};
  static double x[3][N];
  uint64_t seed = 5;
  for (int i = 0; i < N; i++) {
    const int at[3] = {i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE)};
    for (int d = 0; d < 3; d++) x[d][i] = spacing * (at[d] + 0.4 * random_unit(&seed) - 0.2);
  }
  CastError err;
  double *const places[3] = {x[0], x[1], x[2]};
  ok(particles_create(N, places, spacing, cloud.sph.rho0, NULL, &cloud.p, &err), &err);
  ok(neighbours_create(kernel_support(kernel) * cloud.sph.h, neighbours_skin(spacing), NULL, &cloud.nb, &err), &err);
  ok(neighbours_update(cloud.nb, &cloud.p, false, NULL, &err), &err);
  return cloud;
}

static void disturb(Cloud *cloud)
{
  Particles *p = &cloud->p;
  uint64_t seed = 13;
  for (int i = 0; i < N; i++) {
    for (int d = 0; d < 3; d++) p->v[d][i] = random_unit(&seed) - 0.5;
    p->rho[i] = cloud->sph.rho0 * (1.0 + 0.02 * (random_unit(&seed) - 0.5));
    p->T[i] = 1000.0 + 500.0 * random_unit(&seed);
    p->kappa[i] = 1.0 + 100.0 * random_unit(&seed);
    p->mu[i] = 1e-2 * random_unit(&seed);
  }
}

static void destroy(Cloud *cloud)
{
  neighbours_destroy(&cloud->nb);
  particles_destroy(&cloud->p);
}

/* The fast form's pair terms are single: some ten roundings of 6e-8 of the largest term. */
static const double single = 1e-6;

typedef enum Form { PLAIN, FAST, FORMS } Form;

static void compute(Form form, const SphParameters *sph, Particles *p, const Neighbours *nb)
{
  if (form == FAST) {
    sph_rates(sph, p, nb);
  } else {
    sph_forces(sph, p, nb);
    sph_conduction(sph, p, nb);
  }
}

static void pair_forces_conserve_momentum(void **unused)
{
  (void)unused;
  for (int kind = 0; kind < KINDS; kind++) {
    Cloud cloud = make_cloud((KernelKind)kind);
    disturb(&cloud);
    sph_rates(&cloud.sph, &cloud.p, cloud.nb);
    for (int d = 0; d < 3; d++) {
      double sum = 0.0, size = 0.0;
      for (int i = 0; i < N; i++) {
        sum += cloud.p.mass[i] * cloud.p.a[d][i];
        size += fabs(cloud.p.mass[i] * cloud.p.a[d][i]);
      }
      assert_close(sum / size, 0.0, 1e-14); // rounding of some 1e5 pairs of random sign
    }
    destroy(&cloud);
  }
}

static void pair_heat_sums_to_zero(void **unused)
{
  (void)unused;
  for (int kind = 0; kind < KINDS; kind++) {
    Cloud cloud = make_cloud((KernelKind)kind);
    disturb(&cloud);
    sph_rates(&cloud.sph, &cloud.p, cloud.nb);
    long double sum = 0.0L; // so that this sum adds no rounding of its own
    double size = 0.0;
    for (int i = 0; i < N; i++) {
      sum += cloud.p.heat[i];
      size += fabs(cloud.p.heat[i]);
    }
    assert_close((double)sum / size, 0.0, 4.0 * DBL_EPSILON); // each row's sum is rounded
    destroy(&cloud);
  }
}

static void density_diffusion_conserves_mass(void **unused)
{
  (void)unused;
  Cloud cloud = make_cloud(KERNEL_WENDLAND_C2);
  cloud.sph.gravity[2] = -100.0;
  disturb(&cloud);
  for (int d = 0; d < 3; d++) memset(cloud.p.v[d], 0, N * sizeof(double));
  sph_rates(&cloud.sph, &cloud.p, cloud.nb);
  double sum = 0.0, size = 0.0;
  for (int i = 0; i < N; i++) {
    sum += cloud.p.volume[i] * cloud.p.drho[i];
    size += fabs(cloud.p.volume[i] * cloud.p.drho[i]);
  }
  assert_close(sum / size, 0.0, 1e-14);
  destroy(&cloud);
}

/* Two particles alone, 1.2 and 0.6 spacings apart: the sums are one term each, written out here from the published
 * formulas. */
static void a_lone_pair_feels_the_formulas(void **unused)
{
  (void)unused;
  for (int k = 0; k < 2 * KINDS * FORMS; k++) {
    const KernelKind kind = (KernelKind)(k % KINDS);
    const Form form = (Form)(k / KINDS % FORMS);
    const double tolerance = form == FAST ? single : 1e-12, s = k < KINDS * FORMS ? 1e-3 : 0.5e-3;
    SphParameters sph = melt_parameters(kind);
    double x[2] = {0.0, 0.9 * s}, y[2] = {0.0, -0.4 * s}, z[2] = {0.0, 0.7 * s};
    double *const places[3] = {x, y, z};
    CastError err;
    Particles p;
    Neighbours *nb = NULL;
    ok(particles_create(2, places, spacing, sph.rho0, NULL, &p, &err), &err);
    ok(neighbours_create(2.6e-3, 0.0, NULL, &nb, &err), &err);
    ok(neighbours_update(nb, &p, false, NULL, &err), &err);
    const int i = p.id[0] == 0 ? 0 : 1, j = 1 - i;
    const double vi[3] = {0.3, 0.1, -0.2}, vj[3] = {-0.1, 0.2, -0.5};
    for (int d = 0; d < 3; d++) {
      p.v[d][i] = vi[d];
      p.v[d][j] = vj[d];
    }
    p.rho[i] = 6950.0, p.rho[j] = 6890.0, p.T[i] = 1300.0, p.T[j] = 1400.0;
    p.kappa[i] = 30.0, p.kappa[j] = 60.0, p.mu[i] = 5e-3, p.mu[j] = 20e-3;
    compute(form, &sph, &p, nb);

    const double d[3] = {-0.9 * s, 0.4 * s, -0.7 * s}, u[3] = {vi[0] - vj[0], vi[1] - vj[1], vi[2] - vj[2]};
    const double r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], ud = u[0] * d[0] + u[1] * d[1] + u[2] * d[2];
    const double F = kernel_slope(sph.kernel, sqrt(r2), sph.h), m = sph.rho0 * 1e-9;
    const double B = sph.rho0 * sph.c0 * sph.c0 / 7.0, si = 6950.0 / 6900.0, sj = 6890.0 / 6900.0;
    const double Pi = B * (pow(si, 7) - 1.0) / (6950.0 * 6950.0), Pj = B * (pow(sj, 7) - 1.0) / (6890.0 * 6890.0);
    assert_true(ud < 0.0); // they approach: artificial viscosity acts
    const double artificial = -sph.alpha * sph.c0 * sph.h * ud / (r2 + 0.01 * sph.h * sph.h) / sph.rho0;
    const double apart = 0.1 * sph.c0 * sph.c0 / sph.rho0 * fmax(1.0 - sqrt(r2) / (0.8 * spacing), 0.0);
    const double mu = 4.0 * 5e-3 * 20e-3 / 25e-3, kappa = 4.0 * 30.0 * 60.0 / 90.0;
    for (int axis = 0; axis < 3; axis++) {
      const double a = m * (Pi + Pj + artificial + apart) * F * d[axis] - m * mu / (6950.0 * 6890.0) * F * u[axis];
      assert_close(p.a[axis][i] / a, 1.0, tolerance);
      assert_close(p.a[axis][j] / -a, 1.0, tolerance);
    }
    const double eta_i = sph.rho0 * (pow(si, 6) - 1.0) / 6.0, eta_j = sph.rho0 * (pow(sj, 6) - 1.0) / 6.0;
    const double Vi = m / 6950.0, Vj = m / 6890.0, spread = 2.0 * sph.delta * sph.h * sph.c0 * (eta_j - eta_i);
    assert_close(p.drho[i] / (Vj * F * (-6950.0 * ud + spread)), 1.0, tolerance);
    assert_close(p.drho[j] / (Vi * F * (-6890.0 * ud - spread)), 1.0, tolerance);
    assert_close(p.heat[i] / (Vi * Vj * kappa * 100.0 * F), 1.0, tolerance);
    assert_true(p.heat[i] == -p.heat[j]); // to the last bit
    neighbours_destroy(&nb);
    particles_destroy(&p);
  }
}

/* A pair alone is the extreme of all that bounds its terms, which are counted in grains of these bounds: two particles
 * that fly at or past each other, or rest under pressure, 0.1 to 0.7 of the reach apart (closer, places are known to
 * fewer digits). Half a grain of a force is 2^-28 of the strongest push that keeps particles apart. */
static void terms_near_their_bounds_are_counted_right(void **unused)
{
  (void)unused;
  enum { DISTANCES = 60 };
  for (int k = 0; k < KINDS * DISTANCES; k++) {
    const SphParameters sph = melt_parameters((KernelKind)(k % KINDS));
    const double support = kernel_support(sph.kernel) * sph.h,
                 r = support * (0.1 + 0.6 * (k / KINDS + 0.5) / DISTANCES);
    double x[2] = {0.0, r}, y[2] = {0.0, 0.0}, z[2] = {0.0, 0.0};
    CastError err;
    Particles p;
    Neighbours *nb = NULL;
    ok(particles_create(2, (double *const[3]){x, y, z}, spacing, sph.rho0, NULL, &p, &err), &err);
    ok(neighbours_create(support, 0.0, NULL, &nb, &err), &err);
    ok(neighbours_update(nb, &p, false, NULL, &err), &err);
    for (int i = 0; i < 2; i++) {
      const double sign = p.x[0][i] == 0.0 ? 1.0 : -1.0;
      p.rho[i] = sph.rho0 * (k % 3 == 0 ? 1.05 : 1.0);
      p.v[k % 3 == 1 ? 0 : 1][i] = k % 3 == 0 ? 0.0 : 2.0 * sign;
      p.T[i] = 1000.0 + 500.0 * sign;
      p.kappa[i] = 30.0;
      p.mu[i] = k % 2 == 0 ? 5e-3 : 50.0;
    }
    double fast[2][4];
    compute(FAST, &sph, &p, nb);
    for (int i = 0; i < 2; i++) memcpy(fast[i], (double[]){p.a[0][i], p.a[1][i], p.drho[i], p.heat[i]}, sizeof fast[i]);
    for (int d = 0; d < 2; d++) assert_true(fast[0][d] == -fast[1][d]);
    compute(PLAIN, &sph, &p, nb);
    for (int i = 0; i < 2; i++) {
      const double a = hypot(p.a[0][i], p.a[1][i]), grain = 2e-10 * sph.c0 * sph.c0 / spacing;
      assert_close(fast[i][0], p.a[0][i], 2e-6 * a + grain);
      assert_close(fast[i][1], p.a[1][i], 2e-6 * a + grain);
      assert_close(fast[i][2], p.drho[i], 2e-6 * fabs(p.drho[i]));
      assert_close(fast[i][3], p.heat[i], 2e-6 * fabs(p.heat[i]));
    }
    neighbours_destroy(&nb);
    particles_destroy(&p);
  }
}

/* The paper's v_i + v_j would brake it. At rest the cloud feels what parts the few of its particles that are close. */
static void a_melt_moving_as_one_feels_no_force(void **unused)
{
  (void)unused;
  Cloud cloud = make_cloud(KERNEL_WENDLAND_C2), rest = make_cloud(KERNEL_WENDLAND_C2);
  for (int i = 0; i < N; i++) {
    cloud.p.v[0][i] = 3.0;
    cloud.p.v[2][i] = -2.0;
    cloud.p.mu[i] = rest.p.mu[i] = 1.0;
  }
  sph_rates(&cloud.sph, &cloud.p, cloud.nb);
  sph_rates(&rest.sph, &rest.p, rest.nb);
  int unmoved = 0;
  for (int i = 0; i < N; i++) {
    for (int d = 0; d < 3; d++) assert_true(cloud.p.a[d][i] == rest.p.a[d][i]);
    assert_true(cloud.p.drho[i] == 0.0);
    unmoved += rest.p.a[0][i] == 0.0 && rest.p.a[1][i] == 0.0 && rest.p.a[2][i] == 0.0;
  }
  assert_true(unmoved > N / 10); // those that no other is close to
  destroy(&cloud);
  destroy(&rest);
}

static void a_melt_turning_as_one_keeps_its_density(void **unused)
{
  (void)unused;
  for (int form = 0; form < FORMS; form++) {
    Cloud cloud = make_cloud(KERNEL_WENDLAND_C2);
    for (int i = 0; i < N; i++) {
      cloud.p.v[0][i] = -100.0 * cloud.p.x[1][i];
      cloud.p.v[1][i] = 100.0 * cloud.p.x[0][i];
    }
    compute((Form)form, &cloud.sph, &cloud.p, cloud.nb);
    for (int i = 0; i < N; i++) // u.d is a sum of two equal products of opposite sign; 100 1/s is the rate of the flow
      assert_close(cloud.p.drho[i] / (cloud.sph.rho0 * 100.0), 0.0, form == FAST ? single : 1e-13);
    destroy(&cloud);
  }
}

/* sph_forces and sph_conduction take the plain form, one pair after the other in double, sph_rates the vectorised one
 * in single precision. */
static void check_forms_agree(const SphParameters *sph, Particles *p, const Neighbours *nb)
{
  const size_t n = (size_t)p->n_fluid, bytes = n * sizeof(double);
  double *fast[5], *const field[5] = {p->drho, p->heat, p->a[0], p->a[1], p->a[2]};
  compute(FAST, sph, p, nb);
  for (int f = 0; f < 5; f++) {
    fast[f] = malloc(bytes);
    memcpy(fast[f], field[f], bytes);
    memset(field[f], 0, bytes);
  }
  sph_forces(sph, p, nb);
  for (size_t i = 0; i < n; i++) assert_true(p->heat[i] == 0.0);
  sph_conduction(sph, p, nb);
  for (int f = 0; f < 5; f++) {
    double most = 0.0;
    for (size_t i = 0; i < n; i++) most = fmax(most, fabs(field[f][i]));
    assert_true(most > 0.0);
    for (size_t i = 0; i < n; i++) assert_close(fast[f][i], field[f][i], single * most);
    free(fast[f]);
  }
}

static void fast_and_plain_form_agree(void **unused)
{
  (void)unused;
  for (int kind = 0; kind < KINDS; kind++) {
    Cloud cloud = make_cloud((KernelKind)kind);
    disturb(&cloud);
    cloud.sph.gravity[1] = 9.81;
    cloud.sph.spin = (Spin){{0.1, 0.0, 0.0}, {3.0, 4.0, 5.0}, {100.0, 0.0, 50.0}};
    check_forms_agree(&cloud.sph, &cloud.p, cloud.nb);
    destroy(&cloud);
  }
}

/* A channel that repeats along two axes: pairs across its ends and with its walls. */
static void fast_and_plain_form_agree_at_walls_and_across_ends(void **unused)
{
  (void)unused;
  for (int kind = 0; kind < KINDS; kind++) {
    LatticeTank tank = {.fluid = {10, 10, 8},
                        .box = {10, 10, 8},
                        .layers = 3,
                        .low = {false, false, true},
                        .high = {false, false, true},
                        .sph = melt_parameters((KernelKind)kind)};
    tank.sph.gravity[2] = -9.81;
    if (kind % 2 == 0) tank.sph.spin = (Spin){{5e-3, 5e-3, 0.0}, {0.0, 0.0, 30.0}, {0.0, 0.0, 0.0}};
    if (kind % 2 == 1) tank.sph.wall_pull = 5e4; // half of what some of the melt is under
    lattice_tank_create(&tank);
    Particles *p = &tank.particles;
    uint64_t seed = 17;
    for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
      for (int d = 0; d < 3; d++) {
        p->x[d][i] += 0.3 * spacing * (random_unit(&seed) - 0.5);
        p->v[d][i] = random_unit(&seed) - 0.5;
      }
      p->rho[i] *= 1.0 + 0.08 * (random_unit(&seed) - 0.8); // some is torn
      p->T[i] = 1000.0 + 500.0 * random_unit(&seed);
      p->kappa[i] = 1.0 + 100.0 * random_unit(&seed);
      p->mu[i] = 1e-2 * random_unit(&seed);
    }
    CastError err;
    sph_initialise(&tank.sph, p);
    ok(neighbours_update(tank.neighbours, p, true, NULL, &err), &err);
    for (int step = 0; step < 2; step++) { // then beyond the ends, before they are brought back
      check_forms_agree(&tank.sph, p, tank.neighbours);
      for (ptrdiff_t i = 0; i < p->n_fluid; i++) p->x[0][i] += 0.2 * spacing;
    }
    lattice_tank_destroy(&tank);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pair_forces_conserve_momentum),
      cmocka_unit_test(pair_heat_sums_to_zero),
      cmocka_unit_test(density_diffusion_conserves_mass),
      cmocka_unit_test(a_lone_pair_feels_the_formulas),
      cmocka_unit_test(terms_near_their_bounds_are_counted_right),
      cmocka_unit_test(a_melt_moving_as_one_feels_no_force),
      cmocka_unit_test(a_melt_turning_as_one_keeps_its_density),
      cmocka_unit_test(fast_and_plain_form_agree),
      cmocka_unit_test(fast_and_plain_form_agree_at_walls_and_across_ends),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
