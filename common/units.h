/* units.h - quantities with their unit as text, through udunits-2. SI inside, everywhere. */
#ifndef COMMON_UNITS_H
#define COMMON_UNITS_H

#include "common/error.h"

/* Convert text such as "8 mm", "900 degC" or "50 J/cm^3/s" to `si_unit` (a udunits string such as "m", "K",
 * "W/m^2/K", "rad/s", "1" for a pure number). One decimal number and one unit; only a pure number may stand without.
 * Stricter than udunits: an angle is no pure number and "300 rpm" no rate in 1/s, "5 ms" is not taken for 200 1/s,
 * and a unit holds no number but its exponents (or the 1 of "1/s"), since "8 mm 3" would be 24 mm.
 *   value  out, in si_unit; untouched on failure
 * Not for two threads at once: udunits' parser has global state.
 * Errors: CAST_ERR_INPUT, naming both dimensions: "'3 K' is a temperature, a length is expected (for example '8 mm')";
 * CAST_ERR_ARGUMENT if si_unit is no unit; CAST_ERR_LIBRARY if udunits has no database. */
CastStatus units_convert(const char *text, const char *si_unit, double *value, CastError *err);

#endif
