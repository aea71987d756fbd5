/* What of the mesh goes into the ROM file: the whole boundary, the band, and the basis on their nodes; the same on any
 * number of ranks. */
#include "tests/support/petsc_test.h"

#include <string.h>

#include "reduce/fem/thermal_system.h"
#include "reduce/io/wall_geometry.h"
#include "tests/support/box_mould.h"

enum { STATES = 3 };
static int order = 1; // of the elements; the file holds their values at the vertices
static const double BAND = 2.2e-3;
static double budget = 1e9; // bytes

static const BoxMould BOX = {.size = {0.02, 0.012, 0.01},
                             .cells = {8, 6, 8},
                             .grading = 1.6,
                             .patches = {4, 2},
                             .h_sides = 15.0,
                             .kappa = {1.0},
                             .rho = {1800.0},
                             .c = {1100.0}};

/* A "basis" that is known at each place, so that a row at a wrong point shows. */
static double field(int k, const double x[3])
{
  return k == 0 ? 1.0 : sin(70.0 * k * x[0] + 1.0) * cos(110.0 * x[1]) + 40.0 * k * x[2];
}

static void fill_basis(const MouldMesh *mesh, BV *V)
{
  Vec layout, coordinates;
  PetscSection section, coordinate_section;
  PetscInt first, last, begin, end;
  const PetscScalar *x;
  TEST_PETSC(DMCreateGlobalVector(mesh->dm, &layout));
  TEST_PETSC(VecGetOwnershipRange(layout, &begin, &end));
  TEST_PETSC(BVCreate(PetscObjectComm((PetscObject)mesh->dm), V));
  TEST_PETSC(BVSetSizesFromVec(*V, layout, STATES));
  TEST_PETSC(BVSetFromOptions(*V));
  TEST_PETSC(DMGetGlobalSection(mesh->dm, &section));
  TEST_PETSC(DMGetCoordinateSection(mesh->dm, &coordinate_section));
  TEST_PETSC(DMGetCoordinatesLocal(mesh->dm, &coordinates));
  TEST_PETSC(DMPlexGetDepthStratum(mesh->dm, 0, &first, &last));
  TEST_PETSC(VecGetArrayRead(coordinates, &x));
  for (int k = 0; k < STATES; k++) {
    Vec column;
    TEST_PETSC(BVGetColumn(*V, k, &column));
    for (PetscInt vertex = first; vertex < last; vertex++) {
      PetscInt number, offset;
      TEST_PETSC(PetscSectionGetOffset(section, vertex, &number));
      TEST_PETSC(PetscSectionGetOffset(coordinate_section, vertex, &offset));
      if (number >= begin && number < end) TEST_PETSC(VecSetValue(column, number, field(k, x + offset), INSERT_VALUES));
    }
    TEST_PETSC(VecAssemblyBegin(column));
    TEST_PETSC(VecAssemblyEnd(column));
    TEST_PETSC(BVRestoreColumn(*V, k, &column));
  }
  TEST_PETSC(VecRestoreArrayRead(coordinates, &x));
  TEST_PETSC(VecDestroy(&layout));
}

static void gather(MPI_Comm comm, WallGeometry *geometry, MouldMesh **mesh, ReduceConfig **config)
{
  BV V;
  ThermalSystem *system;
  TEST_PETSC(box_mould_create(comm, &BOX, mesh, config));
  (*config)->order = order;
  TEST_PETSC(thermal_system_create(*mesh, *config, &system)); // gives the DM its numbering
  fill_basis(*mesh, &V);
  PetscInt r;
  TEST_PETSC(BVGetActiveColumns(V, NULL, &r));
  const ModelBasis basis = {.V = V, .r = r};
  TEST_PETSC(wall_geometry_gather(*mesh, &basis, BAND, budget, geometry));
  TEST_PETSC(BVDestroy(&V));
  TEST_PETSC(thermal_system_destroy(&system));
}

static int get_rank(void)
{
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return rank;
}

static const double *at(const WallGeometry *geometry, int32_t point)
{
  return geometry->points + 3 * (size_t)point;
}

static double volume_of(const double *a, const double *b, const double *c, const double *d)
{
  double u[3], v[3], w[3];
  for (int i = 0; i < 3; i++) {
    u[i] = b[i] - a[i];
    v[i] = c[i] - a[i];
    w[i] = d[i] - a[i];
  }
  return (w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
          w[2] * (u[0] * v[1] - u[1] * v[0])) /
         6.0;
}

static void the_boundary_encloses_the_mould(void **state)
{
  (void)state;
  static const double origin[3] = {0, 0, 0};
  WallGeometry geometry;
  MouldMesh *mesh;
  ReduceConfig *config;
  gather(PETSC_COMM_WORLD, &geometry, &mesh, &config);
  if (get_rank() == 0) {
    double volume = 0.0;
    assert_int_equal(geometry.n_triangles, 4 * (8 * 6 + 8 * 8 + 6 * 8));
    for (size_t t = 0; t < geometry.n_triangles; t++) {
      const int32_t *p = geometry.triangles + 3 * t;
      volume += volume_of(origin, at(&geometry, p[0]), at(&geometry, p[1]), at(&geometry, p[2]));
      const bool cavity = at(&geometry, p[0])[2] + at(&geometry, p[1])[2] + at(&geometry, p[2])[2] < 1e-9;
      assert_int_equal(geometry.triangle_patch[t] < mesh->n_cavity, cavity);
    }
    ASSERT_CLOSE(volume / mesh->volume, 1.0, 1e-12); // wound out of the mould: positive
  } else {
    assert_int_equal(geometry.n_triangles + geometry.n_points + geometry.n_tetrahedra, 0);
  }
  TEST_PETSC(wall_geometry_destroy(&geometry));
  TEST_PETSC(box_mould_destroy(&mesh, &config));
}

static void a_basis_above_its_budget_keeps_a_thinner_band(void **state)
{
  (void)state;
  WallGeometry whole, thin, least;
  MouldMesh *mesh;
  ReduceConfig *config;
  WallGeometry *const geometry[3] = {&whole, &thin, &least};
  double bytes = 0.0;
  for (int i = 0; i < 3; i++) {
    budget = i == 0 ? 1e9 : i == 1 ? 0.85 * bytes : 1.0;
    gather(PETSC_COMM_WORLD, geometry[i], &mesh, &config);
    if (i == 0) bytes = (double)sizeof(float) * (double)whole.r * (double)whole.n_points;
    MPI_Bcast(&bytes, 1, MPI_DOUBLE, 0, PETSC_COMM_WORLD);
    TEST_PETSC(box_mould_destroy(&mesh, &config));
  }
  budget = 1e9;
  assert_true(whole.band == BAND && thin.band < BAND && least.band < thin.band);
  if (get_rank() == 0) {
    assert_true((double)sizeof(float) * (double)thin.r * (double)thin.n_points <= 0.85 * bytes);
    assert_true(least.n_tetrahedra > 0 && least.n_tetrahedra < thin.n_tetrahedra); // the wall's own elements stay
    assert_int_equal(least.n_triangles, whole.n_triangles);
  }
  for (int i = 0; i < 3; i++) TEST_PETSC(wall_geometry_destroy(geometry[i]));
}

/* The cavity wall is z = 0: the band must hold the box's slice 0 < z < BAND, all of it, and little beyond. */
static void the_band_reaches_as_far_as_it_says(void **state)
{
  (void)state;
  WallGeometry geometry;
  MouldMesh *mesh;
  ReduceConfig *config;
  gather(PETSC_COMM_WORLD, &geometry, &mesh, &config);
  if (get_rank() == 0) {
    double volume = 0.0, highest = 0.0, layer = 0.0; // layer: the first grid plane above the band
    for (int k = BOX.cells[2]; k > 0 && BOX.size[2] * pow((double)k / BOX.cells[2], BOX.grading) >= BAND; k--)
      layer = BOX.size[2] * pow((double)k / BOX.cells[2], BOX.grading);
    for (size_t t = 0; t < geometry.n_tetrahedra; t++) {
      const int32_t *p = geometry.tetrahedra + 4 * t;
      double low = 1.0, high = 0.0;
      const double v = volume_of(at(&geometry, p[0]), at(&geometry, p[1]), at(&geometry, p[2]), at(&geometry, p[3]));
      assert_true(v > 0.0);
      for (int k = 0; k < 4; k++) {
        low = fmin(low, at(&geometry, p[k])[2]);
        high = fmax(high, at(&geometry, p[k])[2]);
      }
      if (high <= layer + 1e-12) volume += v;
      highest = fmax(highest, low);
    }
    ASSERT_CLOSE(volume / (BOX.size[0] * BOX.size[1] * layer), 1.0, 1e-12); // not a tetrahedron of the slice is missing
    assert_true(highest < 2.0 * layer);
  }
  TEST_PETSC(wall_geometry_destroy(&geometry));
  TEST_PETSC(box_mould_destroy(&mesh, &config));
}

static void each_point_has_its_own_row_of_the_basis(void **state)
{
  (void)state;
  WallGeometry geometry;
  MouldMesh *mesh;
  ReduceConfig *config;
  gather(PETSC_COMM_WORLD, &geometry, &mesh, &config);
  for (size_t p = 0; p < geometry.n_points; p++)
    for (int k = 0; k < STATES; k++)
      ASSERT_CLOSE(geometry.basis[p * STATES + (size_t)k], field(k, geometry.points + 3 * p), 1e-6); // float
  TEST_PETSC(wall_geometry_destroy(&geometry));
  TEST_PETSC(box_mould_destroy(&mesh, &config));
}

static void the_geometry_does_not_depend_on_the_number_of_ranks(void **state)
{
  (void)state;
  WallGeometry shared, alone;
  MouldMesh *mesh;
  ReduceConfig *config;
  gather(PETSC_COMM_WORLD, &shared, &mesh, &config);
  TEST_PETSC(box_mould_destroy(&mesh, &config));
  gather(PETSC_COMM_SELF, &alone, &mesh, &config);
  TEST_PETSC(box_mould_destroy(&mesh, &config));
  if (get_rank() == 0) {
    assert_int_equal(shared.n_points, alone.n_points);
    assert_int_equal(shared.n_triangles, alone.n_triangles);
    assert_int_equal(shared.n_tetrahedra, alone.n_tetrahedra);
    assert_memory_equal(shared.points, alone.points, 3 * alone.n_points * sizeof *alone.points);
    assert_memory_equal(shared.triangles, alone.triangles, 3 * alone.n_triangles * sizeof *alone.triangles);
    assert_memory_equal(shared.triangle_patch, alone.triangle_patch, alone.n_triangles * sizeof *alone.triangle_patch);
    assert_memory_equal(shared.tetrahedra, alone.tetrahedra, 4 * alone.n_tetrahedra * sizeof *alone.tetrahedra);
    assert_memory_equal(shared.basis, alone.basis, STATES * alone.n_points * sizeof *alone.basis);
  }
  TEST_PETSC(wall_geometry_destroy(&shared));
  TEST_PETSC(wall_geometry_destroy(&alone));
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_basis_above_its_budget_keeps_a_thinner_band),
      cmocka_unit_test(the_boundary_encloses_the_mould),
      cmocka_unit_test(the_band_reaches_as_far_as_it_says),
      cmocka_unit_test(each_point_has_its_own_row_of_the_basis),
      cmocka_unit_test(the_geometry_does_not_depend_on_the_number_of_ranks),
  };
  if (SlepcInitialize(&argc, &argv, NULL, NULL)) return 1;
  int failed = 0;
  for (order = 1; order <= 2; order++)
    failed += cmocka_run_group_tests_name(order == 1 ? "linear elements" : "quadratic elements", tests, NULL, NULL);
  return SlepcFinalize() ? 1 : failed;
}
