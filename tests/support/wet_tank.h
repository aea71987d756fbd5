/* wet_tank.h - melt with surface tension on the walls of a lattice tank, by hand: no castrun around it. Surface tension
 * and density are 1. */
#ifndef TESTS_SUPPORT_WET_TANK_H
#define TESTS_SUPPORT_WET_TANK_H

#include "cast/physics/tension.h"
#include "tests/support/lattice_tank.h"

typedef struct WetTank {
  LatticeTank tank;
  Tension *tension;
  Table sigma;
} WetTank;

SphParameters wet_parameters(double dx, double c0);
/* Make the tank from its fields, melt of viscosity mu that meets walls at theta, degrees. */
void wet_tank_begin(WetTank *wet, double mu, double theta);
void wet_tank_step(WetTank *wet);
void wet_tank_end(WetTank *wet);

#endif
