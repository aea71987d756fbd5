/* A ROM that was written and read again is the same, to the last bit. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "common/rom/rom_report.h"
#include "common/rom/rom_schema.h"
#include "tests/support/assert_ok.h"
#include "tests/support/synthetic_rom.h"

static const SyntheticSlab slab = {.size = {2e-3, 1e-3},
                                   .depth = 5e-3,
                                   .kappa = 1.0,
                                   .rho = 1800.0,
                                   .c = 1100.0,
                                   .h_bottom = 15.0,
                                   .modes = 40,
                                   .modes_lateral = {3, 2},
                                   .patches = {3, 2}};
static const SyntheticBox box = {.outer = {20e-3, 18e-3, 16e-3},
                                 .cavity = {8e-3, 8e-3, 8e-3},
                                 .pin_width = 2e-3,
                                 .pin_depth = 3e-3,
                                 .cell = 1e-3,
                                 .kappa = 1.0,
                                 .rho = 1800.0,
                                 .c = 1100.0,
                                 .h_outside = 20.0};

static void expect_same_field(const RomData *a, const RomData *b, const RomField *field)
{
  const void *packed[2];
  void *owned[2];
  assert_int_equal(rom_field_pack(a, field, &packed[0], &owned[0], NULL), CAST_OK);
  assert_int_equal(rom_field_pack(b, field, &packed[1], &owned[1], NULL), CAST_OK);
  const size_t n = rom_field_entries(a, field);
  assert_int_equal(n, rom_field_entries(b, field));
  const size_t bytes = rom_stored_size(field->type) > 0 ? n * rom_stored_size(field->type) : strlen(packed[0]) + 1;
  if (memcmp(packed[0], packed[1], bytes) != 0) fail_msg("%s differs", field->name);
  free(owned[0]);
  free(owned[1]);
}

/* Fill what a synthetic ROM leaves empty, so that no row of the schema goes untested. */
static void fill_the_rest(RomData *rom)
{
  RomCertificate *certificate = &rom->certificate;
  double **tables[] = {&rom->shifts, &certificate->frequency, &certificate->transfer_bound, &certificate->time,
                       &certificate->step_error};
  size_t *counts[] = {&rom->n_shifts, &certificate->n_frequencies, &certificate->n_times};
  for (size_t i = 0; i < 3; i++) *counts[i] = 3;
  for (size_t i = 0; i < 5; i++) {
    free(*tables[i]);
    *tables[i] = malloc(3 * sizeof(double));
    assert_non_null(*tables[i]);
    for (size_t k = 0; k < 3; k++) (*tables[i])[k] = 1e-4 * (double)(3 * i + k + 1);
  }
  certificate->step_error_max = 9e-4;
  certificate->met = true;
  certificate->sampled_patches = 17;
  certificate->moment_error = 1e-12;
  certificate->orthogonality = NAN;
  certificate->second_stage_bound = 0.25;
  rom->provenance.seconds_mesh = 1.5;
  rom->provenance.ranks = 4;
  free(rom->provenance.input_text);
  rom->provenance.input_text = strdup("title: \xc3\xbc"
                                      "mlaut\nmesh:\n  size: 1 mm # comment\n");
  memset(rom->material[0].sha256, 'a', 64);
  rom->material[0].reference_temperature = 1073.15;
}

static void expect_roundtrip(RomData *rom)
{
  char path[] = "/tmp/castrom_XXXXXX";
  CastError err = {0};
  RomData *again = NULL;
  const int descriptor = mkstemp(path);
  assert_true(descriptor >= 0);
  close(descriptor);
  ok(rom_write(rom, path, &err), &err); // replaces the file that is there
  ok(rom_read(path, &again, &err), &err);
  for (size_t i = 0; i < rom_field_count; i++) expect_same_field(rom, again, &rom_fields[i]);
  rom_destroy(&again);
  assert_null(again);
  unlink(path);
}

static void slab_comes_back_bit_for_bit(void **state)
{
  (void)state;
  CastError err = {0};
  RomData *rom = NULL;
  ok(synthetic_rom_slab(&slab, &rom, &err), &err);
  expect_roundtrip(rom);
  fill_the_rest(rom);
  expect_roundtrip(rom);
  rom_destroy(&rom);
}

static void box_with_a_pin_comes_back_bit_for_bit(void **state)
{
  (void)state;
  CastError err = {0};
  RomData *rom = NULL;
  ok(synthetic_rom_box_cavity(&box, &rom, &err), &err);
  fill_the_rest(rom);
  expect_roundtrip(rom);
  rom_destroy(&rom);
}

static void model_without_geometry_comes_back_bit_for_bit(void **state)
{
  (void)state;
  CastError err = {0};
  RomData *rom = NULL;
  ok(synthetic_rom_slab(&slab, &rom, &err), &err);
  rom->n_points = rom->n_triangles = rom->n_tetrahedra = 0;
  expect_roundtrip(rom);
  rom_destroy(&rom);
}

static void every_data_set_carries_units_and_a_description(void **state)
{
  (void)state;
  CastError err = {0};
  RomData *rom = NULL;
  char path[] = "/tmp/castrom_XXXXXX", *text = NULL;
  const int descriptor = mkstemp(path);
  assert_true(descriptor >= 0);
  close(descriptor);
  ok(synthetic_rom_slab(&slab, &rom, &err), &err);
  ok(rom_write(rom, path, &err), &err);
  hid_t file = -1;
  ok(h5_file_open(path, &file, &err), &err);
  for (size_t i = 0; i < rom_field_count; i++) {
    const hid_t set = H5Dopen2(file, rom_fields[i].name, H5P_DEFAULT);
    assert_true(set >= 0);
    ok(h5_read_text_attribute(set, "units", &text, &err), &err);
    assert_string_equal(text, rom_fields[i].units);
    free(text);
    ok(h5_read_text_attribute(set, "description", &text, &err), &err);
    assert_string_equal(text, rom_fields[i].description);
    free(text);
    H5Dclose(set);
  }
  ok(h5_file_close(&file, &err), &err);
  rom_destroy(&rom);
  unlink(path);
}

/* docs/rom-format.md stands beside the share folder that the tests are given. */
static void every_data_set_stands_in_the_documentation(void **state)
{
  (void)state;
  const char *share = getenv("CAST_SHARE");
  if (!share) skip();
  char path[4096], line[4096];
  snprintf(path, sizeof path, "%s/../docs/rom-format.md", share);
  size_t next = 0;
  FILE *document = fopen(path, "r");
  assert_non_null(document);
  while (next < rom_field_count && fgets(line, sizeof line, document)) {
    char start[128];
    snprintf(start, sizeof start, "| `%s` |", rom_fields[next].name);
    next += strncmp(line, start, strlen(start)) == 0; // in the order of the checksum
  }
  fclose(document);
  if (next < rom_field_count) fail_msg("%s is not in its place in %s", rom_fields[next].name, path);
}

static void report_tells_what_the_file_holds(void **state)
{
  (void)state;
  CastError err = {0};
  RomData *rom = NULL;
  char *text = NULL;
  ok(synthetic_rom_slab(&slab, &rom, &err), &err);
  ok(rom_report(rom, "a.rom.h5", &text, &err), &err);
  assert_non_null(strstr(text, "no error was measured"));
  free(text);
  fill_the_rest(rom);
  ok(rom_report(rom, "a.rom.h5", &text, &err), &err);
  const char *parts[] = {"a.rom.h5\n",
                         "states     241, reduced from 241 unknowns",
                         "6 on the cavity wall, 2 on outer surfaces",
                         "0.09 % of the largest temperature rise from 1 ms to 100 s, 0.1 % asked for: met",
                         "x 0 to 2 mm, y 0 to 1 mm, z -5 to 0 mm",
                         "volume     0.01 cm3, heat capacity 0.0198 J/K",
                         "outer, h = 15 W/(m2 K)",
                         "taken at",
                         "800 degC"};
  for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
    if (!strstr(text, parts[i])) fail_msg("'%s' is not in\n%s", parts[i], text);
  for (const char *line = text; *line; line += strcspn(line, "\n") + 1) assert_in_range(strcspn(line, "\n"), 0, 100);
  free(text);
  rom_destroy(&rom);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(slab_comes_back_bit_for_bit),
      cmocka_unit_test(box_with_a_pin_comes_back_bit_for_bit),
      cmocka_unit_test(model_without_geometry_comes_back_bit_for_bit),
      cmocka_unit_test(every_data_set_carries_units_and_a_description),
      cmocka_unit_test(every_data_set_stands_in_the_documentation),
      cmocka_unit_test(report_tells_what_the_file_holds),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
