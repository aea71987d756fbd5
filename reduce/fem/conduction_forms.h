/* conduction_forms.h - pointwise integrands of the heat equation, as PetscDS evaluates them at quadrature points.
 *
 *   g3 = kappa I   for  int kappa grad phi_i . grad phi_j      (conduction, W/K)
 *   g0 = rho c     for  int rho c phi_i phi_j                  (heat capacity, J/K)
 *   g0 = h         for  int_Gamma h phi_i phi_j                (Robin wall, W/K)
 *
 * a[] is the cell-wise constant auxiliary field (kappa, rho c); constants[] switches between the matrices, so that
 * each is integrated alone and none is the difference of two large ones. */
#ifndef REDUCE_FEM_CONDUCTION_FORMS_H
#define REDUCE_FEM_CONDUCTION_FORMS_H

#include <petscds.h>

enum { AUX_CONDUCTIVITY, AUX_HEAT_CAPACITY, AUX_COUNT };                       // W/(m K), J/(m3 K)
enum { FORM_CONDUCTION, FORM_STORAGE, FORM_WALL_COEFFICIENT, FORM_CONSTANTS }; // 1, 1, W/(m2 K)

/* Set the integrands of the single temperature field in `ds`. */
PetscErrorCode conduction_forms_set(PetscDS ds);
/* Set the wall integrand (Jacobian h) for faces with `value` in `label`. */
PetscErrorCode conduction_forms_set_wall(PetscDS ds, DMLabel label, PetscInt value);
/* Choose what the next assembly integrates. */
PetscErrorCode conduction_forms_select(PetscDS ds, PetscBool conduction, PetscBool storage, PetscReal wall_coefficient);

#endif
