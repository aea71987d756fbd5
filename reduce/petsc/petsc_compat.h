/* petsc_compat.h - one place for what differs between PETSc 3.18 (Debian 12) and newer. */
#ifndef REDUCE_PETSC_PETSC_COMPAT_H
#define REDUCE_PETSC_PETSC_COMPAT_H

#include <petscsys.h>
#include <petscversion.h>

#if PETSC_VERSION_LT(3, 19, 0)
#define PETSC_SUCCESS ((PetscErrorCode)0)
#endif

/* Call a PETSc-free function f(..., &err) from PETSc code: turns a CastError into a PETSc error with its message. */
#define PETSC_CAST_CALL(comm, call, err)                                                                               \
  do {                                                                                                                 \
    if ((call) != CAST_OK) SETERRQ((comm), PETSC_ERR_USER, "%s", (err).message);                                       \
  } while (0)

#endif
