#include "reduce/pipeline/process_use.h"

#include <malloc.h>
#include <stdio.h>
#include <sys/resource.h>
#include "reduce/petsc/petsc_compat.h"

PetscErrorCode process_use_cpu(MPI_Comm comm, PetscReal *seconds)
{
  struct rusage use;

  PetscFunctionBeginUser;
  getrusage(RUSAGE_SELF, &use);
  *seconds = (PetscReal)(use.ru_utime.tv_sec + use.ru_stime.tv_sec) +
             1e-6 * (PetscReal)(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, seconds, 1, MPIU_REAL, MPIU_SUM, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* "5" sets VmHWM back to what is resident now (proc(5), clear_refs). */
void process_use_reset_peak(void)
{
  malloc_trim(0); // what is free belongs to nobody
  FILE *file = fopen("/proc/self/clear_refs", "w");
  if (!file) return;
  fputs("5", file);
  fclose(file);
}

PetscErrorCode process_use_peak(MPI_Comm comm, PetscReal *bytes)
{
  char line[256];
  unsigned long kilobytes = 0;

  PetscFunctionBeginUser;
  FILE *file = fopen("/proc/self/status", "r");
  while (file && fgets(line, sizeof line, file) && sscanf(line, "VmHWM: %lu", &kilobytes) != 1) {
  }
  if (file) fclose(file);
  *bytes = 1024.0 * (PetscReal)kilobytes;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, bytes, 1, MPIU_REAL, MPIU_SUM, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}
