/* Contact laws of named surfaces, and couplings that are refused. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/assert_close.h"
#include "tests/support/coupling_case.h"

/* ---- what is refused ---- */

static void expect_refusal(MeltOnMould *melt, const CouplingParameters *parameters, const Surface *surface,
                           CastStatus status, const char *word)
{
  CastError err = {0};
  Coupling *coupling = NULL;
  assert_int_equal(coupling_create(parameters, &melt->sph, melt->rom, surface, &melt->particles, &coupling, &err),
                   status);
  assert_null(coupling);
  if (!strstr(err.message, word)) fail_msg("'%s' says nothing of '%s'", err.message, word);
}

static void impossible_couplings_are_refused(void **state)
{
  (void)state;
  const MeltCase given = coupling_case_bronze(COUPLING_SURFACE, 2000.0);
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  const CouplingParameters none = {.h_contact = 0.0}, nan = {.h_contact = (double)NAN}, good = {.h_contact = 1.0},
                           embedded = {.kind = COUPLING_EMBEDDED, .h_contact = 1.0};
  expect_refusal(&melt, &none, melt.surface, CAST_ERR_INPUT, "h_contact");
  expect_refusal(&melt, &nan, melt.surface, CAST_ERR_INPUT, "h_contact");
  expect_refusal(&melt, &good, NULL, CAST_ERR_ARGUMENT, "surface");
  const size_t n = melt.rom->n_tetrahedra;
  melt.rom->n_tetrahedra = 0;
  expect_refusal(&melt, &embedded, melt.surface, CAST_ERR_INPUT, "band");
  melt.rom->n_tetrahedra = n;
  melt_on_mould_destroy(&melt);
}

/* ---- contact laws ---- */

/* Flow into the only patch after one step, W. */
static double flow_with(CouplingKind kind, double h_contact, const ContactLaws *laws)
{
  MeltCase given = coupling_case_bronze(kind, h_contact);
  given.coupling.contact = laws;
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  melt_on_mould_step(&melt, 1e-5);
  const double flow = coupling_flow(melt.coupling)[0];
  melt_on_mould_destroy(&melt);
  return flow;
}

static void a_named_surface_has_its_own_contact(void **state)
{
  (void)state;
  double T[2] = {1400.0, 1450.0}, h[2] = {1500.0, 1500.0}; // the melt is at 1423 K: 1500 there too
  SurfaceContact top = {.surface = "top", .law = {.h = 500.0}};
  const ContactLaws laws = {.elsewhere = {.h = 3000.0}, .n = 1, .surface = &top};
  const ContactLaws table = {.elsewhere = {.basis = CONTACT_OF_TEMPERATURE, .table = {2, T, h}}};
  for (int kind = COUPLING_SURFACE; kind <= COUPLING_EMBEDDED; kind++) {
    assert_true(flow_with(kind, NAN, &laws) == flow_with(kind, 500.0, NULL));
    assert_true(flow_with(kind, NAN, &table) == flow_with(kind, 1500.0, NULL));
  }
}

/* At 1423 K the table gives 10, but 1e7 a little colder: sub-steps must be ready for that. */
static void sub_steps_are_those_of_the_largest_conductance_that_can_occur(void **state)
{
  (void)state;
  double T[3] = {1380.0, 1400.0, 1420.0}, h[3] = {1e7, 1e7, 10.0};
  const ContactLaws rising = {.elsewhere = {.basis = CONTACT_OF_TEMPERATURE, .table = {3, T, h}}};
  long substeps[2];
  double conductance[2];
  for (int k = 0; k < 2; k++) {
    MeltCase given = coupling_case_bronze(COUPLING_SURFACE, 1e7);
    if (k == 1) given.coupling.contact = &rising;
    MeltOnMould melt;
    melt_on_mould_create(&given, &melt);
    melt_on_mould_step(&melt, 1e-3);
    substeps[k] = coupling_substeps(melt.coupling);
    conductance[k] = coupling_conductance(melt.coupling);
    melt_on_mould_destroy(&melt);
  }
  assert_true(substeps[0] > 1);
  assert_int_equal(substeps[1], substeps[0]);
  assert_close(conductance[1], conductance[0], 1e-12 * conductance[0]);
}

static void contact_laws_that_fit_neither_mould_nor_melt_are_refused(void **state)
{
  (void)state;
  const MeltCase given = coupling_case_bronze(COUPLING_SURFACE, 2000.0);
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  double x[1] = {0.5}, h[1] = {100.0}, zero[1] = {0.0};
  SurfaceContact wrong = {.surface = "pins", .law = {.h = 500.0}};
  const ContactLaws unknown = {.elsewhere = {.h = 1.0}, .n = 1, .surface = &wrong};
  const ContactLaws fraction = {.elsewhere = {.basis = CONTACT_OF_SOLID_FRACTION, .table = {1, x, h}}};
  const ContactLaws nothing = {.elsewhere = {.basis = CONTACT_OF_TEMPERATURE, .table = {1, x, zero}}};
  const CouplingParameters a = {.contact = &unknown}, b = {.contact = &fraction}, c = {.contact = &nothing};
  expect_refusal(&melt, &a, melt.surface, CAST_ERR_INPUT, "it has: top");
  expect_refusal(&melt, &b, melt.surface, CAST_ERR_INPUT, "solid fraction");
  expect_refusal(&melt, &c, melt.surface, CAST_ERR_INPUT, "above zero");
  melt_on_mould_destroy(&melt);
}

static void a_step_without_new_contacts_after_a_rebuild_is_refused(void **state)
{
  (void)state;
  const MeltCase given = coupling_case_bronze(COUPLING_SURFACE, 2000.0);
  MeltOnMould melt;
  melt_on_mould_create(&given, &melt);
  CastError err = {0};
  assert_int_equal(neighbours_update(melt.neighbours, &melt.particles, true, NULL, &err), CAST_OK);
  assert_int_equal(coupling_advance(melt.coupling, melt.mould, &melt.particles, melt.neighbours, 1e-4, &err),
                   CAST_ERR_ARGUMENT);
  assert_non_null(strstr(err.message, "coupling_rebuild"));
  melt_on_mould_destroy(&melt);
}

int main(void)
{
  omp_set_num_threads(1); // too few particles for more
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(impossible_couplings_are_refused),
      cmocka_unit_test(a_named_surface_has_its_own_contact),
      cmocka_unit_test(sub_steps_are_those_of_the_largest_conductance_that_can_occur),
      cmocka_unit_test(contact_laws_that_fit_neither_mould_nor_melt_are_refused),
      cmocka_unit_test(a_step_without_new_contacts_after_a_rebuild_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
