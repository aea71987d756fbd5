/* Quantities with units: what is converted, and that nothing else is. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "common/units.h"
#include "tests/support/assert_close.h"

typedef struct Good {
  const char *text, *unit;
  double value;
} Good;

static const Good GOOD[] = {
    {"8 mm", "m", 8e-3},
    {"8mm", "m", 8e-3},
    {"  8   mm  ", "m", 8e-3},
    {"-9.81 m/s^2", "m/s^2", -9.81},
    {"+1e-3 m", "m", 1e-3},
    {"900 degC", "K", 1173.15},
    {"900 °C", "K", 1173.15},
    {"32 degF", "K", 273.15},
    {"300 K", "K", 300.0},
    {"50 J/cm^3/s", "W/m^3", 5e7},
    {"2000 W/m^2/K", "W/m^2/K", 2000.0},
    {"2000 W/m^2/degC", "W/m^2/K", 2000.0}, // a difference: no shift by 273.15
    {"2 kW m-2 K-1", "W/m^2/K", 2000.0},
    {"30 W/(m K)", "W/m/K", 30.0},
    {"230 kJ/kg", "J/kg", 230e3},
    {"5 mPa.s", "Pa.s", 5e-3},
    {"6.9 g/cm3", "kg/m^3", 6900.0},
    {"7 µm", "m", 7e-6},
    {"2 min", "s", 120.0},
    {"100 1/s", "1/s", 100.0},
    {"5 Hz", "1/s", 5.0},
    {"300 rpm", "rad/s", 300.0 * 2.0 * 3.14159265358979323846 / 60.0},
    {"180 deg", "rad", 3.14159265358979323846},
    {"45 deg/s", "rad/s", 3.14159265358979323846 / 4.0},
    {"0.25", "1", 0.25},
    {"5 %", "1", 0.05},
    {"14 K/s", "K/s", 14.0},
};

static void quantity_with_its_unit_becomes_si(void **state)
{
  (void)state;
  for (size_t i = 0; i < sizeof GOOD / sizeof *GOOD; i++) {
    CastError err = {0};
    double value = NAN;
    if (units_convert(GOOD[i].text, GOOD[i].unit, &value, &err) != CAST_OK)
      fail_msg("'%s': %s", GOOD[i].text, err.message);
    assert_close(value, GOOD[i].value, 1e-14 * fabs(GOOD[i].value)); // a few roundings of factor and offset
  }
}

typedef struct Bad {
  const char *text, *unit, *message;
} Bad;

static const Bad BAD[] = {
    {"3 K", "m", "'3 K' is a temperature, a length is expected (for example '8 mm')"},
    {"8", "m", "'8' has no unit, a length is expected (for example '8 mm')"},
    {"0", "K", "'0' has no unit, a temperature is expected (for example '900 degC')"},
    {"1", "rad", "'1' has no unit, an angle is expected (for example '130 deg')"},
    {"8 mm", "1", "'8 mm' is a length, a pure number is expected (for example '0.5')"},
    {"8 deg", "1", "'8 deg' is an angle, a pure number is expected (for example '0.5')"},
    // udunits alone would take the reciprocal
    {"5 ms", "1/s", "'5 ms' is a time, a rate is expected (for example '100 1/s')"},
    {"2 1/s", "s", "'2 1/s' is a rate, a time is expected (for example '20 ms')"},
    // a factor of 2 pi hides here
    {"300 rpm", "1/s", "'300 rpm' is an angular velocity, a rate is expected (for example '100 1/s')"},
    {"5 Hz", "rad/s", "'5 Hz' is a rate, an angular velocity is expected (for example '300 rpm')"},
    {"30 W/mK", "W/m/K", "'30 W/mK' has the unit W/mK, a thermal conductivity is expected (for example '30 W/m/K')"},
    {"2000 W/m2K", "W/m^2/K",
     "'2000 W/m2K': 'W/m2K' is not a unit, a heat transfer coefficient is expected (for example '2000 W/m^2/K')"},
    {"3 cubits", "m", "'3 cubits': 'cubits' is not a unit, a length is expected (for example '8 mm')"},
    {"3 m/s", "W/K", "'3 m/s' is a velocity, a quantity in W/K is expected"},
    // udunits multiplies and shifts by such numbers
    {"8 3 mm", "m", "'8 3 mm' is not one number with one unit, a length is expected (for example '8 mm')"},
    {"8 mm 3", "m", "'8 mm 3' is not one number with one unit, a length is expected (for example '8 mm')"},
    {"8 m -2", "m", "'8 m -2' is not one number with one unit, a length is expected (for example '8 mm')"},
    {"8 3 m/s", "m/s", "'8 3 m/s' is not one number with one unit, a velocity is expected (for example '1 m/s')"},
    {"8 mm since 2000", "m",
     "'8 mm since 2000' is not one number with one unit, a length is expected (for example '8 mm')"},
    {"8 K @ 5", "K", "'8 K @ 5' is not one number with one unit, a temperature is expected (for example '900 degC')"},
    {"2 1", "1", "'2 1' is not one number with one unit, a pure number is expected (for example '0.5')"},
    {"1,5 mm", "m", "'1,5 mm' is not one number with one unit, a length is expected (for example '8 mm')"},
    {"8 lg(re m)", "m", "'8 lg(re m)' has the unit lg(re m), a length is expected (for example '8 mm')"},
    {"nan m", "m", "'nan m' does not begin with a finite decimal number, a length is expected (for example '8 mm')"},
    {"inf m", "m", "'inf m' does not begin with a finite decimal number, a length is expected (for example '8 mm')"},
    {"1e400 m", "m",
     "'1e400 m' does not begin with a finite decimal number, a length is expected (for example '8 mm')"},
    {"0x10 mm", "m",
     "'0x10 mm' does not begin with a finite decimal number, a length is expected (for example '8 mm')"},
    {"", "m", "'' does not begin with a finite decimal number, a length is expected (for example '8 mm')"},
    {"mm", "m", "'mm' does not begin with a finite decimal number, a length is expected (for example '8 mm')"},
    {"1e308 km", "m", "'1e308 km' is too large"},
};

static void anything_else_is_refused_in_plain_words(void **state)
{
  (void)state;
  for (size_t i = 0; i < sizeof BAD / sizeof *BAD; i++) {
    CastError err = {0};
    double value = 42.0;
    assert_int_equal(units_convert(BAD[i].text, BAD[i].unit, &value, &err), CAST_ERR_INPUT);
    assert_string_equal(err.message, BAD[i].message);
    assert_true(value == 42.0); // untouched
  }
}

static void unit_of_absurd_length_is_refused(void **state)
{
  (void)state;
  char text[4096] = "8 ";
  memset(text + 2, 'm', sizeof text - 3);
  CastError err = {0};
  double value;
  assert_int_equal(units_convert(text, "m", &value, &err), CAST_ERR_INPUT);
  assert_non_null(strstr(err.message, "the unit is too long"));
}

static void caller_that_asks_for_no_unit_breaks_the_contract(void **state)
{
  (void)state;
  CastError err = {0};
  double value;
  assert_int_equal(units_convert("8 mm", "cubits", &value, &err), CAST_ERR_ARGUMENT);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(quantity_with_its_unit_becomes_si),
      cmocka_unit_test(anything_else_is_refused_in_plain_words),
      cmocka_unit_test(unit_of_absurd_length_is_refused),
      cmocka_unit_test(caller_that_asks_for_no_unit_breaks_the_contract),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
