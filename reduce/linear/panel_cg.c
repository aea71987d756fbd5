/* panel_cg.c
 * Reference: Eisenstat 1981, SIAM J. Sci. Stat. Comput. 2, 1. */
#include "reduce/linear/panel_cg.h"

#include <math.h>
#include <petscsf.h>
#include <stdlib.h>

#include "reduce/linear/dense_block.h"
#include "reduce/linear/panel_kernels.h"
#include "reduce/linear/panel_pivots.h"
#include "reduce/petsc/petsc_compat.h"

enum { CHECK_EVERY = 4 }; // iterations between looks at the true residual: half a product each

static const PetscReal LEAST_REDUCTION = 3e-7; // that single precision may be asked for
static const PetscReal WORTH_A_LOOK = 10.0;    // the residual of the scaled problem over what is allowed

struct PanelCg {
  Mat A; // borrowed
  MPI_Comm comm;
  PanelMatrix matrix;
  float *root, *inverse_root; // [n] D^(1/2), D^(-1/2), D the pivots
  int n_beyond;               // rows of other processes that own rows couple to
  PetscSF halo;
  MPI_Datatype row;
  PanelRow *x, *r, *p, *t, *v; // [n]
  PanelRow *beyond;            // [n_beyond]
};

typedef struct PanelColumns { // the columns of one panel; those behind the last are zeros
  PetscInt first, n;          // in R and X
  PetscReal scale[PANEL];     // length of R's column, 0: nothing to do
  PetscReal target[PANEL];    // of the residual, over scale
} PanelColumns;

typedef struct Sparse { // own rows of A: those columns that are own rows, and the others
  Mat of[2];
  const PetscInt *row[2], *column[2], *garray;
  PetscScalar *value[2];
  PetscInt n, n_beyond;
  PetscBool both;
} Sparse;

static PetscErrorCode sparse_get(Mat A, Sparse *sparse)
{
  PetscBool ok = PETSC_TRUE;

  PetscFunctionBeginUser;
  *sparse = (Sparse){.both = PETSC_FALSE};
  PetscCall(PetscObjectTypeCompare((PetscObject)A, MATMPIAIJ, &sparse->both));
  sparse->of[0] = A;
  if (sparse->both) PetscCall(MatMPIAIJGetSeqAIJ(A, &sparse->of[0], &sparse->of[1], &sparse->garray));
  for (int b = 0; b < (sparse->both ? 2 : 1); b++) {
    PetscInt rows;
    PetscCall(MatGetRowIJ(sparse->of[b], 0, PETSC_FALSE, PETSC_FALSE, &rows, &sparse->row[b], &sparse->column[b], &ok));
    PetscCheck(ok, PETSC_COMM_SELF, PETSC_ERR_SUP, "a matrix of type AIJ is expected");
    PetscCall(MatSeqAIJGetArray(sparse->of[b], &sparse->value[b]));
    sparse->n = rows;
  }
  if (sparse->both) PetscCall(MatGetSize(sparse->of[1], NULL, &sparse->n_beyond));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode sparse_restore(Sparse *sparse)
{
  PetscBool ok = PETSC_TRUE;

  PetscFunctionBeginUser;
  for (int b = 0; b < (sparse->both ? 2 : 1); b++) {
    PetscInt rows;
    PetscCall(MatSeqAIJRestoreArray(sparse->of[b], &sparse->value[b]));
    PetscCall(
        MatRestoreRowIJ(sparse->of[b], 0, PETSC_FALSE, PETSC_FALSE, &rows, &sparse->row[b], &sparse->column[b], &ok));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* `n` rows, all zeros, where a whole row can be loaded at once */
static PetscErrorCode allocate_rows(int n, PanelRow **rows)
{
  const size_t count = (size_t)PetscMax(n, 1);

  PetscFunctionBeginUser;
  *rows = aligned_alloc(sizeof(PanelRow), count * sizeof(PanelRow));
  PetscCheck(*rows, PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for %d rows of %d columns", n, (int)PANEL);
  PetscCall(PetscMemzero(*rows, count * sizeof(PanelRow)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode create_halo(PanelCg *cg, const Sparse *sparse)
{
  PetscLayout rows;

  PetscFunctionBeginUser;
  PetscCall(MatGetLayouts(cg->A, &rows, NULL));
  PetscCall(PetscSFCreate(cg->comm, &cg->halo));
  PetscCall(PetscSFSetGraphLayout(cg->halo, rows, sparse->n_beyond, NULL, PETSC_COPY_VALUES, sparse->garray));
  PetscCallMPI(MPI_Type_contiguous(PANEL, MPI_FLOAT, &cg->row));
  PetscCallMPI(MPI_Type_commit(&cg->row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Columns of each row: below it, above it, beyond the process. */
static void fill_pattern(const Sparse *sparse, PanelMatrix *A)
{
  int e = 0;
  for (PetscInt i = 0; i < sparse->n; i++) {
    A->start[i] = e;
    for (int above = 0; above < 2; above++) {
      for (PetscInt k = sparse->row[0][i]; k < sparse->row[0][i + 1]; k++) {
        const PetscInt j = sparse->column[0][k];
        if (above ? j > i : j < i) A->column[e++] = (int)j;
      }
      if (!above) A->upper[i] = e;
    }
    A->beyond[i] = e;
    for (PetscInt k = sparse->both ? sparse->row[1][i] : 0; sparse->both && k < sparse->row[1][i + 1]; k++)
      A->column[e++] = (int)sparse->column[1][k];
  }
  A->start[sparse->n] = e;
}

PetscErrorCode panel_cg_create(Mat A, PanelCg **out)
{
  PanelCg *cg;
  Sparse sparse;

  PetscFunctionBeginUser;
  PetscCall(PetscNew(&cg));
  *out = cg;
  cg->A = A;
  cg->comm = PetscObjectComm((PetscObject)A);
  PetscCall(sparse_get(A, &sparse));
  const PetscInt entries = sparse.row[0][sparse.n] + (sparse.both ? sparse.row[1][sparse.n] : 0);
  PetscCheck(entries < PETSC_MAX_INT / 2, PETSC_COMM_SELF, PETSC_ERR_SUP,
             "%" PetscInt_FMT " entries on one process: at most %d are expected", entries, PETSC_MAX_INT / 2);
  const size_t n = (size_t)sparse.n;
  cg->matrix.n = (int)sparse.n;
  cg->n_beyond = (int)sparse.n_beyond;
  PetscCall(PetscMalloc5(n + 1, &cg->matrix.start, n, &cg->matrix.upper, n, &cg->matrix.beyond, (size_t)entries,
                         &cg->matrix.column, (size_t)entries, &cg->matrix.value));
  PetscCall(PetscMalloc3(n, &cg->root, n, &cg->inverse_root, n, &cg->matrix.middle));
  fill_pattern(&sparse, &cg->matrix);
  if (sparse.both) PetscCall(create_halo(cg, &sparse));
  PetscCall(sparse_restore(&sparse));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* D^(-1/2) A D^(-1/2), in the order of the pattern; scale[1] of the rows beyond. */
static void fill_values(const Sparse *sparse, const float *const scale[2], PanelMatrix *A)
{
  for (PetscInt i = 0; i < sparse->n; i++) {
    int e[2] = {A->start[i], A->upper[i]}, at = A->beyond[i];
    const double of_row = (double)scale[0][i];
    for (PetscInt k = sparse->row[0][i]; k < sparse->row[0][i + 1]; k++) {
      const PetscInt j = sparse->column[0][k];
      if (j != i) A->value[e[j > i]++] = (float)(of_row * sparse->value[0][k] * (double)scale[0][j]);
    }
    for (PetscInt k = sparse->both ? sparse->row[1][i] : 0; sparse->both && k < sparse->row[1][i + 1]; k++)
      A->value[at++] = (float)(of_row * sparse->value[1][k] * (double)scale[1][sparse->column[1][k]]);
  }
}

PetscErrorCode panel_cg_take_values(PanelCg *cg)
{
  Sparse sparse;
  Vec diagonal;
  const PetscScalar *d;
  PetscReal smallest, *pivot;
  float *beyond;

  PetscFunctionBeginUser;
  PetscCall(MatCreateVecs(cg->A, &diagonal, NULL));
  PetscCall(MatGetDiagonal(cg->A, diagonal));
  PetscCall(VecMin(diagonal, NULL, &smallest));
  PetscCheck(smallest > 0.0, cg->comm, PETSC_ERR_USER, "s E + K has %g on its diagonal: positive entries are expected",
             (double)smallest);
  PetscCall(sparse_get(cg->A, &sparse));
  PetscCall(VecGetArrayRead(diagonal, &d));
  PetscCall(PetscMalloc1((size_t)sparse.n, &pivot));
  const PivotRows rows = {sparse.n, sparse.row[0], sparse.column[0], sparse.value[0], d};
  PetscCall(panel_pivots(&rows, pivot));
  for (int i = 0; i < cg->matrix.n; i++) {
    cg->root[i] = (float)sqrt(pivot[i]);
    cg->inverse_root[i] = (float)(1.0 / sqrt(pivot[i]));
    cg->matrix.middle[i] = (float)(d[i] / pivot[i] - 2.0);
  }
  PetscCall(PetscFree(pivot));
  PetscCall(VecRestoreArrayRead(diagonal, &d));
  PetscCall(VecDestroy(&diagonal));
  PetscCall(PetscMalloc1((size_t)PetscMax(cg->n_beyond, 1), &beyond));
  if (cg->halo) {
    PetscCall(PetscSFBcastBegin(cg->halo, MPI_FLOAT, cg->inverse_root, beyond, MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(cg->halo, MPI_FLOAT, cg->inverse_root, beyond, MPI_REPLACE));
  }
  fill_values(&sparse, (const float *const[2]){cg->inverse_root, beyond}, &cg->matrix);
  PetscCall(sparse_restore(&sparse));
  PetscCall(PetscFree(beyond));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode allocate_work(PanelCg *cg)
{
  PetscFunctionBeginUser;
  if (cg->x) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(allocate_rows(cg->matrix.n, &cg->x));
  PetscCall(allocate_rows(cg->matrix.n, &cg->r));
  PetscCall(allocate_rows(cg->matrix.n, &cg->p));
  PetscCall(allocate_rows(cg->matrix.n, &cg->t));
  PetscCall(allocate_rows(cg->matrix.n, &cg->v));
  PetscCall(allocate_rows(cg->n_beyond, &cg->beyond));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* r = (I + L)^-1 D^(-1/2) R/|R|, x = p = 0 */
static PetscErrorCode load_panel(PanelCg *cg, Mat R, const PanelColumns *columns)
{
  const PetscScalar *from;
  PetscInt ld;

  PetscFunctionBeginUser;
  const size_t n = (size_t)cg->matrix.n;
  PetscCall(PetscMemzero(cg->x, n * sizeof *cg->x));
  PetscCall(PetscMemzero(cg->p, n * sizeof *cg->p));
  PetscCall(PetscMemzero(cg->r, n * sizeof *cg->r));
  PetscCall(MatDenseGetLDA(R, &ld));
  PetscCall(MatDenseGetArrayRead(R, &from));
  for (PetscInt c = 0; c < columns->n; c++) {
    if (columns->scale[c] == 0.0) continue;
    const PetscScalar *column = from + (size_t)(columns->first + c) * (size_t)ld;
    for (size_t i = 0; i < n; i++)
      cg->r[i][c] = (float)(column[i] / columns->scale[c] * (PetscReal)cg->inverse_root[i]);
  }
  PetscCall(MatDenseRestoreArrayRead(R, &from));
  panel_sweep_forward(&cg->matrix, cg->r);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* X += |R| D^(-1/2) x */
static PetscErrorCode add_panel(const PanelCg *cg, const PanelColumns *columns, Mat X)
{
  PetscScalar *to;
  PetscInt ld;

  PetscFunctionBeginUser;
  PetscCall(MatDenseGetLDA(X, &ld));
  PetscCall(MatDenseGetArray(X, &to));
  for (PetscInt c = 0; c < columns->n; c++) {
    if (columns->scale[c] == 0.0) continue;
    PetscScalar *column = to + (size_t)(columns->first + c) * (size_t)ld;
    for (int i = 0; i < cg->matrix.n; i++)
      column[i] += columns->scale[c] * (PetscReal)cg->inverse_root[i] * (PetscReal)cg->x[i][c];
  }
  PetscCall(MatDenseRestoreArray(X, &to));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode sum_over_processes(const PanelCg *cg, double dot[PANEL])
{
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, dot, PANEL, MPI_DOUBLE, MPI_SUM, cg->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode close_enough(const PanelCg *cg, const PanelColumns *columns, PetscBool *close)
{
  double left[PANEL] = {0.0};

  PetscFunctionBeginUser;
  panel_residual(&cg->matrix, cg->root, cg->r, left);
  PetscCall(sum_over_processes(cg, left));
  *close = PETSC_TRUE;
  for (PetscInt c = 0; c < columns->n; c++)
    if (columns->scale[c] > 0.0 && !(sqrt(left[c]) <= columns->target[c])) *close = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The scaled problem's residual, whose length is at hand, may be near enough. */
static PetscBool worth_a_look(const PanelColumns *columns, const double rr[PANEL], const double first[PANEL])
{
  for (PetscInt c = 0; c < columns->n; c++)
    if (columns->scale[c] > 0.0 && !(sqrt(rr[c] / first[c]) <= WORTH_A_LOOK * columns->target[c])) return PETSC_FALSE;
  return PETSC_TRUE;
}

static PetscErrorCode iterate(PanelCg *cg, const PanelColumns *columns, PetscInt limit, PetscInt *iterations)
{
  double rr[PANEL] = {0.0}, first[PANEL], before[PANEL], pq[PANEL];
  PanelRow alpha = {0.0F}, beta = {0.0F};
  PetscBool close = PETSC_FALSE;

  PetscFunctionBeginUser;
  PetscCall(PetscMemzero(cg->t, (size_t)cg->matrix.n * sizeof *cg->t));
  PetscCall(PetscMemzero(cg->v, (size_t)cg->matrix.n * sizeof *cg->v));
  panel_update(&cg->matrix, &alpha, cg->t, cg->v, cg->x, cg->r, rr);
  PetscCall(sum_over_processes(cg, rr));
  PetscCall(PetscMemcpy(first, rr, sizeof rr));
  for (*iterations = 0; *iterations < limit && !close; ++*iterations) {
    panel_sweep_backward(&cg->matrix, &beta, cg->r, cg->p, cg->t);
    if (cg->halo) {
      PetscCall(PetscSFBcastBegin(cg->halo, cg->row, cg->t, cg->beyond, MPI_REPLACE));
      PetscCall(PetscSFBcastEnd(cg->halo, cg->row, cg->t, cg->beyond, MPI_REPLACE));
    }
    PetscCall(PetscMemzero(pq, sizeof pq));
    panel_apply(&cg->matrix, cg->p, cg->t, cg->beyond, cg->v, pq);
    PetscCall(sum_over_processes(cg, pq));
    for (int c = 0; c < PANEL; c++) alpha[c] = pq[c] > 0.0 ? (float)(rr[c] / pq[c]) : 0.0F;
    PetscCall(PetscMemcpy(before, rr, sizeof rr));
    PetscCall(PetscMemzero(rr, sizeof rr));
    panel_update(&cg->matrix, &alpha, cg->t, cg->v, cg->x, cg->r, rr);
    PetscCall(sum_over_processes(cg, rr));
    for (int c = 0; c < PANEL; c++) beta[c] = before[c] > 0.0 ? (float)(rr[c] / before[c]) : 0.0F;
    if (*iterations % (*iterations < 16 ? 2 : CHECK_EVERY) == 1 && worth_a_look(columns, rr, first))
      PetscCall(close_enough(cg, columns, &close));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode panel_cg_solve(PanelCg *cg, Mat R, Mat X, const PetscReal *length, PetscInt limit, PetscInt *iterations)
{
  PetscInt k;
  PetscReal *squared;

  PetscFunctionBeginUser;
  *iterations = 0;
  PetscCall(allocate_work(cg));
  PetscCall(MatGetSize(R, NULL, &k));
  PetscCall(PetscMalloc1((size_t)k, &squared));
  PetscCall(dense_block_dots(R, R, squared));
  for (PetscInt first = 0; first < k; first += PANEL) {
    PanelColumns columns = {.first = first, .n = PetscMin(PANEL, k - first)};
    PetscBool needed = PETSC_FALSE;
    PetscInt taken;
    for (PetscInt c = 0; c < columns.n; c++) {
      const PetscReal size = PetscSqrtReal(squared[first + c]);
      if (!(size > length[first + c])) continue;
      columns.scale[c] = size;
      columns.target[c] = PetscMax(length[first + c] / size, LEAST_REDUCTION);
      needed = PETSC_TRUE;
    }
    if (!needed) continue;
    PetscCall(load_panel(cg, R, &columns));
    PetscCall(iterate(cg, &columns, limit, &taken));
    PetscCall(add_panel(cg, &columns, X));
    *iterations = PetscMax(*iterations, taken);
  }
  PetscCall(PetscFree(squared));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode panel_cg_destroy(PanelCg **out)
{
  PanelCg *cg = *out;

  PetscFunctionBeginUser;
  if (!cg) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree5(cg->matrix.start, cg->matrix.upper, cg->matrix.beyond, cg->matrix.column, cg->matrix.value));
  PetscCall(PetscFree3(cg->root, cg->inverse_root, cg->matrix.middle));
  PetscCall(PetscSFDestroy(&cg->halo));
  if (cg->row) PetscCallMPI(MPI_Type_free(&cg->row));
  free(cg->x);
  free(cg->r);
  free(cg->p);
  free(cg->t);
  free(cg->v);
  free(cg->beyond);
  PetscCall(PetscFree(cg));
  *out = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}
