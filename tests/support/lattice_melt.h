/* lattice_melt.h - melt on a lattice, without a run around it. */
#ifndef TESTS_SUPPORT_LATTICE_MELT_H
#define TESTS_SUPPORT_LATTICE_MELT_H

#include "cast/particles/particles.h"

/* n[0] x n[1] x n[2] particles in the box with the least corner `corner`, m; T = 1300 K + x 1e4 K/m. Aborts the test if
 * there is no memory; the caller destroys what it gets. */
Particles lattice_melt(const double corner[3], const int n[3], double spacing);

#endif
