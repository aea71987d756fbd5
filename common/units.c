#include "common/units.h"

#include <ctype.h>
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <udunits2.h>

typedef struct Dimension { // a plain word for the dimension of a unit
  const char *unit, *name, *example;
} Dimension;

static const Dimension DIMENSIONS[] = {
    {"1", "a pure number", "0.5"},
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
    {"1/s", "a rate", "100 1/s"},
    {"N", "a force", "1 N"},
};

static ut_system *unit_system;
static pthread_once_t unit_system_once = PTHREAD_ONCE_INIT;

static void unit_system_open(void)
{
  ut_set_error_message_handler(ut_ignore);
  unit_system = ut_read_xml(NULL);
}

static const char *dimension_name(const ut_unit *unit, const char *fallback)
{
  for (size_t i = 0; i < sizeof DIMENSIONS / sizeof *DIMENSIONS; i++) {
    ut_unit *known = ut_parse(unit_system, DIMENSIONS[i].unit, UT_UTF8);
    const int same = known && ut_are_convertible(known, unit);
    ut_free(known);
    if (same) return DIMENSIONS[i].name;
  }
  return fallback;
}

/* Degrees are pure numbers to udunits: an angle asked for must be written as one, and nothing else may be. */
static bool is_angle(const char *unit)
{
  return strcmp(unit, "rad") == 0 || strcmp(unit, "deg") == 0 || strcmp(unit, "degree") == 0 ||
         strcmp(unit, "degrees") == 0 || strcmp(unit, "radian") == 0;
}

static const char *dimension_example(const char *si_unit)
{
  if (is_angle(si_unit)) return "130 deg";
  for (size_t i = 0; i < sizeof DIMENSIONS / sizeof *DIMENSIONS; i++)
    if (strcmp(DIMENSIONS[i].unit, si_unit) == 0) return DIMENSIONS[i].example;
  return si_unit;
}

static CastStatus convert_with_unit(const char *text, const char *unit_text, const char *si_unit, double *value,
                                    CastError *err)
{
  ut_unit *to = ut_parse(unit_system, si_unit, UT_UTF8);
  const bool angle = is_angle(unit_text), angle_expected = is_angle(si_unit);
  const bool degrees = angle && unit_text[0] == 'd'; // udunits knows "deg" by another name
  ut_unit *from = ut_parse(unit_system, degrees ? "arc_degree" : unit_text, UT_UTF8);
  CastStatus status = CAST_OK;
  if (!to) {
    status = cast_error_set(err, CAST_ERR_ARGUMENT, "'%s' is not a unit that udunits knows", si_unit);
  } else if (!from) {
    status = cast_error_set(err, CAST_ERR_INPUT, "'%s': '%s' is not a unit, %s is expected, for example '%s'", text,
                            unit_text, dimension_name(to, si_unit), dimension_example(si_unit));
  } else if (!ut_are_convertible(from, to) || angle != angle_expected) {
    const char *found = angle ? "an angle" : dimension_name(from, "of another dimension");
    const char *expected = angle_expected ? "an angle" : dimension_name(to, "another dimension");
    status = cast_error_set(err, CAST_ERR_INPUT, "'%s' is %s, %s is expected (for example '%s')", text, found, expected,
                            dimension_example(si_unit));
  } else {
    cv_converter *converter = ut_get_converter(from, to);
    *value = cv_convert_double(converter, *value);
    cv_free(converter);
  }
  ut_free(from);
  ut_free(to);
  return status;
}

CastStatus units_convert(const char *text, const char *si_unit, double *value, CastError *err)
{
  pthread_once(&unit_system_once, unit_system_open);
  CAST_CHECK(unit_system, err, CAST_ERR_LIBRARY, "the database of units (udunits-2) cannot be read");
  char *end = NULL;
  *value = strtod(text, &end);
  CAST_CHECK(end != text, err, CAST_ERR_INPUT, "'%s' is not a number with a unit, for example '%s'", text,
             dimension_example(si_unit));
  CAST_CHECK(isfinite(*value), err, CAST_ERR_INPUT, "'%s' is not a finite number", text);
  while (isspace((unsigned char)*end)) end++;
  const int pure = strcmp(si_unit, "1") == 0;
  if (*end == '\0') {
    CAST_CHECK(pure, err, CAST_ERR_INPUT, "'%s' has no unit: write for example '%s'", text,
               dimension_example(si_unit));
    return CAST_OK;
  }
  char unit[128];
  size_t length = strlen(end);
  while (length > 0 && isspace((unsigned char)end[length - 1])) length--;
  CAST_CHECK(length < sizeof unit, err, CAST_ERR_INPUT, "'%.40s...': the unit is too long", text);
  memcpy(unit, end, length);
  unit[length] = '\0';
  // "8 3 mm" would be read by udunits as a unit of 3 mm
  CAST_CHECK(!(isdigit((unsigned char)unit[0]) && !strchr(unit, '/')), err, CAST_ERR_INPUT,
             "'%s': one number with a unit is expected, for example '%s'", text, dimension_example(si_unit));
  return convert_with_unit(text, unit, si_unit, value, err);
}
