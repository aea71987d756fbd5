/* Thin layers at the cavity wall: the mould keeps its shape, its wall and its regions whatever the corners, all volumes
 * are positive and face to face, and the layers are as thin as asked. */
#include "tests/support/petsc_test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/vector.h"
#include "reduce/mesh/geometry/mould_geometry.h"
#include "reduce/mesh/layers/wall_layers.h"
#include "reduce/mesh/tets/resolution.h"
#include "tests/support/mould_files.h"

/* A mould of one or two regions whose outside is "outer" and whose cavity is "wall". */
static ReduceConfig *config_of(const char *geo, const char *mesh_size, const char *layers, bool two_regions)
{
  char yaml[2048], path[128];
  CastError err;
  ReduceConfig *config = NULL;
  mould_files_write(&mould_files, "shape.geo", geo);
  snprintf(yaml, sizeof yaml,
           "geometry: { file: shape.geo, unit: mm }\n"
           "regions:\n"
           "  low: { material: { name: sand, density: 1800 kg/m^3, specific_heat: 1100 J/kg/K, conductivity: 1 W/m/K } "
           "}\n%s"
           "boundaries: { outer: { type: insulated } }\n"
           "cavity: { layers: %s, surfaces: { wall: { one_patch: true, mesh_size: %s } } }\n"
           "mesh: { outside_size: 3 mm, growth: 0.5 }\n"
           "reduction: { times: [1 ms, 10 s], tolerance: 1e-2 }\n"
           "output: { file: shape.rom.h5, band: 0.5 mm }\n",
           two_regions ? "  high: { material: { name: steel, density: 7750 kg/m^3, specific_heat: 500 J/kg/K, "
                         "conductivity: 27 W/m/K } }\n"
                       : "",
           layers, mesh_size);
  snprintf(path, sizeof path, "%s/shape.yaml", mould_files.folder);
  if (reduce_config_read(path, yaml, &config, &err) != CAST_OK) fail_msg("%s", err.message);
  return config;
}

static TetMesh *mesh_of(const ReduceConfig *config)
{
  MouldGeometry *geometry = NULL;
  TetMesh *mesh = NULL;
  CastError err;
  if (mould_geometry_open(config, &geometry, &err) != CAST_OK) fail_msg("%s", err.message);
  if (mould_geometry_mesh(geometry, &mesh, &err) != CAST_OK) fail_msg("%s", err.message);
  mould_geometry_close(&geometry);
  return mesh;
}

typedef struct Sums {
  double volume[2], area[2]; // by region; wall and outside
  double wall_moment[3];     // int x dA over the wall
} Sums;

static Sums sums_of(const TetMesh *mesh)
{
  Sums sums = {0};
  for (size_t t = 0; t < mesh->n_tets; t++) {
    const double volume = tet_mesh_tet_volume(mesh, mesh->tet + 4 * t);
    assert_true(volume > 0.0);
    sums.volume[mesh->tet_region[t]] += volume;
  }
  for (size_t t = 0; t < mesh->n_triangles; t++) {
    double normal[3];
    tet_mesh_triangle_normal(mesh, mesh->triangle + 3 * t, normal);
    sums.area[mesh->triangle_surface[t]] += 0.5 * vec_norm(normal);
    for (int k = 0; mesh->triangle_surface[t] == 0 && k < 3; k++)
      for (int d = 0; d < 3; d++)
        sums.wall_moment[d] += vec_norm(normal) / 6.0 * mesh->x[3 * mesh->triangle[3 * t + (size_t)k] + d];
  }
  return sums;
}

static int by_face(const void *left, const void *right)
{
  return memcmp(left, right, 3 * sizeof(int32_t));
}

/* Each face belongs to two tetrahedra, or to one and a triangle of the boundary. */
static void check_conforming(const TetMesh *mesh)
{
  static const int sides[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
  const size_t n = 4 * mesh->n_tets + mesh->n_triangles;
  int32_t(*face)[3] = malloc(n * sizeof *face);
  assert_non_null(face);
  for (size_t t = 0; t < mesh->n_tets; t++)
    for (size_t s = 0; s < 4; s++)
      for (int k = 0; k < 3; k++) face[4 * t + s][k] = mesh->tet[4 * t + (size_t)sides[s][k]];
  for (size_t t = 0; t < mesh->n_triangles; t++)
    memcpy(face[4 * mesh->n_tets + t], mesh->triangle + 3 * t, sizeof *face);
  for (size_t i = 0; i < n; i++) tet_mesh_sort_corners(face[i]);
  qsort(face, n, sizeof *face, by_face);
  for (size_t i = 0; i < n; i += 2) {
    assert_true(i + 1 < n && by_face(face[i], face[i + 1]) == 0);
    assert_true(i + 2 >= n || by_face(face[i], face[i + 2]) != 0);
  }
  free(face);
}

/* Grow the layers that the config asks for and hold the mesh against what it was. Returns the share of the wall's area
 * on which the first layer is not higher than `first`. Flat outsides: only rounding may change the sums. */
static double grow_and_check(TetMesh *mesh, const ReduceConfig *config, double first)
{
  CastError err;
  TetMeshMeasures measures;
  const Sums before = sums_of(mesh);
  const size_t n_points = mesh->n_points, n_tets = mesh->n_tets;
  double thin = 0.0;
  if (wall_layers_grow(mesh, config, &err) != CAST_OK) fail_msg("%s", err.message);
  const Sums after = sums_of(mesh);
  check_conforming(mesh);
  for (int i = 0; i < 2; i++) {
    ASSERT_CLOSE(after.volume[i], before.volume[i], 1e-12 * (before.volume[0] + before.volume[1]));
    ASSERT_CLOSE(after.area[i] / before.area[i], 1.0, 1e-12);
  }
  for (int d = 0; d < 3; d++) ASSERT_CLOSE(after.wall_moment[d], before.wall_moment[d], 1e-12 * before.area[0] * 0.02);
  for (size_t t = 0; t < mesh->n_triangles; t++) {
    if (mesh->triangle_surface[t] != 0) continue;
    double normal[3];
    tet_mesh_triangle_normal(mesh, mesh->triangle + 3 * t, normal);
    const double height = 6.0 * tet_mesh_tet_volume(mesh, mesh->tet + 4 * mesh->triangle_tet[t]) / vec_norm(normal);
    if (height <= 1.1 * first) thin += 0.5 * vec_norm(normal);
  }
  assert_int_equal(tet_mesh_measure(mesh, config, &measures, &err), CAST_OK);
  print_message("%zu points became %zu, %zu tetrahedra %zu; worst quality outside the layers %.3f; first layer thin "
                "enough on %.2f %% of the wall\n",
                n_points, mesh->n_points, n_tets, mesh->n_tets, measures.worst_quality, 100 * thin / after.area[0]);
  assert_int_equal(mesh->n_tets - mesh->n_layer_tets, n_tets);
  return thin / after.area[0];
}

static double share_of_thin_wall(const char *geo, const char *mesh_size, bool two_regions)
{
  ReduceConfig *config = config_of(geo, mesh_size, "{ first: 5 um, growth: 1.4 }", two_regions);
  TetMesh *mesh = mesh_of(config);
  const double share = grow_and_check(mesh, config, 5e-6);
  tet_mesh_destroy(&mesh);
  reduce_config_destroy(&config);
  return share;
}

#define OCC "SetFactory(\"OpenCASCADE\");\n"
/* the wall: all faces but those in the planes of the block 0..20, 0..16, 0..12 */
#define NAMES                                                                                                          \
  "e = 1e-3; Physical Volume(\"low\") = {Volume{:}};\n"                                                                \
  "out() = Surface In BoundingBox{-e, -e, -e, e, 16 + e, 12 + e};\n"                                                   \
  "out() += Surface In BoundingBox{20 - e, -e, -e, 20 + e, 16 + e, 12 + e};\n"                                         \
  "out() += Surface In BoundingBox{-e, -e, -e, 20 + e, e, 12 + e};\n"                                                  \
  "out() += Surface In BoundingBox{-e, 16 - e, -e, 20 + e, 16 + e, 12 + e};\n"                                         \
  "out() += Surface In BoundingBox{-e, -e, -e, 20 + e, 16 + e, e};\n"                                                  \
  "out() += Surface In BoundingBox{-e, -e, 12 - e, 20 + e, 16 + e, 12 + e};\n"                                         \
  "wall() = Surface{:}; wall() -= out();\n"                                                                            \
  "Physical Surface(\"outer\") = {out()}; Physical Surface(\"wall\") = {wall()};\n"

static void layers_follow_corners_edges_and_the_rim(void **state)
{
  (void)state;
  static const char geo[] = OCC "Box(1) = {0, 0, 0, 20, 16, 12}; Box(2) = {6, 5, 7, 8, 6, 6};\n"
                                "Box(3) = {9.4, 7.4, 4, 1.2, 1.2, 4};\n"
                                "BooleanDifference{ Volume{1}; Delete; }{ Volume{2, 3}; Delete; }\n" NAMES;
  assert_true(share_of_thin_wall(geo, "0.6 mm", false) > 0.999);
}

static void layers_follow_pins_and_blades(void **state)
{
  (void)state;
  // a slender pin, and a wedge-shaped slot that leaves a blade of mould of 20 degrees between its flanks
  static const char geo[] =
      OCC "Box(1) = {0, 0, 0, 20, 16, 12}; Cylinder(2) = {5, 8, 12, 0, 0, -8, 0.5};\n"
          "Point(101) = {10, 4, 13}; Point(102) = {12, 4, 5}; Point(103) = {13.4, 4, 13};\n"
          "Point(104) = {13.6, 4, 13}; Point(105) = {15, 4, 5}; Point(106) = {17, 4, 13};\n"
          "Line(101) = {101, 102}; Line(102) = {102, 103}; Line(103) = {103, 101};\n"
          "Line(104) = {104, 105}; Line(105) = {105, 106}; Line(106) = {106, 104};\n"
          "Curve Loop(101) = {101, 102, 103}; Plane Surface(101) = {101};\n"
          "Curve Loop(102) = {104, 105, 106}; Plane Surface(102) = {102};\n"
          "a() = Extrude {0, 8, 0} { Surface{101}; }; b() = Extrude {0, 8, 0} { Surface{102}; };\n"
          "BooleanDifference{ Volume{1}; Delete; }{ Volume{2, a(1), b(1)}; Delete; }\n" NAMES;
  assert_true(share_of_thin_wall(geo, "0.4 mm", false) > 0.99);
}

static void layers_follow_a_mould_corner_that_reaches_into_the_cavity(void **state)
{
  (void)state;
  // the cavity is a box less a smaller box in its corner and less a cone that touches nothing else
  static const char geo[] = OCC "Box(1) = {0, 0, 0, 20, 16, 12}; Box(2) = {5, 4, 3, 10, 8, 10};\n"
                                "Box(3) = {5, 4, 3, 4, 3, 4}; Cone(4) = {12, 9, 3, 0, 0, 5, 2, 0};\n"
                                "c() = BooleanDifference{ Volume{2}; Delete; }{ Volume{3, 4}; Delete; };\n"
                                "BooleanDifference{ Volume{1}; Delete; }{ Volume{c()}; Delete; }\n" NAMES;
  assert_true(share_of_thin_wall(geo, "0.5 mm", false) > 0.99);
}

static void layers_stay_on_their_side_of_a_border_between_regions(void **state)
{
  (void)state;
  static const char geo[] = OCC "Box(1) = {0, 0, 0, 20, 16, 6}; Box(2) = {0, 0, 6, 20, 16, 6};\n"
                                "Box(3) = {7, 5, 4, 6, 6, 9};\n"
                                "d() = BooleanDifference{ Volume{1, 2}; Delete; }{ Volume{3}; Delete; };\n"
                                "BooleanFragments{ Volume{d()}; Delete; }{}\n" NAMES "Delete Physicals;\n"
                                "in() = Surface In BoundingBox{-e, -e, 6 - e, 20 + e, 16 + e, 6 + e}; wall() -= in();\n"
                                "l() = Volume In BoundingBox{-e, -e, -e, 20 + e, 16 + e, 6 + e};\n"
                                "h() = Volume{:}; h() -= l();\n"
                                "Physical Volume(\"low\") = {l()}; Physical Volume(\"high\") = {h()};\n"
                                "Physical Surface(\"outer\") = {out()}; Physical Surface(\"wall\") = {wall()};\n";
  assert_true(share_of_thin_wall(geo, "0.7 mm", true) > 0.999);
}

static void layers_grow_round_a_sphere_with_the_growth_asked_for(void **state)
{
  (void)state;
  static const char geo[] = OCC "Box(1) = {0, 0, 0, 20, 16, 12}; Sphere(2) = {10, 8, 6, 3};\n"
                                "BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; }\n" NAMES;
  ReduceConfig *config = config_of(geo, "0.6 mm", "{ first: 8 um, growth: 1.5, count: 5 }", false);
  TetMesh *mesh = mesh_of(config);
  const size_t n_points = mesh->n_points, n_triangles = mesh->n_triangles;
  assert_true(grow_and_check(mesh, config, 8e-6) > 0.9999);
  size_t n_wall = 0, on_level = 0;
  for (size_t t = 0; t < n_triangles; t++) n_wall += mesh->triangle_surface[t] == 0;
  assert_int_equal(mesh->n_points - n_points, 5 * (n_wall / 2 + 2)); // Euler: v = f/2 + 2 on a sphere
  assert_int_equal(mesh->n_layer_tets, 3 * 5 * n_wall);
  for (size_t i = n_points; i < mesh->n_points; i++) {
    const double from[3] = {mesh->x[3 * i] - 0.010, mesh->x[3 * i + 1] - 0.008, mesh->x[3 * i + 2] - 0.006};
    const double height = vec_norm(from) - 0.003, asked = 8e-6 * (pow(1.5, (double)((i - n_points) % 5) + 1) - 1) / 0.5;
    on_level += fabs(height / asked - 1.0) < 0.02; // facets lean against the sphere by h/2R = 0.1: cosine 0.995
  }
  assert_int_equal(on_level, mesh->n_points - n_points);
  tet_mesh_destroy(&mesh);
  reduce_config_destroy(&config);
}

/* Where the mesh is as fine as that already, there is nothing to do. */
static void a_mesh_that_is_fine_enough_stays_as_it_is(void **state)
{
  (void)state;
  static const char geo[] = OCC "Box(1) = {0, 0, 0, 20, 16, 12}; Box(2) = {8, 6, 9, 3, 3, 4};\n"
                                "BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; }\n" NAMES;
  ReduceConfig *config = config_of(geo, "0.5 mm", "{ first: 1 mm }", false);
  TetMesh *mesh = mesh_of(config);
  const size_t n_points = mesh->n_points;
  grow_and_check(mesh, config, 1e-3);
  assert_int_equal(mesh->n_points, n_points);
  assert_int_equal(mesh->n_layer_tets, 0);
  tet_mesh_destroy(&mesh);
  reduce_config_destroy(&config);
}

static void automatic_layers_follow_the_thermal_depth_or_the_contact(void **state)
{
  (void)state;
  static const char geo[] = OCC "Box(1) = {0, 0, 0, 20, 16, 12}; Box(2) = {8, 6, 9, 3, 3, 4};\n"
                                "BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; }\n" NAMES;
  ReduceConfig *config = config_of(geo, "0.8 mm", "auto", false);
  const Material *sand = &config->region[0].material;
  const double depth = sqrt(1.0 / (1800.0 * 1100.0) * 1e-3);
  ASSERT_CLOSE(resolution_depth(sand, 1e-3), depth, 1e-15);
  ASSERT_CLOSE(resolution_layer(config, sand), 0.25 * depth, 1e-15);
  assert_true(resolution_error(config, sand, 0.25 * depth) < 0.01);
  assert_true(resolution_error(config, sand, 10 * depth) > 0.5);
  TetMesh *mesh = mesh_of(config);
  assert_true(grow_and_check(mesh, config, 0.25 * depth) > 0.999);
  tet_mesh_destroy(&mesh);
  config->contact = 500.0; // 0.05 * 1/500 = 0.1 mm
  ASSERT_CLOSE(resolution_layer(config, sand), 1e-4, 1e-12);
  assert_true(resolution_error(config, sand, 1e-4) < 0.01);
  mesh = mesh_of(config);
  assert_true(grow_and_check(mesh, config, 1e-4) > 0.999);
  tet_mesh_destroy(&mesh);
  reduce_config_destroy(&config);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(layers_follow_corners_edges_and_the_rim),
      cmocka_unit_test(layers_follow_pins_and_blades),
      cmocka_unit_test(layers_follow_a_mould_corner_that_reaches_into_the_cavity),
      cmocka_unit_test(layers_stay_on_their_side_of_a_border_between_regions),
      cmocka_unit_test(layers_grow_round_a_sphere_with_the_growth_asked_for),
      cmocka_unit_test(a_mesh_that_is_fine_enough_stays_as_it_is),
      cmocka_unit_test(automatic_layers_follow_the_thermal_depth_or_the_contact),
  };
  return cmocka_run_group_tests(tests, mould_files_set_up, mould_files_clean_up);
}
