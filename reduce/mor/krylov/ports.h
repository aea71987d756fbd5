/* ports.h - the columns through which heat enters and temperatures are read, [n x p]: the patches' B, and where the
 * ambient acts its column scaled to sum 1 like B's, so that it is one patch more: heat spread as the Robin walls spread
 * it, read as their mean temperature. */
#ifndef REDUCE_MOR_KRYLOV_PORTS_H
#define REDUCE_MOR_KRYLOV_PORTS_H

#include "reduce/fem/thermal_system.h"

/* sum: of the ambient column, W/K; 0 where there is none, and then p = m. Caller destroys the ports. */
PetscErrorCode ports_create(const ThermalSystem *system, Mat *ports, PetscReal *sum);

#endif
