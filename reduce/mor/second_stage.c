/* second_stage.c
 * Method: for dz/dt = -Lambda z + B u, y = B^T z both Gramians are
 *   P_ij = b_i . b_j/(lambda_i + lambda_j)^(1 - p),   p = 0: plain balanced truncation,
 * so an orthogonal change of coordinates balances, and Galerkin projection on the leading eigenvectors of P truncates.
 * 0 < p < 1 gives the early response more weight. The constant direction c = V^T E 1 is taken out of P and put back
 * after: the stored heat stays exact, and a mode with lambda = 0, whose Gramian does not exist, never enters.
 * Reference: Moore 1981, IEEE Trans. Automat. Control 26, 17; Liu, Sreeram & Teo 1998, Syst. Control Lett. 34, 147
 * (state-space symmetric systems). */
#include "reduce/mor/second_stage.h"

#include <math.h>

#include "reduce/linear/small_dense.h"
#include "reduce/petsc/petsc_compat.h"

enum {
  MOST_INPUTS = 64, // inputs followed when responses are compared: every one up to here, then a sample
  MOST_TRIALS = 8   // orders tried
};

/* P without the constant direction, [r x r]. */
static PetscErrorCode gramian(const ModalModel *model, const PetscReal *weight, PetscReal p, PetscReal *P)
{
  const size_t r = (size_t)model->r, ports = (size_t)model->p;
  PetscReal *scaled, *c, *Pc, length = 0.0, cPc = 0.0;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc3(r * ports, &scaled, r, &c, r, &Pc));
  for (size_t k = 0; k < r; k++)
    for (size_t l = 0; l < ports; l++) scaled[k * ports + l] = model->B[k * ports + l] * weight[l];
  PetscCall(small_multiply('T', 'N', model->r, model->r, model->p, 1.0, scaled, scaled, 0.0, P));
  for (size_t j = 0; j < r; j++)
    for (size_t i = 0; i < r; i++) {
      const PetscReal rate = model->lambda[i] + model->lambda[j];
      P[i + j * r] = rate > 0.0 ? P[i + j * r] * pow(rate, p - 1.0) : 0.0;
    }
  for (size_t i = 0; i < r; i++) length += model->constant[i] * model->constant[i];
  for (size_t i = 0; i < r; i++) c[i] = model->constant[i] / sqrt(length);
  PetscCall(small_multiply('N', 'N', model->r, 1, model->r, 1.0, P, c, 0.0, Pc));
  for (size_t i = 0; i < r; i++) cPc += c[i] * Pc[i];
  for (size_t j = 0; j < r; j++)
    for (size_t i = 0; i < r; i++) P[i + j * r] += c[i] * c[j] * cPc - c[i] * Pc[j] - Pc[i] * c[j];
  PetscCall(PetscFree3(scaled, c, Pc));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Columns of U [r x r]: c, then the eigenvectors by falling Gramian value; value [r] of each, 0 for c. */
static PetscErrorCode balance(const ModalModel *model, const PetscReal *weight, PetscReal p, PetscReal *U,
                              PetscReal *value)
{
  const size_t r = (size_t)model->r;
  PetscReal *P, *w, length = 0.0;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc2(r * r, &P, r, &w));
  PetscCall(gramian(model, weight, p, P));
  PetscCall(small_eigen(model->comm, model->r, P, w));
  for (size_t i = 0; i < r; i++) length += model->constant[i] * model->constant[i];
  for (size_t i = 0; i < r; i++) U[i] = model->constant[i] / sqrt(length);
  value[0] = 0.0;
  for (size_t k = 1; k < r; k++) { // r - 1 leading ones; c itself has the value 0 and comes last
    const PetscReal *vector = P + (r - k) * r;
    value[k] = PetscMax(w[r - k], 0.0);
    PetscReal along = 0.0, left = 0.0;
    for (size_t i = 0; i < r; i++) along += U[i] * vector[i];
    for (size_t i = 0; i < r; i++) U[i + k * r] = vector[i] - along * U[i];
    for (size_t i = 0; i < r; i++) left += U[i + k * r] * U[i + k * r];
    for (size_t i = 0; i < r; i++) U[i + k * r] /= left > 0.0 ? sqrt(left) : 1.0;
  }
  PetscCall(PetscFree2(P, w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* T [m x inputs]: step responses at time t of the inputs first, first + stride, ... */
static PetscErrorCode responses(const ModalModel *model, PetscReal t, PetscInt stride, PetscReal *scaled, PetscReal *T)
{
  const PetscInt columns = model->p, n_inputs = (columns + stride - 1) / stride;

  PetscFunctionBeginUser;
  for (PetscInt k = 0; k < model->r; k++) {
    const PetscReal phi = modal_phi(model->lambda[k], t);
    for (PetscInt j = 0; j < n_inputs; j++)
      scaled[j + k * n_inputs] = phi * model->B[k * columns + (columns - 1 - j * stride)];
  }
  PetscCall(small_multiply('N', 'T', columns, n_inputs, model->r, 1.0, model->B, scaled, 0.0, T));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Largest difference of two models' step responses over the rise. */
static PetscErrorCode deviation(const ModalModel *model, const ModalModel *smaller, PetscInt n_times,
                                const PetscReal *time, PetscReal *worst)
{
  const PetscInt columns = model->p, stride = (columns + MOST_INPUTS - 1) / MOST_INPUTS;
  const PetscInt n_inputs = (columns + stride - 1) / stride;
  PetscReal *scaled, *T, *T_smaller, *rise, *at_end;

  PetscFunctionBeginUser;
  *worst = 0.0;
  PetscCall(PetscMalloc5((size_t)model->r * (size_t)n_inputs, &scaled, (size_t)columns * (size_t)n_inputs, &T,
                         (size_t)columns * (size_t)n_inputs, &T_smaller, (size_t)n_inputs, &rise, (size_t)n_inputs,
                         &at_end));
  PetscCall(PetscArrayzero(rise, (size_t)n_inputs));
  PetscCall(PetscArrayzero(at_end, (size_t)n_inputs));
  PetscCall(responses(model, time[n_times - 1], stride, scaled, T));
  for (PetscInt j = 0; j < n_inputs; j++)
    for (PetscInt i = 0; i < columns; i++) at_end[j] = PetscMax(at_end[j], PetscAbsReal(T[i + j * columns]));
  for (PetscInt t = 0; t < n_times; t++) {
    PetscCall(responses(model, time[t], stride, scaled, T));
    PetscCall(responses(smaller, time[t], stride, scaled, T_smaller));
    for (PetscInt j = 0; j < n_inputs; j++) {
      PetscReal difference = 0.0;
      for (PetscInt i = 0; i < columns; i++) {
        rise[j] = PetscMax(rise[j], PetscAbsReal(T[i + j * columns]));
        difference = PetscMax(difference, PetscAbsReal(T[i + j * columns] - T_smaller[i + j * columns]));
      }
      const PetscReal scale = modal_rise_scale(rise[j], at_end[j], time[t], time[n_times - 1]);
      if (scale > 0.0) *worst = PetscMax(*worst, difference / scale);
    }
  }
  PetscCall(PetscFree5(scaled, T, T_smaller, rise, at_end));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Inputs that the sample has left out may be among those whose error is known: it counts in proportion to its limit. */
static PetscErrorCode add_known_error(const SecondStage *stage, const ModalModel *candidate, PetscReal *worst)
{
  PetscReal error;

  PetscFunctionBeginUser;
  if (!stage->reference) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(step_reference_compare(stage->reference, candidate, NULL, &error));
  *worst = PetscMax(*worst, stage->allowed * error / stage->limit);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The order to try next between one that misses and one that keeps what is allowed: the error falls about exponentially
 * with the order. */
static PetscInt next_order(PetscInt too_few, PetscReal too_large, PetscInt enough, PetscReal small, PetscReal allowed)
{
  const PetscReal slope = log(too_large / small) / (PetscReal)(enough - too_few);
  const PetscInt guess = too_few + (PetscInt)ceil(log(too_large / (0.95 * allowed)) / slope);
  const PetscInt margin = (enough - too_few) / 8; // never close to an end: the bracket has to shrink
  return PetscMin(PetscMax(guess, too_few + 1 + margin), enough - 1 - margin);
}

/* Twice the sum of the Hankel values behind the first k, for the ports as they are: weights are scaled away. */
static PetscReal dropped_bound(const ModalModel *model, const SecondStage *stage, const PetscReal *value, PetscInt k)
{
  PetscReal sum = 0.0, scale = 0.0;
  for (PetscInt i = model->r - 1; i >= k; i--) sum += value[i]; // the small ones first
  for (PetscInt l = 0; l < model->p; l++) scale = PetscMax(scale, 1.0 / PetscSqr(stage->weight[l]));
  return 2.0 * sum * scale;
}

PetscErrorCode second_stage_truncate(const ModalModel *model, SecondStage *stage, ModalModel **smaller)
{
  const size_t r = (size_t)model->r;
  const PetscReal allowed = stage->allowed;
  PetscInt too_few = 1, enough = model->r; // orders known to miss and to keep what is allowed
  PetscReal too_large = 1.0, small = 1e-3 * allowed, *U, *value;

  PetscFunctionBeginUser;
  *smaller = NULL;
  stage->reached = stage->bound = 0.0;
  PetscCall(PetscMalloc2(r * r, &U, r, &value));
  PetscCall(balance(model, stage->weight, stage->early_weight, U, value));
  for (PetscInt trial = 0; trial < MOST_TRIALS && enough - too_few > PetscMax(1, enough / 50); trial++) {
    const PetscInt k = next_order(too_few, too_large, enough, small, allowed);
    ModalModel *candidate;
    PetscReal worst;
    if (k <= too_few || k >= enough) break;
    PetscCall(modal_model_project(model, U, k, stage->singular, &candidate));
    PetscCall(deviation(model, candidate, stage->n_times, stage->time, &worst));
    PetscCall(add_known_error(stage, candidate, &worst));
    if (worst <= allowed) {
      PetscCall(modal_model_destroy(smaller));
      *smaller = candidate;
      stage->reached = small = worst;
      enough = k;
      if (stage->early_weight == 0.0) stage->bound = dropped_bound(model, stage, value, k);
    } else {
      PetscCall(modal_model_destroy(&candidate));
      too_few = k;
      too_large = worst;
    }
  }
  if (*smaller) PetscCall(modal_model_compose(model, U, *smaller));
  PetscCall(PetscFree2(U, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}
