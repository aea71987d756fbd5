#include "common/units.h"

#include <ctype.h>
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <udunits2.h>

typedef struct Dimension { // a plain word for the dimension of a unit
  const char *unit, *name, *example;
} Dimension;

static const Dimension DIMENSIONS[] = {
    {"1", "a pure number", "0.5"},
    {"rad", "an angle", "130 deg"},
    {"m", "a length", "8 mm"},
    {"s", "a time", "20 ms"},
    {"K", "a temperature", "900 degC"},
    {"m^2", "an area", "4 mm^2"},
    {"m^3", "a volume", "2 cm^3"},
    {"kg", "a mass", "5 g"},
    {"kg/m^3", "a density", "6900 kg/m^3"},
    {"J/kg/K", "a specific heat", "560 J/kg/K"},
    {"W/m/K", "a thermal conductivity", "30 W/m/K"},
    {"W/m^2/K", "a heat transfer coefficient", "2000 W/m^2/K"},
    {"m^2/s", "a diffusivity", "1e-6 m^2/s"},
    {"Pa.s", "a dynamic viscosity", "5 mPa.s"},
    {"m/s", "a velocity", "1 m/s"},
    {"m/s^2", "an acceleration", "9.81 m/s^2"},
    {"Pa", "a pressure", "30 kPa"},
    {"W", "a power", "10 W"},
    {"J", "an energy", "5 J"},
    {"J/kg", "an energy per mass", "230 kJ/kg"},
    {"W/m^3", "a power per volume", "50 J/cm^3/s"},
    {"W/m^2", "a heat flux", "1e5 W/m^2"},
    {"N/m", "a surface tension", "1.25 N/m"},
    {"N", "a force", "1 N"},
    {"1/s", "a rate", "100 1/s"},
    {"rad/s", "an angular velocity", "300 rpm"},
    {"rad/s^2", "an angular acceleration", "20 rad/s^2"},
    {"1/m", "a number per length", "500 1/m"},
    {"m^3/s", "a volume flow", "2 cm^3/s"},
    {"kg/s", "a mass flow", "10 g/s"},
    {"K/s", "a cooling rate", "14 K/s"},
    {"K/m", "a temperature gradient", "5 K/mm"},
};
enum { N_DIMENSIONS = sizeof DIMENSIONS / sizeof *DIMENSIONS };

static ut_system *unit_system;
static pthread_once_t unit_system_once = PTHREAD_ONCE_INIT;

/* udunits knows the degree by other names only; "deg" is what people write. */
static void map_deg(void)
{
  ut_unit *degree = ut_parse(unit_system, "arc_degree", UT_ASCII);
  if (degree) ut_map_symbol_to_unit("deg", UT_ASCII, degree);
  ut_free(degree);
}

static void unit_system_open(void)
{
  ut_set_error_message_handler(ut_ignore);
  unit_system = ut_read_xml(NULL);
  if (unit_system) map_deg();
}

/* Is there an angle in the unit? The definition in base units then holds their symbol "rad". */
static bool has_angle(const ut_unit *unit)
{
  char definition[256];
  const int length = ut_format(unit, definition, sizeof definition, UT_ASCII | UT_DEFINITION);
  return length > 0 && (size_t)length < sizeof definition && strstr(definition, "rad");
}

/* The same dimension, angles included. ut_are_convertible() alone would also take seconds for 1/s and turn them over.
 */
static bool same_dimension(const ut_unit *a, const ut_unit *b)
{
  if (!ut_are_convertible(a, b) || has_angle(a) != has_angle(b)) return false;
  ut_unit *ratio = ut_divide(a, b);
  const bool same = ratio && ut_is_dimensionless(ratio);
  ut_free(ratio);
  return same;
}

static const Dimension *dimension_of(const ut_unit *unit)
{
  for (size_t i = 0; i < N_DIMENSIONS; i++) {
    ut_unit *known = ut_parse(unit_system, DIMENSIONS[i].unit, UT_UTF8);
    const bool same = known && same_dimension(known, unit);
    ut_free(known);
    if (same) return &DIMENSIONS[i];
  }
  return NULL;
}

/* "a length is expected (for example '8 mm')" */
static void expected_text(const ut_unit *to, const char *si_unit, char *text, size_t size)
{
  const Dimension *dimension = dimension_of(to);
  if (dimension)
    snprintf(text, size, "%s is expected (for example '%s')", dimension->name, dimension->example);
  else
    snprintf(text, size, "a quantity in %s is expected", si_unit);
}

static CastStatus convert(const char *text, double number, ut_unit *from, ut_unit *to, double *value, CastError *err)
{
  cv_converter *converter = ut_get_converter(from, to);
  CAST_CHECK(converter, err, CAST_ERR_LIBRARY, "'%s' cannot be converted by udunits-2", text);
  const double converted = cv_convert_double(converter, number);
  cv_free(converter);
  CAST_CHECK(isfinite(converted), err, CAST_ERR_INPUT, "'%s' is too large", text);
  *value = converted;
  return CAST_OK;
}

/* `unit_text` may be empty: no unit. */
static CastStatus convert_to(const char *text, double number, const char *unit_text, ut_unit *to, const char *si_unit,
                             double *value, CastError *err)
{
  char expected[256];
  expected_text(to, si_unit, expected, sizeof expected);
  ut_unit *from = ut_parse(unit_system, unit_text[0] ? unit_text : "1", UT_UTF8);
  CastStatus status;
  if (!from) {
    status = cast_error_set(err, CAST_ERR_INPUT, "'%s': '%s' is not a unit, %s", text, unit_text, expected);
  } else if (same_dimension(from, to)) {
    status = convert(text, number, from, to, value, err);
  } else if (!unit_text[0]) {
    status = cast_error_set(err, CAST_ERR_INPUT, "'%s' has no unit, %s", text, expected);
  } else {
    const Dimension *found = dimension_of(from);
    status = found ? cast_error_set(err, CAST_ERR_INPUT, "'%s' is %s, %s", text, found->name, expected)
                   : cast_error_set(err, CAST_ERR_INPUT, "'%s' has the unit %s, %s", text, unit_text, expected);
  }
  ut_free(from);
  return status;
}

/* Length of the decimal number at the start of text, 0 if there is none or it is not finite: no nan, inf or hex. */
static size_t number_length(const char *text, double *number)
{
  char *end = NULL;
  *number = strtod(text, &end);
  const size_t length = (size_t)(end - text);
  return strspn(text, " 0123456789+-.eE") >= length && isfinite(*number) ? length : 0;
}

/* A unit's only digits are exponents, which follow a letter, '^' or a sign after one of these, and the 1 of "1/s".
 * udunits itself multiplies: it reads "mm 3" as 3 mm and "K @ 5" as a shifted scale. */
static bool digits_are_exponents(const char *unit)
{
  size_t i = 0;
  if (unit[0] == '1') i = 1 + strspn(unit + 1, " ");
  if (i > 0 && unit[i] != '/') return false;
  for (; unit[i]; i++) {
    if (!isdigit((unsigned char)unit[i])) continue;
    size_t before = i;
    while (before > 0 && isdigit((unsigned char)unit[before - 1])) before--;
    if (before > 1 && (unit[before - 1] == '-' || unit[before - 1] == '+')) before--;
    if (before == 0 || !(isalpha((unsigned char)unit[before - 1]) || unit[before - 1] == '^')) return false;
  }
  return true;
}

CastStatus units_convert(const char *text, const char *si_unit, double *value, CastError *err)
{
  pthread_once(&unit_system_once, unit_system_open);
  CAST_CHECK(unit_system, err, CAST_ERR_LIBRARY, "the database of units (udunits-2) cannot be read");
  ut_unit *to = ut_parse(unit_system, si_unit, UT_UTF8);
  CAST_CHECK(to, err, CAST_ERR_ARGUMENT, "'%s' is not a unit that udunits knows", si_unit);
  double number;
  const size_t start = number_length(text, &number);
  const char *unit = text + start + strspn(text + start, " \t");
  size_t length = strlen(unit);
  while (length > 0 && isspace((unsigned char)unit[length - 1])) length--;
  char expected[256], unit_text[128] = "";
  expected_text(to, si_unit, expected, sizeof expected);
  CastStatus status;
  if (start == 0) {
    status =
        cast_error_set(err, CAST_ERR_INPUT, "'%.100s' does not begin with a finite decimal number, %s", text, expected);
  } else if (length >= sizeof unit_text) {
    status = cast_error_set(err, CAST_ERR_INPUT, "'%.40s...': the unit is too long", text);
  } else {
    memcpy(unit_text, unit, length);
    unit_text[length] = '\0';
    status = digits_are_exponents(unit_text)
                 ? convert_to(text, number, unit_text, to, si_unit, value, err)
                 : cast_error_set(err, CAST_ERR_INPUT, "'%s' is not one number with one unit, %s", text, expected);
  }
  ut_free(to);
  return status;
}
