/* A closed STL file of the cavity in a flask of mould material: read, checked, meshed anew, named. */
#include "tests/support/petsc_test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "reduce/mesh/geometry/mould_geometry.h"
#include "reduce/mesh/geometry/stl_file.h"
#include "reduce/mesh/mould_mesh.h"
#include "tests/support/mould_files.h"

/* A cup on a pin, both round (facets about the axis z): radius 4 mm from 6 to 12 mm, radius 1 mm from 2 to 6 mm. */
enum { FACETS = 32, RINGS = 6 };
static const double PROFILE[RINGS][2] = {{0, 2}, {1, 2}, {1, 6}, {4, 6}, {4, 12}, {0, 12}};
#define PART_VOLUME (FACETS / 2 * sin(2 * M_PI / FACETS) * (1.0 * 4 + 16.0 * 6))
#define CUP_AREA (FACETS * (2 * 4 * sin(M_PI / FACETS) * 6) + FACETS / 2 * sin(2 * M_PI / FACETS) * (16 - 1))
#define CAP_AREA (FACETS / 2 * sin(2 * M_PI / FACETS) * 16)
#define PIN_AREA (FACETS * (2 * 1 * sin(M_PI / FACETS) * 4) + FACETS / 2 * sin(2 * M_PI / FACETS) * 1)

typedef struct StlWriter {
  FILE *file;
  int written, leave_out, turn; // triangles, from 1; 0: none
} StlWriter;

static void ring_point(int ring, int i, double x[3])
{
  const double angle = 2 * M_PI * (i % FACETS) / FACETS;
  x[0] = PROFILE[ring][0] * cos(angle);
  x[1] = PROFILE[ring][0] * sin(angle);
  x[2] = PROFILE[ring][1];
}

static void write_triangle(StlWriter *writer, double a[3], double b[3], double c[3])
{
  writer->written++;
  if (writer->written == writer->leave_out) return;
  const bool turn = writer->written == writer->turn;
  double *corner[3] = {a, turn ? c : b, turn ? b : c};
  fprintf(writer->file, " facet normal 0 0 0\n  outer loop\n");
  for (int k = 0; k < 3; k++)
    fprintf(writer->file, "   vertex %.9g %.9g %.9g\n", corner[k][0], corner[k][1], corner[k][2]);
  fprintf(writer->file, "  endloop\n endfacet\n");
}

static void write_rings(StlWriter *writer, const char *name, int first, int last)
{
  fprintf(writer->file, "solid %s\n", name);
  for (int ring = first; ring < last; ring++)
    for (int i = 0; i < FACETS; i++) {
      double a[3], b[3], c[3], d[3];
      ring_point(ring, i, a);
      ring_point(ring, i + 1, b);
      ring_point(ring + 1, i + 1, c);
      ring_point(ring + 1, i, d);
      if (PROFILE[ring][0] > 0) write_triangle(writer, a, b, c);
      if (PROFILE[ring + 1][0] > 0) write_triangle(writer, a, c, d);
    }
  fprintf(writer->file, "endsolid %s\n", name);
}

static void write_part(const char *name, int leave_out, int turn)
{
  StlWriter writer = {.file = fopen(mould_files_path(name), "w"), .leave_out = leave_out, .turn = turn};
  assert_non_null(writer.file);
  write_rings(&writer, "pin", 0, 2);
  write_rings(&writer, "cup", 2, RINGS - 1);
  fclose(writer.file);
}

static StlSurface *read_part(const char *name)
{
  StlSurface *part = NULL;
  CastError err;
  if (stl_read(mould_files_path(name), &part, &err) != CAST_OK) fail_msg("%s", err.message);
  return part;
}

static void an_stl_file_is_read_with_its_solids_and_joined_points(void **state)
{
  (void)state;
  CastError err;
  write_part("part.stl", 0, 0);
  StlSurface *part = read_part("part.stl");
  assert_int_equal(part->n_triangles, 8 * FACETS);
  assert_int_equal(part->n_points, 4 * FACETS + 2);
  assert_int_equal(part->n_solids, 2);
  assert_string_equal(part->name[0], "pin");
  assert_string_equal(part->name[1], "cup");
  if (stl_check(part, "part.stl", 1e-3, &err) != CAST_OK) fail_msg("%s", err.message);
  ASSERT_CLOSE(stl_volume(part) / PART_VOLUME, 1.0, 1e-7); // nine digits in the file
  stl_destroy(&part);
}

static void write_binary(const char *name, const StlSurface *part)
{
  FILE *file = fopen(mould_files_path(name), "wb");
  char header[80] = "solid but binary all the same";
  const uint32_t n = (uint32_t)part->n_triangles;
  assert_non_null(file);
  fwrite(header, 1, sizeof header, file);
  fwrite(&n, 4, 1, file);
  for (size_t t = 0; t < part->n_triangles; t++) {
    float numbers[12] = {0};
    for (size_t i = 0; i < 9; i++) numbers[3 + i] = (float)part->x[3 * (size_t)part->triangle[3 * t + i / 3] + i % 3];
    fwrite(numbers, 4, 12, file);
    fwrite("\0", 1, 2, file);
  }
  fclose(file);
}

static void a_binary_file_is_read_as_well(void **state)
{
  (void)state;
  StlSurface *part = read_part("part.stl");
  write_binary("binary.stl", part);
  StlSurface *binary = read_part("binary.stl");
  assert_int_equal(binary->n_triangles, part->n_triangles);
  assert_int_equal(binary->n_points, part->n_points);
  assert_int_equal(binary->n_solids, 1);
  ASSERT_CLOSE(stl_volume(binary) / stl_volume(part), 1.0, 1e-6); // float
  stl_destroy(&binary);
  stl_destroy(&part);
}

static void expect_fault(const char *name, const char *says)
{
  StlSurface *part = NULL;
  CastError err = {CAST_OK, ""};
  CastStatus status = stl_read(mould_files_path(name), &part, &err);
  if (status == CAST_OK) status = stl_check(part, name, 1e-3, &err);
  assert_int_equal(status, CAST_ERR_INPUT);
  if (!strstr(err.message, says)) fail_msg("'%s' does not say '%s'", err.message, says);
  stl_destroy(&part);
}

static void open_turned_and_broken_files_are_refused_with_the_place(void **state)
{
  (void)state;
  write_part("open.stl", 40, 0);
  expect_fault("open.stl", "the surface is open: triangle ");
  write_part("turned.stl", 0, 70);
  expect_fault("turned.stl", "are wound against each other: the normal of one of them points to the wrong side");
  mould_files_write(&mould_files, "word.stl", "solid a\n facet normal 0 0 1\n outer lop\n");
  expect_fault("word.stl", "word.stl:3: 'lop' where 'loop' is expected");
  mould_files_write(&mould_files, "number.stl", "solid a\n facet normal 0 0 1\n outer loop\n  vertex 0 1e 0\n");
  expect_fault("number.stl", "number.stl:4: '1e' where a number is expected");
  mould_files_write(&mould_files, "cut.stl", "solid a\n");
  expect_fault("cut.stl", "the file ends inside a solid");
  mould_files_write(&mould_files, "empty.stl", "");
  expect_fault("empty.stl", "has no triangles");
}

/* Two tetrahedra, the second's tip inside the first. */
static void write_tetrahedra(const char *name, bool inwards, double shift)
{
  static const int sides[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  StlWriter writer = {.file = fopen(mould_files_path(name), "w")};
  assert_non_null(writer.file);
  for (int body = 0; body < 2; body++) {
    const double s = body * shift;
    double x[4][3] = {{s, s, s}, {s + 1, s, s}, {s, s + 1, s}, {s, s, s + 1}};
    fprintf(writer.file, "solid %d\n", body);
    for (int k = 0; k < 4; k++)
      write_triangle(&writer, x[sides[k][0]], x[sides[k][inwards ? 2 : 1]], x[sides[k][inwards ? 1 : 2]]);
    fprintf(writer.file, "endsolid\n");
  }
  fclose(writer.file);
}

static void bodies_turned_inside_out_or_through_each_other_are_refused(void **state)
{
  (void)state;
  CastError err;
  write_tetrahedra("inwards.stl", true, 3.0);
  expect_fault("inwards.stl", "all normals point inwards");
  write_tetrahedra("through.stl", false, 0.2);
  expect_fault("through.stl", "the surface goes through itself: triangles ");
  write_tetrahedra("apart.stl", false, 3.0);
  StlSurface *part = read_part("apart.stl");
  assert_int_equal(stl_check(part, "apart.stl", 1e-3, &err), CAST_OK);
  stl_destroy(&part);
}

/* --- the mould --- */

static const char *mould_yaml(const char *geometry_lines, const char *surfaces)
{
  static char yaml[4096];
  snprintf(yaml, sizeof yaml,
           "geometry:\n%s"
           "regions:\n"
           "  body: { material: { name: sand, density: 1800 kg/m^3, specific_heat: 1100 J/kg/K, conductivity: 1 W/m/K "
           "} }\n"
           "boundaries: { top: { type: insulated }, side: { type: insulated }, bottom: { type: fixed } }\n"
           "cavity: { surfaces: {%s} }\n"
           "mesh: { outside_size: 3 mm, growth: 0.4 }\n"
           "reduction: { times: [1 ms, 10 s], tolerance: 1e-2 }\n"
           "output: { file: mould.rom.h5, band: 0.8 mm }\n",
           geometry_lines, surfaces);
  return yaml;
}

static const char CUP_AND_PIN[] =
    "cup: { patch_size: 3 mm, mesh_size: 0.8 mm }, pin: { patch_size: 2 mm, mesh_size: 0.4 mm }";

static ReduceConfig *read_config(const char *yaml)
{
  CastError err;
  ReduceConfig *config = NULL;
  if (reduce_config_read(mould_files_path("mould.yaml"), yaml, &config, &err) != CAST_OK) fail_msg("%s", err.message);
  return config;
}

static double area_of(const MouldMesh *mesh, const char *surface)
{
  double area = 0.0;
  for (PetscInt l = 0; l < mesh->n_patches; l++)
    if (strcmp(mesh->patch[l].surface, surface) == 0) area += mesh->patch[l].area * 1e6;
  return area;
}

static void check_mould(const char *yaml, double volume, double cup, double top, double side, double bottom)
{
  ReduceConfig *config = read_config(yaml);
  MouldMesh *mesh = NULL;
  TEST_PETSC(mould_mesh_create(PETSC_COMM_WORLD, config, &mesh));
  print_message("volume %.3f of %.3f mm3, cup %.3f of %.3f, pin %.3f of %.3f, worst quality %.3f, shortest edge %.3f\n",
                mesh->volume * 1e9, volume, area_of(mesh, "cup"), cup, area_of(mesh, "pin"), PIN_AREA,
                mesh->worst_quality, mesh->shortest_edge * 1e3);
  ASSERT_CLOSE(mesh->volume * 1e9 / volume, 1.0, 5e-3); // where facets meet at ten degrees their edges may be turned
  ASSERT_CLOSE(area_of(mesh, "top") / top, 1.0, 1e-2);
  ASSERT_CLOSE(area_of(mesh, "side") / side, 1.0, 1e-2);
  ASSERT_CLOSE(area_of(mesh, "bottom") / bottom, 1.0, 1e-2);
  ASSERT_CLOSE(area_of(mesh, "cup") / cup, 1.0, 1e-2);
  ASSERT_CLOSE(area_of(mesh, "pin") / PIN_AREA, 1.0, 1e-2);
  assert_true(mesh->worst_quality > 0.05);
  TEST_PETSC(mould_mesh_destroy(&mesh));
  reduce_config_destroy(&config);
}

static void a_cavity_inside_a_block_is_closed(void **state)
{
  (void)state;
  const char *yaml = mould_yaml("  stl: part.stl\n  unit: mm\n"
                                "  flask: { block: { corner: [-10 mm, -9 mm, -3 mm], size: [20 mm, 18 mm, 20 mm] } }\n",
                                CUP_AND_PIN);
  check_mould(yaml, 20 * 18 * 20 - PART_VOLUME, CUP_AREA + CAP_AREA, 20 * 18, 2 * (20 + 18) * 20, 20 * 18);
}

static void a_cavity_that_reaches_the_top_of_a_cylinder_is_open_there(void **state)
{
  (void)state;
  const char *yaml = mould_yaml("  stl: part.stl\n  unit: mm\n"
                                "  flask: { cylinder: { base: [1 mm, 0 mm, -3 mm], radius: 10 mm, height: 15 mm } }\n",
                                CUP_AND_PIN);
  check_mould(yaml, M_PI * 100 * 15 - PART_VOLUME, CUP_AREA, M_PI * 100 - CAP_AREA, 2 * M_PI * 10 * 15, M_PI * 100);
}

/* A part of one solid needs no name in the file; geometry.groups tells its faces apart. */
static void faces_of_a_single_solid_are_named_by_groups(void **state)
{
  (void)state;
  const char *yaml =
      mould_yaml("  stl: binary.stl\n  unit: mm\n  split_angle: 35 deg\n"
                 "  flask: { block: { corner: [-10 mm, -9 mm, -3 mm], size: [20 mm, 18 mm, 15 mm] } }\n"
                 "  groups:\n"
                 "    body: { volumes: rest }\n"
                 "    pin: { surfaces: { low: [-1.1 mm, -1.1 mm, 1.9 mm], high: [1.1 mm, 1.1 mm, 6.1 mm] } }\n"
                 "    cup: { surfaces: { low: [-4.1 mm, -4.1 mm, 5.9 mm], high: [4.1 mm, 4.1 mm, 12.1 mm] } }\n"
                 "    bottom: { surfaces: { low: [-11 mm, -11 mm, -3.1 mm], high: [11 mm, 11 mm, -2.9 mm] } }\n"
                 "    top: { surfaces: { low: [-11 mm, -11 mm, 11.9 mm], high: [11 mm, 11 mm, 12.1 mm] } }\n"
                 "    side: { surfaces: rest }\n",
                 CUP_AND_PIN);
  check_mould(yaml, 20 * 18 * 15 - PART_VOLUME, CUP_AREA, 20 * 18 - CAP_AREA, 2 * (20 + 18) * 15, 20 * 18);
}

static void expect_mesh_fault(const char *geometry_lines, const char *surfaces, const char *says)
{
  ReduceConfig *config = read_config(mould_yaml(geometry_lines, surfaces));
  MouldGeometry *geometry = NULL;
  CastError err;
  assert_int_equal(mould_geometry_open(config, &geometry, &err), CAST_ERR_INPUT);
  if (!strstr(err.message, says)) fail_msg("'%s' does not say '%s'", err.message, says);
  reduce_config_destroy(&config);
}

static void a_cavity_out_of_the_flask_is_refused_with_the_place(void **state)
{
  (void)state;
  expect_mesh_fault("  stl: part.stl\n  unit: mm\n"
                    "  flask: { block: { corner: [-3 mm, -9 mm, -3 mm], size: [20 mm, 18 mm, 20 mm] } }\n",
                    CUP_AND_PIN, "the cavity reaches the flask's side at (-");
  expect_mesh_fault("  stl: part.stl\n  unit: mm\n"
                    "  flask: { block: { corner: [-9 mm, -9 mm, -3 mm], size: [20 mm, 18 mm, 14 mm] } }\n",
                    CUP_AND_PIN, "the cavity stands out of the flask's top, z = 11 mm");
  expect_mesh_fault("  stl: part.stl\n  unit: mm\n"
                    "  flask: { block: { corner: [-9 mm, -9 mm, 2 mm], size: [20 mm, 18 mm, 14 mm] } }\n",
                    CUP_AND_PIN, "the cavity reaches the flask's bottom");
}

static void surfaces_bear_the_names_of_the_solids(void **state)
{
  (void)state;
  expect_mesh_fault("  stl: part.stl\n  unit: mm\n"
                    "  flask: { block: { corner: [-9 mm, -9 mm, -2 mm], size: [20 mm, 18 mm, 14 mm] } }\n",
                    "cup: { one_patch: true, mesh_size: 0.8 mm }, stem: { one_patch: true, mesh_size: 0.8 mm }",
                    "cavity surface 'stem': the geometry has no physical surface of this name; it has: ");
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_stl_file_is_read_with_its_solids_and_joined_points),
      cmocka_unit_test(a_binary_file_is_read_as_well),
      cmocka_unit_test(open_turned_and_broken_files_are_refused_with_the_place),
      cmocka_unit_test(bodies_turned_inside_out_or_through_each_other_are_refused),
      cmocka_unit_test(a_cavity_inside_a_block_is_closed),
      cmocka_unit_test(a_cavity_that_reaches_the_top_of_a_cylinder_is_open_there),
      cmocka_unit_test(faces_of_a_single_solid_are_named_by_groups),
      cmocka_unit_test(a_cavity_out_of_the_flask_is_refused_with_the_place),
      cmocka_unit_test(surfaces_bear_the_names_of_the_solids),
  };
  if (PetscInitialize(&argc, &argv, NULL, NULL)) return 1;
  const int failed = cmocka_run_group_tests(tests, mould_files_set_up, mould_files_clean_up);
  return PetscFinalize() ? 1 : failed;
}
