/* random_mould.h - small moulds with random cavities and materials, assembled by the closed formulas of linear
 * tetrahedra on one rank: nothing of the program's own mesher or assembly is in them. */
#ifndef TESTS_SUPPORT_RANDOM_MOULD_H
#define TESTS_SUPPORT_RANDOM_MOULD_H

#include "reduce/fem/thermal_system.h"

/* A block of 15-40 mm with one to three boxes cut out, 8-13 graded cells along each axis, two materials that may differ
 * a hundredfold in conductivity, up to 12 patches on the cavity, the outer wall as one more, insulated for every fifth
 * seed. The same seed gives the same mould. */
PetscErrorCode random_mould_create(uint64_t seed, ThermalSystem **system);

#endif
