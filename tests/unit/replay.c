/* The full model in time, the wall's triangles found again on it, and the field files. */
#include <hdf5.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/petsc_test.h"

#include "reduce/io/wall_geometry.h"
#include "reduce/linear/dense_block.h"
#include "reduce/mor/krylov/krylov_basis.h"
#include "reduce/mor/krylov/ports.h"
#include "reduce/replay/field_file.h"
#include "reduce/replay/full_run.h"
#include "reduce/replay/wall_triangles.h"
#include "tests/support/mould_case.h"
#include <slepcsys.h>

static const BoxMould BOX = {.size = {12e-3, 8e-3, 6e-3},
                             .cells = {6, 4, 5},
                             .grading = 1.5,
                             .patches = {3, 2},
                             .h_sides = 50.0,
                             .h_top = 20.0,
                             .kappa = {1.0, 1.0},
                             .rho = {1800.0, 1800.0},
                             .c = {1100.0, 1100.0}};

static MouldCase mould;

static int set_up(void **state)
{
  (void)state;
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &BOX, &mould));
  return 0;
}

static int tear_down(void **state)
{
  (void)state;
  TEST_PETSC(mould_case_destroy(&mould));
  return 0;
}

/* 1 W into patch 0 for 0.1 s, then nothing for 0.1 s, in spans of 0.02 s; temperatures of the patches at the end. */
static void pulse(PetscInt substeps, PetscReal *T)
{
  FullRun *run;
  Mat F;
  PetscReal on = 1.0, q;
  TEST_PETSC(full_run_create(mould.system, 1, substeps, &run));
  TEST_PETSC(dense_block_create(mould.system->E, 1, &F));
  for (int span = 0; span < 10; span++) {
    q = span < 5 ? on : 0.0;
    TEST_PETSC(dense_block_copy(F, 0, mould.system->B, NULL, 1));
    TEST_PETSC(dense_block_scale(F, &q));
    TEST_PETSC(full_run_advance(run, 0.02, F));
  }
  TEST_PETSC(dense_block_inner(mould.system->B, full_run_state(run), T));
  TEST_PETSC(MatDestroy(&F));
  TEST_PETSC(full_run_destroy(&run));
}

static void the_scheme_converges_with_order_five(void **state)
{
  (void)state;
  PetscReal *T[3], difference[2] = {0.0, 0.0};
  for (int k = 0; k < 3; k++) {
    TEST_PETSC(PetscMalloc1(mould.system->m, &T[k]));
    pulse(4 << k, T[k]);
  }
  for (PetscInt l = 0; l < mould.system->m; l++) {
    difference[0] = PetscMax(difference[0], PetscAbsReal(T[1][l] - T[0][l]));
    difference[1] = PetscMax(difference[1], PetscAbsReal(T[2][l] - T[1][l]));
  }
  const double order = log2(difference[0] / difference[1]);
  if (!(order > 4.5 && order < 6.5)) fail_msg("order %g", order); // 5; stiff modes make it waver
  assert_true(difference[1] < 1e-6 * T[2][0]);
  for (int k = 0; k < 3; k++) TEST_PETSC(PetscFree(T[k]));
}

/* dz/dt = -lambda z + u has the closed answer; very stiff ones are at rest at once. */
static void one_mode_follows_its_exact_answer(void **state)
{
  (void)state;
  for (int decade = -3; decade <= 1; decade++) {
    const PetscReal lambda = pow(10.0, decade), exact = -expm1(-lambda) / lambda + 0.5 * exp(-lambda);
    ASSERT_CLOSE(full_run_advance_mode(lambda, 1.0, 1.0, 16, 0.5), exact, 1e-5 * exact);
  }
  ASSERT_CLOSE(full_run_advance_mode(1e8, 1e8, 1.0, 1, 0.0), 1.0, 1e-6);
}

/* What a ROM file would hold of this mould: its boundary. V is one column of ones. */
static void make_rom(RomData *rom)
{
  WallGeometry geometry;
  Vec like;
  BV V;
  PetscMPIInt rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  TEST_PETSC(MatCreateVecs(mould.system->E, &like, NULL));
  TEST_PETSC(BVCreate(PETSC_COMM_WORLD, &V));
  TEST_PETSC(BVSetSizesFromVec(V, like, 1));
  TEST_PETSC(BVSetType(V, BVMAT));
  const ModelBasis basis = {.V = V, .r = 1};
  TEST_PETSC(wall_geometry_gather(mould.mesh, &basis, 1e-3, 1e9, &geometry));
  unsigned long size[2] = {geometry.n_points, geometry.n_triangles};
  MPI_Bcast(size, 2, MPI_UNSIGNED_LONG, 0, PETSC_COMM_WORLD);
  *rom = (RomData){.n_points = size[0], .n_triangles = size[1]};
  rom->points = calloc(3 * size[0], sizeof(double));
  rom->triangles = calloc(3 * size[1], sizeof(int32_t));
  rom->triangle_patch = calloc(size[1], sizeof(int32_t));
  assert_true(rom->points && rom->triangles && rom->triangle_patch);
  if (rank == 0) {
    memcpy(rom->points, geometry.points, 3 * size[0] * sizeof(double));
    memcpy(rom->triangles, geometry.triangles, 3 * size[1] * sizeof(int32_t));
    memcpy(rom->triangle_patch, geometry.triangle_patch, size[1] * sizeof(int32_t));
  }
  MPI_Bcast(rom->points, (int)(3 * size[0]), MPI_DOUBLE, 0, PETSC_COMM_WORLD);
  MPI_Bcast(rom->triangles, (int)(3 * size[1]), MPI_INT32_T, 0, PETSC_COMM_WORLD);
  MPI_Bcast(rom->triangle_patch, (int)size[1], MPI_INT32_T, 0, PETSC_COMM_WORLD);
  TEST_PETSC(wall_geometry_destroy(&geometry));
  TEST_PETSC(BVDestroy(&V));
  TEST_PETSC(VecDestroy(&like));
}

static void free_rom(RomData *rom)
{
  free(rom->points);
  free(rom->triangles);
  free(rom->triangle_patch);
}

static PetscReal area_of(const RomData *rom, size_t t)
{
  PetscReal u[3], v[3], n2 = 0.0;
  for (int d = 0; d < 3; d++) {
    const double a = rom->points[3 * rom->triangles[3 * t] + d];
    u[d] = rom->points[3 * rom->triangles[3 * t + 1] + d] - a;
    v[d] = rom->points[3 * rom->triangles[3 * t + 2] + d] - a;
  }
  for (int d = 0; d < 3; d++) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    n2 += PetscSqr(u[e] * v[f] - u[f] * v[e]);
  }
  return 0.5 * PetscSqrtReal(n2);
}

/* A patch's heat spread evenly over its triangles is the patch's column of B. */
static void even_heat_on_triangles_is_the_patch_s_heat(void **state)
{
  (void)state;
  RomData rom;
  WallTriangles *wall;
  PetscReal *heat, off, size;
  PetscInt *patch;
  Vec F, b;
  make_rom(&rom);
  TEST_PETSC(wall_triangles_create(mould.mesh, &rom, &wall));
  TEST_PETSC(PetscCalloc2(rom.n_triangles, &heat, rom.n_triangles, &patch));
  TEST_PETSC(wall_triangles_patches(wall, rom.n_triangles, patch));
  const PetscInt l = 4;
  for (size_t t = 0; t < rom.n_triangles; t++) {
    assert_int_equal(patch[t], rom.triangle_patch[t]);
    if (patch[t] == l) heat[t] = area_of(&rom, t) / mould.system->area[l];
  }
  TEST_PETSC(MatCreateVecs(mould.system->E, &F, NULL));
  TEST_PETSC(VecZeroEntries(F));
  TEST_PETSC(wall_triangles_load(wall, heat, F));
  TEST_PETSC(MatDenseGetColumnVecRead(mould.system->B, l, &b));
  TEST_PETSC(VecNorm(b, NORM_INFINITY, &size));
  TEST_PETSC(VecAXPY(F, -1.0, b));
  TEST_PETSC(MatDenseRestoreColumnVecRead(mould.system->B, l, &b));
  TEST_PETSC(VecNorm(F, NORM_INFINITY, &off));
  assert_true(off < 1e-13 * size); // the same sums in another order
  TEST_PETSC(VecDestroy(&F));
  TEST_PETSC(PetscFree2(heat, patch));
  TEST_PETSC(wall_triangles_destroy(&wall));
  free_rom(&rom);
}

static void a_rom_of_another_mesh_is_refused(void **state)
{
  (void)state;
  RomData rom;
  WallTriangles *wall;
  make_rom(&rom);
  rom.provenance.libraries = (char[]){"none"};
  rom.points[0] += 1e-12;
  TEST_PETSC(PetscPushErrorHandler(PetscIgnoreErrorHandler, NULL));
  assert_int_equal((int)wall_triangles_create(mould.mesh, &rom, &wall), PETSC_ERR_USER);
  TEST_PETSC(PetscPopErrorHandler());
  free_rom(&rom);
}

static void read_set(hid_t file, const char *name, hid_t type, void *values)
{
  const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
  assert_true(set >= 0 && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
  H5Dclose(set);
}

/* The heat in the field file's tetrahedra, rho c V (mean T - preheat), is that which the state holds, 1^T E theta. */
static double heat_in_file(const char *path, double preheat)
{
  enum { MOST = 20000 };
  static double points[3 * MOST];
  static float T[MOST];
  static long long cells[4 * MOST], offsets[MOST], n_points[64], n_cells[64];
  const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  PetscMPIInt ranks;
  double heat = 0.0;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  assert_true(file >= 0);
  read_set(file, "VTKHDF/NumberOfPoints", H5T_NATIVE_LLONG, n_points);
  read_set(file, "VTKHDF/NumberOfCells", H5T_NATIVE_LLONG, n_cells);
  read_set(file, "VTKHDF/Points", H5T_NATIVE_DOUBLE, points);
  read_set(file, "VTKHDF/Connectivity", H5T_NATIVE_LLONG, cells);
  read_set(file, "VTKHDF/Offsets", H5T_NATIVE_LLONG, offsets);
  read_set(file, "VTKHDF/PointData/temperature", H5T_NATIVE_FLOAT, T);
  H5Fclose(file);
  long long first_point = 0, first_cell = 0;
  for (int part = 0; part < ranks; part++) {
    for (long long c = first_cell; c < first_cell + n_cells[part]; c++) {
      const double *x[4];
      double mean = 0.0, e[3][3];
      for (int k = 0; k < 4; k++) {
        x[k] = points + 3 * (first_point + cells[4 * c + k]);
        mean += 0.25 * ((double)T[first_point + cells[4 * c + k]] - preheat);
      }
      for (int k = 0; k < 3; k++)
        for (int d = 0; d < 3; d++) e[k][d] = x[k + 1][d] - x[0][d];
      const double volume =
          (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) + e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
           e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
          6.0;
      assert_true(volume > 0.0); // wound as VTK wants it
      heat += 1800.0 * 1100.0 * volume * mean;
    }
    first_point += n_points[part];
    first_cell += n_cells[part];
  }
  return heat;
}

static void the_field_file_holds_the_heat_of_the_state(void **state)
{
  (void)state;
  static const char PATH[] = "/tmp/cast_field_test.vtkhdf";
  Vec theta, E_theta;
  PetscScalar held;
  PetscMPIInt rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  TEST_PETSC(MatCreateVecs(mould.system->E, &theta, &E_theta));
  PetscInt begin, end;
  TEST_PETSC(VecGetOwnershipRange(theta, &begin, &end));
  for (PetscInt i = begin; i < end; i++) TEST_PETSC(VecSetValue(theta, i, 10.0 + 5.0 * sin((double)i), INSERT_VALUES));
  TEST_PETSC(VecAssemblyBegin(theta));
  TEST_PETSC(VecAssemblyEnd(theta));
  TEST_PETSC(MatMult(mould.system->E, theta, E_theta));
  TEST_PETSC(VecSum(E_theta, &held));
  TEST_PETSC(field_file_write(mould.mesh->dm, theta, 1000.0, 0.25, PATH));
  if (rank == 0) ASSERT_CLOSE(heat_in_file(PATH, 1000.0) / held, 1.0, 1e-4); // floats of 1000 K hold 10 K to 6e-6
  MPI_Barrier(PETSC_COMM_WORLD);
  if (rank == 0) unlink(PATH);
  TEST_PETSC(VecDestroy(&theta));
  TEST_PETSC(VecDestroy(&E_theta));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_scheme_converges_with_order_five),       cmocka_unit_test(one_mode_follows_its_exact_answer),
      cmocka_unit_test(even_heat_on_triangles_is_the_patch_s_heat), cmocka_unit_test(a_rom_of_another_mesh_is_refused),
      cmocka_unit_test(the_field_file_holds_the_heat_of_the_state),
  };
  if (SlepcInitialize(&argc, &argv, NULL, NULL)) return 1;
  const int failed = cmocka_run_group_tests(tests, set_up, tear_down);
  return SlepcFinalize() ? 1 : failed;
}
