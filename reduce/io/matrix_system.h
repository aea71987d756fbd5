/* matrix_system.h - a mould whose matrices another program has assembled, as Matrix Market files. */
#ifndef REDUCE_IO_MATRIX_SYSTEM_H
#define REDUCE_IO_MATRIX_SYSTEM_H

#include "reduce/fem/thermal_system.h"

/* Rank 0 reads and checks the files that config->matrices names; the system is distributed by rows. Its ambient is K 1:
 * where K takes heat from a mould of constant temperature, that heat goes to the surroundings. Collective.
 * Errors: PETSC_ERR_USER with file and line, or the entry at fault. */
PetscErrorCode matrix_system_create(MPI_Comm comm, const ReduceConfig *config, ThermalSystem **system);
/* Read and check only, on one rank; `summary` gets what the files hold in a line. */
CastStatus matrix_system_check(const ReduceConfig *config, char *summary, size_t size, CastError *err);

#endif
