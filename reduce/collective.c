#include "reduce/collective.h"

#include <stdio.h>
#include "reduce/petsc_compat.h"

PetscErrorCode collective_check(MPI_Comm comm, CastStatus status, const CastError *err)
{
  PetscMPIInt rank, size, failing;
  CastError shared = {CAST_OK, ""};

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  failing = status == CAST_OK ? size : rank;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &failing, 1, MPI_INT, MPI_MIN, comm));
  if (failing == size) PetscFunctionReturn(PETSC_SUCCESS);
  if (rank == failing && err) shared = *err;
  PetscCallMPI(MPI_Bcast(shared.message, (PetscMPIInt)sizeof shared.message, MPI_CHAR, failing, comm));
  SETERRQ(comm, PETSC_ERR_USER, "%s", shared.message);
}
