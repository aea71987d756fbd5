/* When each particle froze: crossings between updates, remelting, what a checkpoint keeps. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "cast/results/freezing.h"
#include "tests/support/assert_close.h"

static double T_range[2] = {1000.0, 1100.0}, fractions[2] = {1.0, 0.0};
static const Material melt = {.liquidus = 1100.0,
                              .solidus = 1000.0,
                              .solid_fraction = {2, T_range, fractions},
                              .arm_spacing_at_1s = 10e-6,
                              .arm_spacing_exponent = 0.5};

static Particles two_particles(void)
{
  static double x[3][2];
  double *const places[3] = {x[0], x[1], x[2]};
  Particles p;
  CastError err;
  assert_int_equal(particles_create(2, places, 1e-3, 7000.0, NULL, &p, &err), CAST_OK);
  return p;
}

static Freezing *start(const Material *of, Particles *p)
{
  CastError err;
  Freezing *f = NULL;
  assert_int_equal(freezing_create(of, 2, &f, &err), CAST_OK);
  p->T[0] = 1150.0;
  p->T[1] = 1200.0;
  freezing_update(f, p, 0.0);
  return f;
}

static void update(Freezing *f, Particles *p, double time, double first, double second)
{
  p->T[p->id[0] == 0 ? 0 : 1] = first;
  p->T[p->id[0] == 0 ? 1 : 0] = second;
  freezing_update(f, p, time);
}

static void times_lie_between_the_updates_and_follow_the_particle_not_its_place(void **state)
{
  (void)state;
  Particles p = two_particles();
  Freezing *f = start(&melt, &p);
  update(f, &p, 1.0, 1050.0, 1190.0); // falls through 1100 half-way
  assert_close(freezing_value(f, FREEZING_LIQUIDUS_TIME, 0), 0.5, 1e-12);
  assert_true(isnan(freezing_value(f, FREEZING_SOLIDUS_TIME, 0)));
  assert_true(isnan(freezing_value(f, FREEZING_LIQUIDUS_TIME, 1)));
  p.id[0] = 1; // re-sorted
  p.id[1] = 0;
  update(f, &p, 3.0, 950.0, 990.0); // the second falls through both in one step, from 1190 to 990
  assert_close(freezing_value(f, FREEZING_SOLIDUS_TIME, 0), 2.0, 1e-12);
  assert_close(freezing_value(f, FREEZING_SOLIDIFICATION_TIME, 0), 1.5, 1e-12);
  assert_close(freezing_value(f, FREEZING_COOLING_RATE, 0), 100.0 / 1.5, 1e-9);
  assert_close(freezing_value(f, FREEZING_LIQUIDUS_TIME, 1), 1.9, 1e-12);
  assert_close(freezing_value(f, FREEZING_SOLIDUS_TIME, 1), 2.9, 1e-12);
  freezing_destroy(&f);
  assert_null(f);
  particles_destroy(&p);
}

static void what_remelts_freezes_anew(void **state)
{
  (void)state;
  Particles p = two_particles();
  Freezing *f = start(&melt, &p);
  update(f, &p, 1.0, 950.0, 950.0);
  update(f, &p, 2.0, 1050.0, 1150.0); // the first half-melts, the second melts
  assert_close(freezing_value(f, FREEZING_LIQUIDUS_TIME, 0), 0.25, 1e-12);
  assert_true(isnan(freezing_value(f, FREEZING_SOLIDUS_TIME, 0)));
  assert_true(isnan(freezing_value(f, FREEZING_LIQUIDUS_TIME, 1)));
  update(f, &p, 3.0, 950.0, 1050.0);
  assert_close(freezing_value(f, FREEZING_SOLIDUS_TIME, 0), 2.5, 1e-12);
  assert_close(freezing_value(f, FREEZING_LIQUIDUS_TIME, 1), 2.5, 1e-12);
  assert_true(freezing_value(f, FREEZING_REMELTED, 0) == 1.0);
  update(f, &p, 4.0, 1010.0, 1010.0); // the second was never solid
  assert_true(freezing_value(f, FREEZING_REMELTED, 0) == 2.0);
  assert_true(freezing_value(f, FREEZING_REMELTED, 1) == 1.0);
  freezing_destroy(&f);
  particles_destroy(&p);
}

static void the_rate_at_the_end_is_that_of_the_last_fifth_and_arms_follow_the_local_time(void **state)
{
  (void)state;
  Particles p = two_particles();
  Freezing *f = start(&melt, &p);
  update(f, &p, 1.0, 1050.0, 1190.0); // 1100 at 0.5 s
  update(f, &p, 2.0, 1020.0, 1180.0); // the last fifth begins at 2 s
  update(f, &p, 6.0, 980.0, 1170.0);  // 1000 at 4 s
  assert_close(freezing_value(f, FREEZING_FINAL_RATE, 0), 20.0 / 2.0, 1e-12);
  assert_close(freezing_value(f, FREEZING_COOLING_RATE, 0), 100.0 / 3.5, 1e-12);
  assert_close(freezing_value(f, FREEZING_ARM_SPACING, 0), 10e-6 * sqrt(3.5), 1e-15);
  assert_true(isnan(freezing_value(f, FREEZING_GRADIENT, 0))); // nobody asked for gradients
  assert_true(isnan(freezing_value(f, FREEZING_NIYAMA, 0)));
  freezing_destroy(&f);
  particles_destroy(&p);
}

static void a_checkpoint_keeps_it_all(void **state)
{
  (void)state;
  Particles p = two_particles();
  Freezing *f = start(&melt, &p), *g = start(&melt, &p);
  update(f, &p, 1.0, 1050.0, 1190.0);
  double buffer[32];
  assert_true(freezing_size(f) <= 32);
  freezing_save(f, buffer);
  freezing_restore(g, buffer);
  update(g, &p, 3.0, 950.0, 990.0);
  assert_close(freezing_value(g, FREEZING_SOLIDIFICATION_TIME, 0), 1.5, 1e-12);
  assert_close(freezing_value(g, FREEZING_FINAL_RATE, 0), 50.0, 1e-12);
  assert_close(freezing_value(g, FREEZING_SOLIDUS_TIME, 1), 2.9, 1e-12);
  freezing_destroy(&f);
  freezing_destroy(&g);
  particles_destroy(&p);
}

static void what_has_no_freezing_range_never_freezes(void **state)
{
  (void)state;
  const Material wax = {.liquidus = (double)NAN, .solidus = (double)NAN};
  Particles p = two_particles();
  Freezing *f = start(&wax, &p);
  update(f, &p, 1.0, 10.0, 10.0);
  for (int k = 0; k < FREEZING_FIELDS; k++) assert_true(isnan(freezing_value(f, (FreezingField)k, 0)));
  freezing_destroy(&f);
  particles_destroy(&p);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(times_lie_between_the_updates_and_follow_the_particle_not_its_place),
      cmocka_unit_test(what_remelts_freezes_anew),
      cmocka_unit_test(the_rate_at_the_end_is_that_of_the_last_fifth_and_arms_follow_the_local_time),
      cmocka_unit_test(a_checkpoint_keeps_it_all),
      cmocka_unit_test(what_has_no_freezing_range_never_freezes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
