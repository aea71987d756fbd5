/* Orders in time of the mould's two schemes under a flow that changes within the step, on the exact modes of a slab. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "cast/mould/rom_state.h"
#include "tests/support/assert_close.h"
#include "tests/support/synthetic_rom.h"

static const double end = 2.0, rate = 3.0; // s, rad/s

/* int_0^end exp(-lambda (end - t)) sin(rate t) dt */
static double driven_mode(double lambda)
{
  return (lambda * sin(rate * end) - rate * cos(rate * end) + rate * exp(-lambda * end)) /
         (lambda * lambda + rate * rate);
}

/* Error, K, of the top's temperature after `steps` steps of 1 W sin(rate t), each step taking the flow at the share
 * `at` of the step. */
static double top_error(RomScheme scheme, double at, int steps)
{
  const SyntheticSlab slab = {
      .size = {1e-3, 1e-3}, .depth = 2e-3, .kappa = 1.0, .rho = 1800.0, .c = 1100.0, .modes = 6};
  CastError err = {0};
  RomData *rom = NULL;
  RomState *state = NULL;
  if (synthetic_rom_slab(&slab, &rom, &err) != CAST_OK) fail_msg("%s", err.message);
  if (rom_state_create(rom, scheme, 0.0, 0.0, &state, &err) != CAST_OK) fail_msg("%s", err.message);
  const double dt = end / steps;
  double q[] = {0.0, 0.0, 0.0}, exact = 0.0;
  for (int n = 0; n < steps; n++) {
    q[0] = sin(rate * (n + at) * dt);
    rom_state_step(state, q, dt);
  }
  for (size_t k = 0; k < rom->r; k++) exact += rom->B[k * rom->m] * rom->B[k * rom->m] * driven_mode(rom->lambda[k]);
  const double error = fabs(rom_state_patch_temperature(state)[0] - exact);
  rom_state_destroy(&state);
  rom_destroy(&rom);
  return error;
}

static double order(RomScheme scheme, double at)
{
  return log2(top_error(scheme, at, 512) / top_error(scheme, at, 1024));
}

static void backward_euler_converges_with_order_one(void **state)
{
  (void)state;
  assert_close(order(ROM_BACKWARD_EULER, 1.0), 1.0, 0.05); // the leading error term dominates at these steps
}

static void exponential_scheme_with_flows_of_the_step_s_start_converges_with_order_one(void **state)
{
  (void)state;
  assert_close(order(ROM_EXPONENTIAL, 0.0), 1.0, 0.05); // the staggered exchange: flows are half a step old
}

static void exponential_scheme_with_flows_of_the_step_s_middle_converges_with_order_two(void **state)
{
  (void)state;
  assert_close(order(ROM_EXPONENTIAL, 0.5), 2.0, 0.05);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(backward_euler_converges_with_order_one),
      cmocka_unit_test(exponential_scheme_with_flows_of_the_step_s_start_converges_with_order_one),
      cmocka_unit_test(exponential_scheme_with_flows_of_the_step_s_middle_converges_with_order_two),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
