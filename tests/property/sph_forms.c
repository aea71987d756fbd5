/* One binary, several processors: what the loader picks (AVX-512, AVX2, neither) computes the same to rounding. The
 * forms for lesser processors are the same sources compiled for them alone, in programs of their own: sph_forms this
 * test's splash to stdout, as doubles sph_forms PROGRAM..            compares it with theirs Pair terms have 24 bits
 * and their sums' order differs: one evaluation agrees to 2e-6 of the largest rate. Through 50 steps of a splash
 * differences grow; positions agree to 1e-4 spacings. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/lattice_tank.h"

static const double spacing = 1e-3;
enum { SIDE = 8, N = SIDE * SIDE * SIDE, STEPS = 50, RATES = 4 * N, ALL = RATES + 3 * N };

static LatticeTank make_tank(void)
{
  LatticeTank tank = {.fluid = {SIDE, SIDE, SIDE},
                      .box = {SIDE + 4, SIDE + 4, SIDE + 4},
                      .layers = 3,
                      .low = {true, true, true},
                      .high = {true, true, false},
                      .sph = {.kernel = KERNEL_WENDLAND_C2,
                              .h = 1.3 * spacing,
                              .spacing = spacing,
                              .rho0 = 6900.0,
                              .c0 = 15.0,
                              .gamma = 7.0,
                              .delta = 0.1,
                              .alpha = 0.02,
                              .gravity = {0.0, 0.0, -9.81}}};
  lattice_tank_create(&tank);
  Particles *p = &tank.particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const int32_t id = p->id[i];
    p->T[i] = 1000.0 + (double)(id % 13);
    p->kappa[i] = 20.0 + (double)(id % 7);
    p->mu[i] = 5e-3 + 1e-4 * (double)(id % 11);
    p->v[0][i] = 0.3 + 0.01 * (double)(id % 5);
    p->v[2][i] = -0.7 + 0.01 * (double)(id % 3);
  }
  return tank;
}

static void store(const LatticeTank *tank, double *const field[], int fields, double *out)
{
  for (int f = 0; f < fields; f++)
    for (ptrdiff_t i = 0; i < N; i++) out[f * N + tank->particles.id[i]] = field[f][i];
}

/* Rates of the first step, then positions, by id. */
static void compute(double out[ALL])
{
  LatticeTank tank = make_tank();
  const Particles *p = &tank.particles;
  for (int step = 0; step < STEPS; step++) {
    lattice_tank_step(&tank, 1.5e-5);
    if (step == 0) store(&tank, (double *const[]){p->a[0], p->a[1], p->a[2], p->drho}, 4, out);
  }
  store(&tank, (double *const[]){p->x[0], p->x[1], p->x[2]}, 3, out + RATES);
  lattice_tank_destroy(&tank);
}

static int programs;
static char **program;

static double largest(const double *value, ptrdiff_t n)
{
  double most = 0.0;
  for (ptrdiff_t i = 0; i < n; i++) most = fmax(most, fabs(value[i]));
  return most;
}

static double largest_difference(const double *a, const double *b, ptrdiff_t n)
{
  double most = 0.0;
  for (ptrdiff_t i = 0; i < n; i++) most = fmax(most, fabs(a[i] - b[i]));
  return most;
}

static void forms_for_other_processors_agree(void **state)
{
  (void)state;
  static double own[ALL], other[ALL];
  compute(own);
  if (programs == 0) skip(); // not x86-64, or this processor cannot run them
  for (int k = 0; k < programs; k++) {
    FILE *pipe = popen(program[k], "r");
    assert_non_null(pipe);
    assert_int_equal(fread(other, sizeof(double), ALL, pipe), ALL);
    assert_int_equal(pclose(pipe), 0);
    const double a = largest_difference(own, other, 3 * N) / largest(own, 3 * N);
    const double drho = largest_difference(own + 3 * N, other + 3 * N, N) / largest(own + 3 * N, N);
    const double way = largest_difference(own + RATES, other + RATES, 3 * N) / spacing;
    print_message("%s: rates differ by %.1e and %.1e of the largest, places after %d steps by %.1e spacings\n",
                  strrchr(program[k], '/') + 1, a, drho, STEPS, way);
    assert_true(a < 2e-6 && drho < 2e-6);
    assert_true(way < 1e-4);
    assert_true(way > 0.0); // it was another form
  }
}

int main(int argc, char **argv)
{
  if (argc == 1) {
    static double all[ALL];
    compute(all);
    return fwrite(all, sizeof(double), ALL, stdout) == ALL ? 0 : 1;
  }
#ifdef __x86_64__
  program = argv + 1;
  programs = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("avx512vl") ? argc - 1 : 0;
#endif
  const struct CMUnitTest tests[] = {cmocka_unit_test(forms_for_other_processors_agree)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
