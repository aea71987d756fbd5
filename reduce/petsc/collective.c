#include "reduce/petsc/collective.h"

#include <stdio.h>
#include <time.h>

#include "reduce/petsc/petsc_compat.h"

PetscErrorCode collective_wait(MPI_Comm comm)
{
  const long longest = 5000000; // ns
  MPI_Request request;
  int here = 0;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Ibarrier(comm, &request));
  PetscCallMPI(MPI_Test(&request, &here, MPI_STATUS_IGNORE));
  for (long pause = 1000; !here; pause = pause < longest / 2 ? 2 * pause : longest) {
    nanosleep(&(struct timespec){.tv_nsec = pause}, NULL);
    PetscCallMPI(MPI_Test(&request, &here, MPI_STATUS_IGNORE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode collective_check(MPI_Comm comm, CastStatus status, const CastError *err)
{
  PetscMPIInt rank, size, failing;
  CastError shared = {CAST_OK, ""};

  PetscFunctionBeginUser;
  PetscCall(collective_wait(comm)); // one rank's work is mostly what is checked
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  failing = status == CAST_OK ? size : rank;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &failing, 1, MPI_INT, MPI_MIN, comm));
  if (failing == size) PetscFunctionReturn(PETSC_SUCCESS);
  if (rank == failing && err) shared = *err;
  PetscCallMPI(MPI_Bcast(shared.message, (PetscMPIInt)sizeof shared.message, MPI_CHAR, failing, comm));
  SETERRQ(comm, PETSC_ERR_USER, "%s", shared.message);
}
