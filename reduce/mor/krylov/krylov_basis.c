/* krylov_basis.c
 * Method: block Gram-Schmidt in the E inner product, twice, with deflation by the eigenvalues of the block's Gram
 * matrix (a block orthogonalisation by Cholesky would break down where directions depend on each other).
 * Reference: Stathopoulos & Wu 2002, SIAM J. Sci. Comput. 23, 2165 (SVQB). */
#include "reduce/mor/krylov/krylov_basis_private.h"

#include "reduce/linear/dense_block.h"
#include "reduce/linear/small_dense.h"
#include "reduce/petsc/petsc_compat.h"

/* A Gram eigenvalue below this, of vectors of length 1, is rounding of the inner products. */
static const PetscReal GRAM_ROUNDING = 1e-13;
/* Above it one projection leaves less than about 1e-14 along the basis, far below any tolerance. */
static const PetscReal ONCE_IS_ENOUGH = 1e-2;

static PetscErrorCode create_bv(const ThermalSystem *system, PetscInt columns, BV *bv)
{
  Vec like;

  PetscFunctionBeginUser;
  PetscCall(MatCreateVecs(system->E, &like, NULL));
  PetscCall(BVCreate(PetscObjectComm((PetscObject)system->E), bv));
  PetscCall(BVSetSizesFromVec(*bv, like, columns));
  PetscCall(BVSetType(*bv, BVMAT));
  PetscCall(BVSetMatrix(*bv, system->E, PETSC_FALSE));
  PetscCall(VecDestroy(&like));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode add_constant(KrylovBasis *basis)
{
  Mat X;
  Vec column;
  PetscInt kept;

  PetscFunctionBeginUser;
  PetscCall(krylov_basis_get_block(basis, 1, &X));
  PetscCall(MatDenseGetColumnVecWrite(X, 0, &column));
  PetscCall(VecSet(column, 1.0));
  PetscCall(MatDenseRestoreColumnVecWrite(X, 0, &column));
  PetscCall(krylov_basis_add(basis, &X, &kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode krylov_basis_set_problem(const ThermalSystem *system, Mat ports, PetscReal deflation, KrylovBasis *basis)
{
  Vec ones;

  PetscFunctionBeginUser;
  basis->system = system;
  basis->ports = ports;
  PetscCall(MatGetSize(ports, NULL, &basis->p));
  basis->deflation = deflation;
  PetscCall(MatCreateVecs(system->E, &ones, &basis->E_one));
  PetscCall(VecDuplicate(basis->E_one, &basis->K_one));
  PetscCall(VecSet(ones, 1.0));
  PetscCall(MatMult(system->E, ones, basis->E_one));
  PetscCall(MatMult(system->K, ones, basis->K_one));
  PetscCall(VecDestroy(&ones));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode krylov_basis_create(const ThermalSystem *system, Mat ports, PetscInt capacity, PetscInt width,
                                   PetscReal deflation, KrylovBasis **out)
{
  KrylovBasis *basis;

  PetscFunctionBeginUser;
  PetscCall(PetscNew(&basis));
  *out = basis;
  PetscCall(krylov_basis_set_problem(system, ports, deflation, basis));
  basis->capacity = PetscMax(capacity, 1);
  basis->width = width;
  PetscCall(create_bv(system, basis->capacity, &basis->V));
  PetscCall(create_bv(system, basis->width, &basis->W));
  PetscCall(dense_block_create(system->E, basis->width, &basis->work));
  PetscCall(PetscCalloc3((size_t)basis->capacity * (size_t)basis->capacity, &basis->K,
                         (size_t)basis->capacity * (size_t)basis->p, &basis->inputs, (size_t)basis->capacity,
                         &basis->constant));
  PetscCall(add_constant(basis));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode krylov_basis_get_block(KrylovBasis *basis, PetscInt k, Mat *X)
{
  PetscFunctionBeginUser;
  PetscCheck(k <= basis->width, PETSC_COMM_SELF, PETSC_ERR_ARG_SIZ,
             "a block of %" PetscInt_FMT " vectors, at most %" PetscInt_FMT " are expected", k, basis->width);
  PetscCall(BVSetActiveColumns(basis->W, 0, k));
  PetscCall(BVGetMat(basis->W, X));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Room for `kept` more vectors. */
static PetscErrorCode reserve(KrylovBasis *basis, PetscInt kept)
{
  const PetscInt old = basis->capacity, inputs = basis->p;
  PetscReal *K, *of_inputs, *constant;

  PetscFunctionBeginUser;
  if (basis->r + kept <= old) PetscFunctionReturn(PETSC_SUCCESS);
  basis->capacity = basis->r + kept + basis->width;
  const size_t capacity = (size_t)basis->capacity;
  PetscCall(BVResize(basis->V, basis->capacity, PETSC_TRUE));
  PetscCall(PetscCalloc3(capacity * capacity, &K, capacity * (size_t)inputs, &of_inputs, capacity, &constant));
  for (PetscInt c = 0; c < basis->r; c++)
    PetscCall(PetscArraycpy(K + (size_t)c * capacity, basis->K + (size_t)c * (size_t)old, (size_t)basis->r));
  PetscCall(PetscArraycpy(of_inputs, basis->inputs, (size_t)basis->r * (size_t)inputs));
  PetscCall(PetscArraycpy(constant, basis->constant, (size_t)basis->r));
  PetscCall(PetscFree3(basis->K, basis->inputs, basis->constant));
  basis->K = K;
  basis->inputs = of_inputs;
  basis->constant = constant;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* W -= V (V^T E W), V's first `columns` */
static PetscErrorCode project_out(KrylovBasis *basis, PetscInt k, PetscInt columns)
{
  Mat M;

  PetscFunctionBeginUser;
  if (columns == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BVSetActiveColumns(basis->V, 0, columns));
  PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, columns, k, NULL, &M));
  PetscCall(BVDot(basis->W, basis->V, M));
  PetscCall(BVMult(basis->W, -1.0, 1.0, basis->V, M));
  PetscCall(MatDestroy(&M));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* W becomes an orthonormal basis of its own directions whose Gram eigenvalue is above `smallest`.
 *   least  out: of those that are kept */
static PetscErrorCode orthonormalise_block(KrylovBasis *basis, PetscInt k, PetscReal smallest, PetscInt *kept,
                                           PetscReal *least)
{
  Mat M, Q;
  PetscScalar *gram, *to;
  PetscReal *w;

  PetscFunctionBeginUser;
  PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, k, k, NULL, &M));
  PetscCall(BVDot(basis->W, basis->W, M));
  PetscCall(PetscMalloc1((size_t)k, &w));
  PetscCall(MatDenseGetArray(M, &gram));
  for (PetscInt j = 0; j < k; j++)
    for (PetscInt i = 0; i < j; i++) gram[j + i * k] = 0.5 * (gram[j + i * k] + gram[i + j * k]);
  PetscCall(small_eigen(PetscObjectComm((PetscObject)basis->W), k, gram, w));
  *kept = 0;
  while (*kept < k && w[k - 1 - *kept] > smallest) (*kept)++;
  *least = *kept > 0 ? w[k - *kept] : 0.0;
  PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, k, PetscMax(*kept, 1), NULL, &Q));
  PetscCall(MatDenseGetArray(Q, &to));
  for (PetscInt c = 0; c < *kept; c++) // the longest direction first
    for (PetscInt i = 0; i < k; i++) to[i + c * k] = gram[i + (k - 1 - c) * k] / PetscSqrtReal(w[k - 1 - c]);
  PetscCall(MatDenseRestoreArray(Q, &to));
  PetscCall(MatDenseRestoreArray(M, &gram));
  if (*kept > 0) PetscCall(BVMultInPlace(basis->W, Q, 0, *kept));
  PetscCall(BVSetActiveColumns(basis->W, 0, *kept));
  PetscCall(MatDestroy(&Q));
  PetscCall(MatDestroy(&M));
  PetscCall(PetscFree(w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Vectors to E-length 1, so that deflation is relative. */
static PetscErrorCode normalise(KrylovBasis *basis, PetscInt k)
{
  Mat X, Y;
  PetscReal *length;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)k, &length));
  PetscCall(BVGetMat(basis->W, &X));
  PetscCall(MatDenseGetSubMatrix(basis->work, PETSC_DECIDE, PETSC_DECIDE, 0, k, &Y));
  PetscCall(dense_block_multiply(basis->system->E, X, Y));
  PetscCall(dense_block_dots(X, Y, length));
  for (PetscInt c = 0; c < k; c++) length[c] = length[c] > 0.0 ? 1.0 / PetscSqrtReal(length[c]) : 0.0;
  PetscCall(dense_block_scale(X, length));
  PetscCall(MatDenseRestoreSubMatrix(basis->work, &Y));
  PetscCall(BVRestoreMat(basis->W, &X));
  PetscCall(PetscFree(length));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* K, the ports and the constant in the new vectors X, which are V's columns r .. r + kept. */
static PetscErrorCode project_system(KrylovBasis *basis, Mat X, PetscInt kept)
{
  const ThermalSystem *system = basis->system;
  const PetscInt r = basis->r, total = r + kept, p = basis->p;
  Mat V, KX;
  PetscReal *block, *of_ports;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc2((size_t)total * (size_t)kept, &block, (size_t)kept * (size_t)p, &of_ports));
  PetscCall(MatDenseGetSubMatrix(basis->work, PETSC_DECIDE, PETSC_DECIDE, 0, kept, &KX));
  PetscCall(dense_block_multiply(system->K, X, KX));
  PetscCall(BVSetActiveColumns(basis->V, 0, total));
  PetscCall(BVGetMat(basis->V, &V));
  PetscCall(dense_block_inner(V, KX, block));
  PetscCall(BVRestoreMat(basis->V, &V));
  PetscCall(MatDenseRestoreSubMatrix(basis->work, &KX));
  for (PetscInt c = 0; c < kept; c++)
    for (PetscInt i = 0; i < total; i++) {
      const PetscReal value = block[i + c * total];
      basis->K[(size_t)i + (size_t)(r + c) * (size_t)basis->capacity] = value;
      basis->K[(size_t)(r + c) + (size_t)i * (size_t)basis->capacity] = value;
    }
  PetscCall(dense_block_inner(X, basis->ports, of_ports));
  for (PetscInt c = 0; c < kept; c++) {
    Vec column;
    PetscReal *row = basis->inputs + (size_t)(r + c) * (size_t)p;
    for (PetscInt l = 0; l < p; l++) row[l] = of_ports[c + l * kept];
    PetscCall(MatDenseGetColumnVecRead(X, c, &column));
    PetscCall(VecDot(column, basis->E_one, &basis->constant[r + c]));
    PetscCall(MatDenseRestoreColumnVecRead(X, c, &column));
  }
  PetscCall(PetscFree2(block, of_ports));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Append the block's first `kept` vectors to V. */
static PetscErrorCode append(KrylovBasis *basis, PetscInt kept)
{
  Mat X, V;

  PetscFunctionBeginUser;
  PetscCall(reserve(basis, kept));
  PetscCall(BVSetActiveColumns(basis->W, 0, kept));
  PetscCall(BVGetMat(basis->W, &X));
  PetscCall(BVSetActiveColumns(basis->V, 0, basis->r + kept));
  PetscCall(BVGetMat(basis->V, &V));
  PetscCall(dense_block_copy(V, basis->r, X, NULL, kept));
  PetscCall(BVRestoreMat(basis->V, &V));
  PetscCall(project_system(basis, X, kept));
  PetscCall(BVRestoreMat(basis->W, &X));
  basis->r += kept;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode krylov_basis_add(KrylovBasis *basis, Mat *X, PetscInt *kept)
{
  const PetscReal smallest = PetscMax(basis->deflation * basis->deflation, GRAM_ROUNDING);
  PetscReal least;
  PetscInt k;

  PetscFunctionBeginUser;
  PetscCall(MatGetSize(*X, NULL, &k));
  PetscCall(BVRestoreMat(basis->W, X));
  PetscCall(normalise(basis, k));
  PetscCall(project_out(basis, k, basis->r));
  PetscCall(orthonormalise_block(basis, k, smallest, kept, &least));
  if (*kept > 0) {
    /* The second pass finds vectors that are orthonormal but for the rounding that the first has magnified: what was
     * left of them, of length 1 before, is at least sqrt(least) long. The constant comes first and is heat: no
     * exception for it. */
    PetscCall(project_out(basis, *kept, least < ONCE_IS_ENOUGH ? basis->r : PetscMin(basis->r, 1)));
    PetscCall(orthonormalise_block(basis, *kept, 0.25, kept, &least));
  }
  if (*kept > 0) PetscCall(append(basis, *kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode krylov_basis_combine(const KrylovBasis *basis, const PetscReal *Q, Mat Y)
{
  Mat V;

  PetscFunctionBeginUser;
  if (basis->blocks) {
    PetscCall(krylov_basis_stored_combine(basis, Q, Y));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BVSetActiveColumns(basis->V, 0, basis->r));
  PetscCall(BVGetMat(basis->V, &V));
  PetscCall(dense_block_combine(Y, 0.0, 1.0, V, Q, basis->r));
  PetscCall(BVRestoreMat(basis->V, &V));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode krylov_basis_inner(const KrylovBasis *basis, Mat Y, PetscReal *G)
{
  Mat V;

  PetscFunctionBeginUser;
  if (basis->blocks) {
    PetscCall(krylov_basis_stored_inner(basis, Y, G));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(BVSetActiveColumns(basis->V, 0, basis->r));
  PetscCall(BVGetMat(basis->V, &V));
  PetscCall(dense_block_inner(Y, V, G));
  PetscCall(BVRestoreMat(basis->V, &V));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A few rows at a time, for the sake of memory. */
static PetscErrorCode rows_of_vectors(const KrylovBasis *basis, PetscInt k, const PetscReal *Q, PetscInt n,
                                      const PetscInt *row, PetscReal *rows)
{
  enum { ROWS = 2048 };
  Mat V;

  PetscFunctionBeginUser;
  PetscCall(PetscArrayzero(rows, (size_t)n * (size_t)k));
  PetscCall(BVSetActiveColumns(basis->V, 0, basis->r));
  PetscCall(BVGetMat(basis->V, &V));
  for (PetscInt first = 0; first < n; first += ROWS)
    PetscCall(krylov_basis_add_rows(V, Q, basis->r, k, PetscMin(ROWS, n - first), row + first,
                                    rows + (size_t)first * (size_t)k));
  PetscCall(BVRestoreMat(basis->V, &V));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode krylov_basis_rows(const KrylovBasis *basis, PetscInt k, const PetscReal *Q, PetscInt n,
                                 const PetscInt *row, PetscReal *rows)
{
  PetscFunctionBeginUser;
  if (basis->blocks)
    PetscCall(krylov_basis_stored_rows(basis, k, Q, n, row, rows));
  else
    PetscCall(rows_of_vectors(basis, k, Q, n, row, rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode krylov_basis_take(KrylovBasis *basis, PetscInt k, const PetscReal *Q, BV *taken)
{
  Mat of_small;
  PetscScalar *to;

  PetscFunctionBeginUser;
  PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, basis->r, k, NULL, &of_small));
  PetscCall(MatDenseGetArray(of_small, &to));
  PetscCall(PetscArraycpy(to, Q, (size_t)basis->r * (size_t)k));
  PetscCall(MatDenseRestoreArray(of_small, &to));
  PetscCall(BVSetActiveColumns(basis->V, 0, basis->r));
  PetscCall(BVMultInPlace(basis->V, of_small, 0, k));
  PetscCall(BVSetActiveColumns(basis->V, 0, k));
  PetscCall(MatDestroy(&of_small));
  *taken = basis->V;
  basis->V = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode krylov_basis_destroy(KrylovBasis **basis)
{
  PetscFunctionBeginUser;
  if (!*basis) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BVDestroy(&(*basis)->V));
  PetscCall(BVDestroy(&(*basis)->W));
  PetscCall(MatDestroy(&(*basis)->work));
  PetscCall(VecDestroy(&(*basis)->E_one));
  PetscCall(VecDestroy(&(*basis)->K_one));
  PetscCall(loewner_destroy(&(*basis)->raw));
  PetscCall(shift_blocks_destroy(&(*basis)->blocks, PETSC_TRUE));
  PetscCall(PetscFree3((*basis)->K, (*basis)->inputs, (*basis)->constant));
  PetscCall(PetscFree(*basis));
  PetscFunctionReturn(PETSC_SUCCESS);
}
