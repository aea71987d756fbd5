/* collective.h - faults that one rank finds become errors that all ranks return together, so that none waits for ever.
 */
#ifndef REDUCE_PETSC_COLLECTIVE_H
#define REDUCE_PETSC_COLLECTIVE_H

#include <petscsys.h>
#include "common/error.h"

/* Go on when every rank of `comm` is here. Ranks that have to wait sleep: other than in MPI_Barrier their processors
 * are free meanwhile, so that one rank's long work (meshing, a dense eigenproblem) has the machine. Collective. */
PetscErrorCode collective_wait(MPI_Comm comm);

/* Agree over `comm` whether any rank failed; then every rank raises PETSC_ERR_USER with the message of the lowest
 * failing rank. `err` is read only where status is not CAST_OK. Collective. */
PetscErrorCode collective_check(MPI_Comm comm, CastStatus status, const CastError *err);

#endif
