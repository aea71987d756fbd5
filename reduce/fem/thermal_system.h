/* thermal_system.h - heat conduction in the mould by Galerkin FEM on tetrahedra:
 *   E dtheta/dt = -K theta + B q + ambient (T_amb - T_preheat)          (docs/theory)
 * E [n x n] heat capacity J/K, K [n x n] conduction and Robin terms W/K: symmetric, distributed by rows.
 * B [n x m] dense: B_il = (1/|Gamma_l|) int_{Gamma_l} phi_i dA, columns sum to 1; C = B^T.
 * ambient [n] W/K: sum over outer surfaces of int h phi_i dA. */
#ifndef REDUCE_FEM_THERMAL_SYSTEM_H
#define REDUCE_FEM_THERMAL_SYSTEM_H

#include <petscmat.h>
#include "reduce/mesh/mould_mesh.h"

typedef struct ThermalSystem {
  Mat E, K;        // owned, symmetric (MATAIJ, PETSC_TRUE for MAT_SPD / MAT_SYMMETRIC)
  Mat B;           // owned, dense
  Vec ambient;     // owned
  PetscReal *area; // [m] m2, owned: weights of the patches in the reduction
  PetscInt n, m;
  PetscBool singular; // K has the constant in its null space (all walls insulated)
} ThermalSystem;

/* Assemble with PETSc's own elements (PetscFE, of config->order) on mesh->dm. Also sets the DM's section. Collective.
 */
PetscErrorCode thermal_system_create(MouldMesh *mesh, const ReduceConfig *config, ThermalSystem **system);
/* Wrap matrices that came from elsewhere (tests, other FEM programs); references are taken. area NULL: all 1. */
PetscErrorCode thermal_system_wrap(Mat E, Mat K, Mat B, Vec ambient, const PetscReal *area, ThermalSystem **system);
PetscErrorCode thermal_system_destroy(ThermalSystem **system);

#endif
