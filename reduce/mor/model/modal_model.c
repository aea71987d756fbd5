#include "reduce/mor/model/modal_model.h"

#include <math.h>

#include "reduce/linear/small_dense.h"
#include "reduce/petsc/petsc_compat.h"

/* K_r's eigenvectors rotate what is given in the old coordinates. */
PetscErrorCode modal_model_create(MPI_Comm comm, PetscInt r, PetscInt p, const PetscReal *K, PetscInt ld,
                                  const PetscReal *B, const PetscReal *constant, PetscBool singular, ModalModel **out)
{
  ModalModel *model;
  const size_t size = (size_t)r, columns = (size_t)p;

  PetscFunctionBeginUser;
  PetscCall(PetscNew(&model));
  *out = model;
  model->comm = comm;
  model->r = model->n_basis = r;
  model->p = p;
  PetscCall(PetscMalloc1(size, &model->lambda));
  PetscCall(PetscMalloc1(size * columns, &model->B));
  PetscCall(PetscMalloc1(size, &model->constant));
  PetscCall(PetscMalloc1(size * size, &model->Q));
  for (size_t j = 0; j < size; j++)
    for (size_t i = 0; i < size; i++) model->Q[i + j * size] = 0.5 * (K[i + j * (size_t)ld] + K[j + i * (size_t)ld]);
  PetscCall(small_eigen(comm, r, model->Q, model->lambda));
  const PetscReal rounding = 1e-12 * model->lambda[r - 1];
  PetscCheck(model->lambda[0] >= -rounding, comm, PETSC_ERR_USER,
             "the reduced K has the eigenvalue %g 1/s below zero: K is not positive semi-definite",
             (double)model->lambda[0]);
  for (PetscInt k = 0; k < r; k++) model->lambda[k] = PetscMax(model->lambda[k], 0.0);
  if (singular) model->lambda[0] = 0.0;
  PetscCall(small_multiply('N', 'N', p, r, r, 1.0, B, model->Q, 0.0, model->B)); // (Q^T B)^T
  PetscCall(small_multiply('T', 'N', r, 1, r, 1.0, model->Q, constant, 0.0, model->constant));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode modal_model_project(const ModalModel *model, const PetscReal *U, PetscInt k, PetscBool singular,
                                   ModalModel **smaller)
{
  const size_t r = (size_t)model->r, size = (size_t)k;
  PetscReal *scaled, *K, *B, *constant;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc4(r * size, &scaled, size * size, &K, size * (size_t)model->p, &B, size, &constant));
  for (size_t j = 0; j < size; j++)
    for (size_t i = 0; i < r; i++) scaled[i + j * r] = model->lambda[i] * U[i + j * r];
  PetscCall(small_multiply('T', 'N', k, k, model->r, 1.0, U, scaled, 0.0, K));
  PetscCall(small_multiply('N', 'N', model->p, k, model->r, 1.0, model->B, U, 0.0, B));
  PetscCall(small_multiply('T', 'N', k, 1, model->r, 1.0, U, model->constant, 0.0, constant));
  PetscCall(modal_model_create(model->comm, k, model->p, K, k, B, constant, singular, smaller));
  PetscCall(PetscFree4(scaled, K, B, constant));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode modal_model_compose(const ModalModel *model, const PetscReal *U, ModalModel *smaller)
{
  const size_t n_basis = (size_t)model->n_basis, size = (size_t)smaller->r;
  PetscReal *UQ, *composed;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)model->r * size, &UQ));
  PetscCall(PetscMalloc1(n_basis * size, &composed));
  PetscCall(small_multiply('N', 'N', model->r, smaller->r, smaller->r, 1.0, U, smaller->Q, 0.0, UQ));
  PetscCall(small_multiply('N', 'N', model->n_basis, smaller->r, model->r, 1.0, model->Q, UQ, 0.0, composed));
  PetscCall(PetscFree(UQ));
  PetscCall(PetscFree(smaller->Q));
  smaller->Q = composed;
  smaller->n_basis = model->n_basis;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The series keeps what 1 - exp(-x) loses, and holds at lambda = 0. */
PetscReal modal_phi(PetscReal lambda, PetscReal t)
{
  const PetscReal x = lambda * t;
  return x > 1e-8 ? -expm1(-x) / lambda : t * (1.0 - 0.5 * x);
}

PetscReal modal_rise_scale(PetscReal so_far, PetscReal at_end, PetscReal t, PetscReal t_end)
{
  return PetscMax(so_far, at_end * sqrt(t / t_end));
}

void modal_model_step_response(const ModalModel *model, PetscReal t, const PetscReal *u, PetscReal *state,
                               PetscReal *temperature)
{
  const PetscInt p = model->p;

  for (PetscInt l = 0; l < p; l++) temperature[l] = 0.0;
  for (PetscInt k = 0; k < model->r; k++) {
    const PetscReal *row = model->B + (size_t)k * (size_t)p;
    PetscReal drive = 0.0;
    for (PetscInt l = 0; l < p; l++) drive += row[l] * u[l];
    state[k] = modal_phi(model->lambda[k], t) * drive;
    for (PetscInt l = 0; l < p; l++) temperature[l] += row[l] * state[k];
  }
}

void modal_model_moment(const ModalModel *model, PetscReal s, PetscInt power, const PetscReal *u, PetscReal *moment)
{
  const PetscInt p = model->p;

  for (PetscInt l = 0; l < p; l++) moment[l] = 0.0;
  for (PetscInt k = 0; k < model->r; k++) {
    const PetscReal *row = model->B + (size_t)k * (size_t)p;
    PetscReal drive = 0.0;
    for (PetscInt l = 0; l < p; l++) drive += row[l] * u[l];
    drive *= pow(s + model->lambda[k], -(PetscReal)(power + 1));
    for (PetscInt l = 0; l < p; l++) moment[l] += row[l] * drive;
  }
}

/* H += sign * (real or imaginary part of) B^T (iw + Lambda)^-1 B, [p x p] */
static PetscErrorCode add_transfer(const ModalModel *model, PetscReal w, PetscBool imaginary, PetscReal sign,
                                   PetscReal *H)
{
  const size_t r = (size_t)model->r, p = (size_t)model->p;
  PetscReal *scaled;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1(r * p, &scaled));
  for (size_t k = 0; k < r; k++) {
    const PetscReal lambda = model->lambda[k], factor = (imaginary ? -w : lambda) / (lambda * lambda + w * w);
    for (size_t l = 0; l < p; l++) scaled[l + k * p] = factor * model->B[l + k * p];
  }
  PetscCall(small_multiply('N', 'T', model->p, model->p, model->r, sign, model->B, scaled, 1.0, H));
  PetscCall(PetscFree(scaled));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode modal_model_transfer(const ModalModel *model, const ModalModel *other, PetscReal w, PetscReal *real,
                                    PetscReal *imaginary)
{
  const size_t size = (size_t)model->p * (size_t)model->p;

  PetscFunctionBeginUser;
  for (int part = 0; part < 2; part++) {
    PetscReal *H = part == 0 ? real : imaginary;
    PetscCall(PetscArrayzero(H, size));
    PetscCall(add_transfer(model, w, (PetscBool)part, 1.0, H));
    if (other) PetscCall(add_transfer(other, w, (PetscBool)part, -1.0, H));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode modal_model_difference(const ModalModel *model, const ModalModel *other, PetscReal w,
                                      PetscReal *difference)
{
  const size_t size = (size_t)model->p * (size_t)model->p;
  PetscReal *H, sum = 0.0;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1(2 * size, &H));
  PetscCall(modal_model_transfer(model, other, w, H, H + size));
  for (size_t i = 0; i < 2 * size; i++) sum += H[i] * H[i];
  *difference = sqrt(sum);
  PetscCall(PetscFree(H));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode modal_model_destroy(ModalModel **model)
{
  PetscFunctionBeginUser;
  if (!*model) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*model)->lambda));
  PetscCall(PetscFree((*model)->B));
  PetscCall(PetscFree((*model)->constant));
  PetscCall(PetscFree((*model)->Q));
  PetscCall(PetscFree(*model));
  PetscFunctionReturn(PETSC_SUCCESS);
}
