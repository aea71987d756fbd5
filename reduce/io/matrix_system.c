#include "reduce/io/matrix_system.h"

#include <petscksp.h>
#include <stdlib.h>
#include "reduce/io/matrix_files.h"
#include "reduce/petsc/collective.h"
#include "reduce/petsc/petsc_compat.h"

/* Entries of rank 0 become rows of all ranks. */
static PetscErrorCode distribute(MPI_Comm comm, const MarketMatrix *from, PetscInt n, PetscReal sign, Mat *A)
{
  PetscInt *row, *column;
  PetscScalar *value;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc3(from->n, &row, from->n, &column, from->n, &value));
  for (size_t i = 0; i < from->n; i++) {
    row[i] = from->entry[i].row;
    column[i] = from->entry[i].column;
    value[i] = sign * from->entry[i].value;
  }
  PetscCall(MatCreate(comm, A));
  PetscCall(MatSetSizes(*A, PETSC_DECIDE, PETSC_DECIDE, n, n));
  PetscCall(MatSetType(*A, MATAIJ));
  PetscCall(MatSetPreallocationCOO(*A, (PetscCount)from->n, row, column));
  PetscCall(MatSetValuesCOO(*A, value, INSERT_VALUES));
  PetscCall(PetscFree3(row, column, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode distribute_inputs(MPI_Comm comm, const MarketMatrix *from, PetscInt m, Mat like, Mat *B)
{
  PetscInt n, n_local;

  PetscFunctionBeginUser;
  PetscCall(MatGetSize(like, &n, NULL));
  PetscCall(MatGetLocalSize(like, &n_local, NULL));
  PetscCall(MatCreateDense(comm, n_local, PETSC_DECIDE, n, m, NULL, B));
  for (size_t i = 0; i < from->n; i++)
    PetscCall(MatSetValue(*B, from->entry[i].row, from->entry[i].column, from->entry[i].value, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(*B, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*B, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* K 1; NULL where it is zero to the rounding of the files' numbers. */
static PetscErrorCode find_ambient(Mat K, const char *path, Vec *ambient)
{
  static const PetscReal ROUNDING = 1e-12;
  PetscReal largest, of_K;
  PetscScalar sum;
  Vec ones;

  PetscFunctionBeginUser;
  PetscCall(MatCreateVecs(K, &ones, ambient));
  PetscCall(VecSet(ones, 1.0));
  PetscCall(MatMult(K, ones, *ambient));
  PetscCall(VecNorm(*ambient, NORM_INFINITY, &largest));
  PetscCall(VecSum(*ambient, &sum));
  PetscCall(MatNorm(K, NORM_INFINITY, &of_K));
  PetscCall(VecDestroy(&ones));
  if (largest <= ROUNDING * of_K) PetscCall(VecDestroy(ambient));
  PetscCheck(!*ambient || PetscRealPart(sum) > 0.0, PetscObjectComm((PetscObject)K), PETSC_ERR_USER,
             "%s: the entries of K add up to %g W/K: a mould above the temperature of its surroundings would gain heat "
             "from them; K = -A must be positive semi-definite (is it A that the file holds?)",
             path, (double)PetscRealPart(sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The 2 x 2 minors were positive; conjugate gradients meet a negative direction, if there is one, with any right-hand
 * side that has a part in it, and a random one has. A heat capacity is well conditioned: some tens of steps. */
static PetscErrorCode check_positive(Mat E, const char *path)
{
  KSPConvergedReason reason;
  PetscRandom random;
  Vec b, x;
  PC pc;
  KSP ksp;

  PetscFunctionBeginUser;
  PetscCall(MatCreateVecs(E, &x, &b));
  PetscCall(PetscRandomCreate(PetscObjectComm((PetscObject)E), &random)); // its seed is fixed
  PetscCall(VecSetRandom(b, random));
  PetscCall(PetscRandomDestroy(&random));
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)E), &ksp));
  PetscCall(KSPSetOperators(ksp, E, E));
  PetscCall(KSPSetType(ksp, KSPCG));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCJACOBI));
  PetscCall(KSPSetTolerances(ksp, 1e-12, PETSC_DEFAULT, PETSC_DEFAULT, 500));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(KSPGetConvergedReason(ksp, &reason));
  PetscCall(KSPDestroy(&ksp));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&x));
  PetscCheck(reason != KSP_DIVERGED_INDEFINITE_MAT && reason != KSP_DIVERGED_NANORINF, PetscObjectComm((PetscObject)E),
             PETSC_ERR_USER,
             "%s: E is not positive definite: there is a temperature field that it gives a negative heat", path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode build(MPI_Comm comm, const ReduceConfig *config, MatrixFiles *files, ThermalSystem **system)
{
  Mat E, K, B;
  Vec ambient;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Bcast(&files->n, 1, MPIU_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(&files->m, 1, MPIU_INT, 0, comm));
  if (!files->area) files->area = calloc((size_t)files->m, sizeof *files->area);
  PetscCheck(files->area, PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for %d inputs", (int)files->m);
  PetscCallMPI(MPI_Bcast(files->area, (PetscMPIInt)files->m, MPIU_REAL, 0, comm));
  PetscCall(distribute(comm, &files->E, files->n, 1.0, &E));
  PetscCall(distribute(comm, &files->K, files->n, config->matrices->K_is_A ? -1.0 : 1.0, &K));
  PetscCall(distribute_inputs(comm, &files->B, files->m, E, &B));
  PetscCall(check_positive(E, config->matrices->E));
  PetscCall(find_ambient(K, config->matrices->K, &ambient));
  PetscCall(thermal_system_wrap(E, K, B, ambient, files->area, system));
  PetscCall(MatDestroy(&E));
  PetscCall(MatDestroy(&K));
  PetscCall(MatDestroy(&B));
  PetscCall(VecDestroy(&ambient));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode matrix_system_create(MPI_Comm comm, const ReduceConfig *config, ThermalSystem **system)
{
  MatrixFiles files = {0};
  CastError err = {CAST_OK, ""};
  CastStatus status = CAST_OK;
  PetscMPIInt rank;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) status = matrix_files_read(config->matrices, &files, &err);
  PetscCall(collective_check(comm, status, &err));
  PetscCall(build(comm, config, &files, system));
  matrix_files_free(&files);
  PetscFunctionReturn(PETSC_SUCCESS);
}

CastStatus matrix_system_check(const ReduceConfig *config, char *summary, size_t size, CastError *err)
{
  MatrixFiles files = {0};
  CAST_CALL(matrix_files_read(config->matrices, &files, err));
  snprintf(summary, size, "%lld unknowns, %lld inputs, %zu entries in E, %zu in K, %zu in B", (long long)files.n,
           (long long)files.m, files.E.n, files.K.n, files.B.n);
  matrix_files_free(&files);
  return CAST_OK;
}
