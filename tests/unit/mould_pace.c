/* A mould that is stepped less often than the melt: nearly the temperatures of one stepped with it, the same books. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/assert_close.h"
#include "tests/support/melt_on_mould.h"

static const double dx = 1e-4, dt = 5e-6; // m, s

typedef enum Motion { AT_REST, SLIDING, PUSHED } Motion;

/* Aluminium bronze, a block of 12 x 12 x 5 particles on a slab of phosphate with 5 x 5 patches. */
static MeltCase block(double h_contact, double interval)
{
  return (MeltCase){.spacing = dx,
                    .corner = {3.0 * dx, 3.0 * dx},
                    .count = {12, 12, 5},
                    .slab = {.size = {30.0 * dx, 30.0 * dx},
                             .depth = 2e-3,
                             .kappa = 1.0,
                             .rho = 1800.0,
                             .c = 1100.0,
                             .h_bottom = 50.0,
                             .modes = 40,
                             .modes_lateral = {16, 16},
                             .patches = {5, 5}},
                    .coupling = {.kind = COUPLING_SURFACE, .h_contact = h_contact, .mould_interval = interval},
                    .kappa = 30.0,
                    .rho = 7000.0,
                    .c = 560.0,
                    .hot = 1423.0,
                    .preheat = 1073.0,
                    .ambient = 300.0};
}

/* Sliding: two patches in all, a little every tenth step. Pushed: a patch on at once, so that melt is suddenly
 * on dry patches and others are left. */
static void move(MeltOnMould *melt, Motion motion, int n)
{
  double way = 0.0;
  if (motion == SLIDING && n % 10 == 0) way = 0.3 * dx; // 0.6 m/s
  if (motion == PUSHED && n % 150 == 103) way = 6.0 * dx;
  if (way == 0.0) return;
  for (ptrdiff_t i = 0; i < melt->particles.n_fluid; i++) melt->particles.x[0][i] += way;
  melt_on_mould_rebuild(melt);
}

typedef struct Difference { // over the largest rise of any patch
  double at_steps, between; // of the mould
} Difference;

static Difference difference(double h_contact, double interval, Motion motion, int steps)
{
  const MeltCase often = block(h_contact, 0.0), seldom = block(h_contact, interval);
  MeltOnMould a, b;
  Difference found = {0.0, 0.0};
  double rise = 0.0;
  melt_on_mould_create(&often, &a);
  melt_on_mould_create(&seldom, &b);
  for (int n = 0; n < steps; n++) {
    move(&a, motion, n);
    move(&b, motion, n);
    melt_on_mould_step(&a, dt);
    melt_on_mould_step(&b, dt);
    const double *exact = coupling_patch_temperature(a.coupling, a.mould);
    const double *T = coupling_patch_temperature(b.coupling, b.mould);
    double *worst = T == rom_state_patch_temperature(b.mould) ? &found.at_steps : &found.between;
    for (size_t l = 0; l < 25; l++) {
      rise = fmax(rise, fabs(exact[l] - often.preheat));
      *worst = fmax(*worst, fabs(T[l] - exact[l]));
    }
  }
  melt_on_mould_destroy(&a);
  melt_on_mould_destroy(&b);
  return (Difference){found.at_steps / rise, found.between / rise};
}

/* A model is made for an error of a thousandth: this adds a tenth of it, twice that where melt jumps. In between, in
 * the first interval, what goes from patch to patch is missing: with 16 waves across five patches that is a hundredth.
 */
static void patch_temperatures_differ_by_a_tenth_of_the_usual_tolerance(void **state)
{
  (void)state;
  static const struct {
    double h;
    Motion motion;
  } cases[] = {{2000.0, SLIDING}, {20000.0, SLIDING}, {20000.0, PUSHED}};
  for (int k = 0; k < 3; k++) {
    const Difference found = difference(cases[k].h, 10.0 * dt, cases[k].motion, 400);
    assert_true(found.at_steps > 0.0 && found.between > 0.0); // both were seen
    assert_true(found.at_steps < (cases[k].motion == SLIDING ? 1e-4 : 2e-4));
    assert_true(found.between < 1e-2);
  }
}

/* Flows and the courses between are second order. */
static void the_difference_falls_with_the_square_of_the_interval(void **state)
{
  (void)state;
  const Difference longer = difference(20000.0, 16.0 * dt, AT_REST, 160),
                   shorter = difference(20000.0, 8.0 * dt, AT_REST, 160);
  assert_true(longer.at_steps > 3.5 * shorter.at_steps); // 4 but for what dt itself does
}

static void books_close_between_the_steps_of_the_mould(void **state)
{
  (void)state;
  const MeltCase given = block(2000.0, 16.0 * dt);
  MeltOnMould melt;
  bool behind = false;
  melt_on_mould_create(&given, &melt);
  for (int n = 0; n < 75; n++) {
    melt_on_mould_step(&melt, dt);
    const EnergyLedger now = coupling_ledger(melt.coupling, melt.mould, &melt.particles);
    behind = behind || rom_state_time(melt.mould) < ((double)n + 0.5) * dt;
    assert_close(now.residual, 0.0, 1e-12 * fabs(now.melt_start)); // rounding of the melt's own sum
    assert_true(now.exchanged > 0.0);
  }
  assert_true(behind);
  const double before = rom_state_heat(melt.mould);
  coupling_settle(melt.coupling, melt.mould);
  assert_close(rom_state_time(melt.mould), 75.0 * dt, 1e-12 * 75.0 * dt);
  assert_true(rom_state_heat(melt.mould) > before);
  melt_on_mould_destroy(&melt);
}

/* 7 steps into an interval of 16. */
static void a_run_resumed_within_an_interval_has_the_same_bits(void **state)
{
  (void)state;
  const MeltCase given = block(2000.0, 16.0 * dt);
  MeltOnMould a, b;
  melt_on_mould_create(&given, &a);
  melt_on_mould_create(&given, &b);
  for (int n = 0; n < 39; n++) melt_on_mould_step(&a, dt);
  double *mould = malloc(rom_state_size(a.mould) * sizeof *mould);
  double *coupling = malloc(coupling_size(a.coupling) * sizeof *coupling);
  rom_state_save(a.mould, mould);
  coupling_save(a.coupling, coupling);
  rom_state_restore(b.mould, mould);
  coupling_restore(b.coupling, b.mould, coupling);
  memcpy(b.particles.E, a.particles.E, (size_t)a.particles.n * sizeof(double));
  memcpy(b.particles.T, a.particles.T, (size_t)a.particles.n * sizeof(double));
  for (int n = 0; n < 20; n++) {
    melt_on_mould_step(&a, dt);
    melt_on_mould_step(&b, dt);
  }
  assert_memory_equal(rom_state_z(a.mould), rom_state_z(b.mould), a.rom->r * sizeof(double));
  assert_memory_equal(coupling_patch_temperature(a.coupling, a.mould), coupling_patch_temperature(b.coupling, b.mould),
                      a.rom->m * sizeof(double));
  assert_memory_equal(a.particles.E, b.particles.E, (size_t)a.particles.n_fluid * sizeof(double));
  free(mould);
  free(coupling);
  melt_on_mould_destroy(&a);
  melt_on_mould_destroy(&b);
}

/* A twentieth of t_start; what brings the mould below a hundredth of the melt; stability; one step of the melt. */
static void the_interval_is_the_shortest_of_its_limits(void **state)
{
  (void)state;
  const MeltCase given = block(2000.0, (double)INFINITY), stiff = block(1e6, (double)INFINITY);
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  melt_on_mould_step(&melt, dt); // so that there is a contact
  const double numbers = (double)melt.rom->r * (double)melt.rom->m;
  melt.rom->t_start = 1e-3;
  assert_close(coupling_mould_interval(melt.coupling, melt.mould, 100, dt), 5e-5, 1e-12);
  assert_close(coupling_mould_interval(melt.coupling, melt.mould, (ptrdiff_t)(numbers / 30.0) + 1, dt), 5.0 * dt,
               1e-12);
  assert_close(coupling_mould_interval(melt.coupling, melt.mould, (ptrdiff_t)numbers, dt), dt, 1e-15);
  melt.rom->t_start = 0.0; // not known
  assert_close(coupling_mould_interval(melt.coupling, melt.mould, 100, dt), dt, 1e-15);
  melt_on_mould_destroy(&melt);
  melt_on_mould_create(&stiff, &melt);
  melt_on_mould_step(&melt, 1e-8);
  melt.rom->t_start = 1e-3;
  const double interval = coupling_mould_interval(melt.coupling, melt.mould, 100, 1e-7);
  assert_true(interval < 5e-5 && interval > 1e-7);
  assert_true(rom_state_stiffness(melt.mould, coupling_conductance(melt.coupling), interval) <= 0.5);
  melt_on_mould_destroy(&melt);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(patch_temperatures_differ_by_a_tenth_of_the_usual_tolerance),
      cmocka_unit_test(the_difference_falls_with_the_square_of_the_interval),
      cmocka_unit_test(books_close_between_the_steps_of_the_mould),
      cmocka_unit_test(a_run_resumed_within_an_interval_has_the_same_bits),
      cmocka_unit_test(the_interval_is_the_shortest_of_its_limits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
