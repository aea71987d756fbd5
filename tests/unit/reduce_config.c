/* mould.yaml: what is read, what is filled in, and that all faults come in one go, each with its line. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/mould_files.h"

static MouldFiles files;

static int make_files(void **state)
{
  (void)state;
  mould_files_create(&files);
  mould_files_write(&files, "mould.msh", "not read here");
  mould_files_write(&files, "mould.step", "not read here");
  return 0;
}

static int remove_files(void **state)
{
  (void)state;
  mould_files_remove(&files);
  return 0;
}

static CastStatus try_to_read(const char *yaml, ReduceConfig **config, CastError *err)
{
  char path[128];
  snprintf(path, sizeof path, "%s/mould.yaml", files.folder);
  return reduce_config_read(path, yaml, config, err);
}

static ReduceConfig *read_config(const char *yaml)
{
  ReduceConfig *config = NULL;
  CastError err;
  if (try_to_read(yaml, &config, &err) != CAST_OK) fail_msg("%s", err.message);
  return config;
}

static void expect_problem(const char *yaml, const char *says)
{
  ReduceConfig *config = NULL;
  CastError err;
  assert_int_equal(try_to_read(yaml, &config, &err), CAST_ERR_INPUT);
  assert_null(config);
  if (!strstr(err.message, says)) fail_msg("'%s' does not say '%s'", err.message, says);
}

/* The good input with one piece of text replaced. */
static const char *changed(const char *from, const char *to)
{
  static char text[10000];
  const char *good = mould_files_yaml("mould.geo", "  unit: mm\n"), *at = strstr(good, from);
  assert_non_null(at);
  snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, to, at + strlen(from));
  return text;
}

static void a_whole_input_is_read_in_si(void **state)
{
  (void)state;
  ReduceConfig *config = read_config(mould_files_yaml("mould.geo", "  unit: mm\n"));
  assert_string_equal(config->title, "block with a basin and a pin");
  assert_int_equal(config->geometry_kind, GEOMETRY_GEO);
  assert_true(config->geometry_unit == 1e-3);
  assert_int_equal(strlen(config->geometry_sha256), 64);
  assert_int_equal(config->n_regions, 2);
  assert_string_equal(config->region[0].name, "base");
  assert_true(config->region[0].material.conductivity == 27.0 && config->region[1].material.density == 1800.0);
  assert_int_equal(config->n_boundaries, 3);
  assert_int_equal(config->boundary[0].kind, BOUNDARY_ROBIN);
  assert_true(config->boundary[0].h == 15.0);
  assert_int_equal(config->boundary[1].kind, BOUNDARY_INSULATED);
  assert_int_equal(config->boundary[2].kind, BOUNDARY_FIXED);
  assert_int_equal(config->n_cavity, 2);
  assert_true(config->cavity[0].patch_size == 3e-3 && config->cavity[0].mesh_size == 0.8e-3);
  assert_true(config->cavity[1].patch_size == 0.0); // one patch
  assert_true(config->outside_size == 3e-3 && config->growth == 0.4 && config->band == 0.8e-3);
  assert_true(config->reduction.t_start == 1e-3 && config->reduction.t_end == 10.0);
  assert_true(config->reduction.tolerance == 1e-2);
  assert_int_equal(config->reduction.method, REDUCTION_RATIONAL);
  assert_int_equal(config->reduction.n_shifts, 0);
  assert_int_equal(config->order, 1);
  reduce_config_destroy(&config);
  assert_null(config);
}

static void paths_are_seen_from_the_input_file(void **state)
{
  (void)state;
  char expected[160];
  ReduceConfig *config = read_config(mould_files_yaml("mould.geo", "  unit: mm\n"));
  snprintf(expected, sizeof expected, "%s/mould.geo", files.folder);
  assert_string_equal(config->geometry_path, expected);
  snprintf(expected, sizeof expected, "%s/mould.rom.h5", files.folder);
  assert_string_equal(config->rom_path, expected);
  reduce_config_destroy(&config);
}

static void the_settings_of_each_method_are_read(void **state)
{
  (void)state;
  ReduceConfig *config =
      read_config(changed("method: rational", "method: rational, shifts: [0.1 1/s, 1 1/ms], deflation: 1e-6, "
                                              "second_stage: false, solver: iterative, solver_tolerance: 1e-9"));
  assert_int_equal(config->reduction.n_shifts, 2);
  assert_true(config->reduction.shifts[0] == 0.1);
  assert_true(fabs(config->reduction.shifts[1] - 1000.0) < 1e-9);
  assert_true(config->reduction.deflation == 1e-6 && !config->reduction.second_stage && config->reduction.iterative);
  assert_true(config->reduction.solver_rtol == 1e-9);
  reduce_config_destroy(&config);
  config = read_config(changed("method: rational", "method: arnoldi, moments: 7, s0: 2 1/s"));
  assert_int_equal(config->reduction.method, REDUCTION_ARNOLDI);
  assert_int_equal(config->reduction.moments, 7);
  assert_true(config->reduction.s0 == 2.0);
  reduce_config_destroy(&config);
}

static void groups_are_lists_boxes_or_the_rest(void **state)
{
  (void)state;
  ReduceConfig *config =
      read_config(mould_files_yaml("mould.step", "  groups: { base: { volumes: [1] }, body: { volumes: rest }, foot: { "
                                                 "surfaces: [3, 5] }, rim: { surfaces: [7] }, "
                                                 "pin: { surfaces: { low: 0 0 1 mm, high: [2 mm, 2 mm, 2 mm] } }, "
                                                 "basin: { surfaces: [8] }, side: { surfaces: rest } }\n"));
  assert_int_equal(config->geometry_kind, GEOMETRY_STEP);
  assert_true(config->geometry_unit == 1e-3);
  assert_int_equal(config->n_groups, 7);
  assert_int_equal(config->group[0].dimension, 3);
  assert_true(config->group[1].rest && config->group[6].rest && !config->group[0].rest);
  assert_int_equal(config->group[2].n_tags, 2);
  assert_int_equal(config->group[2].tags[1], 5);
  assert_true(config->group[4].has_box && config->group[4].box[2] == 1e-3 && config->group[4].box[3] == 2e-3);
  reduce_config_destroy(&config);
}

static void the_mesh_follows_the_patches_unless_told_otherwise(void **state)
{
  (void)state;
  ReduceConfig *config = read_config(changed("patch_size: 3 mm, mesh_size: 0.8 mm", "patch_size: 3 mm"));
  assert_true(config->cavity[0].mesh_size == 0.75e-3 && config->cavity[1].mesh_size == 0.4e-3);
  reduce_config_destroy(&config);
  expect_problem(changed("one_patch: true, mesh_size: 0.4 mm", "one_patch: true"), "key 'mesh_size' is missing");
}

static void a_cavity_of_stl_stands_in_a_flask(void **state)
{
  (void)state;
  mould_files_write(&files, "part.stl", "not read here");
  ReduceConfig *config = read_config(changed("  file: mould.geo\n",
                                             "  stl: part.stl\n  split_angle: 30 deg\n  flask: { cylinder: { base: [0 "
                                             "mm, 1 mm, 2 mm], radius: 1 cm, height: 30 mm } }\n"));
  assert_int_equal(config->geometry_kind, GEOMETRY_STL);
  assert_int_equal(config->flask.kind, FLASK_CYLINDER);
  assert_true(config->flask.base[1] == 1e-3 && config->flask.radius == 1e-2 && config->flask.height == 0.03);
  assert_true(fabs(config->split_angle - 30.0 * M_PI / 180.0) < 1e-12);
  reduce_config_destroy(&config);
  config =
      read_config(changed("  file: mould.geo\n", "  stl: part.stl\n  flask: { block: { corner: [0 mm, 1 mm, 2 mm], "
                                                 "size: [3 mm, 4 mm, 5 mm] } }\n"));
  assert_int_equal(config->flask.kind, FLASK_BLOCK);
  assert_true(config->flask.corner[2] == 2e-3 && config->flask.size[0] == 3e-3);
  reduce_config_destroy(&config);
  expect_problem(changed("  file: mould.geo\n",
                         "  stl: part.stl\n  flask: { block: { corner: [0 mm, 1 mm, 2 mm], size: [3 mm, 0 mm, 5 mm] } "
                         "}\n"),
                 "0 m along y: a length above zero is expected");
}

static void layers_are_automatic_given_or_none(void **state)
{
  (void)state;
  ReduceConfig *config = read_config(mould_files_yaml("mould.geo", "  unit: mm\n"));
  assert_int_equal(config->cavity[0].layers.kind, LAYERS_NONE);
  assert_true(config->contact == 0.0);
  reduce_config_destroy(&config);
  config = read_config(changed("  surfaces:\n    basin: { ",
                               "  layers: auto\n  contact: 2 kW/m^2/K\n  surfaces:\n    basin: { "
                               "layers: { first: 5 um, growth: 1.5, count: 4 }, "));
  assert_true(config->contact == 2000.0);
  assert_int_equal(config->cavity[0].layers.kind, LAYERS_GIVEN);
  assert_true(fabs(config->cavity[0].layers.first - 5e-6) < 1e-18);
  assert_true(config->cavity[0].layers.growth == 1.5 && config->cavity[0].layers.count == 4);
  assert_int_equal(config->cavity[1].layers.kind, LAYERS_AUTO);
  assert_true(config->cavity[1].layers.first == 0.0);
  reduce_config_destroy(&config);
  expect_problem(changed("  surfaces:\n    basin", "  layers: thin\n  surfaces:\n    basin"),
                 "cavity.layers: 'auto', 'none' or {first: 5 um, growth: 1.4, count: 10} is expected");
  expect_problem(changed("  surfaces:\n    basin", "  layers: { growth: 1.5 }\n  surfaces:\n    basin"),
                 "'first' is missing");
  expect_problem(changed("  surfaces:\n    basin", "  layers: { first: 5 um, growth: 0.9 }\n  surfaces:\n    basin"),
                 "cavity.layers.growth");
}

static void all_faults_come_in_one_go_in_the_order_of_their_lines(void **state)
{
  (void)state;
  static const char yaml[] = "titel: typing error\n"                                          // 1
                             "geometry:\n"                                                    // 2
                             "  file: no-such.geo\n"                                          // 3
                             "  unit: K\n"                                                    // 4
                             "regions:\n"                                                     // 5
                             "  body: { material: no-such-material }\n"                       // 6
                             "boundaries:\n"                                                  // 7
                             "  side: { type: robin }\n"                                      // 8
                             "  rim: { type: warm }\n"                                        // 9
                             "  foot: { type: insulated, h: 3 W/m^2/K }\n"                    // 10
                             "cavity:\n"                                                      // 11
                             "  surfaces:\n"                                                  // 12
                             "    basin: { patch_size: 3 K, mesh_size: 1 mm }\n"              // 13
                             "    side: { patch_size: 3 mm, one_patch: yes, mesh_size: 1 }\n" // 14
                             "mesh: { outside_size: 0.1 mm, growth: -1 }\n"                   // 15
                             "reduction: { times: [1 s, 1 ms], moments: 3 }\n"                // 16
                             "output: { file: mould.rom.h5 }\n";                              // 17
  static const char *const says[] = {
      ":1: unknown key 'titel' (did you mean 'title'?)",
      ":3: geometry.file: ",
      ":4: geometry.unit: 'K' is no unit of length",
      ":6: regions.body.material: ",
      ":8: boundaries.side: key 'h' is missing",
      ":9: boundaries.rim.type: 'warm' is not allowed here; allowed: robin, insulated, fixed",
      ":10: boundaries.foot.h: only a wall of type robin",
      ":13: cavity.surfaces.basin.patch_size: '3 K' is a temperature, a length is expected",
      ":14: cavity.surfaces.side.mesh_size: '1' has no unit",
      ":14: cavity.surfaces.side.patch_size: the surface is one patch already",
      ":14: cavity.surfaces.side: is an outer surface as well (line 8)",
      ":15: mesh.growth: '-1' is not allowed",
      ":15: mesh.outside_size: 0.0001 m is finer than 0.001 m on the cavity surface 'basin'",
      ":16: reduction.moments: has no meaning for method rational",
      ":16: reduction.times: the second time, 0.001 s, must be after the first, 1 s",
      ":17: output: key 'band' is missing"};
  ReduceConfig *config = NULL;
  CastError err;
  assert_int_equal(try_to_read(yaml, &config, &err), CAST_ERR_INPUT);
  const char *at = err.message;
  for (size_t i = 0; i < sizeof says / sizeof *says; i++) {
    const char *found = strstr(at, says[i]);
    if (!found) fail_msg("'%s' is missing or out of order in:\n%s", says[i], err.message);
    at = found;
  }
  size_t lines = 1;
  for (const char *c = err.message; *c; c++) lines += *c == '\n';
  assert_int_equal(lines, sizeof says / sizeof *says);
}

static void settings_that_would_do_nothing_are_refused(void **state)
{
  (void)state;
  expect_problem(changed("method: rational", "method: arnoldi, shifts: [1 1/s]"),
                 "shifts: has no meaning for method arnoldi");
  expect_problem(changed("method: rational", "method: rational, s0: 0 1/s"), "s0: has no meaning for method rational");
  expect_problem(mould_files_yaml("mould.msh", "  unit: mm\n"), "the geometry is a ready mesh");
  expect_problem(mould_files_yaml("mould.step", "  unit: mm\n"), "a STEP file says its unit itself");
  expect_problem(changed("type: insulated", "type: fixed, h: 1 W/m^2/K"), "only a wall of type robin");
}

static void impossible_values_are_refused(void **state)
{
  (void)state;
  expect_problem(changed("tolerance: 1e-2", "tolerance: 0"), "tolerance: '0' is not allowed");
  expect_problem(changed("patch_size: 3 mm", "patch_size: 0.3 mm"), "smaller than the mesh there");
  expect_problem(changed("h: 15 W/m^2/K", "h: -15 W/m^2/K"), "h: '-15 W/m^2/K' is not allowed");
  expect_problem(changed("mould.rom.h5", "mould.txt"), "a name that ends in '.rom.h5' is expected");
  expect_problem(changed("file: mould.geo", "file: mould.obj"), "'mould.obj' is of no kind that can be read");
  expect_problem(changed("conductivity: 27 W/m/K", "conductivity: 0 W/m/K"), "conductivity");
  expect_problem(changed("    pin:", "    a/b:"), "no '/'");
  expect_problem(changed("method: rational", "shifts: [1 1/s, 1 1/s]"), "1 1/s stands here already");
}

static void groups_must_fit_the_names_in_use(void **state)
{
  (void)state;
  expect_problem(mould_files_yaml("mould.step", "  groups: { base: { volumes: rest } }\n"),
                 "regions.body: geometry.groups has no volumes of this name");
  expect_problem(mould_files_yaml("mould.step", "  groups: { hull: { surfaces: [1] } }\n"),
                 "geometry.groups.hull: no boundary and no cavity surface has this name");
  expect_problem(mould_files_yaml("mould.step", "  groups: { base: { volumes: [0] }, body: { volumes: all } }\n"),
                 "a list of numbers, a box");
  expect_problem(mould_files_yaml("mould.step", "  groups: { base: { volumes: rest }, body: { volumes: rest } }\n"),
                 "only one group can hold the rest of the volumes");
  expect_problem(mould_files_yaml("mould.step", "  groups: { pin: { surfaces: { low: 0 0 2 mm, high: 1 1 1 mm } } }\n"),
                 "lies below 'low' along z");
}

static void the_report_shows_every_setting(void **state)
{
  (void)state;
  static const char *const shows[] = {"block with a basin", "0.001 m",          "sand, 1 W/(m K)", "robin, h = 15",
                                      "fixed at the",       "patches of 0.003", "one patch",       "grows by 0.4",
                                      "0.001 s to 10 s",    "rational",         "mould.rom.h5",    "0.0008 m"};
  ReduceConfig *config = read_config(mould_files_yaml("mould.geo", "  unit: mm\n"));
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  assert_non_null(out);
  reduce_config_print(config, out);
  fclose(out);
  for (size_t i = 0; i < sizeof shows / sizeof *shows; i++)
    if (!strstr(text, shows[i])) fail_msg("'%s' is missing in:\n%s", shows[i], text);
  free(text);
  reduce_config_destroy(&config);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_whole_input_is_read_in_si),
      cmocka_unit_test(paths_are_seen_from_the_input_file),
      cmocka_unit_test(the_settings_of_each_method_are_read),
      cmocka_unit_test(groups_are_lists_boxes_or_the_rest),
      cmocka_unit_test(the_mesh_follows_the_patches_unless_told_otherwise),
      cmocka_unit_test(a_cavity_of_stl_stands_in_a_flask),
      cmocka_unit_test(layers_are_automatic_given_or_none),
      cmocka_unit_test(all_faults_come_in_one_go_in_the_order_of_their_lines),
      cmocka_unit_test(settings_that_would_do_nothing_are_refused),
      cmocka_unit_test(impossible_values_are_refused),
      cmocka_unit_test(groups_must_fit_the_names_in_use),
      cmocka_unit_test(the_report_shows_every_setting),
  };
  return cmocka_run_group_tests(tests, make_files, remove_files);
}
