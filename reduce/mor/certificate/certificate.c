/* certificate.c
 * Galerkin's residual R(iw) has V^T R = 0, and C = B^T, so
 *   H - H_r = R^T (iw E + K)^-1 R.
 * In the generalised eigenbasis of (K, E), |lambda + iw| >= (lambda + w)/sqrt(2), hence
 *   ||H(iw) - H_r(iw)||_2 <= sqrt(2) lambda_max(R^H (w E + K)^-1 R).
 * Where V^T R = 0 holds only nearly, x^T V^T R comes on top.
 * R(iw) = R_0 Phi(iw) (residual.h), so the matrix G(w) = R_0^T (w E + K)^-1 R_0, p real solves, serves all w near by:
 * for u < w < v and any lambda_0 >= 0, with U = u + lambda_0, W = w + lambda_0 and V = v + lambda_0,
 *   1/(lambda + w) <= a/(lambda + u) + b/(lambda + v),  a = (U/W)^2 (V - W)/(V - U),  b = (V/W)^2 (W - U)/(V - U),
 * for the right side touches the left at lambda_0, and their difference times the denominators is
 * (a + b - 1)(lambda - lambda_0)^2 with a + b >= 1. The same holds between G(w), G(u) and G(v) as quadratic forms.
 * A second stage's part, T = H_projected - H_last, is known as it is. Beside it: (lambda + w)/(lambda + iw) lies on the
 * circle around (1 - i)/2 of radius 1/sqrt(2) for every lambda >= 0, so that
 *   ||H - H_last - T - (1 - i)/2 Phi^T G Phi||_2 <= lambda_max(Phi^H G Phi)/sqrt(2):
 * half of the bound above, around a centre that knows where the errors of the two stages cancel. The centre is taken
 * with G_e <= G, the energy of a Galerkin model of the error (error_model.h), which adds what G_e may lack. */
#include "reduce/mor/certificate/certificate_private.h"

#include <math.h>

#include "reduce/linear/dense_block.h"
#include "reduce/linear/small_dense.h"
#include "reduce/petsc/petsc_compat.h"

enum { NODES_PER_DECADE = 1 }; // of G: a power law w^(-1/2) is met within 1.2 between them

static const PetscReal NEGLIGIBLE = 0.02; // share of the residual that inexact solves may add unexamined

static PetscErrorCode allocate(Certificate *band)
{
  const size_t p = (size_t)band->p, square = p * p, nodes = (size_t)band->n_nodes;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc4(nodes, &band->node, nodes * square, &band->G, nodes, &band->solved, p, &band->weight));
  PetscCall(PetscMalloc2(nodes * square, &band->plain, nodes * square, &band->heat));
  for (int i = 0; i < 2; i++)
    PetscCall(PetscMalloc4(square, &band->Phi[i], square, &band->product[i], square, &band->part[i][0], square,
                           &band->part[i][1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode certificate_energy(const Certificate *band, const PetscReal *G, PetscReal *P, PetscReal *S)
{
  const PetscInt p = band->p;

  PetscFunctionBeginUser;
  for (int i = 0; i < 2; i++) PetscCall(small_multiply('N', 'N', p, p, p, 1.0, G, band->Phi[i], 0.0, band->product[i]));
  PetscCall(small_multiply('T', 'N', p, p, p, 1.0, band->Phi[0], band->product[0], 0.0, P));
  PetscCall(small_multiply('T', 'N', p, p, p, 1.0, band->Phi[1], band->product[1], 1.0, P));
  PetscCall(small_multiply('T', 'N', p, p, p, 1.0, band->Phi[0], band->product[1], 0.0, S));
  PetscCall(small_multiply('T', 'N', p, p, p, -1.0, band->Phi[1], band->product[0], 1.0, S));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode certificate_take_factor(const Certificate *band, PetscReal w)
{
  PetscFunctionBeginUser;
  PetscCall(residual_factor(band->residual, band->model, w, band->Phi[0], band->Phi[1]));
  for (int i = 0; i < 2; i++)
    for (PetscInt l = 0; l < band->p; l++)
      for (PetscInt k = 0; k < band->p; k++) band->Phi[i][k + l * band->p] *= band->weight[l];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* G at node i, and by how much inexact solves have spoilt R = R_0 Phi there. */
static PetscErrorCode solve_node(Certificate *band, const KrylovBasis *basis, ShiftedSolver *solver, PetscInt i)
{
  const size_t at = (size_t)i * (size_t)band->p * (size_t)band->p;
  PetscReal *G = band->G + at, largest, by_sums, defect;

  PetscFunctionBeginUser;
  PetscCall(residual_energy(band->residual, solver, band->node[i], G, band->plain + at, band->heat + at));
  PetscCall(certificate_take_factor(band, band->node[i]));
  PetscCall(certificate_energy(band, G, band->part[0][0], band->part[0][1]));
  PetscCall(small_hermitian_largest(band->model->comm, band->p, band->part[0][0], band->part[0][1], &largest));
  const PetscReal size = sqrt(PetscMax(largest, 0.0));
  const ResidualExam exam = {
      .weight = band->weight, .negligible = NEGLIGIBLE * size, .most_inputs = CERTIFICATE_MOST_PORTS};
  PetscCall(residual_defect(band->residual, basis, band->model, solver, &exam, &defect));
  PetscCall(residual_defect_by_sums(band->residual, band->model, band->node[i], band->weight, &by_sums));
  band->solved[i] = by_sums > 0.0 ? defect / by_sums : 1.0;
  if (size > 0.0) band->spoilt = PetscMax(band->spoilt, defect / size);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode find_slip(Certificate *band, const KrylovBasis *basis)
{
  PetscReal *slip;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)band->n_nodes, &slip));
  PetscCall(residual_slip(band->residual, basis, band->model, band->weight, band->n_nodes, band->node, slip));
  for (PetscInt i = 0; i < band->n_nodes; i++) band->slip = PetscMax(band->slip, slip[i]);
  PetscCall(PetscFree(slip));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The Galerkin model of G agrees with it at the nodes but for inexact solves and the directions dropped. */
static PetscErrorCode create_error_model(Certificate *band)
{
  const ErrorNodes nodes = {.n = band->n_nodes, .p = band->p, .rate = band->node, .G = band->plain, .heat = band->heat};
  const size_t square = (size_t)band->p * (size_t)band->p;
  PetscReal *G, *const *P = band->part[0], *const *S = band->part[1], energy, above, below;

  PetscFunctionBeginUser;
  if (band->p > CERTIFICATE_MOST_PORTS) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(error_model_create(band->model->comm, &nodes, 0, 1, &band->error));
  PetscCall(PetscMalloc1(square, &G));
  for (PetscInt i = 0; i < band->n_nodes; i++) {
    PetscCall(certificate_take_factor(band, band->node[i]));
    PetscCall(certificate_energy(band, band->plain + (size_t)i * square, P[0], S[0]));
    PetscCall(small_hermitian_largest(band->model->comm, band->p, P[0], S[0], &energy));
    PetscCall(error_model_energy(band->error, band->node[i], G));
    for (size_t e = 0; e < square; e++) G[e] -= band->plain[(size_t)i * square + e];
    PetscCall(certificate_energy(band, G, P[0], S[0]));
    PetscCall(small_hermitian_largest(band->model->comm, band->p, P[0], S[0], &above));
    for (size_t e = 0; e < square; e++) P[1][e] = -P[0][e], S[1][e] = -S[0][e];
    PetscCall(small_hermitian_largest(band->model->comm, band->p, P[1], S[1], &below));
    if (energy > 0.0) band->mismatch = PetscMax(band->mismatch, PetscMax(above, below) / energy);
  }
  PetscCall(PetscFree(G));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode certificate_create(const KrylovBasis *basis, const ModalModel *model, ShiftedSolver *solver,
                                  PetscReal w_first, PetscReal w_last, Certificate **out)
{
  Certificate *band;
  const PetscReal ratio = w_last / w_first, present = shifted_solver_get_shift(solver);
  const PetscBool downwards = (PetscBool)(present * present > w_first * w_last); // its preconditioner is at hand

  PetscFunctionBeginUser;
  PetscCall(PetscNew(&band));
  *out = band;
  *band = (Certificate){.system = basis->system, .model = model, .w_first = w_first, .w_last = w_last};
  band->m = basis->system->m;
  band->p = basis->p;
  band->n_nodes = 1 + PetscMax(1, (PetscInt)ceil(NODES_PER_DECADE * log10(ratio) - 1e-9));
  PetscCall(allocate(band));
  for (PetscInt l = 0; l < band->p; l++) band->weight[l] = l < band->m ? sqrt(basis->system->area[l]) : 0.0;
  for (PetscInt i = 0; i < band->n_nodes; i++)
    band->node[i] = i == band->n_nodes - 1 ? w_last : w_first * pow(ratio, (double)i / (double)(band->n_nodes - 1));
  PetscCall(residual_create(basis, model, &band->residual));
  PetscCall(find_slip(band, basis));
  for (PetscInt k = 0; k < band->n_nodes; k++)
    PetscCall(solve_node(band, basis, solver, downwards ? band->n_nodes - 1 - k : k));
  PetscCall(create_error_model(band));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const Residual *certificate_get_residual(const Certificate *certificate)
{
  return certificate->residual;
}

/* By the nodes first, first + stride, .. */
static PetscErrorCode missing_steps(const Certificate *band, const ErrorSteps *steps, PetscInt first, PetscInt stride,
                                    PetscReal *temperature)
{
  const ErrorNodes nodes = {.n = band->n_nodes, .p = band->p, .rate = band->node, .G = band->plain, .heat = band->heat};
  ErrorModel *error;

  PetscFunctionBeginUser;
  PetscCall(error_model_create(band->model->comm, &nodes, first, stride, &error));
  PetscCall(error_model_steps(error, band->residual, band->model, steps, temperature));
  PetscCall(error_model_destroy(&error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Every other node alone gives the error less well by far, be they the even or the odd ones: the smaller of both
 * differences is above what all of them miss. What R_0 Phi leaves out enters once at either end. */
PetscErrorCode certificate_correct(const Certificate *band, StepReference *reference)
{
  const size_t size = (size_t)reference->n_times * (size_t)reference->n_inputs * (size_t)reference->p;
  const ErrorSteps steps = {
      .n_inputs = reference->n_inputs, .n_times = reference->n_times, .u = reference->u, .time = reference->time};
  PetscReal *missing, *even, *odd;

  PetscFunctionBeginUser;
  PetscCheck(band->error, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONGSTATE,
             "%" PetscInt_FMT " inputs: at most %d are expected", band->p, (int)CERTIFICATE_MOST_PORTS);
  PetscCall(PetscMalloc3(size, &missing, size, &even, size, &odd));
  PetscCall(error_model_steps(band->error, band->residual, band->model, &steps, missing));
  PetscCall(missing_steps(band, &steps, 0, 2, even));
  PetscCall(missing_steps(band, &steps, 1, 2, odd));
  for (size_t e = 0; e < size; e++)
    even[e] = PetscMin(PetscAbsReal(even[e] - missing[e]), PetscAbsReal(odd[e] - missing[e])) +
              2.0 * band->spoilt * PetscAbsReal(missing[e]);
  PetscCall(step_reference_set(reference, band->model, missing, even));
  PetscCall(PetscFree3(missing, even, odd));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode certificate_destroy(Certificate **certificate)
{
  Certificate *band = *certificate;

  PetscFunctionBeginUser;
  if (!band) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree2(band->plain, band->heat));
  PetscCall(PetscFree4(band->node, band->G, band->solved, band->weight));
  for (int i = 0; i < 2; i++) PetscCall(PetscFree4(band->Phi[i], band->product[i], band->part[i][0], band->part[i][1]));
  PetscCall(residual_destroy(&band->residual));
  PetscCall(error_model_destroy(&band->error));
  PetscCall(PetscFree(band));
  *certificate = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}
