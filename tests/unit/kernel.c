/* Smoothing kernels: integral, slope, support; equation of state. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "cast/kernel/kernel.h"
#include "cast/kernel/pair.h"
#include "tests/support/assert_close.h"

enum { KINDS = 4 };
static const double h = 1.3e-4;

static void every_kernel_integrates_to_one(void **unused)
{
  (void)unused;
  for (int kind = 0; kind < KINDS; kind++) {
    const double reach = kernel_support((KernelKind)kind) * h;
    const int n = 30000; // Simpson's rule, knots on the kernels' breaks: its error is 1e-15 and less
    double sum = 0.0;
    for (int k = 0; k <= n; k++) {
      const double r = reach * k / n, weight = k == 0 || k == n ? 1.0 : k % 2 ? 4.0 : 2.0;
      sum += weight * 4.0 * pair_pi * r * r * kernel_value((KernelKind)kind, r, h);
    }
    assert_close(sum * reach / n / 3.0, 1.0, 1e-10);
  }
}

static void slope_is_minus_the_derivative_over_r(void **unused)
{
  (void)unused;
  for (int kind = 0; kind < KINDS; kind++) {
    const KernelKind k = (KernelKind)kind;
    const double reach = kernel_support(k) * h, step = 1e-5 * h, largest = kernel_slope(k, 0.0, h);
    for (double r = 0.0137 * reach; r < 1.2 * reach; r += 0.0171 * reach) {
      const double difference = (kernel_value(k, r - step, h) - kernel_value(k, r + step, h)) / (2.0 * step * r);
      // central differences of values of 1/h^3 with a step of 1e-5 h, over r
      assert_close(kernel_slope(k, r, h), difference, 1e-8 * largest);
    }
  }
}

static void slope_is_never_negative_and_both_vanish_outside_the_support(void **unused)
{
  (void)unused;
  for (int kind = 0; kind < KINDS; kind++) {
    const KernelKind k = (KernelKind)kind;
    const double reach = kernel_support(k) * h, largest = kernel_value(k, 0.0, h);
    for (int n = 0; n <= 3000; n++) {
      const double r = 1.5 * reach * n / 3000.0;
      // the splines are differences of powers: rounding may leave 1e-13 of the largest near the edge
      assert_true(kernel_slope(k, r, h) >= 0.0);
      assert_true(kernel_value(k, r, h) >= -1e-13 * largest);
      if (r > reach * (1.0 + 1e-12)) {
        assert_true(kernel_slope(k, r, h) == 0.0);
        assert_true(kernel_value(k, r, h) == 0.0);
      }
    }
  }
}

static void slope_is_finite_where_particles_coincide(void **unused)
{
  (void)unused;
  for (int kind = 0; kind < KINDS; kind++) {
    const double at = kernel_slope((KernelKind)kind, 0.0, h), near = kernel_slope((KernelKind)kind, 1e-9 * h, h);
    assert_true(isfinite(at) && at > 0.0);
    assert_close(near / at, 1.0, 1e-8); // F falls by about r/h at most
  }
}

/* What conduction sums: 2 sum_j V_j F_ij (x_j - x_i)^2/2 = 1 along each axis, whence the Laplacian of x^2 is 2. */
static void second_moment_of_the_slope_is_one(void **unused)
{
  (void)unused;
  for (int kind = 0; kind < KINDS; kind++) {
    const double reach = kernel_support((KernelKind)kind) * h;
    const int n = 30000;
    double sum = 0.0;
    for (int k = 0; k <= n; k++) {
      const double r = reach * k / n, weight = k == 0 || k == n ? 1.0 : k % 2 ? 4.0 : 2.0;
      sum += weight * 4.0 / 3.0 * pair_pi * r * r * r * r * kernel_slope((KernelKind)kind, r, h);
    }
    assert_close(sum * reach / n / 3.0, 1.0, 1e-9);
  }
}

static void kernels_are_named_as_in_input_files(void **unused)
{
  (void)unused;
  assert_string_equal(kernel_name(KERNEL_WENDLAND_C2), "wendland-c2");
  assert_string_equal(kernel_name(KERNEL_CUBIC_SPLINE), "cubic-spline");
  assert_string_equal(kernel_name(KERNEL_QUINTIC_SPLINE), "quintic-spline");
  assert_string_equal(kernel_name(KERNEL_LUCY), "lucy");
}

static void tait_pressure_and_density_are_inverse(void **unused)
{
  (void)unused;
  const double rho0 = 6900.0, c0 = 40.0;
  for (double gamma = 1.0; gamma < 8.0; gamma += 3.0)
    for (double rho = 0.97 * rho0; rho < 1.05 * rho0; rho += 0.003 * rho0)
      assert_close(tait_density(tait_pressure(rho, rho0, c0, gamma), rho0, c0, gamma) / rho0, rho / rho0, 1e-14);
  assert_true(tait_pressure(rho0, rho0, c0, 7.0) == 0.0);
}

static void sound_travels_at_c0_at_the_reference_density(void **unused)
{
  (void)unused;
  const double rho0 = 6900.0, c0 = 40.0, step = 1e-5 * rho0;
  for (double gamma = 1.0; gamma < 8.0; gamma += 3.0) {
    const double up = tait_pressure(rho0 + step, rho0, c0, gamma), down = tait_pressure(rho0 - step, rho0, c0, gamma);
    assert_close((up - down) / (2.0 * step) / (c0 * c0), 1.0, 1e-8); // central difference: step^2
  }
}

/* In hydrostatic equilibrium dp = -rho g dz; the density found by integrating that makes diffused_density uniform. */
static void diffused_density_is_uniform_in_a_melt_at_rest(void **unused)
{
  (void)unused;
  const double rho0 = 6900.0, c0 = 12.0, g = 9.81;
  double p = 0.0;
  const int n = 20000;
  const double depth = 0.2, step = depth / n;
  for (int k = 0; k <= n; k++) {
    const double rho = tait_density(p, rho0, c0, 7.0), z = -step * k;
    if (k % 2000 == 0) // against the change of density over the depth, 1 %: 100 kg/m3 and more
      assert_close(diffused_density(rho, rho0, c0, 7.0, -g * z), 0.0, 1e-6);
    const double half = tait_density(p + 0.5 * rho * g * step, rho0, c0, 7.0);
    p += half * g * step; // midpoint rule
  }
  assert_true(tait_density(p, rho0, c0, 7.0) - rho0 > 50.0); // the case is compressible enough to tell
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_kernel_integrates_to_one),
      cmocka_unit_test(slope_is_minus_the_derivative_over_r),
      cmocka_unit_test(slope_is_never_negative_and_both_vanish_outside_the_support),
      cmocka_unit_test(slope_is_finite_where_particles_coincide),
      cmocka_unit_test(second_moment_of_the_slope_is_one),
      cmocka_unit_test(kernels_are_named_as_in_input_files),
      cmocka_unit_test(tait_pressure_and_density_are_inverse),
      cmocka_unit_test(sound_travels_at_c0_at_the_reference_density),
      cmocka_unit_test(diffused_density_is_uniform_in_a_melt_at_rest),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
