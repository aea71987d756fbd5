/* From geometry files to the distributed mesh: exact volumes and areas, sizes, labels, on any number of ranks. */
#include "tests/support/petsc_test.h"

#include <petscdmplex.h>
#include <stdio.h>
#include <string.h>

#include "reduce/mesh/geometry/mould_geometry.h"
#include "reduce/mesh/mould_mesh.h"
#include "tests/support/mould_files.h"

static MouldFiles files;
static PetscMPIInt rank;

/* One folder for all ranks. */
static int make_files(void **state)
{
  (void)state;
  if (rank == 0) mould_files_create(&files);
  MPI_Bcast(&files, (int)sizeof files, MPI_BYTE, 0, PETSC_COMM_WORLD);
  return 0;
}

static int remove_files(void **state)
{
  (void)state;
  MPI_Barrier(PETSC_COMM_WORLD);
  if (rank == 0) mould_files_remove(&files);
  return 0;
}

static void convert(const char *name, const char *options)
{
  if (rank == 0) mould_files_convert(&files, name, options);
  MPI_Barrier(PETSC_COMM_WORLD);
}

static ReduceConfig *read_config(const char *yaml)
{
  char path[128];
  CastError err;
  ReduceConfig *config = NULL;
  snprintf(path, sizeof path, "%s/mould.yaml", files.folder);
  if (reduce_config_read(path, yaml, &config, &err) != CAST_OK) fail_msg("%s", err.message);
  return config;
}

static double area_of(const MouldMesh *mesh, const char *surface)
{
  double area = 0.0;
  for (PetscInt l = 0; l < mesh->n_patches; l++)
    if (strcmp(mesh->patch[l].surface, surface) == 0) area += mesh->patch[l].area * 1e6;
  return area;
}

/* Flat faces: only rounding is between the sums and the products. */
static void check_exact_sizes(const MouldMesh *mesh)
{
  static const double ROUNDING = 1e-11;
  ASSERT_CLOSE(mesh->volume * 1e9 / MOULD_VOLUME, 1.0, ROUNDING);
  ASSERT_CLOSE(area_of(mesh, "basin") / MOULD_BASIN_AREA, 1.0, ROUNDING);
  ASSERT_CLOSE(area_of(mesh, "pin") / MOULD_PIN_AREA, 1.0, ROUNDING);
  ASSERT_CLOSE(area_of(mesh, "rim") / MOULD_RIM_AREA, 1.0, ROUNDING);
  ASSERT_CLOSE(area_of(mesh, "side") / MOULD_SIDE_AREA, 1.0, ROUNDING);
  ASSERT_CLOSE(area_of(mesh, "foot") / MOULD_FOOT_AREA, 1.0, ROUNDING);
}

/* Volume by region and area by patch from the labels of the distributed mesh, mm3 and mm2. */
static void check_labels(const MouldMesh *mesh)
{
  enum { MOST_PATCHES = 64 };
  double volume[2] = {0, 0}, area[MOST_PATCHES] = {0};
  PetscInt first, last;
  DMLabel region, patch;
  TEST_PETSC(DMGetLabel(mesh->dm, "region", &region));
  TEST_PETSC(DMGetLabel(mesh->dm, "patch", &patch));
  TEST_PETSC(DMPlexGetHeightStratum(mesh->dm, 0, &first, &last));
  for (PetscInt c = first; c < last; c++) {
    PetscInt value;
    PetscReal size, J[9], inverse[9], determinant;
    TEST_PETSC(DMLabelGetValue(region, c, &value));
    assert_in_range(value, 0, 1);
    TEST_PETSC(DMPlexComputeCellGeometryFVM(mesh->dm, c, &size, NULL, NULL));
    TEST_PETSC(DMPlexComputeCellGeometryFEM(mesh->dm, c, NULL, NULL, J, inverse, &determinant));
    assert_true(determinant > 0.0); // PETSc's own orientation
    volume[value] += size * 1e9;
  }
  TEST_PETSC(DMPlexGetHeightStratum(mesh->dm, 1, &first, &last));
  for (PetscInt f = first; f < last; f++) {
    PetscInt value, cells;
    PetscReal size;
    TEST_PETSC(DMLabelGetValue(patch, f, &value));
    if (value < 0) continue;
    assert_true(value < mesh->n_patches);
    TEST_PETSC(DMPlexGetSupportSize(mesh->dm, f, &cells));
    assert_int_equal(cells, 1);
    TEST_PETSC(DMPlexComputeCellGeometryFVM(mesh->dm, f, &size, NULL, NULL));
    area[value] += size * 1e6;
  }
  MPI_Allreduce(MPI_IN_PLACE, volume, 2, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  MPI_Allreduce(MPI_IN_PLACE, area, MOST_PATCHES, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  ASSERT_CLOSE(volume[0] / MOULD_FOOT_VOLUME, 1.0, 1e-11);
  ASSERT_CLOSE(volume[1] / (MOULD_VOLUME - MOULD_FOOT_VOLUME), 1.0, 1e-11);
  for (PetscInt l = 0; l < mesh->n_patches; l++) ASSERT_CLOSE(area[l] / (mesh->patch[l].area * 1e6), 1.0, 1e-11);
}

static MouldMesh *make_mesh(const char *yaml, ReduceConfig **config)
{
  MouldMesh *mesh = NULL;
  *config = read_config(yaml);
  TEST_PETSC(mould_mesh_create(PETSC_COMM_WORLD, *config, &mesh));
  check_exact_sizes(mesh);
  check_labels(mesh);
  return mesh;
}

static void release(MouldMesh **mesh, ReduceConfig **config)
{
  TEST_PETSC(mould_mesh_destroy(mesh));
  assert_null(*mesh);
  reduce_config_destroy(config);
}

static void a_geo_file_becomes_a_mesh_of_exact_volume_and_areas(void **state)
{
  (void)state;
  ReduceConfig *config;
  MouldMesh *mesh = make_mesh(mould_files_yaml("mould.geo", "  unit: mm\n"), &config);
  assert_true(mesh->worst_quality > 0.1);
  release(&mesh, &config);
}

static void the_unit_scales_the_mould(void **state)
{
  (void)state;
  MouldMesh *mesh = NULL;
  ReduceConfig *config = read_config(mould_files_yaml("mould.geo", "  unit: 0.5 mm\n"));
  TEST_PETSC(mould_mesh_create(PETSC_COMM_WORLD, config, &mesh));
  ASSERT_CLOSE(mesh->volume * 1e9 / MOULD_VOLUME, 0.125, 1e-11);
  release(&mesh, &config);
}

static void a_step_file_with_groups_becomes_the_same_mould(void **state)
{
  (void)state;
  ReduceConfig *config;
  convert("mould.step", "");
  MouldMesh *mesh = make_mesh(mould_files_yaml("mould.step", MOULD_GROUPS), &config);
  release(&mesh, &config);
}

static void a_brep_file_with_groups_becomes_the_same_mould(void **state)
{
  (void)state;
  ReduceConfig *config;
  char lines[2048];
  convert("mould.brep", "");
  snprintf(lines, sizeof lines, "  unit: mm\n%s", MOULD_GROUPS);
  MouldMesh *mesh = make_mesh(mould_files_yaml("mould.brep", lines), &config);
  release(&mesh, &config);
}

static void ready_meshes_of_both_versions_become_the_same_mould(void **state)
{
  (void)state;
  static const char *const versions[] = {"Mesh.MshFileVersion = 2.2; Mesh.MeshSizeMax = 2;\n",
                                         "Mesh.MshFileVersion = 4.1; Mesh.MeshSizeMax = 2;\n"};
  for (size_t i = 0; i < 2; i++) {
    ReduceConfig *config;
    convert("mould.msh", versions[i]);
    MouldMesh *mesh = make_mesh(mould_files_yaml_of_mesh("mould.msh", "  unit: mm\n"), &config);
    release(&mesh, &config);
  }
}

static void patches_and_walls_are_as_the_input_says(void **state)
{
  (void)state;
  ReduceConfig *config;
  MouldMesh *mesh = make_mesh(mould_files_yaml("mould.geo", "  unit: mm\n"), &config);
  PetscInt l = mesh->n_cavity - 1;
  assert_string_equal(mesh->patch[0].name, "basin/1");
  assert_string_equal(mesh->patch[l].name, "pin"); // one patch keeps the plain name
  // four walls of 40 and 30 mm2 and a floor of 47 mm2 in patches of about 9 mm2
  assert_int_equal(mesh->n_cavity, 2 * 4 + 2 * 3 + 5 + 1);
  for (l = 0; l < mesh->n_cavity; l++) assert_true(!mesh->patch[l].outer && mesh->patch[l].h == 0.0);
  assert_int_equal(mesh->n_patches, mesh->n_cavity + 3);
  const RomPatch *side = &mesh->patch[l], *rim = side + 1, *foot = side + 2;
  assert_string_equal(side->name, "side");
  assert_true(side->outer && side->h == 15.0 && !side->fixed);
  assert_true(rim->outer && rim->h == 0.0 && !rim->fixed);
  assert_true(foot->outer && foot->fixed);
  assert_true(foot->h > 1e4 * 27.0 / config->outside_size);
  ASSERT_CLOSE(foot->centroid[2], 0.0, 1e-15);
  ASSERT_CLOSE(rim->centroid[2], 0.012, 1e-12);
  release(&mesh, &config);
}

/* Each rank meshes the mould alone as well: the patch table must be the same to the last bit. */
static void patches_do_not_depend_on_the_number_of_ranks(void **state)
{
  (void)state;
  ReduceConfig *config;
  MouldMesh *alone = NULL, *mesh = make_mesh(mould_files_yaml("mould.geo", "  unit: mm\n"), &config);
  TEST_PETSC(mould_mesh_create(PETSC_COMM_SELF, config, &alone));
  assert_int_equal(alone->n_patches, mesh->n_patches);
  assert_memory_equal(alone->patch, mesh->patch, (size_t)mesh->n_patches * sizeof *mesh->patch);
  assert_memory_equal(alone->triangles, mesh->triangles, (size_t)mesh->n_patches * sizeof *mesh->triangles);
  assert_true(alone->first_layer == mesh->first_layer && alone->shortest_edge == mesh->shortest_edge);
  TEST_PETSC(mould_mesh_destroy(&alone));
  release(&mesh, &config);
}

static double box_distance(const double x[3], const double low[3], const double high[3])
{
  double square = 0.0;
  for (int d = 0; d < 3; d++) square += pow(fmax(fmax(low[d] - x[d], x[d] - high[d]), 0.0), 2);
  return sqrt(square);
}

/* Outside the cavity the distance to its wall is that to its two boxes. A good mesher keeps its mean edge near the size
 * asked for; a size that is off by a factor (a missing unit, a growth that does not act) is far outside these limits.
 */
static void sizes_grow_from_the_cavity_as_asked(void **state)
{
  (void)state;
  static const double low[2][3] = {{-4, -3, 7}, {-0.6, -0.6, 4}}, high[2][3] = {{4, 3, 12}, {0.6, 0.6, 7}};
  static const double wall[2] = {0.8, 0.4};
  MouldGeometry *geometry = NULL;
  TetMesh *mesh = NULL;
  CastError err;
  ReduceConfig *config = read_config(mould_files_yaml("mould.geo", "  unit: mm\n"));
  assert_int_equal(mould_geometry_open(config, &geometry, &err), CAST_OK);
  assert_int_equal(mould_geometry_mesh(geometry, &mesh, &err), CAST_OK);
  double ratio[2] = {0, 0}; // near the cavity, far from it
  size_t count[2] = {0, 0};
  for (size_t t = 0; t < mesh->n_tets; t++) {
    double centre[3] = {0, 0, 0}, edge = 0.0, size = 3.0;
    for (size_t k = 0; k < 4; k++)
      for (size_t d = 0; d < 3; d++) centre[d] += 0.25e3 * mesh->x[3 * (size_t)mesh->tet[4 * t + k] + d];
    for (size_t a = 0; a < 4; a++)
      for (size_t b = 0; b < a; b++) {
        double square = 0.0;
        for (size_t d = 0; d < 3; d++)
          square += pow(
              1e3 * (mesh->x[3 * (size_t)mesh->tet[4 * t + a] + d] - mesh->x[3 * (size_t)mesh->tet[4 * t + b] + d]), 2);
        edge += sqrt(square) / 6.0;
      }
    for (int i = 0; i < 2; i++) size = fmin(size, wall[i] + 0.4 * box_distance(centre, low[i], high[i]));
    const int far = size > 1.6;
    ratio[far] += edge / size;
    count[far]++;
  }
  print_message("%zu tetrahedra: mean edge over size asked for %.3f near the cavity, %.3f far from it\n", mesh->n_tets,
                ratio[0] / (double)count[0], ratio[1] / (double)count[1]);
  for (int i = 0; i < 2; i++) ASSERT_CLOSE(ratio[i] / (double)count[i], 1.0, 0.2);
  tet_mesh_destroy(&mesh);
  mould_geometry_close(&geometry);
  reduce_config_destroy(&config);
}

static void quality_is_one_for_a_regular_tetrahedron_and_none_for_a_flat_one(void **state)
{
  (void)state;
  double x[12] = {1, 1, 1, -1, 1, -1, 1, -1, -1, -1, -1, 1};
  TetMesh mesh = {.x = x};
  ASSERT_CLOSE(tet_mesh_tet_quality(&mesh, (int32_t[]){0, 1, 3, 2}) +
                   tet_mesh_tet_quality(&mesh, (int32_t[]){0, 1, 2, 3}),
               1.0, 1e-12); // one of the two is inverted: 0
  memcpy(x, (double[12]){0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, sizeof x);
  ASSERT_CLOSE(tet_mesh_tet_quality(&mesh, (int32_t[]){0, 1, 2, 3}), 0.0, 1e-12);
  // the corner of a cube: r_in = (3 - sqrt(3))/6, r_out = sqrt(3)/2
  memcpy(x, (double[12]){0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, sizeof x);
  ASSERT_CLOSE(tet_mesh_tet_quality(&mesh, (int32_t[]){0, 1, 2, 3}), (3.0 - sqrt(3.0)) / sqrt(3.0), 1e-12);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_geo_file_becomes_a_mesh_of_exact_volume_and_areas),
      cmocka_unit_test(the_unit_scales_the_mould),
      cmocka_unit_test(a_step_file_with_groups_becomes_the_same_mould),
      cmocka_unit_test(a_brep_file_with_groups_becomes_the_same_mould),
      cmocka_unit_test(ready_meshes_of_both_versions_become_the_same_mould),
      cmocka_unit_test(patches_and_walls_are_as_the_input_says),
      cmocka_unit_test(patches_do_not_depend_on_the_number_of_ranks),
      cmocka_unit_test(sizes_grow_from_the_cavity_as_asked),
      cmocka_unit_test(quality_is_one_for_a_regular_tetrahedron_and_none_for_a_flat_one),
  };
  if (PetscInitialize(&argc, &argv, NULL, NULL)) return 1;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  const int failed = cmocka_run_group_tests(tests, make_files, remove_files);
  return PetscFinalize() ? 1 : failed;
}
