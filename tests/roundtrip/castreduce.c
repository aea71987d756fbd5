/* castreduce as a user runs it: from geometry to ROM file, on one and on several ranks, and what it says. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "common/rom/rom.h"
#include "tests/support/mould_files.h"
#include "tests/support/program.h"
#include "tests/support/validation.h"

static const char *program, *mpiexec;

/* The test mould with a tight solver, so that ROMs of several runs can be compared. */
static void write_input(const char *name, const char *rom)
{
  static char text[10000];
  const char *good = mould_files_yaml("mould.geo", "  unit: mm\n");
  const char *at = strstr(good, "tolerance: 1e-2"), *end = strstr(at, "mould.rom.h5");
  snprintf(text, sizeof text, "%.*stolerance: 1e-2, solver_tolerance: 1e-13%.*s%s%s", (int)(at - good), good,
           (int)(end - at - 15), at + 15, rom, end + 12);
  mould_files_write(&mould_files, name, text);
}

static RomData *read_rom(const char *name)
{
  char path[256];
  RomData *rom = NULL;
  CastError err;
  snprintf(path, sizeof path, "%s/%s", mould_files.folder, name);
  if (rom_read(path, &rom, &err) != CAST_OK) fail_msg("%s", err.message); // which checks it as well
  return rom;
}

/* Made by the first test that wants it. */
static RomData *reduce_on(int ranks)
{
  char input[64], rom[64], path[256];
  snprintf(input, sizeof input, "on%d.yaml", ranks);
  snprintf(rom, sizeof rom, "on%d.rom.h5", ranks);
  snprintf(path, sizeof path, "%s/%s", mould_files.folder, rom);
  if (access(path, F_OK) == 0) return read_rom(rom);
  write_input(input, rom);
  const int code = ranks == 1 ? run("cd '%s' && '%s' run %s 2>&1", mould_files.folder, program, input)
                              : run("cd '%s' && '%s' --allow-run-as-root --oversubscribe -n %d '%s' run %s 2>&1",
                                    mould_files.folder, mpiexec, ranks, program, input);
  if (code != 0) fail_msg("exit code %d: %s", code, said);
  return read_rom(rom);
}

/* H_r(s) = B^T (s + Lambda)^-1 B, K/W */
static double transfer(const RomData *rom, double s, size_t i, size_t j)
{
  double sum = 0.0;
  for (size_t k = 0; k < rom->r; k++) sum += rom->B[k * rom->m + i] * rom->B[k * rom->m + j] / (s + rom->lambda[k]);
  return sum;
}

static double transfer_difference(const RomData *a, const RomData *b)
{
  static const double rates[] = {0.0, 1e-2, 1.0, 1e2, 1e4}; // 1/s; a fixed wall: s = 0 is regular
  double worst = 0.0;
  for (size_t n = 0; n < sizeof rates / sizeof *rates; n++) {
    double difference = 0.0, size = 0.0;
    for (size_t i = 0; i < a->m; i++)
      for (size_t j = 0; j < a->m; j++) {
        difference = fmax(difference, fabs(transfer(a, rates[n], i, j) - transfer(b, rates[n], i, j)));
        size = fmax(size, fabs(transfer(a, rates[n], i, j)));
      }
    worst = fmax(worst, difference / size);
  }
  return worst;
}

static void a_mould_becomes_a_rom_that_says_where_it_comes_from(void **state)
{
  (void)state;
  RomData *rom = reduce_on(1);
  assert_string_equal(rom->title, "block with a basin and a pin");
  assert_string_equal(rom->method, "rational");
  assert_string_equal(rom->provenance.program, "castreduce");
  assert_non_null(strstr(rom->provenance.command, "run on1.yaml"));
  assert_non_null(strstr(rom->provenance.input_text, "title: block with a basin and a pin"));
  assert_int_equal(strlen(rom->provenance.geometry_sha256), 64);
  assert_non_null(strstr(rom->provenance.libraries, "PETSc"));
  assert_int_equal(rom->provenance.ranks, 1);
  assert_true(rom->provenance.seconds_mesh > 0 && rom->provenance.seconds_reduction > 0);
  assert_true(rom->certificate.met && rom->certificate.step_error_max <= 1e-2);
  assert_int_equal(rom->n_materials, 2);
  assert_string_equal(rom->material[1].name, "sand");
  const double capacity = 1e-9 * (MOULD_FOOT_VOLUME * 7750 * 500 + (MOULD_VOLUME - MOULD_FOOT_VOLUME) * 1800 * 1100);
  assert_true(fabs(rom->heat_capacity / capacity - 1.0) < 1e-11); // sums of exact volumes
  rom_destroy(&rom);
}

static void the_rom_is_the_same_on_any_number_of_ranks(void **state)
{
  (void)state;
  validation_begin("R6-castreduce");
  RomData *one = reduce_on(1);
  for (int ranks = 2; ranks <= 4; ranks += 2) {
    RomData *many = reduce_on(ranks);
    assert_int_equal(many->provenance.ranks, ranks);
    assert_int_equal(many->m, one->m);
    assert_int_equal(many->n_full, one->n_full);
    assert_int_equal(many->n_points, one->n_points);
    assert_int_equal(many->n_triangles, one->n_triangles);
    assert_int_equal(many->n_tetrahedra, one->n_tetrahedra);
    assert_memory_equal(many->points, one->points, 3 * one->n_points * sizeof *one->points);
    assert_memory_equal(many->triangles, one->triangles, 3 * one->n_triangles * sizeof *one->triangles);
    assert_memory_equal(many->triangle_patch, one->triangle_patch, one->n_triangles * sizeof *one->triangle_patch);
    assert_memory_equal(many->tetrahedra, one->tetrahedra, 4 * one->n_tetrahedra * sizeof *one->tetrahedra);
    assert_memory_equal(many->patch, one->patch, one->m * sizeof *one->patch);
    const double difference = transfer_difference(one, many);
    const ValidationRow row = {.id = "R6-castreduce",
                               .quantity = validation_text("H(s) of castreduce's ROM on %d ranks", ranks),
                               .reference = "1 rank",
                               .ours = "the same geometry to the last bit",
                               .error = validation_text("%.1e", difference),
                               .target = "1e-8",
                               .resolution = validation_text("%zu unknowns, %zu patches", one->n_full, one->m),
                               .cpu_seconds = validation_cpu_time()};
    validation_write(&row);
    assert_true(difference < 1e-8); // R6 of the validation ladder
    rom_destroy(&many);
  }
  rom_destroy(&one);
}

/* The transfer function of two ROMs of the same mould, over which only the meshes differ, at rates that the mesh
 * resolves. */
static double difference_at_rest(const RomData *a, const RomData *b)
{
  double difference = 0.0, size = 0.0;
  for (size_t j = a->m - 3; j < a->m; j++) { // the outer surfaces: the cavity's patches are cut from another mesh
    difference = fmax(difference, fabs(transfer(a, 1e-2, j, j) - transfer(b, 1e-2, b->m - a->m + j, b->m - a->m + j)));
    size = fmax(size, fabs(transfer(a, 1e-2, j, j)));
  }
  return difference / size;
}

typedef struct Kind {
  const char *file, *lines, *options, *extra, *instead;
  double difference; // that the mesh may make, from the .geo file's ROM
} Kind;

static void reduce_kind(const Kind *kind, const RomData *one)
{
  static char text[10000];
  const bool ready = strstr(kind->file, ".msh") != NULL;
  const char *good =
      ready ? mould_files_yaml_of_mesh(kind->file, kind->lines) : mould_files_yaml(kind->file, kind->lines);
  const char *at = strstr(good, kind->extra), *end = strstr(good, "mould.rom.h5");
  assert_true(at && end);
  snprintf(text, sizeof text, "%.*s%s%.*skind.rom.h5%s", (int)(at - good), good, kind->instead,
           (int)(end - at - (ptrdiff_t)strlen(kind->extra)), at + strlen(kind->extra), end + 12);
  mould_files_write(&mould_files, "kind.yaml", text);
  if (strcmp(kind->file, "mould.geo") != 0) mould_files_convert(&mould_files, kind->file, kind->options);
  if (run("cd '%s' && '%s' run kind.yaml 2>&1", mould_files.folder, program) != 0) fail_msg("%s: %s", kind->file, said);
  RomData *rom = read_rom("kind.rom.h5");
  assert_true(rom->certificate.met);
  assert_true(fabs(rom->heat_capacity / one->heat_capacity - 1.0) < 1e-9); // the same regions and materials
  for (size_t k = 1; k <= 3; k++) {
    const RomPatch *mine = &rom->patch[rom->m - k], *theirs = &one->patch[one->m - k];
    assert_string_equal(mine->name, theirs->name);
    assert_true(fabs(mine->area / theirs->area - 1.0) < 1e-9);
  }
  const double difference = difference_at_rest(one, rom);
  print_message("%s with '%s': %zu unknowns, %zu states, differs by %.2e\n", kind->file, kind->instead, rom->n_full,
                rom->r, difference);
  assert_true(difference < kind->difference);
  rom_destroy(&rom);
}

static void every_kind_of_geometry_becomes_a_certified_rom(void **state)
{
  (void)state;
  char brep_lines[2048];
  snprintf(brep_lines, sizeof brep_lines, "  unit: mm\n%s", MOULD_GROUPS);
  const Kind kinds[] = {
      {"mould.step", MOULD_GROUPS, "", "cavity:\n", "cavity:\n", 0.01},
      {"mould.step", MOULD_GROUPS, "", "cavity:\n", "cavity:\n  layers: auto\n  contact: 2000 W/m^2/K\n", 0.02},
      {"mould.brep", brep_lines, "", "cavity:\n", "cavity:\n", 0.01},
      {"mould.geo", "  unit: mm\n", "", "growth: 0.4", "growth: 0.4, order: 2", 0.02},
      {"mould.msh", "  unit: mm\n", "Mesh.MeshSizeMax = 1.5;\n", "reduction:", "mesh: { order: 1 }\nreduction:", 0.05},
  };
  RomData *one = reduce_on(1);
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) reduce_kind(&kinds[i], one);
  rom_destroy(&one);
}

static void check_prints_the_input_and_makes_nothing(void **state)
{
  (void)state;
  char path[256];
  write_input("checked.yaml", "checked.rom.h5");
  assert_int_equal(run("'%s' check '%s/checked.yaml' 2>&1", program, mould_files.folder), 0);
  expect_said("title                   block with a basin and a pin");
  expect_said("cavity surface basin: 5 surfaces");
  expect_said("region body: 1 volume");
  snprintf(path, sizeof path, "%s/checked.rom.h5", mould_files.folder);
  assert_int_not_equal(access(path, F_OK), 0);
}

static void info_prints_what_a_rom_holds(void **state)
{
  (void)state;
  RomData *rom = reduce_on(1);
  rom_destroy(&rom);
  assert_int_equal(run("'%s' info '%s/on1.rom.h5' 2>&1", program, mould_files.folder), 0);
  expect_said("block with a basin and a pin");
  expect_said("basin");
  assert_int_equal(run("'%s' info '%s/mould.geo' 2>&1", program, mould_files.folder), 1);
  expect_said("castreduce: error: ");
}

static void unused_options_are_named(void **state)
{
  (void)state;
  write_input("typo.yaml", "typo.rom.h5");
  assert_int_equal(run("cd '%s' && '%s' run typo.yaml --quiet -ksp_typo 3 2>&1", mould_files.folder, program), 0);
  expect_said("warning: option -ksp_typo was not used by anything");
  assert_int_equal(run("'%s' run typo.yaml stray 2>&1", program), 2);
  expect_said("'stray' is not understood here");
  assert_int_equal(run("'%s' check typo.yaml --quiet 2>&1", program), 2); // check has nothing but its output
}

static void a_refused_run_leaves_an_earlier_rom_alone(void **state)
{
  (void)state;
  RomData *rom = reduce_on(1);
  rom_destroy(&rom);
  char text[10000];
  snprintf(text, sizeof text, "%s", mould_files_yaml("mould.geo", "  unit: mm\n"));
  memcpy(strstr(text, "mould.rom.h5"), "on1.rom.h5  ", 12); // the same output
  char *pin = strstr(text, "    pin:");
  memcpy(pin, "    pen:", 8); // not in the geometry
  mould_files_write(&mould_files, "spoilt.yaml", text);
  assert_int_equal(run("'%s' run '%s/spoilt.yaml' 2>&1", program, mould_files.folder), 1);
  expect_said("cavity surface 'pen': the geometry has no physical surface of this name");
  rom = read_rom("on1.rom.h5");
  rom_destroy(&rom);
}

static void help_and_version_are_there(void **state)
{
  (void)state;
  assert_int_equal(run("'%s' --help", program), 0);
  expect_said("castreduce run MOULD.YAML");
  assert_int_equal(run("'%s' --version", program), 0);
  expect_said("castreduce ");
  assert_int_equal(run("'%s' 2>&1", program), 2);
  assert_int_equal(run("'%s' dance 2>&1", program), 2);
  expect_said("'dance'");
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_mould_becomes_a_rom_that_says_where_it_comes_from),
      cmocka_unit_test(the_rom_is_the_same_on_any_number_of_ranks),
      cmocka_unit_test(every_kind_of_geometry_becomes_a_certified_rom),
      cmocka_unit_test(check_prints_the_input_and_makes_nothing),
      cmocka_unit_test(info_prints_what_a_rom_holds),
      cmocka_unit_test(unused_options_are_named),
      cmocka_unit_test(a_refused_run_leaves_an_earlier_rom_alone),
      cmocka_unit_test(help_and_version_are_there),
  };
  if (argc != 3) return 99;
  program = realpath(argv[1], NULL); // commands change the folder
  if (!program) return 99;
  mpiexec = argv[2];
  return cmocka_run_group_tests(tests, mould_files_set_up, mould_files_clean_up);
}
