#include "tests/support/random_mould.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "reduce/petsc/petsc_compat.h"
#include "tests/support/random_numbers.h"
#include "tests/support/voxel_mould.h"

enum { HALVES = 2, MOST_PATCHES = 6 * HALVES + 1, OUTER = MOST_PATCHES - 1 };

typedef struct Shape {
  uint64_t seed;
  double split, low_kappa, high_kappa, rho_c[2], h;
  int split_axis;
} Shape;

static int random_between(uint64_t *seed, int low, int high)
{
  return low + (int)(random_unit(seed) * (double)(high - low + 1));
}

static VoxelMould random_voxels(Shape *shape)
{
  size_t n[3];
  double *lines[3];
  for (int d = 0; d < 3; d++) {
    const double size = 0.015 + 0.025 * random_unit(&shape->seed);
    n[d] = (size_t)random_between(&shape->seed, 8, 13);
    lines[d] = synthetic_array(n[d] + 1, sizeof(double));
    for (size_t i = 0; i < n[d]; i++) lines[d][i + 1] = lines[d][i] + 0.1 + random_unit(&shape->seed);
    for (size_t i = 0; i <= n[d]; i++) lines[d][i] *= size / lines[d][n[d]];
  }
  VoxelMould mould = voxel_mould_create(n, lines);
  for (int box = random_between(&shape->seed, 1, 3); box > 0; box--) {
    size_t low[3], high[3];
    for (int d = 0; d < 3; d++) {
      low[d] = (size_t)random_between(&shape->seed, 1, (int)n[d] - 4);
      high[d] = low[d] + (size_t)random_between(&shape->seed, 1, (int)(n[d] - 2 - low[d]));
    }
    for (size_t k = low[2]; k < high[2]; k++)
      for (size_t j = low[1]; j < high[1]; j++)
        for (size_t i = low[0]; i < high[0]; i++) mould.solid[voxel_cell(&mould, i, j, k)] = 0;
  }
  memcpy(mould.band, mould.solid, n[0] * n[1] * n[2]);
  shape->split_axis = random_between(&shape->seed, 0, 2);
  shape->split = lines[shape->split_axis][n[shape->split_axis]] * random_unit(&shape->seed);
  return mould;
}

static void random_materials(Shape *shape)
{
  shape->low_kappa = 0.3 * pow(10.0, random_unit(&shape->seed));
  shape->high_kappa = shape->low_kappa * pow(100.0, random_unit(&shape->seed));
  for (int i = 0; i < 2; i++) shape->rho_c[i] = 1e6 * (1.0 + 2.0 * random_unit(&shape->seed));
  shape->h = 5.0 * pow(20.0, random_unit(&shape->seed));
}

static int32_t patch_of(const void *context, const VoxelFace *face)
{
  const Shape *shape = context;
  if (!face->inside) return OUTER;
  const int half = face->low[shape->split_axis] < shape->split ? 0 : 1;
  return (int32_t)(HALVES * (2 * face->axis + (face->sign > 0 ? 1 : 0)) + half);
}

/* Gradients of the four linear functions, grad[i] = normal of the opposite face / (3 V); volume V. */
static double gradients(const double *x[4], double grad[4][3])
{
  double e[3][3], volume;
  for (int i = 0; i < 3; i++)
    for (int d = 0; d < 3; d++) e[i][d] = x[i + 1][d] - x[0][d];
  for (int i = 0; i < 3; i++) {
    const double *a = e[(i + 1) % 3], *b = e[(i + 2) % 3];
    for (int d = 0; d < 3; d++) grad[i + 1][d] = a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3];
  }
  volume = (e[0][0] * grad[1][0] + e[0][1] * grad[1][1] + e[0][2] * grad[1][2]) / 6.0;
  for (int d = 0; d < 3; d++) {
    for (int i = 1; i < 4; i++) grad[i][d] /= 6.0 * volume;
    grad[0][d] = -grad[1][d] - grad[2][d] - grad[3][d];
  }
  return volume;
}

static PetscErrorCode add_tetrahedra(const RomData *mesh, const Shape *shape, Mat E, Mat K)
{
  PetscFunctionBeginUser;
  for (size_t t = 0; t < mesh->n_tetrahedra; t++) {
    const int32_t *node = mesh->tetrahedra + 4 * t;
    const double *x[4];
    double grad[4][3], e[16], k[16], centre = 0.0;
    for (int i = 0; i < 4; i++) x[i] = mesh->points + 3 * node[i];
    for (int i = 0; i < 4; i++) centre += 0.25 * x[i][shape->split_axis];
    const int region = centre < shape->split ? 0 : 1;
    const double volume = gradients(x, grad), kappa = region == 0 ? shape->low_kappa : shape->high_kappa;
    for (int i = 0; i < 4; i++)
      for (int j = 0; j < 4; j++) {
        e[4 * i + j] = shape->rho_c[region] * volume * (i == j ? 0.1 : 0.05);
        k[4 * i + j] = kappa * volume * (grad[i][0] * grad[j][0] + grad[i][1] * grad[j][1] + grad[i][2] * grad[j][2]);
      }
    PetscCall(MatSetValues(E, 4, node, 4, node, e, ADD_VALUES));
    PetscCall(MatSetValues(K, 4, node, 4, node, k, ADD_VALUES));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static double triangle_area(const RomData *mesh, size_t t)
{
  const int32_t *node = mesh->triangles + 3 * t;
  const double *x[3] = {mesh->points + 3 * node[0], mesh->points + 3 * node[1], mesh->points + 3 * node[2]};
  double sum = 0.0;
  for (int d = 0; d < 3; d++) {
    const int a = (d + 1) % 3, b = (d + 2) % 3;
    const double c = (x[1][a] - x[0][a]) * (x[2][b] - x[0][b]) - (x[1][b] - x[0][b]) * (x[2][a] - x[0][a]);
    sum += c * c;
  }
  return 0.5 * sqrt(sum);
}

/* B, the Robin wall in K, the ambient column; area [m] of the patches that exist, the outer one last. */
static PetscErrorCode add_triangles(const RomData *mesh, const Shape *shape, PetscReal *area, Mat K, Mat *B,
                                    Vec ambient)
{
  PetscReal all[MOST_PATCHES] = {0};
  PetscInt column[MOST_PATCHES], m = 0;

  PetscFunctionBeginUser;
  for (size_t t = 0; t < mesh->n_triangles; t++) all[mesh->triangle_patch[t]] += triangle_area(mesh, t);
  for (int l = 0; l < MOST_PATCHES; l++)
    if (all[l] > 0.0) {
      area[m] = all[l];
      column[l] = m++;
    }
  PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, (PetscInt)mesh->n_points, m, NULL, B));
  for (size_t t = 0; t < mesh->n_triangles; t++) {
    const int32_t *node = mesh->triangles + 3 * t;
    const int patch = mesh->triangle_patch[t];
    const double a = triangle_area(mesh, t);
    double k[9];
    for (int i = 0; i < 3; i++) {
      for (int j = 0; j < 3; j++) k[3 * i + j] = shape->h * a * (i == j ? 1.0 / 6.0 : 1.0 / 12.0);
      PetscCall(MatSetValue(*B, node[i], column[patch], a / 3.0 / all[patch], ADD_VALUES));
      if (patch == OUTER) PetscCall(VecSetValue(ambient, node[i], shape->h * a / 3.0, ADD_VALUES));
    }
    if (patch == OUTER) PetscCall(MatSetValues(K, 3, node, 3, node, k, ADD_VALUES));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode assemble(const RomData *mesh, const Shape *shape, ThermalSystem **system)
{
  const PetscInt n = (PetscInt)mesh->n_points;
  PetscReal area[MOST_PATCHES];
  Mat E, K, B;
  Vec ambient;

  PetscFunctionBeginUser;
  PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, n, n, 32, NULL, &E));
  PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, n, n, 32, NULL, &K));
  PetscCall(MatCreateVecs(E, NULL, &ambient));
  PetscCall(VecZeroEntries(ambient));
  PetscCall(add_tetrahedra(mesh, shape, E, K));
  PetscCall(add_triangles(mesh, shape, area, K, &B, ambient));
  Mat of[] = {E, K, B};
  for (int i = 0; i < 3; i++) {
    PetscCall(MatAssemblyBegin(of[i], MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(of[i], MAT_FINAL_ASSEMBLY));
  }
  PetscCall(VecAssemblyBegin(ambient));
  PetscCall(VecAssemblyEnd(ambient));
  PetscCall(thermal_system_wrap(E, K, B, ambient, area, system));
  PetscCall(MatDestroy(&E));
  PetscCall(MatDestroy(&K));
  PetscCall(MatDestroy(&B));
  PetscCall(VecDestroy(&ambient));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode random_mould_create(uint64_t seed, ThermalSystem **system)
{
  Shape shape = {.seed = seed * 977 + 13};
  RomData *mesh = synthetic_array(1, sizeof *mesh);
  VoxelMould voxels = random_voxels(&shape);

  PetscFunctionBeginUser;
  random_materials(&shape);
  if (seed % 5 == 4) shape.h = 0.0;
  mesh->m = MOST_PATCHES;
  mesh->patch = synthetic_array(mesh->m, sizeof *mesh->patch);
  voxel_mould_geometry(&voxels, patch_of, &shape, mesh);
  PetscCall(assemble(mesh, &shape, system));
  voxel_mould_destroy(&voxels);
  rom_destroy(&mesh);
  PetscFunctionReturn(PETSC_SUCCESS);
}
