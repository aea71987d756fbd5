/* Whatever stands in an input file, reading it ends in a result or in a message that names the file: real inputs with
 * bytes changed, cut out, doubled and moved (fixed seed). Run under the address sanitizer to see the most. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cast_build_config.h"
#include "common/material/material.h"

enum { TEXT = 16384, MUTANTS = 3000 };

static uint64_t random_state;

static size_t random_below(size_t n)
{
  random_state ^= random_state >> 12; // xorshift64*
  random_state ^= random_state << 25;
  random_state ^= random_state >> 27;
  return n ? (size_t)((random_state * 2685821657736338717ULL) >> 33) % n : 0;
}

static void read_source(const char *path, char text[TEXT])
{
  char full[4096];
  snprintf(full, sizeof full, "%s/../%s", CAST_SHARE_SOURCE, path);
  FILE *file = fopen(full, "rb");
  if (!file) fail_msg("%s", full);
  text[fread(text, 1, TEXT / 2, file)] = '\0';
  fclose(file);
}

/* Change one place of the text; what follows a byte made 0 is lost, as in any C string. */
static void mutate(char text[TEXT])
{
  static const char SIGNS[] = ":-[]{},&*!|>'\"%@`#?\t\n \\0123eE+\xc2\xb5\xff";
  const size_t n = strlen(text), at = random_below(n), length = 1 + random_below(12);
  switch (random_below(4)) {
  case 0:
    text[at] = (char)random_below(256);
    break;
  case 1:
    text[at] = SIGNS[random_below(sizeof SIGNS - 1)];
    break;
  case 2: // cut out
    if (at + length < n) memmove(text + at, text + at + length, n - at - length + 1);
    break;
  default: // double
    if (at + length < n && n + length < TEXT) memmove(text + at + length, text + at, n - at + 1);
    break;
  }
}

/* Ask every getter of every node. */
static void walk(YamlNode node)
{
  static const char *const CHOICES[] = {"a", "b", NULL};
  double v[3];
  size_t start, end;
  yaml_input_extent(node, &start, &end);
  assert_true(start <= end && end <= strlen(yaml_input_text(node.input)));
  assert_true(yaml_line(node) >= 1);
  yaml_quantity(node, "m", YAML_POSITIVE, NAN);
  yaml_vector(node, "m/s^2", v);
  yaml_integer(node, 0, 10, 0);
  yaml_boolean(node, true);
  yaml_choice(node, CHOICES, 0);
  yaml_require(node, "missing");
  for (size_t i = 0; i < yaml_count(node); i++) walk(yaml_is_map(node) ? yaml_value(node, i) : yaml_item(node, i));
}

static void expect_message(CastStatus status, const CastError *err)
{
  if (status == CAST_OK) return;
  assert_int_equal(status, CAST_ERR_INPUT);
  assert_non_null(strstr(err->message, "mutant"));
  assert_true(strlen(err->message) < sizeof err->message - 1 && strlen(err->message) > strlen("mutant: "));
}

static void read_mutant(const char *text, int *accepted)
{
  YamlInput *input = NULL;
  CastError err = {0};
  CastStatus status = yaml_input_parse(text, "mutant", &input, &err);
  expect_message(status, &err);
  if (status != CAST_OK) return;
  walk(yaml_root(input));
  expect_message(yaml_input_finish(input, &err), &err);
  yaml_input_destroy(&input);
  Material material;
  assert_int_equal(yaml_input_parse(text, "mutant", &input, &err), CAST_OK);
  assert_int_equal(material_read(yaml_root(input), &material, &err), CAST_OK);
  status = yaml_input_finish(input, &err);
  expect_message(status, &err);
  if (status == CAST_OK && material.enthalpy.n >= 2) { // what was accepted can be used
    const double T = material_temperature(&material, material_enthalpy(&material, 1000.0));
    assert_true(fabs(T - 1000.0) < 1e-6 && material_specific_heat_min(&material) > 0.0);
  }
  *accepted += status == CAST_OK;
  material_destroy(&material);
  yaml_input_destroy(&input);
}

static int mutate_file(const char *path)
{
  char original[TEXT], text[TEXT];
  int accepted = 0;
  read_source(path, original);
  for (int i = 0; i < MUTANTS; i++) {
    strcpy(text, original);
    for (size_t k = 1 + random_below(4); k-- > 0;) mutate(text);
    read_mutant(text, &accepted);
  }
  return accepted;
}

static void any_mutant_of_an_input_is_read_or_refused(void **state)
{
  (void)state;
  random_state = 12345;
  mutate_file("examples/quickstart/mould.yaml");
  mutate_file("examples/quickstart/cast.yaml");
}

static void any_mutant_of_a_material_is_read_or_refused(void **state)
{
  (void)state;
  random_state = 54321;
  const int accepted = mutate_file("share/materials/cual10.yaml") + mutate_file("share/materials/aluminium.yaml");
  assert_true(accepted > MUTANTS / 20 && accepted < 2 * MUTANTS - MUTANTS / 20); // both outcomes are exercised
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(any_mutant_of_an_input_is_read_or_refused),
      cmocka_unit_test(any_mutant_of_a_material_is_read_or_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
