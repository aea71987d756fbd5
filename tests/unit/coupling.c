/* Heat between melt and mould: conserved to rounding, stable, in the books. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/assert_close.h"
#include "tests/support/coupling_case.h"

static const double dx = COUPLING_CASE_SPACING;

/* ---- what is exchanged ---- */

static void what_the_melt_loses_the_patches_get(void **state)
{
  (void)state;
  for (int kind = 0; kind < 2; kind++) {
    const MeltCase given = coupling_case_block((CouplingKind)kind, 12, 6);
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    coupling_case_shake(&melt, 0.3);
    coupling_case_exchange(&melt);
    double fluid = 0.0, size = 0.0;
    for (ptrdiff_t i = 0; i < melt.particles.n_fluid; i++) {
      fluid += melt.particles.heat[i];
      size += fabs(melt.particles.heat[i]);
    }
    assert_true(size > 0.0);
    assert_close(fluid + coupling_case_flow(&melt), 0.0, 1e-14 * size); // rounding of some thousand terms
    melt_on_mould_destroy(&melt);
  }
}

/* Melt that conducts so well that only the contact resists: q = h A (T_melt - T_mould). */
static void contact_resistance_alone_gives_h_area_difference(void **state)
{
  (void)state;
  for (int kind = 0; kind < 2; kind++) {
    MeltCase given = coupling_case_bronze((CouplingKind)kind, 2000.0);
    given.kappa = given.slab.kappa = 1e7;
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    coupling_case_exchange(&melt);
    const double area = 64.0 * dx * dx, exact = 2000.0 * area * 350.0;
    // surface: areas add up to the wetted area. embedded: as good as sums over particles stand for integrals
    assert_close(coupling_flow(melt.coupling)[0], exact, (kind == 0 ? 1e-6 : 0.01) * exact);
    assert_close(coupling_flow(melt.coupling)[1], 0.0, 0.0); // the outer patches get nothing
    melt_on_mould_destroy(&melt);
  }
}

/* With the volumes of whole cells, dx^3, a half-filled uppermost layer would count for twice the wall. */
static void embedded_flux_does_not_depend_on_where_the_wall_cuts_the_lattice(void **state)
{
  (void)state;
  const double shifts[] = {0.1, 0.3, 0.5, 0.7, 0.9};
  for (size_t s = 0; s < sizeof shifts / sizeof *shifts; s++) {
    MeltCase given = coupling_case_bronze(COUPLING_EMBEDDED, 2000.0);
    given.kappa = given.slab.kappa = 1e7;
    given.shift = shifts[s];
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    coupling_case_exchange(&melt);
    const double exact = 2000.0 * 64.0 * dx * dx * 350.0;
    assert_close(coupling_flow(melt.coupling)[0], exact, 0.035 * exact); // sums over particles for integrals
    melt_on_mould_destroy(&melt);
  }
}

/* A linear temperature through melt, contact and mould carries kappa dT/dz everywhere. */
static void embedded_flux_of_a_linear_temperature_is_kappa_times_its_slope(void **state)
{
  (void)state;
  MeltCase given = coupling_case_bronze(COUPLING_EMBEDDED, 10000.0);
  given.slab.h_bottom = 2000.0; // with a steady flow the mould's temperature is linear
  given.ambient = given.preheat;
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  const double area = 64.0 * dx * dx, flux = 1e5, q[] = {flux * area, 0.0, 0.0};
  for (int n = 0; n < 100; n++) rom_state_step(melt.mould, q, 1e3);
  const double wall = given.preheat + flux * (1.0 / 2000.0 + 2e-3 / 1.0);
  Particles *p = &melt.particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++)
    p->E[i] = material_enthalpy(&melt.melt, wall + flux * (1.0 / 10000.0 + p->x[2][i] / 30.0));
  sph_initialise(&melt.sph, p);
  coupling_case_exchange(&melt);
  assert_close(coupling_flow(melt.coupling)[0], flux * area, 0.01 * flux * area); // sums over particles for integrals
  melt_on_mould_destroy(&melt);
}

static void embedded_walls_have_the_mould_s_temperature_at_their_place(void **state)
{
  (void)state;
  const MeltCase given = coupling_case_bronze(COUPLING_EMBEDDED, 2000.0);
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  const double q[] = {0.05, 0.0, 0.0};
  rom_state_step(melt.mould, q, 0.5);
  coupling_case_exchange(&melt);
  const Particles *p = &melt.particles;
  double *points = malloc(melt.rom->n_points * sizeof *points);
  rom_state_point_temperature(melt.mould, points);
  const double rise = rom_state_patch_temperature(melt.mould)[0] - given.preheat, layer = 0.6e-3 / 24;
  assert_true(rise > 10.0);
  for (ptrdiff_t k = 0; k < p->n - p->n_fluid; k++) {
    if (p->depth[k] > 2.0 * dx) continue; // beyond reach of the melt: shown with the patch's temperature
    double nearest = INFINITY, T = 0.0;   // point of the mesh at the depth of this particle: layers are uniform
    for (size_t n = 0; n < melt.rom->n_points; n++) {
      const double off = fabs(melt.rom->points[3 * n + 2] - p->x[2][p->n_fluid + k]);
      if (off < nearest) {
        nearest = off;
        T = points[n];
      }
    }
    assert_true(nearest < 1e-3 * layer || nearest < 0.51 * layer);
    // half a layer off at most, on a slope of rise/(1 mm) or less
    assert_close(p->T[p->n_fluid + k], T, 2e-5 * rise + rise * nearest / 0.4e-3);
  }
  free(points);
  melt_on_mould_destroy(&melt);
}

static void a_cold_melt_takes_heat_from_the_mould(void **state)
{
  (void)state;
  MeltCase given = coupling_case_bronze(COUPLING_SURFACE, 2000.0);
  given.hot = 900.0;
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  melt_on_mould_step(&melt, 1e-3);
  assert_true(coupling_flow(melt.coupling)[0] < 0.0);
  assert_true(rom_state_patch_temperature(melt.mould)[0] < given.preheat);
  assert_true(melt_on_mould_temperature(&melt, 0.5 * dx) > 900.0);
  melt_on_mould_destroy(&melt);
}

/* Melt that rises by a tenth of a spacing, between two rebuilds: its distance follows. */
static void distances_follow_the_melt_between_rebuilds(void **state)
{
  (void)state;
  MeltCase given = coupling_case_bronze(COUPLING_SURFACE, (double)INFINITY);
  given.layers = 1;
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  coupling_case_exchange(&melt);
  const double before = coupling_case_flow(&melt);
  for (ptrdiff_t i = 0; i < melt.particles.n_fluid; i++) melt.particles.x[2][i] += 0.1 * dx;
  coupling_case_exchange(&melt);
  assert_close(coupling_case_flow(&melt), before * 0.5 / 0.6, 1e-9 * before); // kappa A dT/d
  melt_on_mould_destroy(&melt);
}

static void an_empty_mould_exchanges_nothing(void **state)
{
  (void)state;
  for (int kind = 0; kind < 2; kind++) {
    const MeltCase given = coupling_case_block((CouplingKind)kind, 0, 0);
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    CastError err = {0};
    assert_int_equal(coupling_advance(melt.coupling, melt.mould, &melt.particles, melt.neighbours, 1e-3, &err),
                     CAST_OK);
    assert_true(coupling_case_flow(&melt) == 0.0 && coupling_case_wetted(&melt) == 0.0);
    assert_true(rom_state_time(melt.mould) == 1e-3);
    melt_on_mould_destroy(&melt);
  }
}

/* ---- stability ---- */

/* Perfect contact of a good conductor: the plain exchange swings with growing size, sub-steps follow the exact
 * contact. */
static MeltCase stiff_case(void)
{
  MeltCase given = coupling_case_bronze(COUPLING_SURFACE, (double)INFINITY);
  given.layers = 40;
  given.slab.modes = 4000;
  given.slab.h_bottom = 0.0;
  return given;
}

static void a_stiff_exchange_blows_up_without_sub_steps(void **state)
{
  (void)state;
  const MeltCase given = stiff_case();
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  const double dt = 0.25 * melt_on_mould_time_step(&melt); // the particles alone are stable
  double stiffness = 0.0, most = 0.0;
  for (int n = 0; n < 40; n++) {
    sph_rates(&melt.sph, &melt.particles, melt.neighbours);
    coupling_exchange(melt.coupling, melt.mould, &melt.particles, melt.neighbours);
    if (n == 0) assert_false(coupling_check_stability(melt.coupling, melt.mould, dt, &stiffness));
    coupling_step_mould(melt.coupling, melt.mould, &melt.particles, dt);
    CastError err = {0};
    if (sph_finish(&melt.sph, &melt.particles, dt, &err) != CAST_OK) break; // colder than 0 K
    most = fmax(most, rom_state_patch_temperature(melt.mould)[0]);
  }
  assert_true(stiffness > 1.0);
  assert_true(most > given.hot + 1000.0); // hotter than anything was
  melt_on_mould_destroy(&melt);
}

static void a_stiff_exchange_is_right_with_sub_steps(void **state)
{
  (void)state;
  const MeltCase given = stiff_case();
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  const double dt = melt_on_mould_time_step(&melt), e_melt = sqrt(30.0 * 7000.0 * 560.0),
               e_mould = sqrt(1800.0 * 1100.0);
  const double exact = (e_melt * given.hot + e_mould * given.preheat) / (e_melt + e_mould);
  while (melt.time < 0.01) {
    melt_on_mould_step(&melt, dt);
    assert_true(rom_state_patch_temperature(melt.mould)[0] < given.hot);
  }
  assert_true(coupling_substeps(melt.coupling) > 1);
  assert_close(rom_state_patch_temperature(melt.mould)[0], exact, 0.005 * 350.0); // row H4
  melt_on_mould_destroy(&melt);
}

/* A step so long that a plain exchange would take more from a particle than it has to give. */
static void sub_steps_keep_a_particle_above_the_wall_s_temperature(void **state)
{
  (void)state;
  MeltCase given = coupling_case_bronze(COUPLING_SURFACE, 1e5);
  given.coupling.mould_frozen = true;
  given.layers = 1;
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  const double contact = coupling_contact_area(melt.coupling, 0) / 64.0 / (1e-5 + 0.5 * dx / 30.0);
  const double rate = contact / (7000.0 * 560.0 * dx * dx * dx), dt = 3.0 / rate;
  melt_on_mould_step(&melt, dt);
  assert_true(coupling_substeps(melt.coupling) >= 6);
  const double T = melt_on_mould_temperature(&melt, 0.5 * dx), n = (double)coupling_substeps(melt.coupling);
  assert_close(T, given.preheat + 350.0 * pow(1.0 - rate * dt / n, n), 1e-9); // explicit sub-steps of one layer
  melt_on_mould_destroy(&melt);
}

static void stiffness_of_a_covered_patch_is_conductance_times_step_response(void **state)
{
  (void)state;
  const MeltCase given = coupling_case_bronze(COUPLING_SURFACE, 2000.0);
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  coupling_case_exchange(&melt);
  double stiffness;
  assert_true(coupling_check_stability(melt.coupling, melt.mould, 1e-4, &stiffness));
  const double expected = rom_state_stiffness(melt.mould, coupling_conductance(melt.coupling), 1e-4);
  assert_close(stiffness, expected, 1e-9 * expected);
  melt_on_mould_destroy(&melt);
}

/* ---- books ---- */

static void a_frozen_mould_keeps_its_temperature_and_the_books_close(void **state)
{
  (void)state;
  MeltCase given = coupling_case_bronze(COUPLING_SURFACE, 2000.0);
  given.coupling.mould_frozen = true;
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  for (int n = 0; n < 50; n++) melt_on_mould_step(&melt, 1e-4);
  assert_true(rom_state_patch_temperature(melt.mould)[0] == given.preheat);
  const EnergyLedger ledger = coupling_ledger(melt.coupling, melt.mould, &melt.particles);
  assert_true(ledger.exchanged > 0.0 && ledger.mould_now == 0.0);
  assert_close(ledger.residual, 0.0, 1e-9 * ledger.exchanged);
  melt_on_mould_destroy(&melt);
}

static void melt_that_leaves_is_in_the_books(void **state)
{
  (void)state;
  const MeltCase given = coupling_case_block(COUPLING_SURFACE, 6, 3);
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  for (int n = 0; n < 20; n++) melt_on_mould_step(&melt, 1e-4);
  Particles *p = &melt.particles;
  coupling_record_removed(melt.coupling, p->mass[p->n_fluid - 1] * p->E[p->n_fluid - 1]);
  p->mass[p->n_fluid - 1] = 0.0;
  const EnergyLedger ledger = coupling_ledger(melt.coupling, melt.mould, p);
  assert_true(ledger.removed > 100.0 * ledger.exchanged / 108.0);
  assert_close(ledger.residual, 0.0, 1e-9 * ledger.exchanged);
  melt_on_mould_destroy(&melt);
}

static void books_saved_and_restored_go_on(void **state)
{
  (void)state;
  const MeltCase given = coupling_case_bronze(COUPLING_SURFACE, 2000.0);
  MeltOnMould melt, other;
  melt_on_mould_create(&given, &melt);
  melt_on_mould_create(&given, &other);
  for (int n = 0; n < 20; n++) melt_on_mould_step(&melt, 1e-4);
  double *buffer = malloc(coupling_size(melt.coupling) * sizeof *buffer);
  coupling_save(melt.coupling, buffer);
  coupling_restore(other.coupling, melt.mould, buffer);
  free(buffer);
  const EnergyLedger a = coupling_ledger(melt.coupling, melt.mould, &melt.particles);
  const EnergyLedger b = coupling_ledger(other.coupling, melt.mould, &melt.particles);
  assert_memory_equal(&a, &b, sizeof a);
  melt_on_mould_destroy(&melt);
  melt_on_mould_destroy(&other);
}

static void the_exchange_has_the_same_bits_on_any_number_of_threads(void **state)
{
  (void)state;
  for (int kind = 0; kind < 2; kind++) {
    double *heat[2], *flow[2];
    size_t n = 0, m = 0;
    for (int run = 0; run < 2; run++) {
      omp_set_num_threads(run == 0 ? 1 : 3);
      const MeltCase given = coupling_case_block((CouplingKind)kind, 12, 4);
      MeltOnMould melt;
      melt_on_mould_create(&given, &melt);
      coupling_case_shake(&melt, 0.3);
      for (int step = 0; step < 5; step++) melt_on_mould_step(&melt, 1e-4);
      n = (size_t)melt.particles.n_fluid;
      m = melt.rom->m;
      heat[run] = malloc(n * sizeof(double));
      flow[run] = malloc(m * sizeof(double));
      memcpy(heat[run], melt.particles.E, n * sizeof(double));
      memcpy(flow[run], coupling_flow(melt.coupling), m * sizeof(double));
      melt_on_mould_destroy(&melt);
    }
    assert_memory_equal(heat[0], heat[1], n * sizeof(double));
    assert_memory_equal(flow[0], flow[1], m * sizeof(double));
    for (int run = 0; run < 2; run++) {
      free(heat[run]);
      free(flow[run]);
    }
    omp_set_num_threads(1);
  }
}

int main(void)
{
  omp_set_num_threads(1); // too few particles for more
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_the_melt_loses_the_patches_get),
      cmocka_unit_test(contact_resistance_alone_gives_h_area_difference),
      cmocka_unit_test(embedded_flux_does_not_depend_on_where_the_wall_cuts_the_lattice),
      cmocka_unit_test(embedded_flux_of_a_linear_temperature_is_kappa_times_its_slope),
      cmocka_unit_test(embedded_walls_have_the_mould_s_temperature_at_their_place),
      cmocka_unit_test(a_cold_melt_takes_heat_from_the_mould),
      cmocka_unit_test(distances_follow_the_melt_between_rebuilds),
      cmocka_unit_test(an_empty_mould_exchanges_nothing),
      cmocka_unit_test(a_stiff_exchange_blows_up_without_sub_steps),
      cmocka_unit_test(a_stiff_exchange_is_right_with_sub_steps),
      cmocka_unit_test(sub_steps_keep_a_particle_above_the_wall_s_temperature),
      cmocka_unit_test(stiffness_of_a_covered_patch_is_conductance_times_step_response),
      cmocka_unit_test(a_frozen_mould_keeps_its_temperature_and_the_books_close),
      cmocka_unit_test(melt_that_leaves_is_in_the_books),
      cmocka_unit_test(books_saved_and_restored_go_on),
      cmocka_unit_test(the_exchange_has_the_same_bits_on_any_number_of_threads),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
