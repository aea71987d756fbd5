/* units.h - quantities with their unit as text, through udunits-2. SI inside, everywhere. */
#ifndef COMMON_UNITS_H
#define COMMON_UNITS_H

#include "common/error.h"

/* Convert text such as "8 mm", "900 degC" or "50 J/cm^3/s" to `si_unit` (a udunits string such as "m", "K",
 * "W/m^2/K", "1" for a pure number).
 *   value  out, in si_unit
 * Errors: CAST_ERR_INPUT, naming both dimensions: "'3 K' is a temperature, a length is expected (unit m)". */
CastStatus units_convert(const char *text, const char *si_unit, double *value, CastError *err);

#endif
