/* lanczos.c
 * Method: f(A) b from the Krylov space of the inverse with one real pole. With mu = 1/(pole + lambda) and
 *   x_0 = (pole E + K)^-1 b,   theta(t) = g_t(S) x_0,   g_t(mu) = phi_t(lambda)/mu,
 *   theta(t) ~ ||x_0||_E V g_t(T) e_1.
 * The error falls like (sqrt 2 - 1)^steps for 2 < pole t < 32, whatever the mesh: g_t is smooth on [0, 1/pole].
 * Reference: van den Eshof & Hochbruck 2006, SIAM J. Sci. Comput. 27, 1438; Andersson 1981, J. Approx. Theory 32, 85.
 */
#include "reduce/mor/certificate/lanczos.h"

#include <petscblaslapack.h>

#include "reduce/linear/dense_block.h"
#include "reduce/mor/model/modal_model.h"
#include "reduce/petsc/petsc_compat.h"

/* `next` (not yet of length 1) becomes the current vector number `steps`; its length is beta[steps]. */
static PetscErrorCode accept(Lanczos *lanczos)
{
  const PetscInt k = lanczos->k, p = lanczos->p, q = lanczos->steps;
  PetscReal *length, *block;
  Mat swap = lanczos->previous;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc2((size_t)k, &length, (size_t)(p * k), &block));
  lanczos->previous = lanczos->current;
  lanczos->current = lanczos->next;
  lanczos->next = swap;
  PetscCall(dense_block_multiply(lanczos->system->E, lanczos->current, lanczos->E_current));
  PetscCall(dense_block_dots(lanczos->current, lanczos->E_current, length));
  for (PetscInt j = 0; j < k; j++) {
    const PetscReal of_vector = PetscSqrtReal(PetscMax(length[j], 0.0));
    /* A space that S leaves invariant holds the answer already: what follows is rounding, and is left out. */
    const PetscBool exhausted = (PetscBool)(q > 0 && of_vector * shifted_solver_get_shift(lanczos->solver) < 1e-13);
    lanczos->beta[q * k + j] = exhausted ? 0.0 : of_vector;
    length[j] = exhausted || of_vector == 0.0 ? 0.0 : 1.0 / of_vector;
  }
  PetscCall(dense_block_scale(lanczos->current, length));
  PetscCall(dense_block_scale(lanczos->E_current, length));
  PetscCall(dense_block_inner(lanczos->ports, lanczos->current, block));
  PetscCall(PetscArraycpy(lanczos->outputs + (size_t)q * (size_t)(k * p), block, (size_t)(p * k)));
  PetscCall(PetscFree2(length, block));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode lanczos_create(const ThermalSystem *system, ShiftedSolver *solver, Mat ports, Mat F, Lanczos **out)
{
  Lanczos *lanczos;

  PetscFunctionBeginUser;
  PetscCall(PetscNew(&lanczos));
  *out = lanczos;
  lanczos->system = system;
  lanczos->solver = solver;
  lanczos->ports = ports;
  PetscCall(MatGetSize(ports, NULL, &lanczos->p));
  PetscCall(MatGetSize(F, NULL, &lanczos->k));
  const size_t k = (size_t)lanczos->k;
  PetscCall(dense_block_create(system->E, lanczos->k, &lanczos->previous));
  PetscCall(dense_block_create(system->E, lanczos->k, &lanczos->current));
  PetscCall(dense_block_create(system->E, lanczos->k, &lanczos->E_current));
  PetscCall(dense_block_create(system->E, lanczos->k, &lanczos->next));
  PetscCall(PetscCalloc3(LANCZOS_MAX * k, &lanczos->alpha, LANCZOS_MAX * k, &lanczos->beta,
                         LANCZOS_MAX * k * (size_t)lanczos->p, &lanczos->outputs));
  PetscCall(shifted_solver_solve(solver, F, lanczos->next));
  PetscCall(accept(lanczos));
  PetscCall(MatZeroEntries(lanczos->previous));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* v_next = S v - alpha v - beta v_previous; the diagonal alpha is known only when the step is done, so T has as many
 * rows as diagonals. */
PetscErrorCode lanczos_step(Lanczos *lanczos)
{
  const PetscInt k = lanczos->k, q = lanczos->steps;
  PetscReal *factor;

  PetscFunctionBeginUser;
  PetscCheck(q + 1 < LANCZOS_MAX, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE, "more than %d Lanczos vectors",
             (int)LANCZOS_MAX);
  PetscCall(PetscMalloc1((size_t)k, &factor));
  PetscCall(shifted_solver_solve(lanczos->solver, lanczos->E_current, lanczos->next));
  PetscCall(dense_block_dots(lanczos->next, lanczos->E_current, lanczos->alpha + q * k));
  for (PetscInt j = 0; j < k; j++) factor[j] = -lanczos->alpha[q * k + j];
  PetscCall(dense_block_axpby(lanczos->next, 1.0, factor, lanczos->current));
  for (PetscInt j = 0; j < k; j++) factor[j] = q > 0 ? -lanczos->beta[q * k + j] : 0.0;
  PetscCall(dense_block_axpby(lanczos->next, 1.0, factor, lanczos->previous));
  lanczos->steps++;
  PetscCall(accept(lanczos));
  PetscCall(PetscFree(factor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode lanczos_response(const Lanczos *lanczos, PetscInt j, PetscInt n_times, const PetscReal *time,
                                PetscReal *temperature)
{
  const PetscInt steps = lanczos->steps, k = lanczos->k, p = lanczos->p;
  const PetscReal pole = shifted_solver_get_shift(lanczos->solver), length = lanczos->beta[j];
  PetscReal mu[LANCZOS_MAX], coupling[LANCZOS_MAX], work[2 * LANCZOS_MAX], *U;
  PetscBLASInt size, info;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)(steps * steps), &U));
  for (PetscInt q = 0; q < steps; q++) {
    mu[q] = lanczos->alpha[q * k + j];
    if (q > 0) coupling[q - 1] = lanczos->beta[q * k + j];
  }
  PetscCall(PetscBLASIntCast(steps, &size));
  PetscCallBLAS("LAPACKsteqr", LAPACKsteqr_("I", &size, mu, coupling, U, &size, work, &info));
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK steqr: info = %d", (int)info);
  for (PetscInt t = 0; t < n_times; t++) {
    PetscReal *at = temperature + (size_t)t * (size_t)p, weight[LANCZOS_MAX] = {0};
    for (PetscInt a = 0; a < steps; a++) {
      if (mu[a] <= 0.0) continue; // an exhausted space leaves zeros in T: no part of the answer
      const PetscReal g = modal_phi(PetscMax(1.0 / mu[a] - pole, 0.0), time[t]) / mu[a];
      for (PetscInt q = 0; q < steps; q++) weight[q] += length * U[a * steps] * g * U[q + a * steps];
    }
    for (PetscInt i = 0; i < p; i++) at[i] = 0.0;
    for (PetscInt q = 0; q < steps; q++) {
      const PetscReal *out = lanczos->outputs + ((size_t)q * (size_t)k + (size_t)j) * (size_t)p;
      for (PetscInt i = 0; i < p; i++) at[i] += weight[q] * out[i];
    }
  }
  PetscCall(PetscFree(U));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode lanczos_destroy(Lanczos **lanczos)
{
  PetscFunctionBeginUser;
  if (!*lanczos) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatDestroy(&(*lanczos)->previous));
  PetscCall(MatDestroy(&(*lanczos)->current));
  PetscCall(MatDestroy(&(*lanczos)->E_current));
  PetscCall(MatDestroy(&(*lanczos)->next));
  PetscCall(PetscFree3((*lanczos)->alpha, (*lanczos)->beta, (*lanczos)->outputs));
  PetscCall(PetscFree(*lanczos));
  PetscFunctionReturn(PETSC_SUCCESS);
}
