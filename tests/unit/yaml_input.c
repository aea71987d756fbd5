/* Input files: what the getters give, and that all that is wrong is said in one go, with its line. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "common/input/yaml_input.h"
#include "tests/support/assert_close.h"

static YamlInput *open_text(const char *text)
{
  YamlInput *input = NULL;
  CastError err;
  if (yaml_input_parse(text, "mould.yaml", &input, &err) != CAST_OK) fail_msg("%s", err.message);
  return input;
}

static YamlNode at(YamlInput *input, const char *key)
{
  return yaml_get(yaml_root(input), key);
}

/* Finish and release; `expected` is the whole message. */
static void expect_problems(YamlInput *input, const char *expected)
{
  CastError err = {0};
  assert_int_equal(yaml_input_finish(input, &err), expected[0] ? CAST_ERR_INPUT : CAST_OK);
  assert_string_equal(err.message, expected);
  yaml_input_destroy(&input);
  assert_null(input);
}

static void values_of_every_kind_are_read(void **state)
{
  (void)state;
  static const char *const CHOICES[] = {"rational", "arnoldi", NULL};
  YamlInput *input = open_text("size: 8 mm\nn: 12\nyes: true\nno: no\nmethod: arnoldi\n\"text\": 'a: b'\n"
                               "each: [1 mm, 2 cm, 0 m]\nshared: 0 -1.5e0 3 mm\nlist: [1, 2]\n");
  assert_close(yaml_quantity(at(input, "size"), "m", YAML_POSITIVE, NAN), 8e-3, 1e-17);
  assert_int_equal(yaml_integer(at(input, "n"), 1, 20, 0), 12);
  assert_true(yaml_boolean(at(input, "yes"), false) && !yaml_boolean(at(input, "no"), true));
  assert_int_equal(yaml_choice(at(input, "method"), CHOICES, 0), 1);
  assert_string_equal(yaml_string(at(input, "text"), ""), "a: b");
  double v[3];
  assert_true(yaml_vector(at(input, "each"), "m", v));
  assert_true(v[0] == 1e-3 && v[1] == 2e-2 && v[2] == 0.0);
  assert_true(yaml_vector(at(input, "shared"), "m", v));
  assert_true(v[0] == 0.0 && v[1] == -1.5e-3 && v[2] == 3e-3);
  assert_int_equal(yaml_count(at(input, "list")), 2);
  assert_string_equal(yaml_string(yaml_item(at(input, "list"), 1), ""), "2");
  expect_problems(input, "");
}

static void overrides_take_the_place_of_what_stands_in_the_file(void **state)
{
  (void)state;
  YamlInput *input = open_text("a: 1 mm\nmelt:\n  t: 900 K\n  blocks:\n    - {size: 1 mm}\n    - {size: 2 mm}\n"
                               "overrides:\n  a: 5 mm\n  melt.blocks[2].size: 7 mm\n  new.deep.key: 3\n  melt.t: [1, 2]\n");
  assert_close(yaml_quantity(at(input, "a"), "m", YAML_POSITIVE, NAN), 5e-3, 1e-17);
  const YamlNode melt = at(input, "melt"), blocks = yaml_get(melt, "blocks");
  assert_close(yaml_quantity(yaml_get(yaml_item(blocks, 0), "size"), "m", YAML_POSITIVE, NAN), 1e-3, 1e-17);
  assert_close(yaml_quantity(yaml_get(yaml_item(blocks, 1), "size"), "m", YAML_POSITIVE, NAN), 7e-3, 1e-17);
  assert_int_equal(yaml_count(yaml_get(melt, "t")), 2);
  const YamlNode deep = yaml_get(yaml_get(at(input, "new"), "deep"), "key");
  assert_int_equal(yaml_integer(deep, 0, 9, -1), 3);
  assert_false(yaml_exists(at(input, "overrides")));
  yaml_problem(deep, "too large");
  expect_problems(input, "mould.yaml:10: new.deep.key: too large");
}

static void overrides_that_lead_nowhere_are_refused(void **state)
{
  (void)state;
  static const char *const CASES[][2] = {
      {"a: 1\noverrides: 3\n", "mould.yaml:2: overrides: a map is expected, such as {melt.temperature: 1100 degC}"},
      {"a: 1\noverrides: {a.b: 3}\n", "mould.yaml:2: overrides: 'a.b' leads through something that has no keys"},
      {"a: [1]\noverrides: {\"a[2]\": 3}\n",
       "mould.yaml:2: overrides: 'a[2]' names item 2 of a list of 1 (items count from 1)"},
      {"a: 1\noverrides:\n  .b: 3\n", "mould.yaml:3: overrides: '.b' is no path of keys such as melt.temperature"}};
  for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
    YamlInput *input = NULL;
    CastError err = {0};
    assert_int_equal(yaml_input_parse(CASES[i][0], "mould.yaml", &input, &err), CAST_ERR_INPUT);
    assert_string_equal(err.message, CASES[i][1]);
    assert_null(input);
  }
}

static void absent_nodes_give_the_fallback_and_no_further_problem(void **state)
{
  (void)state;
  YamlInput *input = open_text("a: 1\n");
  const YamlNode none = yaml_get(at(input, "mesh"), "size");
  double v[3];
  assert_true(yaml_quantity(none, "m", YAML_POSITIVE, 7.0) == 7.0 && yaml_integer(none, 0, 9, 3) == 3);
  assert_true(yaml_boolean(none, true) && yaml_choice(none, NULL, 2) == 2 && !yaml_vector(none, "m", v));
  assert_string_equal(yaml_string(none, "fallback"), "fallback");
  assert_false(yaml_exists(yaml_require(none, "x")) || yaml_exists(yaml_item(none, 0)) || yaml_is_map(none));
  assert_true(yaml_count(none) == 0 && yaml_line(none) == 0 && yaml_key(none, 0) == NULL);
  at(input, "a");
  expect_problems(input, "");
}

static void names_chosen_by_the_user_can_be_walked(void **state)
{
  (void)state;
  YamlInput *input = open_text("regions:\n  shell: 1 mm\n  core: 2 mm\n");
  const YamlNode regions = at(input, "regions");
  assert_int_equal(yaml_count(regions), 2);
  assert_string_equal(yaml_key(regions, 1), "core");
  assert_close(yaml_quantity(yaml_value(regions, 1), "m", YAML_ANY, NAN), 2e-3, 0.0);
  yaml_value(regions, 0);
  expect_problems(input, "");
}

static void all_problems_come_at_once_sorted_by_line(void **state)
{
  (void)state;
  static const char *const METHODS[] = {"rational", "arnoldi", NULL};
  YamlInput *input = open_text("# a comment\nmesh:\n  cavity_siz: 1 mm\n  growth: 5\n  layers: 2.5\n"
                               "reduction:\n  method: magic\n  second_stage: maybe\n"
                               "blocks:\n  - size: [1 mm, 2 K, 3 mm]\n  - size: 3 mm\n");
  const YamlNode mesh = at(input, "mesh"), reduction = at(input, "reduction"), blocks = at(input, "blocks");
  double v[3];
  for (size_t i = yaml_count(blocks); i-- > 0;) // backwards: the report sorts
    assert_false(yaml_vector(yaml_get(yaml_item(blocks, i), "size"), "m", v));
  assert_int_equal(yaml_choice(yaml_get(reduction, "method"), METHODS, 0), 0);
  yaml_boolean(yaml_get(reduction, "second_stage"), false);
  assert_true(isnan(yaml_quantity(yaml_require(mesh, "cavity_size"), "m", YAML_POSITIVE, NAN)));
  yaml_quantity(yaml_get(mesh, "growth"), "1", (YamlRange){0.01, 2.0, false}, 0.4);
  yaml_integer(yaml_get(mesh, "layers"), 0, 9, 0);
  expect_problems(input, "mould.yaml:2: mesh: key 'cavity_size' is missing\n"
                         "mould.yaml:3: mesh: unknown key 'cavity_siz' (did you mean 'cavity_size'?); allowed here: "
                         "cavity_size, growth, layers\n"
                         "mould.yaml:4: mesh.growth: '5' is not allowed: a value of at least 0.01 and of at most 2 is "
                         "expected\n"
                         "mould.yaml:5: mesh.layers: '2.5' is not a whole number\n"
                         "mould.yaml:7: reduction.method: 'magic' is not allowed here; allowed: rational, arnoldi\n"
                         "mould.yaml:8: reduction.second_stage: 'maybe' is neither true nor false\n"
                         "mould.yaml:10: blocks[1].size[2]: '2 K' is a temperature, a length is expected (for example "
                         "'8 mm')\n"
                         "mould.yaml:11: blocks[2].size: '3 mm' is not a vector: '[0 mm, 0 mm, 3 mm]' or '0 0 3 mm' is "
                         "expected");
}

static void ranges_are_said_in_si(void **state)
{
  (void)state;
  YamlInput *input = open_text("a: -1 mm\nb: 0 mm\nc: 0 mm\nd: 9 m\ne: 0\nf: 99\n");
  yaml_quantity(at(input, "a"), "m", YAML_NON_NEGATIVE, 0.0);
  yaml_quantity(at(input, "b"), "m", YAML_POSITIVE, 0.0);
  assert_true(yaml_quantity(at(input, "c"), "m", YAML_NON_NEGATIVE, 5.0) == 0.0);
  yaml_quantity(at(input, "d"), "m", (YamlRange){-INFINITY, 1.0, false}, 0.0);
  yaml_integer(at(input, "e"), 1, LONG_MAX, 1);
  yaml_integer(at(input, "f"), 1, 20, 1);
  expect_problems(input, "mould.yaml:1: a: '-1 mm' is not allowed: a value of at least 0 m is expected\n"
                         "mould.yaml:2: b: '0 mm' is not allowed: a value above 0 m is expected\n"
                         "mould.yaml:4: d: '9 m' is not allowed: a value of at most 1 m is expected\n"
                         "mould.yaml:5: e: 0 is not allowed: a whole number of at least 1 is expected\n"
                         "mould.yaml:6: f: 99 is not allowed: a whole number from 1 to 20 is expected");
}

static void value_of_the_wrong_shape_is_reported_once(void **state)
{
  (void)state;
  YamlInput *input = open_text("mesh: 5\nsize: {x: 1}\nlist: [1]\nempty:\n");
  for (int i = 0; i < 3; i++) yaml_get(at(input, "mesh"), i == 0 ? "a" : i == 1 ? "b" : "c");
  yaml_quantity(at(input, "size"), "m", YAML_ANY, 0.0);
  yaml_string(at(input, "list"), NULL);
  yaml_string(at(input, "empty"), NULL);
  expect_problems(input, "mould.yaml:1: mesh: a map of keys and values is expected here\n"
                         "mould.yaml:2: size: a single value is expected here, not a map\n"
                         "mould.yaml:3: list: a single value is expected here, not a list\n"
                         "mould.yaml:4: empty: a single value is expected here, there is none");
}

static void suggestion_is_made_only_for_what_looks_alike(void **state)
{
  (void)state;
  YamlInput *input = open_text("h: 1\nwholly_different: 2\nThcikness: 3\n");
  at(input, "w");
  at(input, "thickness");
  expect_problems(input, "mould.yaml:1: unknown key 'h'; allowed here: w, thickness\n"
                         "mould.yaml:2: unknown key 'wholly_different'; allowed here: w, thickness\n"
                         "mould.yaml:3: unknown key 'Thcikness'; allowed here: w, thickness"); // three letters off
  input = open_text("thikness: 3\n");
  at(input, "thickness");
  expect_problems(input, "mould.yaml:1: unknown key 'thikness' (did you mean 'thickness'?); allowed here: thickness");
}

static void more_problems_than_fit_are_counted(void **state)
{
  (void)state;
  char text[8000] = "list: [0";
  for (int i = 1; i < 500; i++) snprintf(text + strlen(text), sizeof text - strlen(text), ",\n%d", i);
  strcat(text, "]\n");
  YamlInput *input = open_text(text);
  for (size_t i = 0; i < 500; i++) yaml_quantity(yaml_item(at(input, "list"), i), "m", YAML_ANY, 0.0);
  CastError err;
  assert_int_equal(yaml_input_finish(input, &err), CAST_ERR_INPUT);
  size_t lines = 0, more = 0;
  for (const char *c = err.message; (c = strchr(c, '\n')); c++) lines++;
  assert_int_equal(sscanf(strrchr(err.message, '\n'), "\n... and %zu more", &more), 1);
  assert_int_equal(lines + more, 500);
  assert_true(lines > 50);
  yaml_input_destroy(&input);
}

static void block_is_found_at_its_key_and_cut_out_without_what_follows(void **state)
{
  (void)state;
  // two-byte letters before it: libyaml counts characters
  const char *text =
      "\xef\xbb\xbf# µm, °C\nmelt:\n  name: µ-bronze\n  list:\n    - 1\n    - two °C  # here\n\n# about x\nx: 1\n"
      "flow: { a: 1 }  # f\n";
  YamlInput *input = open_text(text);
  size_t start, end;
  yaml_input_extent(at(input, "melt"), &start, &end);
  assert_int_equal(yaml_line(at(input, "melt")), 2);
  const char *melt = "name: µ-bronze\n  list:\n    - 1\n    - two °C";
  assert_int_equal(end - start, strlen(melt));
  assert_memory_equal(text + start, melt, end - start);
  yaml_input_extent(at(input, "flow"), &start, &end);
  assert_int_equal(end - start, strlen("{ a: 1 }"));
  assert_memory_equal(text + start, "{ a: 1 }", end - start);
  assert_int_equal(yaml_line(at(input, "x")), 9);
  assert_string_equal(yaml_input_text(input), text);
  assert_string_equal(yaml_input_path(input), "mould.yaml");
  yaml_input_destroy(&input);
}

static void file_that_cannot_be_read_says_why(void **state)
{
  (void)state;
  YamlInput *input = NULL;
  CastError err;
  assert_int_equal(yaml_input_load("/nowhere/mould.yaml", &input, &err), CAST_ERR_IO);
  assert_string_equal(err.message, "'/nowhere/mould.yaml' cannot be opened: No such file or directory");
  assert_int_equal(yaml_input_load("/tmp", &input, &err), CAST_ERR_IO);
  assert_string_equal(err.message, "'/tmp' cannot be read: Is a directory");
  assert_int_equal(yaml_input_load("/dev/zero", &input, &err), CAST_ERR_INPUT); // endless
  assert_string_equal(err.message, "'/dev/zero' is larger than 4 MiB: no input file");
  assert_null(input);
}

static void deep_nesting_is_refused_at_once(void **state)
{
  (void)state;
  static char text[1000002];
  memset(text, '[', 1000000);
  memcpy(text, "a: ", 3);
  YamlInput *input = NULL;
  CastError err;
  assert_int_equal(yaml_input_parse(text, "deep.yaml", &input, &err), CAST_ERR_INPUT); // libyaml alone: minutes
  assert_string_equal(err.message, "deep.yaml:1: nested more than 32 deep");
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(values_of_every_kind_are_read),
      cmocka_unit_test(overrides_take_the_place_of_what_stands_in_the_file),
      cmocka_unit_test(overrides_that_lead_nowhere_are_refused),
      cmocka_unit_test(absent_nodes_give_the_fallback_and_no_further_problem),
      cmocka_unit_test(names_chosen_by_the_user_can_be_walked),
      cmocka_unit_test(all_problems_come_at_once_sorted_by_line),
      cmocka_unit_test(ranges_are_said_in_si),
      cmocka_unit_test(value_of_the_wrong_shape_is_reported_once),
      cmocka_unit_test(suggestion_is_made_only_for_what_looks_alike),
      cmocka_unit_test(more_problems_than_fit_are_counted),
      cmocka_unit_test(block_is_found_at_its_key_and_cut_out_without_what_follows),
      cmocka_unit_test(file_that_cannot_be_read_says_why),
      cmocka_unit_test(deep_nesting_is_refused_at_once),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
