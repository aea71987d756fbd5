/* solidification.h - what freezing does to the flow: pure formulas of a particle's solid fraction fs.
 *   below the coherency fraction fc the solid swims in the melt, which thickens (Krieger & Dougherty 1959, Trans. Soc.
 *     Rheol. 3, 137, with Einstein's 2.5):       mu = mu_l (1 - fs/fc)^(-2.5 fc), at most most_viscosity times mu_l
 *   a mush that hangs on the wall holds it back (Carman & Kozeny; Poirier 1987, Metall. Trans. B 18, 245), where the
 *     material gives its dendrite arm spacing d: dv/dt = -v mu_l/(rho K),   K = d^2 (1 - fs)^3/(180 fs^2)
 *   from fc on the solid is a skeleton: the particle stands still and is a wall for its neighbours, with its own
 *     density and pressure, until it is remelted.                                        (docs/theory, eq. 19, 20)
 * All of it is a function of the particle's enthalpy now, so remelting needs no memory. */
#ifndef CAST_PHYSICS_SOLIDIFICATION_H
#define CAST_PHYSICS_SOLIDIFICATION_H

#include <stdbool.h>
#include "common/material/material.h"

typedef struct Solidification {
  double lock_enthalpy; // J/kg; a particle of less is locked; -INFINITY: none ever is
  double liquidus;      // K; -INFINITY where the material does not freeze
  double packing;       // fc, or 0.64 (random close packing) where the material gives none
  double arm;           // m, dendrite arm spacing; 0: no drag
} Solidification;

/*  melt  NULL: nothing freezes */
Solidification solidification_of(const Material *melt);
double solidification_thickening(double solid_fraction, double packing); // mu/mu_l
double solidification_drag(double solid_fraction, double arm);           // 1/K, 1/m2
/* Particles locked among n of enthalpies E. */
ptrdiff_t solidification_count_locked(const Material *melt, ptrdiff_t n, const double *E);

#endif
