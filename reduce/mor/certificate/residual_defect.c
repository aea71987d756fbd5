/* residual_defect.c - what inexact solves, or a projection from moments, have spoilt of R = R_0 Phi and V^T R = 0.
 * R_0 Phi - R = (K V - E V K_r - R_0 c^T) x(iw): random sums of the bracket's rows, made once (Residual.left), give the
 * size at every rate: E ||S^T A||_F^2 = ||A||_F^2 in the norm of diag(E)^-1 (Hutchinson 1990, Commun. Stat. Simul. 19,
 * 433). */
#include "reduce/linear/dense_block.h"
#include "reduce/linear/small_dense.h"
#include "reduce/mor/certificate/residual_private.h"
#include "reduce/petsc/petsc_compat.h"

typedef struct Probes { // inputs, or sums of them, on which inexact solves are examined
  PetscInt k;
  PetscReal *W;            // [p x k]
  PetscReal safety;        // of norms found by them
  const PetscReal *weight; // [p] D's diagonal; borrowed
} Probes;

/* A block of columns of another block: first .. first + k */
static PetscErrorCode axpby_part(Mat Y, PetscInt to, PetscInt k, const PetscReal *factor, Mat X, PetscInt from)
{
  Mat part_x, part_y;

  PetscFunctionBeginUser;
  PetscCall(MatDenseGetSubMatrix(Y, PETSC_DECIDE, PETSC_DECIDE, to, to + k, &part_y));
  PetscCall(MatDenseGetSubMatrix(X, PETSC_DECIDE, PETSC_DECIDE, from, from + k, &part_x));
  PetscCall(dense_block_axpby(part_y, 1.0, factor, part_x));
  PetscCall(MatDenseRestoreSubMatrix(X, &part_x));
  PetscCall(MatDenseRestoreSubMatrix(Y, &part_y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* (iw E + K) V x(iw) W at n rates w, in one pass over V: with V x W = a + ib,  K a - w E b  and  K b + w E a.
 *   both  out, [n_dof x 2 n k]: real parts of all rates, then imaginary parts */
static PetscErrorCode applied(const Residual *residual, const KrylovBasis *basis, const ModalModel *model, PetscInt n,
                              const PetscReal *rate, const Probes *probes, Mat both)
{
  const ThermalSystem *system = residual->system;
  const PetscInt p = residual->p, r = residual->r, k = probes->k, half = n * k;
  Mat Vx, product;
  PetscReal *x, *xW, *QxW, *factor;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc4((size_t)r * (size_t)p, &x, (size_t)r * (size_t)k, &xW, (size_t)r * (size_t)(2 * half), &QxW,
                         (size_t)half, &factor));
  for (int part = 0; part < 2; part++)
    for (PetscInt i = 0; i < n; i++) {
      residual_modal_state(model, rate[i], part, x);
      PetscCall(small_multiply('T', 'N', r, k, p, 1.0, x, probes->W, 0.0, xW));
      PetscCall(
          small_multiply('N', 'N', r, k, r, 1.0, model->Q, xW, 0.0, QxW + (size_t)r * (size_t)(part * half + i * k)));
    }
  PetscCall(dense_block_create(system->E, 2 * half, &Vx));
  PetscCall(dense_block_create(system->E, 2 * half, &product));
  PetscCall(krylov_basis_combine(basis, QxW, Vx));
  PetscCall(dense_block_multiply(system->K, Vx, both));
  PetscCall(dense_block_multiply(system->E, Vx, product));
  for (int part = 0; part < 2; part++) {
    for (PetscInt c = 0; c < half; c++) factor[c] = part == 0 ? -rate[c / k] : rate[c / k];
    PetscCall(axpby_part(both, part * half, half, factor, product, (1 - part) * half));
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

/* The norm of M^(-1/2) (X_r + i X_i), M = w E + K, from above; both: [X_r, X_i]. The 2-norm; frobenius: Frobenius',
 * which is what random sums tell. */
static PetscErrorCode solved_size(const ThermalSystem *system, ShiftedSolver *solver, Mat both, PetscBool frobenius,
                                  PetscReal *size)
{
  PetscInt k;
  PetscReal *G, *P, *S, largest = 0.0;

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
  if (frobenius)
    for (PetscInt j = 0; j < half; j++) largest += P[j + j * half];
  else
    PetscCall(small_hermitian_largest(PetscObjectComm((PetscObject)system->E), half, P, S, &largest));
  *size = PetscSqrtReal(PetscMax(largest, 0.0));
  PetscCall(PetscFree3(G, P, S));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* W: all inputs, or of more than `most` a few random sums with signs +-1/sqrt(k), the same on every rank: then
 * ||X D||_F^2 = E ||X W||_F^2. */
static PetscErrorCode choose_probes(PetscInt p, const PetscReal *weight, PetscInt most, Probes *probes)
{
  const PetscBool all = (PetscBool)(p <= most);
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

/* both += sign X F, F = Re, Im [p x k] of one rate; imaginary NULL: of the real part only */
static PetscErrorCode add_ports(Mat both, PetscReal sign, Mat X, PetscInt k, PetscInt p, PetscReal *const F[2])
{
  PetscFunctionBeginUser;
  for (int part = 0; part < 2 && F[part]; part++) {
    Mat columns;
    PetscCall(MatDenseGetSubMatrix(both, PETSC_DECIDE, PETSC_DECIDE, part * k, (part + 1) * k, &columns));
    PetscCall(dense_block_combine(columns, 1.0, sign, X, F[part], p));
    PetscCall(MatDenseRestoreSubMatrix(both, &columns));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ||D x^T V^T R W||_F at iw; inner = V^T R W, [k x r] of either part: (a + ib)^T (c + id), [k x p] */
static PetscErrorCode slip_at(const ModalModel *model, PetscReal w, const Probes *probes, PetscReal *const inner[2],
                              PetscReal *slip)
{
  const PetscInt p = model->p, r = model->r, k = probes->k;
  const size_t square = (size_t)k * (size_t)p;
  PetscReal *turned, *x, *S[2];

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc4((size_t)r * (size_t)k, &turned, (size_t)r * (size_t)p, &x, square, &S[0], square, &S[1]));
  for (int part = 0; part < 2; part++) {
    PetscCall(small_multiply('N', 'N', k, r, r, 1.0, inner[part], model->Q, 0.0, turned));
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
  PetscCall(PetscFree4(turned, x, S[0], S[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Vectors on disk are read twice for all rates together. */
PetscErrorCode residual_slip(const Residual *residual, const KrylovBasis *basis, const ModalModel *model,
                             const PetscReal *weight, PetscInt n, const PetscReal *rate, PetscReal *slip)
{
  Mat both;
  Probes probes;
  PetscReal *inner, *part[2], *ones;

  PetscFunctionBeginUser;
  PetscCall(PetscArrayzero(slip, n));
  if (!basis->blocks) PetscFunctionReturn(PETSC_SUCCESS); // orthonormal to rounding, and K_r made of the vectors
  PetscCall(choose_probes(residual->p, weight, 2 * RESIDUAL_PROBES, &probes));
  const PetscInt k = probes.k, r = residual->r, all = 2 * n * k;
  PetscCall(dense_block_create(residual->system->E, all, &both));
  PetscCall(applied(residual, basis, model, n, rate, &probes, both));
  PetscCall(PetscMalloc4((size_t)all * (size_t)r, &inner, (size_t)k * (size_t)r, &part[0], (size_t)k * (size_t)r,
                         &part[1], (size_t)residual->p * (size_t)(n * k), &ones));
  for (PetscInt i = 0; i < n; i++)
    PetscCall(PetscArraycpy(ones + (size_t)residual->p * (size_t)(i * k), probes.W, residual->p * k));
  PetscCall(add_ports(both, -1.0, basis->ports, n * k, residual->p, (PetscReal *const[2]){ones, NULL})); // -R W
  PetscCall(krylov_basis_inner(basis, both, inner));
  PetscCall(MatDestroy(&both));
  for (PetscInt i = 0; i < n; i++) {
    for (int im = 0; im < 2; im++)
      for (PetscInt j = 0; j < r; j++)
        PetscCall(PetscArraycpy(part[im] + (size_t)j * (size_t)k,
                                inner + (size_t)j * (size_t)all + (size_t)((im * n + i) * k), k));
    PetscCall(slip_at(model, rate[i], &probes, part, &slip[i]));
  }
  PetscCall(PetscFree4(inner, part[0], part[1], ones));
  PetscCall(PetscFree(probes.W));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* both = (R_0 Phi - R) W at iw */
static PetscErrorCode spoilt_part(const Residual *residual, const KrylovBasis *basis, const ModalModel *model,
                                  PetscReal w, const Probes *probes, Mat both)
{
  const PetscInt p = residual->p, k = probes->k;
  PetscReal *Phi[2], *PhiW[2];

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc4((size_t)p * (size_t)p, &Phi[0], (size_t)p * (size_t)p, &Phi[1], (size_t)p * (size_t)k,
                         &PhiW[0], (size_t)p * (size_t)k, &PhiW[1]));
  PetscCall(applied(residual, basis, model, 1, &w, probes, both));
  PetscCall(add_ports(both, -1.0, basis->ports, k, p, (PetscReal *const[2]){probes->W, NULL})); // -R W
  PetscCall(residual_factor(residual, model, w, Phi[0], Phi[1]));
  for (int part = 0; part < 2; part++)
    PetscCall(small_multiply('N', 'N', p, k, p, 1.0, Phi[part], probes->W, 0.0, PhiW[part]));
  PetscCall(add_ports(both, 1.0, residual->R0, k, p, PhiW));
  PetscCall(PetscFree4(Phi[0], Phi[1], PhiW[0], PhiW[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode residual_defect(const Residual *residual, const KrylovBasis *basis, const ModalModel *model,
                               ShiftedSolver *solver, const ResidualExam *exam, PetscReal *size)
{
  Mat both;
  Probes probes;

  PetscFunctionBeginUser;
  const PetscReal w = shifted_solver_get_shift(solver);
  PetscCall(residual_defect_by_sums(residual, model, w, exam->weight, size));
  if (*size <= exam->negligible) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(choose_probes(residual->p, exam->weight, exam->most_inputs, &probes));
  PetscCall(dense_block_create(residual->system->E, 2 * probes.k, &both));
  PetscCall(spoilt_part(residual, basis, model, w, &probes, both));
  PetscCall(solved_size(residual->system, solver, both, (PetscBool)(residual->p > exam->most_inputs), size));
  *size *= probes.safety;
  PetscCall(MatDestroy(&both));
  PetscCall(PetscFree(probes.W));
  PetscFunctionReturn(PETSC_SUCCESS);
}
