/* Input files that are wrong, each named after its fault. The files in malformed/yaml are read as a small mould.yaml,
 * those in malformed/material as a material. A file begins with the message it must give, one line of it after each
 * "#! ", in which {path} stands for the file itself. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cast_build_config.h"
#include "common/input/yaml_input.h"
#include "common/material/material.h"

enum { TEXT = 8192 };

/* A reader that uses every kind of getter. */
static void read_mould(YamlNode root)
{
  static const char *const METHODS[] = {"rational", "arnoldi", NULL};
  const YamlNode mesh = yaml_require(root, "mesh"), reduction = yaml_get(root, "reduction");
  yaml_string(yaml_get(root, "title"), "");
  yaml_quantity(yaml_require(mesh, "cavity_size"), "m", YAML_POSITIVE, NAN);
  yaml_quantity(yaml_get(mesh, "growth"), "1", (YamlRange){0.01, 2.0, false}, 0.4);
  yaml_integer(yaml_get(mesh, "layers"), 0, 20, 0);
  yaml_choice(yaml_get(reduction, "method"), METHODS, 0);
  yaml_boolean(yaml_get(reduction, "second_stage"), false);
  double v[3];
  yaml_vector(yaml_get(root, "gravity"), "m/s^2", v);
  const YamlNode boundaries = yaml_get(root, "boundaries");
  for (size_t i = 0; i < yaml_count(boundaries); i++)
    yaml_quantity(yaml_require(yaml_value(boundaries, i), "h"), "W/m^2/K", YAML_NON_NEGATIVE, NAN);
}

static CastStatus read_as_mould(const char *path, CastError *err)
{
  YamlInput *input = NULL;
  CAST_CALL(yaml_input_load(path, &input, err));
  read_mould(yaml_root(input));
  const CastStatus status = yaml_input_finish(input, err);
  yaml_input_destroy(&input);
  return status;
}

/* Named by its path in an input file; what material_read returns is the fault in the file. */
static CastStatus read_as_material(const char *path, CastError *err)
{
  char text[TEXT];
  YamlInput *input = NULL;
  Material material;
  snprintf(text, sizeof text, "m: %s\n", path);
  CAST_CALL(yaml_input_parse(text, "cast.yaml", &input, err));
  CastStatus status = material_read(yaml_get(yaml_root(input), "m"), &material, err);
  if (status == CAST_OK) status = material_check_melt(&material, err);
  material_destroy(&material);
  yaml_input_destroy(&input);
  return status;
}

static void append(char *text, const char *line, const char *path)
{
  char *end = text + strlen(text);
  if (end > text) *end++ = '\n';
  const char *mark = strstr(line, "{path}");
  snprintf(end, TEXT - (size_t)(end - text), "%.*s%s%s", mark ? (int)(mark - line) : 0, line, mark ? path : "",
           mark ? mark + strlen("{path}") : line);
}

/* The message that the head of the file promises. */
static void read_expected(const char *path, char expected[TEXT])
{
  char line[1024];
  expected[0] = '\0';
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  while (fgets(line, sizeof line, file) && strncmp(line, "#! ", 3) == 0) {
    line[strcspn(line, "\n")] = '\0';
    append(expected, line + 3, path);
  }
  fclose(file);
}

static int count_failures(const char *name, CastStatus (*read)(const char *, CastError *), int *n_files)
{
  char folder[4096], path[TEXT], expected[TEXT];
  snprintf(folder, sizeof folder, "%s/../tests/malformed/%s", CAST_SHARE_SOURCE, name);
  DIR *directory = opendir(folder);
  assert_non_null(directory);
  int failures = 0;
  const struct dirent *entry;
  *n_files = 0;
  while ((entry = readdir(directory))) {
    if (!strstr(entry->d_name, ".yaml")) continue;
    CastError err = {0};
    snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
    read_expected(path, expected);
    const CastStatus status = read(path, &err);
    const int good = status == CAST_ERR_INPUT && expected[0] && strcmp(err.message, expected) == 0;
    if (!good)
      print_error("%s: status %d\n  says    %s\n  instead %s\n", entry->d_name, (int)status, err.message, expected);
    failures += !good;
    ++*n_files;
  }
  closedir(directory);
  return failures;
}

static void each_malformed_input_is_refused_with_its_line_and_reason(void **state)
{
  (void)state;
  int n_files;
  assert_int_equal(count_failures("yaml", read_as_mould, &n_files), 0);
  assert_true(n_files >= 25);
}

static void each_malformed_material_is_refused_with_its_line_and_reason(void **state)
{
  (void)state;
  int n_files;
  assert_int_equal(count_failures("material", read_as_material, &n_files), 0);
  assert_true(n_files >= 20);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_malformed_input_is_refused_with_its_line_and_reason),
      cmocka_unit_test(each_malformed_material_is_refused_with_its_line_and_reason),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
