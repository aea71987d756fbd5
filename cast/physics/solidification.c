#include "cast/physics/solidification.h"

#include <math.h>

static const double random_packing = 0.64; // of spheres
static const double most_viscosity = 1e3;  // times the liquid's: stiff beside all flow, yet no limit of the time step

Solidification solidification_of(const Material *melt)
{
  Solidification s = {.lock_enthalpy = (double)-INFINITY, .liquidus = (double)-INFINITY, .packing = random_packing};
  if (!melt || melt->solid_fraction.n == 0) return s;
  s.liquidus = melt->solid_fraction.x[melt->solid_fraction.n - 1];
  if (melt->dendrite_arm_spacing > 0.0) s.arm = melt->dendrite_arm_spacing;
  if (melt->coherency_fraction > 0.0) {
    s.packing = melt->coherency_fraction;
    s.lock_enthalpy = material_enthalpy(melt, material_temperature_of_fraction(melt, melt->coherency_fraction));
  }
  return s;
}

double solidification_thickening(double solid_fraction, double packing)
{
  const double room = 1.0 - solid_fraction / packing;
  return room > 0.0 ? fmin(pow(room, -2.5 * packing), most_viscosity) : most_viscosity;
}

double solidification_drag(double solid_fraction, double arm)
{
  const double liquid = 1.0 - solid_fraction;
  return 180.0 * solid_fraction * solid_fraction / (arm * arm * liquid * liquid * liquid);
}

ptrdiff_t solidification_count_locked(const Material *melt, ptrdiff_t n, const double *E)
{
  const double lock = solidification_of(melt).lock_enthalpy;
  ptrdiff_t locked = 0;
#pragma omp parallel for reduction(+ : locked)
  for (ptrdiff_t i = 0; i < n; i++) locked += E[i] <= lock;
  return locked;
}
