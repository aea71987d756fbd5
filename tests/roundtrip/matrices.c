/* A mould as matrices from elsewhere: what castreduce makes of the files, in each of their forms and on several ranks,
 * and what the programs then do with a ROM that has no geometry. */
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
#include "tests/support/matrix_mould.h"
#include "tests/support/mould_files.h"
#include "tests/support/program.h"
#include "tests/support/text_file.h"

enum { CELLS = 6, M = 4 };
static const char *program, *mpiexec, *castrun;
static MatrixMould mould;

static void write_transposed(const char *name, const char *form, double factor)
{
  double *C = calloc(mould.m * mould.n, sizeof *C);
  assert_non_null(C);
  for (size_t i = 0; i < mould.n; i++)
    for (size_t l = 0; l < mould.m; l++) C[l * mould.n + i] = mould.B[i * mould.m + l];
  matrix_write(mould_files_path(name), form, mould.m, mould.n, C, factor);
  free(C);
}

static int make_files(void **state)
{
  static const char sparse[] = "coordinate real general", lower[] = "coordinate real symmetric";
  (void)state;
  mould_files_create(&mould_files);
  matrix_mould_create(CELLS, 100.0, &mould);
  matrix_write(mould_files_path("E.mtx"), lower, mould.n, mould.n, mould.E, 1.0);
  matrix_write(mould_files_path("K.mtx"), lower, mould.n, mould.n, mould.K, 1.0);
  matrix_write(mould_files_path("A.mtx"), sparse, mould.n, mould.n, mould.K, -1.0);
  matrix_write(mould_files_path("B.mtx"), sparse, mould.n, mould.m, mould.B, 1.0);
  matrix_write(mould_files_path("B_array.mtx"), "array real general", mould.n, mould.m, mould.B, 1.0);
  matrix_write(mould_files_path("B_flux.mtx"), sparse, mould.n, mould.m, mould.B, mould.area);
  write_transposed("C.mtx", "array real general", 7.0);
  return 0;
}

static int remove_files(void **state)
{
  (void)state;
  matrix_mould_destroy(&mould);
  mould_files_remove(&mould_files);
  return 0;
}

/* Reduce with the given section `matrices`; the ROM's name is NAME.rom.h5. */
static RomData *reduce(const char *name, const char *matrices, int ranks)
{
  char text[1000], input[64], before[400] = "";
  RomData *rom = NULL;
  CastError err;
  snprintf(text, sizeof text,
           "title: a block as matrices\nmatrices: { %s }\n"
           "reduction: { times: [10 ms, 100 s], tolerance: 1e-4, solver_tolerance: 1e-13 }\n"
           "output: { file: %s.rom.h5 }\n",
           matrices, name);
  snprintf(input, sizeof input, "%s.yaml", name);
  mould_files_write(&mould_files, input, text);
  if (ranks > 1) snprintf(before, sizeof before, "'%s' --allow-run-as-root --oversubscribe -n %d ", mpiexec, ranks);
  if (run("cd '%s' && %s'%s' run %s 2>&1", mould_files.folder, before, program, input) != 0) fail_msg("%s", said);
  snprintf(input, sizeof input, "%s.rom.h5", name);
  if (rom_read(mould_files_path(input), &rom, &err) != CAST_OK) fail_msg("%s", err.message);
  return rom;
}

/* Largest difference of H(s) from the full model's, over the largest entry, for s from 1e-2 to 1e2 1/s. */
static double transfer_error(const RomData *rom)
{
  double worst = 0.0;
  for (int decade = -2; decade <= 2; decade++) {
    const double s = 3.0 * pow(10.0, decade);
    double H[M * M], size = 0.0, difference = 0.0;
    matrix_mould_transfer(&mould, s, H);
    for (size_t a = 0; a < M; a++)
      for (size_t b = 0; b < M; b++) {
        double reduced = 0.0;
        for (size_t k = 0; k < rom->r; k++) reduced += rom->B[k * M + a] * rom->B[k * M + b] / (s + rom->lambda[k]);
        size = fmax(size, fabs(H[a * M + b]));
        difference = fmax(difference, fabs(H[a * M + b] - reduced));
      }
    worst = fmax(worst, difference / size);
  }
  return worst;
}

static void matrices_become_a_rom_of_their_transfer_function(void **state)
{
  (void)state;
  RomData *rom = reduce("plain", "E: E.mtx, K: K.mtx, B: B.mtx", 1);
  assert_int_equal(rom->n_full, CELLS * CELLS * CELLS);
  assert_int_equal(rom->m, M);
  assert_int_equal(rom->n_triangles, 0);
  assert_true(rom->certificate.met);
  assert_true(rom->r < rom->n_full / 2);
  assert_true(transfer_error(rom) < 1e-4); // the tolerance asked for; on the real axis the error is smaller still
  const double capacity = 2e6 * 1e-9 * CELLS * CELLS * CELLS, loss = 100.0 * 1e-6 * CELLS * CELLS;
  assert_true(fabs(rom->heat_capacity / capacity - 1.0) < 1e-12); // sum of equal numbers
  double sum = 0.0; // 1^T K 1 = h A: what a mould 1 K above its surroundings loses, W/K
  for (size_t k = 0; k < rom->r; k++) sum += rom->constant[k] * rom->ambient[k];
  assert_true(fabs(sum / loss - 1.0) < 1e-9);
  assert_string_equal(rom->patch[3].name, "inputs/4");
  rom_destroy(&rom);
}

static void each_form_of_the_files_gives_the_same_rom(void **state)
{
  static const char *const forms[] = {"E: E.mtx, A: A.mtx, B: B.mtx", "E: E.mtx, K: K.mtx, B: B_array.mtx, C: C.mtx",
                                      "E: E.mtx, K: K.mtx, B: B_flux.mtx, inputs: flux"};
  (void)state;
  for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
    char name[16];
    snprintf(name, sizeof name, "form%zu", i);
    RomData *rom = reduce(name, forms[i], 1);
    assert_true(transfer_error(rom) < 1e-4); // as above
    const double area = strstr(forms[i], "flux") ? mould.area : 1.0;
    assert_true(fabs(rom->patch[0].area / area - 1.0) < 1e-12);
    rom_destroy(&rom);
  }
}

static void several_ranks_give_the_same_model(void **state)
{
  (void)state;
  RomData *rom = reduce("ranks", "E: E.mtx, K: K.mtx, B: B.mtx", 3);
  assert_int_equal(rom->provenance.ranks, 3);
  assert_true(transfer_error(rom) < 1e-4); // as above
  rom_destroy(&rom);
}

static void info_and_check_cope_without_geometry(void **state)
{
  (void)state;
  RomData *rom = reduce("plain", "E: E.mtx, K: K.mtx, B: B.mtx", 1);
  rom_destroy(&rom);
  assert_int_equal(run("'%s' info '%s/plain.rom.h5' 2>&1", program, mould_files.folder), 0);
  expect_said("none: the model was reduced from matrices");
  assert_int_equal(run("'%s' check '%s/plain.yaml' 2>&1", program, mould_files.folder), 0);
  expect_said("216 unknowns, 4 inputs");
  expect_said("B.mtx, of watts: each column sums to 1");
  assert_int_equal(
      run("'%s' picture '%s/plain.rom.h5' '%s/plain.png' 2>&1", program, mould_files.folder, mould_files.folder), 1);
  expect_said("castreduce: error: ");
}

/* The CSV's numbers of the row that begins with "method",: states, CPU seconds, share, bytes, error. */
static void read_row(const char *csv, const char *method, double value[5])
{
  const char *at = strstr(csv, method);
  if (!at) fail_msg("no row %s in %s", method, csv);
  const int found =
      sscanf(at + strlen(method), ",%lf,%lf,%lf,%lf,%lf", value, value + 1, value + 2, value + 3, value + 4);
  assert_int_equal(found, 5);
}

static void compare_ranks_the_methods_and_writes_no_rom(void **state)
{
  (void)state;
  double arnoldi[5], modal[5], rational[5], shorter[5];
  mould_files_write(&mould_files, "methods.yaml",
                    "matrices: { E: E.mtx, K: K.mtx, B: B.mtx }\n"
                    "reduction: { times: [10 ms, 100 s], tolerance: 1e-3 }\noutput: { file: methods.rom.h5 }\n");
  if (run("cd '%s' && '%s' compare methods.yaml --quiet 2>&1", mould_files.folder, program) != 0) fail_msg("%s", said);
  expect_said("| arnoldi, q = 3 |");
  char *csv = text_file_read(mould_files_path("methods.compare.csv"));
  read_row(csv, "\"arnoldi, q = 5\"", arnoldi);
  read_row(csv, "\"modal, 20 modes\"", modal);
  read_row(csv, "\"rational\"", rational);
  read_row(csv, "\"rational, early weight\"", shorter);
  free(csv);
  assert_true(arnoldi[0] <= 5 * (M + 1) + 2 && modal[0] == 21); // m inputs and the ambient; modes and the constant
  assert_true(rational[4] <= 1e-3 && shorter[4] <= 1e-3);       // the tolerance asked for
  assert_true(shorter[0] < rational[0]);
  assert_true(modal[4] > rational[4] && arnoldi[4] > rational[4]);
  assert_true(rational[1] > 0.0 && rational[2] > 0.0 && rational[2] < 1.0 && rational[3] > 1e6);
  assert_int_equal(access(mould_files_path("methods.compare.png"), F_OK), 0);
  assert_int_not_equal(access(mould_files_path("methods.rom.h5"), F_OK), 0);
}

static void castrun_refuses_a_rom_without_a_cavity(void **state)
{
  (void)state;
  if (!castrun) skip();
  RomData *rom = reduce("plain", "E: E.mtx, K: K.mtx, B: B.mtx", 1);
  rom_destroy(&rom);
  mould_files_write(
      &mould_files, "cast.yaml",
      "rom: plain.rom.h5\npreheat: 700 degC\nambient: 25 degC\n"
      "melt: { material: cual10, temperature: 1150 degC, blocks: [{ corner: 0 0 0 mm, size: 1 1 1 mm }] }\n"
      "forces: { gravity: 0 0 -9.81 m/s^2 }\ncontact: { h: 2000 W/m^2/K }\nsph: { spacing: 0.2 mm }\ntime: { end: 1 ms "
      "}\n"
      "output: { folder: results, every: 1 ms, curves_every: 1 ms }\n");
  assert_int_equal(run("'%s' check '%s/cast.yaml' 2>&1", castrun, mould_files.folder), 1);
  expect_said("was reduced from matrices and has no geometry: there is no cavity to pour into");
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(matrices_become_a_rom_of_their_transfer_function),
      cmocka_unit_test(each_form_of_the_files_gives_the_same_rom),
      cmocka_unit_test(several_ranks_give_the_same_model),
      cmocka_unit_test(info_and_check_cope_without_geometry),
      cmocka_unit_test(compare_ranks_the_methods_and_writes_no_rom),
      cmocka_unit_test(castrun_refuses_a_rom_without_a_cavity),
  };
  if (argc < 3) return 99;
  program = realpath(argv[1], NULL); // commands change the folder
  if (!program) return 99;
  mpiexec = argv[2];
  castrun = argc > 3 ? argv[3] : NULL;
  return cmocka_run_group_tests(tests, make_files, remove_files);
}
