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
 * A second stage adds ||H_projected - H_last||_2, which is computed as it is; or its own residual is taken
 * (residual_truncated.c), which knows where the errors of the two stages cancel: the smaller one counts. */
#include "reduce/mor/certificate.h"

#include <math.h>

#include "reduce/mor/dense_block.h"
#include "reduce/mor/small_dense.h"
#include "reduce/petsc_compat.h"

enum {
  NODES_PER_DECADE = 1,      // of G: a power law w^(-1/2) is met within 1.2 between them
  EVALUATIONS_PER_DECADE = 2 // of the bound, and as many again halfway between
};

enum { MOST_INPUTS = 256 };           // for which a second stage's own residual is worth its r^2 p multiplications
static const PetscReal CANCELS = 0.1; // where the second stage's error is above this share of the first's

static const PetscReal ROUNDING = 1e-12;   // of the arithmetic, relative to ||H||
static const PetscReal NEGLIGIBLE = 0.002; // share of the residual that inexact solves may add unexamined

struct Certificate {
  const ThermalSystem *system; // borrowed
  const ModalModel *model;     // borrowed
  Residual *residual;
  PetscReal w_first, w_last;
  PetscInt m, p, n_nodes;
  PetscReal *node, *G;    // [n_nodes] rad/s, [n_nodes x p x p]
  ResidualDefect *defect; // [n_nodes]
  PetscBool everywhere;   // it matters: worked out at each node from here on
  PetscReal *Phi[2];      // [p x p] factor of the residual, its columns scaled by `weight`
  PetscReal *product[2];  // [p x p]
  PetscReal *part[2][2];  // [node below or above][P or S] [p x p]
  PetscReal *weight;      // [p] area^(1/2), 0 for the ambient
};

static PetscErrorCode allocate(Certificate *band)
{
  const size_t p = (size_t)band->p, square = p * p, nodes = (size_t)band->n_nodes;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc4(nodes, &band->node, nodes * square, &band->G, nodes, &band->defect, p, &band->weight));
  for (int i = 0; i < 2; i++)
    PetscCall(PetscMalloc4(square, &band->Phi[i], square, &band->product[i], square, &band->part[i][0], square,
                           &band->part[i][1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* P + iS = (Phi D)^H G (Phi D), Hermitian; G of one node. */
static PetscErrorCode energy(const Certificate *band, const PetscReal *G, PetscReal *P, PetscReal *S)
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

/* Phi(iw) D */
static PetscErrorCode weighted_factor(const Certificate *band, PetscReal w)
{
  PetscFunctionBeginUser;
  PetscCall(residual_factor(band->residual, band->model, w, band->Phi[0], band->Phi[1]));
  for (int i = 0; i < 2; i++)
    for (PetscInt l = 0; l < band->p; l++)
      for (PetscInt k = 0; k < band->p; k++) band->Phi[i][k + l * band->p] *= band->weight[l];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The defect is worked out at both ends and in the middle, and at every node once it was seen to matter. */
static PetscBool known_here(const Certificate *band, PetscInt i)
{
  return (PetscBool)(band->everywhere || i == 0 || i == band->n_nodes / 2 || i == band->n_nodes - 1);
}

/* G at node i, and by how much inexact solves have spoilt R = R_0 Phi there. */
static PetscErrorCode solve_node(Certificate *band, const KrylovBasis *basis, ShiftedSolver *solver, PetscInt i)
{
  PetscReal *G = band->G + (size_t)i * (size_t)band->p * (size_t)band->p, largest;

  PetscFunctionBeginUser;
  PetscCall(residual_energy(band->residual, solver, band->node[i], G));
  band->defect[i] = (ResidualDefect){0.0, 0.0};
  if (!known_here(band, i)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(weighted_factor(band, band->node[i]));
  PetscCall(energy(band, G, band->part[0][0], band->part[0][1]));
  PetscCall(small_hermitian_largest(band->model->comm, band->p, band->part[0][0], band->part[0][1], &largest));
  PetscCall(residual_defect(band->residual, basis, band->model, solver, band->weight,
                            NEGLIGIBLE * sqrt(PetscMax(largest, 0.0)), &band->defect[i]));
  if (band->defect[i].size > NEGLIGIBLE * sqrt(PetscMax(largest, 0.0))) band->everywhere = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Known at the nodes i and j, small against the residual, and about a power of the rate: twice that between them. */
static void spread_defects(Certificate *band, PetscInt i, PetscInt j)
{
  for (PetscInt k = i + 1; k < j; k++) {
    if (band->defect[k].size > 0.0) continue;
    const PetscReal share = log(band->node[k] / band->node[i]) / log(band->node[j] / band->node[i]);
    band->defect[k].size = 2.0 * pow(band->defect[i].size, 1.0 - share) * pow(band->defect[j].size, share);
    band->defect[k].slip = 2.0 * pow(band->defect[i].slip, 1.0 - share) * pow(band->defect[j].slip, share);
  }
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
  for (PetscInt k = 0; k < band->n_nodes; k++)
    PetscCall(solve_node(band, basis, solver, downwards ? band->n_nodes - 1 - k : k));
  spread_defects(band, 0, band->n_nodes / 2);
  spread_defects(band, band->n_nodes / 2, band->n_nodes - 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* lambda_max of Phi^H G(w) Phi + P + iS, from above, by the nodes around w; by how much the projection slips.
 *   more  P, S, or NULL: none */
static PetscErrorCode largest_energy(const Certificate *band, PetscReal w, PetscReal *const more[2], PetscReal *largest,
                                     PetscReal *slip)
{
  const size_t square = (size_t)band->p * (size_t)band->p;
  PetscReal *const *below = band->part[0], *const *above = band->part[1];
  PetscInt k = 0;

  PetscFunctionBeginUser;
  while (k < band->n_nodes - 2 && band->node[k + 1] <= w) k++;
  const PetscReal U = band->node[k] + w, W = 2.0 * w, V = band->node[k + 1] + w; // lambda_0 = w
  const PetscReal a = (U / W) * (U / W) * (V - W) / (V - U), b = (V / W) * (V / W) * (W - U) / (V - U);
  PetscCall(energy(band, band->G + (size_t)k * square, below[0], below[1]));
  PetscCall(energy(band, band->G + (size_t)(k + 1) * square, above[0], above[1]));
  for (int i = 0; i < 2; i++)
    for (size_t e = 0; e < square; e++) below[i][e] = a * below[i][e] + b * above[i][e] + (more ? more[i][e] : 0.0);
  PetscCall(small_hermitian_largest(band->model->comm, band->p, below[0], below[1], largest));
  const PetscReal size = PetscMax(band->defect[k].size, band->defect[k + 1].size);
  *largest = pow(sqrt(PetscMax(*largest, 0.0)) + size, 2.0);
  *slip = PetscMax(band->defect[k].slip, band->defect[k + 1].slip);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ||D (H - H_other) D||_2 of two models, other NULL: of one; by the Hermitian X^H X, X = P + iS with P, S symmetric. */
static PetscErrorCode transfer_norm(const Certificate *band, const ModalModel *model, const ModalModel *other,
                                    PetscReal w, PetscReal *norm)
{
  const PetscInt p = band->p;
  PetscReal *P = band->part[0][0], *S = band->part[0][1], *real = band->part[1][0], *imaginary = band->part[1][1];

  PetscFunctionBeginUser;
  PetscCall(modal_model_transfer(model, other, w, P, S));
  for (PetscInt j = 0; j < p; j++)
    for (PetscInt i = 0; i < p; i++) {
      P[i + j * p] *= band->weight[i] * band->weight[j];
      S[i + j * p] *= band->weight[i] * band->weight[j];
    }
  /* (P - iS)(P + iS) = (P^2 + S^2) + i(PS - SP) */
  PetscCall(small_multiply('N', 'N', p, p, p, 1.0, P, P, 0.0, real));
  PetscCall(small_multiply('N', 'N', p, p, p, 1.0, S, S, 1.0, real));
  PetscCall(small_multiply('N', 'N', p, p, p, 1.0, P, S, 0.0, imaginary));
  PetscCall(small_multiply('N', 'N', p, p, p, -1.0, S, P, 1.0, imaginary));
  PetscCall(small_hermitian_largest(model->comm, p, real, imaginary, norm));
  *norm = sqrt(PetscMax(*norm, 0.0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By the residual of the last model itself. Inexact solves count twice: they were examined on the projected one. */
static PetscErrorCode own_bound(const Certificate *band, const TruncatedModel *cut, PetscReal w, PetscReal *bound)
{
  const size_t square = (size_t)band->p * (size_t)band->p;
  PetscReal *more[2], largest, slip;
  Certificate doubtful = *band;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc3(square, &more[0], square, &more[1], (size_t)band->n_nodes, &doubtful.defect));
  for (PetscInt i = 0; i < band->n_nodes; i++)
    doubtful.defect[i] = (ResidualDefect){.size = 2.0 * band->defect[i].size, .slip = 2.0 * band->defect[i].slip};
  PetscCall(residual_truncated(band->residual, band->model, cut, w, band->weight, band->Phi, more[0], more[1]));
  PetscCall(largest_energy(&doubtful, w, more, &largest, &slip));
  *bound = PETSC_SQRT2 * largest + slip;
  PetscCall(PetscFree3(more[0], more[1], doubtful.defect));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode bound_at(const Certificate *band, const TruncatedModel *cut, PetscReal w, PetscReal *bound)
{
  PetscReal largest, slip = 0.0, truncated = 0.0, norm;

  PetscFunctionBeginUser;
  PetscCall(weighted_factor(band, w));
  PetscCall(largest_energy(band, w, NULL, &largest, &slip));
  if (cut->last != band->model) PetscCall(transfer_norm(band, band->model, cut->last, w, &truncated));
  PetscCall(transfer_norm(band, cut->last, NULL, w, &norm));
  *bound = PETSC_SQRT2 * largest + slip + truncated;
  if (cut->W && truncated > CANCELS * PETSC_SQRT2 * largest) {
    PetscReal own = *bound;
    PetscCall(own_bound(band, cut, w, &own));
    *bound = PetscMin(*bound, own);
  }
  *bound = *bound / norm + ROUNDING;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* W = Q^T Q_last: both bases' coordinates are orthonormal. */
static PetscErrorCode describe_cut(const Certificate *band, const ModalModel *last, TruncatedModel *cut)
{
  const ModalModel *model = band->model;

  PetscFunctionBeginUser;
  *cut = (TruncatedModel){.last = last};
  if (last == model || band->p > MOST_INPUTS) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1((size_t)model->r * (size_t)last->r, &cut->W));
  PetscCall(small_multiply('T', 'N', model->r, last->r, model->n_basis, 1.0, model->Q, last->Q, 0.0, cut->W));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode certificate_transfer_bounds(const Certificate *band, const ModalModel *last, PetscInt *n,
                                           PetscReal **frequency, PetscReal **bound)
{
  const PetscReal ratio = band->w_last / band->w_first;
  const PetscInt gaps = PetscMax(1, (PetscInt)ceil(EVALUATIONS_PER_DECADE * log10(ratio) - 1e-9));
  PetscReal *w, *at, missed = 0.0;
  TruncatedModel cut;

  PetscFunctionBeginUser;
  PetscCall(describe_cut(band, last, &cut));
  *n = 2 * gaps + 1;
  PetscCall(PetscMalloc2((size_t)*n, &w, (size_t)*n, &at));
  for (PetscInt i = 0; i < *n; i++) {
    w[i] = i == *n - 1 ? band->w_last : band->w_first * pow(ratio, (double)i / (double)(*n - 1));
    PetscCall(bound_at(band, &cut, w[i], &at[i]));
  }
  for (PetscInt i = 1; i < *n; i += 2) missed = PetscMax(missed, at[i] / sqrt(at[i - 1] * at[i + 1]) - 1.0);
  for (PetscInt i = 0; i < *n; i++) at[i] *= 1.0 + 0.5 * missed; // the gaps are half as wide now: a quarter would do
  PetscCall(PetscFree(cut.W));
  *frequency = w;
  *bound = at;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode certificate_destroy(Certificate **certificate)
{
  Certificate *band = *certificate;

  PetscFunctionBeginUser;
  if (!band) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree4(band->node, band->G, band->defect, band->weight));
  for (int i = 0; i < 2; i++) PetscCall(PetscFree4(band->Phi[i], band->product[i], band->part[i][0], band->part[i][1]));
  PetscCall(residual_destroy(&band->residual));
  PetscCall(PetscFree(band));
  *certificate = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}
