#include "tests/support/full_transfer.h"

#include <math.h>
#include <petscblaslapack.h>
#include <petscksp.h>

#include "tests/support/petsc_test.h"

/* ||P + iS||_2 = ||[P -S; S P]||_2 by the largest singular value. */
static double norm_2(PetscInt m, const PetscReal *P, const PetscReal *S)
{
  const PetscInt twice = 2 * m;
  PetscReal *A, *singular, *work;
  PetscBLASInt n = (PetscBLASInt)twice, length = 10 * n, one = 1, info;
  TEST_PETSC(PetscMalloc3((size_t)(twice * twice), &A, (size_t)twice, &singular, (size_t)length, &work));
  for (PetscInt j = 0; j < m; j++)
    for (PetscInt i = 0; i < m; i++) {
      A[i + j * twice] = A[(i + m) + (j + m) * twice] = P[i + j * m];
      A[(i + m) + j * twice] = S[i + j * m];
      A[i + (j + m) * twice] = -S[i + j * m];
    }
  LAPACKgesvd_("N", "N", &n, &n, A, &n, singular, NULL, &one, NULL, &one, work, &length, &info);
  assert_int_equal(info, 0);
  const double largest = singular[0];
  TEST_PETSC(PetscFree3(A, singular, work));
  return largest;
}

static void factorise_double_system(const ThermalSystem *system, PetscReal w, KSP *ksp)
{
  Mat upper, lower, nest, A, blocks[4];
  PC pc;
  TEST_PETSC(MatDuplicate(system->E, MAT_COPY_VALUES, &upper));
  TEST_PETSC(MatScale(upper, -w));
  TEST_PETSC(MatDuplicate(system->E, MAT_COPY_VALUES, &lower));
  TEST_PETSC(MatScale(lower, w));
  blocks[0] = blocks[3] = system->K;
  blocks[1] = upper;
  blocks[2] = lower;
  TEST_PETSC(MatCreateNest(PETSC_COMM_SELF, 2, NULL, 2, NULL, blocks, &nest));
  TEST_PETSC(MatConvert(nest, MATAIJ, MAT_INITIAL_MATRIX, &A));
  TEST_PETSC(KSPCreate(PETSC_COMM_SELF, ksp));
  TEST_PETSC(KSPSetOperators(*ksp, A, A));
  TEST_PETSC(KSPSetType(*ksp, KSPPREONLY));
  TEST_PETSC(KSPGetPC(*ksp, &pc));
  TEST_PETSC(PCSetType(pc, PCLU));
  TEST_PETSC(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  TEST_PETSC(KSPSetUp(*ksp));
  TEST_PETSC(MatDestroy(&A));
  TEST_PETSC(MatDestroy(&nest));
  TEST_PETSC(MatDestroy(&upper));
  TEST_PETSC(MatDestroy(&lower));
}

/* Re and Im of the full H(iw), [m x m]. */
static void full_transfer(const ThermalSystem *system, PetscReal w, PetscReal *P, PetscReal *S)
{
  const PetscInt n = system->n, m = system->m;
  KSP ksp;
  Vec rhs, x, of_patches, half;
  factorise_double_system(system, w, &ksp);
  TEST_PETSC(VecCreateSeq(PETSC_COMM_SELF, 2 * n, &rhs));
  TEST_PETSC(VecDuplicate(rhs, &x));
  TEST_PETSC(MatCreateVecs(system->B, &of_patches, &half));
  for (PetscInt j = 0; j < m; j++) {
    const PetscScalar *from;
    PetscScalar *to;
    TEST_PETSC(VecZeroEntries(rhs));
    TEST_PETSC(MatGetColumnVector(system->B, half, j));
    TEST_PETSC(VecGetArrayRead(half, &from));
    TEST_PETSC(VecGetArray(rhs, &to));
    TEST_PETSC(PetscArraycpy(to, from, (size_t)n));
    TEST_PETSC(VecRestoreArray(rhs, &to));
    TEST_PETSC(VecRestoreArrayRead(half, &from));
    TEST_PETSC(KSPSolve(ksp, rhs, x));
    for (int part = 0; part < 2; part++) {
      TEST_PETSC(VecGetArrayRead(x, &from));
      TEST_PETSC(VecGetArray(half, &to));
      TEST_PETSC(PetscArraycpy(to, from + part * n, (size_t)n));
      TEST_PETSC(VecRestoreArray(half, &to));
      TEST_PETSC(VecRestoreArrayRead(x, &from));
      TEST_PETSC(MatMultTranspose(system->B, half, of_patches));
      TEST_PETSC(VecGetArrayRead(of_patches, &from));
      for (PetscInt i = 0; i < m; i++)
        (part == 0 ? P : S)[i + j * m] = sqrt(system->area[i] * system->area[j]) * from[i];
      TEST_PETSC(VecRestoreArrayRead(of_patches, &from));
    }
  }
  TEST_PETSC(VecDestroy(&rhs));
  TEST_PETSC(VecDestroy(&x));
  TEST_PETSC(VecDestroy(&half));
  TEST_PETSC(VecDestroy(&of_patches));
  TEST_PETSC(KSPDestroy(&ksp));
}

/* ||H - H_r||_2/||H_r||_2 at w. */
double transfer_error(const ThermalSystem *system, const ReducedModel *model, PetscReal w)
{
  const PetscInt m = system->m;
  PetscReal *P, *S, *Pr, *Sr;
  TEST_PETSC(PetscMalloc2((size_t)(m * m), &P, (size_t)(m * m), &S));
  TEST_PETSC(PetscCalloc2((size_t)(m * m), &Pr, (size_t)(m * m), &Sr));
  full_transfer(system, w, P, S);
  for (PetscInt k = 0; k < model->r; k++) {
    const PetscReal lambda = model->lambda[k], size = lambda * lambda + w * w;
    for (PetscInt j = 0; j < m; j++)
      for (PetscInt i = 0; i < m; i++) {
        const PetscReal b = model->B[k * m + i] * model->B[k * m + j] * sqrt(system->area[i] * system->area[j]);
        Pr[i + j * m] += b * lambda / size;
        Sr[i + j * m] -= b * w / size;
      }
  }
  const double norm = norm_2(m, Pr, Sr);
  for (PetscInt i = 0; i < m * m; i++) P[i] -= Pr[i], S[i] -= Sr[i];
  const double error = norm_2(m, P, S) / norm;
  TEST_PETSC(PetscFree2(P, S));
  TEST_PETSC(PetscFree2(Pr, Sr));
  return error;
}
