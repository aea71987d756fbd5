/* process_use.h - processor time and memory of all ranks together. */
#ifndef REDUCE_PIPELINE_PROCESS_USE_H
#define REDUCE_PIPELINE_PROCESS_USE_H

#include <petscsys.h>

/* Processor time used so far, s, user and system, summed over the ranks. Collective. */
PetscErrorCode process_use_cpu(MPI_Comm comm, PetscReal *seconds);
/* Start a new count of the largest resident memory (Linux 4.0 and newer; elsewhere the count goes on). */
void process_use_reset_peak(void);
/* Largest resident memory since then, bytes, summed over the ranks; 0 where the system does not say. Collective. */
PetscErrorCode process_use_peak(MPI_Comm comm, PetscReal *bytes);

#endif
