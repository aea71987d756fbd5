/* residual_defect.c - what inexact solves, or a projection from moments, have spoilt of R = R_0 Phi and V^T R = 0.
 * R_0 Phi - R = (K V - E V K_r - R_0 c^T) x(iw): random sums of the bracket's rows, made once (Residual.left), give the
 * size at every rate: E ||S^T A||_F^2 = ||A||_F^2 in the norm of diag(E)^-1 (Hutchinson 1990, Commun. Stat. Simul. 19,
 * 433). */
#include "reduce/mor/dense_block.h"
#include "reduce/mor/residual_private.h"
#include "reduce/mor/small_dense.h"
#include "reduce/petsc_compat.h"

typedef struct Probes { // inputs, or sums of them, on which inexact solves are examined
  PetscInt k;
  PetscReal *W;            // [p x k]
  PetscReal safety;        // of norms found by them
  const PetscReal *weight; // [p] D's diagonal; borrowed
} Probes;

/* Add Re and Im of (iw E + K) V x(iw) W, W [p x k]: with V x W = a + ib,  K a - w E b  and  K b + w E a. */
static PetscErrorCode applied(const Residual *residual, const KrylovBasis *basis, const ModalModel *model, PetscReal w,
                              const Probes *probes, Mat of[2])
{
  const ThermalSystem *system = residual->system;
  const PetscInt p = residual->p, r = residual->r, k = probes->k;
  Mat Vx, product;
  PetscReal *x, *xW, *QxW, *factor;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc4((size_t)r * (size_t)p, &x, (size_t)r * (size_t)k, &xW, (size_t)r * (size_t)k, &QxW, (size_t)k,
                         &factor));
  PetscCall(dense_block_create(system->E, k, &Vx));
  PetscCall(dense_block_create(system->E, k, &product));
  for (int part = 0; part < 2; part++) {
    residual_modal_state(model, w, part, x);
    PetscCall(small_multiply('T', 'N', r, k, p, 1.0, x, probes->W, 0.0, xW));
    PetscCall(small_multiply('N', 'N', r, k, r, 1.0, model->Q, xW, 0.0, QxW));
    PetscCall(krylov_basis_combine(basis, QxW, Vx));
    PetscCall(dense_block_multiply(system->K, Vx, product));
    for (PetscInt c = 0; c < k; c++) factor[c] = 1.0;
    PetscCall(dense_block_axpby(of[part], 1.0, factor, product));
    PetscCall(dense_block_multiply(system->E, Vx, product));
    for (PetscInt c = 0; c < k; c++) factor[c] = part == 0 ? w : -w;
    PetscCall(dense_block_axpby(of[1 - part], 1.0, factor, product));
  }
  PetscCall(MatDestroy(&Vx));
  PetscCall(MatDestroy(&product));
  PetscCall(PetscFree4(x, xW, QxW, factor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ||M^(-1/2) (R_0 Phi - R) D||_F <= ||diag(w E_ii)^(-1/2) ..||_F/sqrt(share), w the rate, by the sums of its rows */
PetscErrorCode residual_defect_by_sums(const Residual *residual, const ModalModel *model, PetscReal w,
                                       const PetscReal *weight, PetscReal *size)
{
  const PetscInt p = residual->p, k = RESIDUAL_PROBES;
  PetscReal *x, *sums;

  PetscFunctionBeginUser;
  *size = 0.0;
  PetscCall(PetscMalloc2((size_t)model->r * (size_t)p, &x, (size_t)k * (size_t)p, &sums));
  for (int part = 0; part < 2; part++) {
    residual_modal_state(model, w, part, x);
    PetscCall(small_multiply('N', 'T', k, p, model->r, 1.0, residual->left, x, 0.0, sums));
    for (PetscInt l = 0; l < p; l++)
      for (PetscInt c = 0; c < k; c++) *size += PetscSqr(weight[l] * sums[c + l * k]);
  }
  *size = RESIDUAL_PROBE_SAFETY * PetscSqrtReal(*size / (w * RESIDUAL_DIAGONAL_SHARE));
  PetscCall(PetscFree2(x, sums));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The 2-norm of M^(-1/2) (X_r + i X_i), M = w E + K, from above; both: [X_r, X_i] */
static PetscErrorCode solved_size(const ThermalSystem *system, ShiftedSolver *solver, Mat both, PetscReal *size)
{
  PetscInt k;
  PetscReal *G, *P, *S, largest;

  PetscFunctionBeginUser;
  PetscCall(MatGetSize(both, NULL, &k));
  const PetscInt half = k / 2;
  const size_t square = (size_t)half * (size_t)half;
  PetscCall(PetscMalloc3((size_t)k * (size_t)k, &G, square, &P, square, &S));
  PetscCall(residual_energy_of(system, solver, both, G, NULL, NULL));
  for (PetscInt j = 0; j < half; j++)
    for (PetscInt i = 0; i < half; i++) {
      P[i + j * half] = G[i + j * k] + G[i + half + (j + half) * k];
      S[i + j * half] = G[i + (j + half) * k] - G[i + half + j * k];
    }
  PetscCall(small_hermitian_largest(PetscObjectComm((PetscObject)system->E), half, P, S, &largest));
  *size = PetscSqrtReal(PetscMax(largest, 0.0));
  PetscCall(PetscFree3(G, P, S));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ||D x^T V^T R W||_F at iw, of = -R W */
static PetscErrorCode galerkin_slip(const KrylovBasis *basis, const ModalModel *model, PetscReal w,
                                    const Probes *probes, Mat of[2], PetscReal *slip)
{
  const PetscInt p = basis->p, r = basis->r, k = probes->k;
  PetscReal *inner, *turned, *x, *S[2];

  PetscFunctionBeginUser;
  const size_t size = (size_t)r * (size_t)k, square = (size_t)k * (size_t)p;
  PetscCall(PetscMalloc5(size, &inner, size, &turned, (size_t)r * (size_t)p, &x, square, &S[0], square, &S[1]));
  for (int part = 0; part < 2; part++) { // (a + ib)^T (c + id), [k x p]: R^T V of one part times both of x
    PetscCall(krylov_basis_inner(basis, of[part], inner));
    PetscCall(small_multiply('N', 'N', k, r, r, 1.0, inner, model->Q, 0.0, turned));
    for (int other = 0; other < 2; other++) {
      residual_modal_state(model, w, other, x);
      PetscCall(small_multiply('N', 'T', k, p, r, part == 1 && other == 1 ? -1.0 : 1.0, turned, x,
                               part == 0 ? 0.0 : 1.0, S[part == other ? 0 : 1]));
    }
  }
  *slip = 0.0;
  for (PetscInt j = 0; j < p; j++)
    for (PetscInt i = 0; i < k; i++) {
      const PetscReal size_2 = S[0][i + j * k] * S[0][i + j * k] + S[1][i + j * k] * S[1][i + j * k];
      *slip += probes->weight[j] * probes->weight[j] * size_2;
    }
  *slip = probes->safety * PetscSqrtReal(*slip);
  PetscCall(PetscFree5(inner, turned, x, S[0], S[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* W: all inputs, or of many a few random sums with signs +-1/sqrt(k), the same on every rank: then
 * ||X D||_F^2 = E ||X W||_F^2. */
static PetscErrorCode choose_probes(PetscInt p, const PetscReal *weight, PetscBool every_input, Probes *probes)
{
  const PetscBool all = (PetscBool)(every_input || p <= 2 * RESIDUAL_PROBES);
  uint64_t random = 0x9e3779b97f4a7c15u;

  PetscFunctionBeginUser;
  *probes = (Probes){.k = all ? p : RESIDUAL_PROBES, .safety = all ? 1.0 : RESIDUAL_PROBE_SAFETY, .weight = weight};
  PetscCall(PetscCalloc1((size_t)p * (size_t)probes->k, &probes->W));
  for (PetscInt l = 0; l < p; l++) {
    if (all) probes->W[l + l * p] = weight[l];
    for (PetscInt c = 0; c < probes->k && !all; c++) {
      random = random * 6364136223846793005u + 1442695040888963407u;
      probes->W[l + c * p] = (random >> 63 ? 1.0 : -1.0) * weight[l] / PetscSqrtReal((PetscReal)probes->k);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* of = (R_0 Phi - R) W at iw; what V^T R is, on the way */
static PetscErrorCode spoilt_part(const Residual *residual, const KrylovBasis *basis, const ModalModel *model,
                                  PetscReal w, const Probes *probes, Mat of[2], PetscReal *slip)
{
  const PetscInt p = residual->p, k = probes->k;
  PetscReal *Phi[2], *PhiW;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc3((size_t)p * (size_t)p, &Phi[0], (size_t)p * (size_t)p, &Phi[1], (size_t)p * (size_t)k, &PhiW));
  PetscCall(applied(residual, basis, model, w, probes, of));
  PetscCall(dense_block_combine(of[0], 1.0, -1.0, basis->ports, probes->W, p)); // -R W
  *slip = 0.0; // with vectors that are orthonormal to rounding, and K_r made of them, V^T R is rounding too
  if (basis->blocks) PetscCall(galerkin_slip(basis, model, w, probes, of, slip));
  PetscCall(residual_factor(residual, model, w, Phi[0], Phi[1]));
  for (int part = 0; part < 2; part++) {
    PetscCall(small_multiply('N', 'N', p, k, p, 1.0, Phi[part], probes->W, 0.0, PhiW));
    PetscCall(dense_block_combine(of[part], 1.0, 1.0, residual->R0, PhiW, p));
  }
  PetscCall(PetscFree3(Phi[0], Phi[1], PhiW));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The slip by products with the vectors; solve: the size by solves on every input, too */
static PetscErrorCode examine(const Residual *residual, const KrylovBasis *basis, const ModalModel *model,
                              ShiftedSolver *solver, const PetscReal *weight, PetscBool solve, ResidualDefect *defect)
{
  Mat both, of[2];
  Probes probes;

  PetscFunctionBeginUser;
  PetscCall(choose_probes(residual->p, weight, solve, &probes));
  PetscCall(dense_block_create(residual->system->E, 2 * probes.k, &both));
  PetscCall(dense_block_create(residual->system->E, probes.k, &of[0]));
  PetscCall(dense_block_create(residual->system->E, probes.k, &of[1]));
  PetscCall(spoilt_part(residual, basis, model, shifted_solver_get_shift(solver), &probes, of, &defect->slip));
  for (int part = 0; part < 2; part++) PetscCall(dense_block_copy(both, part * probes.k, of[part], NULL, probes.k));
  if (solve) PetscCall(solved_size(residual->system, solver, both, &defect->size));
  PetscCall(MatDestroy(&both));
  PetscCall(MatDestroy(&of[0]));
  PetscCall(MatDestroy(&of[1]));
  PetscCall(PetscFree(probes.W));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode residual_defect(const Residual *residual, const KrylovBasis *basis, const ModalModel *model,
                               ShiftedSolver *solver, const PetscReal *weight, PetscReal negligible,
                               ResidualDefect *defect)
{
  PetscFunctionBeginUser;
  defect->slip = 0.0;
  PetscCall(residual_defect_by_sums(residual, model, shifted_solver_get_shift(solver), weight, &defect->size));
  const PetscBool solve = (PetscBool)(defect->size > negligible);
  if (solve || basis->blocks) PetscCall(examine(residual, basis, model, solver, weight, solve, defect));
  PetscFunctionReturn(PETSC_SUCCESS);
}
