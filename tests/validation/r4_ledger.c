/* R4: the books of melt and mould over 100 000 steps. Melt lost = mould's heat from its state + the integral of its
 * losses; nowhere is the sum of the flows compared with itself. Melt and mould exchange through several patches, the
 * mould loses heat to colder surroundings, particles move about and contacts are made anew. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/support/assert_close.h"
#include "tests/support/melt_on_mould.h"
#include "tests/support/validation.h"

static const double dx = 1e-4, target = 1e-9; // m; of the heat exchanged

static MeltCase ledger_case(CouplingKind kind, RomScheme scheme, double h_contact)
{
  return (MeltCase){.spacing = dx,
                    .corner = {5.0 * dx, 5.0 * dx, 0.0},
                    .count = {5, 5, 4},
                    .slab = {.size = {15.0 * dx, 15.0 * dx},
                             .depth = 2e-3,
                             .kappa = 1.0,
                             .rho = 1800.0,
                             .c = 1100.0,
                             .h_bottom = 200.0,
                             .modes = 12,
                             .modes_lateral = {2, 2},
                             .patches = {2, 2},
                             .band = 0.5e-3,
                             .band_layers = 6,
                             .cells = {1, 1}},
                    .coupling = {.kind = kind, .h_contact = h_contact},
                    .scheme = scheme,
                    .kappa = 30.0,
                    .rho = 7000.0,
                    .c = 560.0,
                    .hot = 1423.0,
                    .preheat = 1073.0,
                    .ambient = 300.0};
}

/* Particles wander to and fro by a quarter of a spacing. */
static void wander(MeltOnMould *melt, int turn)
{
  Particles *p = &melt->particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++)
    for (int d = 0; d < 3; d++) p->x[d][i] += (turn % 2 ? -0.25 : 0.25) * dx * sin(12.9898 * p->id[i] + 4.1414 * d);
  melt_on_mould_rebuild(melt);
}

static void check(const MeltCase *given, const char *name, int steps, bool sub_cycled)
{
  MeltOnMould melt;
  const double start = validation_cpu_time();
  melt_on_mould_create(given, &melt);
  const double dt = 0.5 * melt_on_mould_time_step(&melt);
  double worst = 0.0;
  for (int n = 0; n < steps; n++) {
    if (n % 500 == 250) wander(&melt, n / 500);
    melt_on_mould_step(&melt, dt * (1.0 + 0.5 * sin(0.1 * n)));
    if (n % 1000 != 999) continue;
    const EnergyLedger now = coupling_ledger(melt.coupling, melt.mould, &melt.particles);
    worst = fmax(worst, fabs(now.residual) / now.exchanged);
  }
  const EnergyLedger ledger = coupling_ledger(melt.coupling, melt.mould, &melt.particles);
  assert_true((coupling_substeps(melt.coupling) > 1) == sub_cycled);
  // all columns of the books must take part, or their closing says little
  assert_true(ledger.lost > 0.01 * ledger.exchanged && fabs(ledger.mould_now) > 0.01 * ledger.exchanged);
  const ValidationRow row = {
      "R4",
      validation_text("energy ledger, %s", name),
      "0 J",
      validation_text("%.1e J of %.2g J exchanged", ledger.residual, ledger.exchanged),
      validation_text("%.1e of the heat exchanged", worst),
      "1e-9",
      validation_text("%d steps, %td particles, %zu states", steps, melt.particles.n_fluid, melt.rom->r),
      validation_cpu_time() - start};
  validation_write(&row);
  assert_true(worst < target);
  melt_on_mould_destroy(&melt);
}

static void books_of_surface_coupling_close(void **state)
{
  (void)state;
  const MeltCase given = ledger_case(COUPLING_SURFACE, ROM_EXPONENTIAL, 2000.0);
  check(&given, "`surface`, exponential", 100000, false);
}

static void books_of_embedded_coupling_close(void **state)
{
  (void)state;
  const MeltCase given = ledger_case(COUPLING_EMBEDDED, ROM_EXPONENTIAL, 2000.0);
  check(&given, "`embedded`, exponential", 100000, false);
}

static void books_of_backward_euler_close(void **state)
{
  (void)state;
  const MeltCase given = ledger_case(COUPLING_SURFACE, ROM_BACKWARD_EULER, 2000.0);
  check(&given, "`surface`, backward Euler", 100000, false);
}

static void books_of_a_sub_cycled_exchange_close(void **state)
{
  (void)state;
  MeltCase given = ledger_case(COUPLING_SURFACE, ROM_EXPONENTIAL, (double)INFINITY);
  given.slab.modes = 100;
  given.corner[0] = given.corner[1] = 2.0 * dx; // patches well covered: a stiff exchange
  given.count[0] = given.count[1] = 11;
  given.count[2] = 2;
  check(&given, "`surface`, perfect contact, sub-cycled", 10000, true);
}

int main(void)
{
  omp_set_num_threads(1); // too few particles for more
  validation_begin("R4");
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(books_of_surface_coupling_close),
      cmocka_unit_test(books_of_embedded_coupling_close),
      cmocka_unit_test(books_of_backward_euler_close),
      cmocka_unit_test(books_of_a_sub_cycled_exchange_close),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
