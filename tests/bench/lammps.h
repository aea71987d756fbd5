/* lammps.h - the same workload in LAMMPS (sph/taitwater with sph/heatconduction), where `lmp` is found on the machine.
 */
#ifndef TESTS_BENCH_LAMMPS_H
#define TESTS_BENCH_LAMMPS_H

#include "tests/support/lattice_tank.h"

/* Microseconds of processor time a fluid particle and step, one thread, from the difference of a long and a short run;
 * NAN: there is no `lmp`, or it has no SPH package. Print what it was into `note`. */
double lammps_time(const LatticeTank *tank, double dt, char note[160]);

#endif
