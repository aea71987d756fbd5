/* T(E) undoes E(T), for random monotone curves (fixed seed) and for the materials that come with the programs. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "common/material/material.h"
#include "tests/support/assert_close.h"
#include "tests/support/random_numbers.h"

enum { MAX_POINTS = 200, CURVES = 500, SAMPLES = 200 };

static uint64_t seed;

static double random_between(double low, double high)
{
  return low * pow(high / low, random_unit(&seed)); // even in the logarithm
}

/* Specific heats of 100 to 5000 J/(kg K), latent heat up to 400 kJ/kg in one segment of ten, segments of 0.1 to 100 K.
 */
static Material random_melt(void)
{
  Material melt = {.specific_heat = NAN};
  double T[MAX_POINTS], E[MAX_POINTS];
  const size_t n = 2 + (size_t)(random_unit(&seed) * (MAX_POINTS - 2));
  T[0] = random_between(1.0, 300.0);
  E[0] = 1e6 * (random_unit(&seed) - 0.5);
  for (size_t i = 1; i < n; i++) {
    const double width = random_between(0.1, 100.0);
    T[i] = T[i - 1] + width;
    E[i] =
        E[i - 1] + random_between(100.0, 5000.0) * width + (random_unit(&seed) < 0.1 ? 4e5 * random_unit(&seed) : 0.0);
  }
  CastError err;
  assert_int_equal(table_create(n, T, E, &melt.enthalpy, &err), CAST_OK);
  return melt;
}

/* E reaches 5e7 J/kg and c falls to 100 J/(kg K): rounding of E is worth 5e7 * 2^-53/100 = 6e-11 K at some 1e4 K. */
static const double RELATIVE = 1e-12;

static void check_inverse(const Material *melt)
{
  const Table *curve = &melt->enthalpy;
  const double low = 0.5 * curve->x[0] + 1.0, high = curve->x[curve->n - 1] + 500.0;
  double previous_T = -INFINITY, previous_E = -INFINITY;
  for (int k = 0; k <= SAMPLES; k++) {
    const double T = low + (high - low) * k / SAMPLES, E = material_enthalpy(melt, T);
    assert_close(material_temperature(melt, E), T, RELATIVE * T);
    assert_true(T > previous_T && E > previous_E);
    previous_T = T;
    previous_E = E;
  }
  for (size_t i = 0; i < curve->n; i++) { // the points themselves, from both sides
    assert_close(material_temperature(melt, curve->y[i]), curve->x[i], RELATIVE * curve->x[i]);
    assert_close(material_temperature(melt, nextafter(curve->y[i], INFINITY)), curve->x[i], RELATIVE * curve->x[i]);
    assert_close(material_temperature(melt, nextafter(curve->y[i], -INFINITY)), curve->x[i], RELATIVE * curve->x[i]);
  }
}

static void temperature_undoes_enthalpy_for_random_curves(void **state)
{
  (void)state;
  seed = 20240229;
  for (int i = 0; i < CURVES; i++) {
    Material melt = random_melt();
    check_inverse(&melt);
    table_destroy(&melt.enthalpy);
  }
}

static void no_segment_is_flatter_than_the_least_specific_heat(void **state)
{
  (void)state;
  seed = 7;
  for (int i = 0; i < CURVES; i++) {
    Material melt = random_melt();
    const double least = material_specific_heat_min(&melt);
    for (int k = 0; k < SAMPLES; k++) {
      const double T = random_between(1.0, 5000.0), dT = random_between(1e-2, 100.0);
      const double mean = (material_enthalpy(&melt, T + dT) - material_enthalpy(&melt, T)) / dT;
      assert_true(mean >= least * (1.0 - 1e-6)); // difference of energies up to 5e7 over 0.01 K: 1e-8/100 relative
    }
    table_destroy(&melt.enthalpy);
  }
}

static void temperature_undoes_enthalpy_for_the_shipped_melts(void **state)
{
  (void)state;
  static const char *const MELTS[] = {"cual10", "au57ag25cu13pd4", "a356", "aluminium", "tin", "gallium", "paper-melt"};
  for (size_t i = 0; i < sizeof MELTS / sizeof *MELTS; i++) {
    char text[64];
    snprintf(text, sizeof text, "m: %s\n", MELTS[i]);
    YamlInput *input = NULL;
    CastError err;
    Material melt;
    assert_int_equal(yaml_input_parse(text, "cast.yaml", &input, &err), CAST_OK);
    assert_int_equal(material_read(yaml_get(yaml_root(input), "m"), &melt, &err), CAST_OK);
    assert_int_equal(yaml_input_finish(input, &err), CAST_OK);
    check_inverse(&melt);
    material_destroy(&melt);
    yaml_input_destroy(&input);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(temperature_undoes_enthalpy_for_random_curves),
      cmocka_unit_test(no_segment_is_flatter_than_the_least_specific_heat),
      cmocka_unit_test(temperature_undoes_enthalpy_for_the_shipped_melts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
