/* modal_model.h - the reduced mould in modal form, small arrays only, the same on every rank:
 *   dz/dt = -Lambda z + B u,   T = B^T z,   u [p] heat through the ports (ports.h), T [p] their mean temperatures
 * A step of input u from rest gives z(t) = phi(Lambda, t) B u, phi(lambda, t) = (1 - exp(-lambda t))/lambda. */
#ifndef REDUCE_MOR_MODEL_MODAL_MODEL_H
#define REDUCE_MOR_MODEL_MODAL_MODEL_H

#include <petscsys.h>

typedef struct ModalModel {
  MPI_Comm comm; // whose ranks hold it
  PetscInt r, p, n_basis;
  PetscReal *lambda;   // [r] 1/s, ascending, >= 0
  PetscReal *B;        // [r x p] row-major
  PetscReal *constant; // [r] sqrt(J/K)
  PetscReal *Q;        // [n_basis x r] column-major: modes in the vectors of the Krylov basis
} ModalModel;

/* Diagonalise K [r x r] (column-major, ld rows). singular: the slowest mode is the constant and has lambda = 0. */
PetscErrorCode modal_model_create(MPI_Comm comm, PetscInt r, PetscInt p, const PetscReal *K, PetscInt ld,
                                  const PetscReal *B, const PetscReal *constant, PetscBool singular,
                                  ModalModel **model);
/* Project on the orthonormal columns of U [r x k] and diagonalise again. The smaller model's Q is in terms of U. */
PetscErrorCode modal_model_project(const ModalModel *model, const PetscReal *U, PetscInt k, PetscBool singular,
                                   ModalModel **smaller);
/* Bring the smaller model's Q from U's terms to those of the Krylov basis, as model's is: half of a projection's work,
 * left out for models that are only tried. */
PetscErrorCode modal_model_compose(const ModalModel *model, const PetscReal *U, ModalModel *smaller);
PetscReal modal_phi(PetscReal lambda, PetscReal t);
/* What an error at time t is held against: the largest rise so far, but no less than what a heated half-space with the
 * same rise at t_end had by then, T ~ sqrt(t). (Heat from afar has not arrived early on: no relative error exists.) */
PetscReal modal_rise_scale(PetscReal so_far, PetscReal at_end, PetscReal t, PetscReal t_end);
/* Temperatures [p] at time t after a step of the inputs u [p]; `state` [r] is work space. */
void modal_model_step_response(const ModalModel *model, PetscReal t, const PetscReal *u, PetscReal *state,
                               PetscReal *temperature);
/* B^T (s + Lambda)^-(power + 1) B u, [p] */
void modal_model_moment(const ModalModel *model, PetscReal s, PetscInt power, const PetscReal *u, PetscReal *moment);
/* Re and Im of B^T (iw + Lambda)^-1 B, of the one minus that of the other (NULL: nothing), [p x p]. Same p. */
PetscErrorCode modal_model_transfer(const ModalModel *model, const ModalModel *other, PetscReal w, PetscReal *real,
                                    PetscReal *imaginary);
/* ||B^T (iw + Lambda)^-1 B of the one minus that of the other||_F, an upper bound of its 2-norm, K/W. Same p. */
PetscErrorCode modal_model_difference(const ModalModel *model, const ModalModel *other, PetscReal w,
                                      PetscReal *difference);
PetscErrorCode modal_model_destroy(ModalModel **model);

#endif
