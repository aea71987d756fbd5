#include "reduce/fem/conduction_forms.h"
#include "reduce/petsc/petsc_compat.h"

// PETSc fixes the argument lists below (PetscPointJac, PetscBdPointJac).

static void heat_capacity(PetscInt dim, PetscInt n_fields, PetscInt n_aux, const PetscInt u_offset[],
                          const PetscInt u_offset_x[], const PetscScalar u[], const PetscScalar u_t[],
                          const PetscScalar u_x[], const PetscInt a_offset[], const PetscInt a_offset_x[],
                          const PetscScalar a[], const PetscScalar a_t[], const PetscScalar a_x[], PetscReal t,
                          PetscReal shift, const PetscReal x[], PetscInt n_constants, const PetscScalar constants[],
                          PetscScalar g0[])
{
  (void)dim, (void)n_fields, (void)n_aux, (void)u_offset, (void)u_offset_x, (void)u, (void)u_t, (void)u_x;
  (void)a_offset_x, (void)a_t, (void)a_x, (void)t, (void)shift, (void)x, (void)n_constants;
  g0[0] = constants[FORM_STORAGE] * a[a_offset[0] + AUX_HEAT_CAPACITY];
}

static void conduction(PetscInt dim, PetscInt n_fields, PetscInt n_aux, const PetscInt u_offset[],
                       const PetscInt u_offset_x[], const PetscScalar u[], const PetscScalar u_t[],
                       const PetscScalar u_x[], const PetscInt a_offset[], const PetscInt a_offset_x[],
                       const PetscScalar a[], const PetscScalar a_t[], const PetscScalar a_x[], PetscReal t,
                       PetscReal shift, const PetscReal x[], PetscInt n_constants, const PetscScalar constants[],
                       PetscScalar g3[])
{
  (void)n_fields, (void)n_aux, (void)u_offset, (void)u_offset_x, (void)u, (void)u_t, (void)u_x;
  (void)a_offset_x, (void)a_t, (void)a_x, (void)t, (void)shift, (void)x, (void)n_constants;
  for (PetscInt d = 0; d < dim; d++) g3[d * dim + d] = constants[FORM_CONDUCTION] * a[a_offset[0] + AUX_CONDUCTIVITY];
}

static void wall_exchange(PetscInt dim, PetscInt n_fields, PetscInt n_aux, const PetscInt u_offset[],
                          const PetscInt u_offset_x[], const PetscScalar u[], const PetscScalar u_t[],
                          const PetscScalar u_x[], const PetscInt a_offset[], const PetscInt a_offset_x[],
                          const PetscScalar a[], const PetscScalar a_t[], const PetscScalar a_x[], PetscReal t,
                          PetscReal shift, const PetscReal x[], const PetscReal normal[], PetscInt n_constants,
                          const PetscScalar constants[], PetscScalar g0[])
{
  (void)dim, (void)n_fields, (void)n_aux, (void)u_offset, (void)u_offset_x, (void)u, (void)u_t, (void)u_x;
  (void)a_offset, (void)a_offset_x, (void)a, (void)a_t, (void)a_x, (void)t, (void)shift, (void)x, (void)normal;
  (void)n_constants;
  g0[0] = constants[FORM_WALL_COEFFICIENT];
}

PetscErrorCode conduction_forms_set(PetscDS ds)
{
  PetscFunctionBeginUser;
  PetscCall(PetscDSSetJacobian(ds, 0, 0, heat_capacity, NULL, NULL, conduction));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode conduction_forms_set_wall(PetscDS ds, DMLabel label, PetscInt value)
{
  PetscWeakForm form;

  PetscFunctionBeginUser;
  PetscCall(PetscDSGetWeakForm(ds, &form));
  PetscCall(PetscWeakFormSetIndexBdJacobian(form, label, value, 0, 0, 0, 0, wall_exchange, 0, NULL, 0, NULL, 0, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode conduction_forms_select(PetscDS ds, PetscBool conduction_on, PetscBool storage_on,
                                       PetscReal wall_coefficient)
{
  PetscScalar constants[FORM_CONSTANTS];

  PetscFunctionBeginUser;
  constants[FORM_CONDUCTION] = conduction_on ? 1.0 : 0.0;
  constants[FORM_STORAGE] = storage_on ? 1.0 : 0.0;
  constants[FORM_WALL_COEFFICIENT] = wall_coefficient;
  PetscCall(PetscDSSetConstants(ds, FORM_CONSTANTS, constants));
  PetscFunctionReturn(PETSC_SUCCESS);
}
