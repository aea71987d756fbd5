/* Files that a run writes: VTKHDF structure as VTK's reader takes it, side files, tables. */
#define _GNU_SOURCE // fork, kill, nanosleep
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "cast/io/csv.h"
#include "cast/io/melt_results.h"
#include "cast/io/mould_results.h"
#include "cast/geometry/placement.h"
#include "tests/support/assert_close.h"
#include "tests/support/assert_ok.h"
#include "tests/support/cast_case.h"
#include "tests/support/lattice_melt.h"

static RomData *rom; // of the case
static Material melt;

static CastStatus read_melt(CastError *err)
{
  YamlInput *input = NULL;
  CAST_CALL(yaml_input_parse("material: cual10\n", "test", &input, err));
  const CastStatus status = material_read(yaml_get(yaml_root(input), "material"), &melt, err);
  yaml_input_destroy(&input);
  return status;
}

static int set_up(void **state)
{
  (void)state;
  CastError err = {0};
  char path[128];
  CastStatus status = cast_case_create(&casting, &err);
  snprintf(path, sizeof path, "%s/mould.rom.h5", casting.folder);
  if (status == CAST_OK) status = rom_read(path, &rom, &err);
  if (status == CAST_OK) status = read_melt(&err);
  if (status != CAST_OK) fprintf(stderr, "%s\n", err.message);
  return status != CAST_OK;
}

static int clean_up(void **state)
{
  (void)state;
  material_destroy(&melt);
  rom_destroy(&rom);
  cast_case_remove(&casting);
  return 0;
}

/* ---- VTKHDF ---- */

static long long *integers(hid_t file, const char *name, hsize_t expected)
{
  CastError err = {0};
  hsize_t shape[2] = {expected, 0};
  void *values = NULL;
  const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
  assert_true(set >= 0);
  const hid_t space = H5Dget_space(set);
  const int rank = H5Sget_simple_extent_ndims(space);
  H5Sclose(space);
  H5Dclose(set);
  ok(h5_read(file, name, H5T_NATIVE_LLONG, rank, shape, &values, &err), &err);
  assert_true(shape[0] == expected);
  return values;
}

/* What vtkHDFReader computes for one step of PolyData: where it reads each list, and that this is in the file. */
static void check_step(hid_t file, hsize_t n_steps, hsize_t step, long long n_points)
{
  static const char *const kinds[] = {"Vertices", "Lines", "Polygons", "Strips"};
  long long *part = integers(file, "VTKHDF/Steps/PartOffsets", n_steps),
            *parts = integers(file, "VTKHDF/Steps/NumberOfParts", n_steps);
  long long *cells_at = integers(file, "VTKHDF/Steps/CellOffsets", n_steps);
  long long *ids_at = integers(file, "VTKHDF/Steps/ConnectivityIdOffsets", n_steps);
  assert_int_equal(parts[step], 1);
  for (int k = 0; k < 4; k++) {
    char name[96];
    snprintf(name, sizeof name, "VTKHDF/%s/NumberOfCells", kinds[k]);
    long long *cells = integers(file, name, n_steps);
    snprintf(name, sizeof name, "VTKHDF/%s/NumberOfConnectivityIds", kinds[k]);
    long long *ids = integers(file, name, n_steps);
    const long long n = cells[part[step]];
    assert_int_equal(n, k == 0 ? n_points : 0);
    assert_int_equal(ids[part[step]], n);
    hsize_t rows = 0;
    CastError err = {0};
    void *read = NULL;
    snprintf(name, sizeof name, "VTKHDF/%s/Offsets", kinds[k]);
    ok(h5_read(file, name, H5T_NATIVE_LLONG, 1, &rows, &read, &err), &err);
    const long long *offsets = (long long *)read + cells_at[4 * step + (hsize_t)k];
    assert_true((hsize_t)(cells_at[4 * step + (hsize_t)k] + n + 1) <= rows); // n + 1 offsets are read
    assert_int_equal(offsets[0], 0);
    assert_int_equal(offsets[n], n);
    free(read);
    if (n > 0) {
      snprintf(name, sizeof name, "VTKHDF/%s/Connectivity", kinds[k]);
      rows = 0;
      ok(h5_read(file, name, H5T_NATIVE_LLONG, 1, &rows, &read, &err), &err);
      const long long *connectivity = (long long *)read + ids_at[4 * step + (hsize_t)k];
      for (long long i = 0; i < n; i++) assert_int_equal(connectivity[i], i); // vertex i is point i of the step
      free(read);
    }
    free(cells);
    free(ids);
  }
  free(part);
  free(parts);
  free(cells_at);
  free(ids_at);
}

/* Three steps with 24, 24 and 23 particles: one leaves. Particles are shuffled, as the neighbour search does. */
static void write_three_steps(MeltResults *results, Particles *p)
{
  CastError err = {0};
  for (int step = 0; step < 3; step++) {
    for (ptrdiff_t i = 0; i + 1 < p->n_fluid; i += 2) {
      const int32_t id = p->id[i];
      const double x = p->x[0][i], T = p->T[i];
      p->id[i] = p->id[i + 1], p->x[0][i] = p->x[0][i + 1], p->T[i] = p->T[i + 1];
      p->id[i + 1] = id, p->x[0][i + 1] = x, p->T[i + 1] = T;
    }
    if (step == 2) p->n = --p->n_fluid;
    ok(melt_results_append(results, 0.5 * step, p, &err), &err);
  }
}

static void steps_of_different_length_are_read_as_vtk_reads_them(void **state)
{
  (void)state;
  CastError err = {0};
  const double corner[3] = {0, 0, 0};
  Particles p = lattice_melt(corner, (const int[3]){4, 3, 2}, 1e-3);
  MeltResults *results = NULL;
  ok(melt_results_open(casting.folder, &melt, p.n, 0, &results, &err), &err);
  write_three_steps(results, &p);
  hid_t file = -1;
  ok(h5_file_open(melt_results_path(results), &file, &err), &err); // open while the run goes on
  long long version[2];
  char *type = NULL;
  const hid_t root = H5Gopen2(file, "VTKHDF", H5P_DEFAULT);
  ok(h5_read_attribute(root, "Version", H5T_NATIVE_LLONG, 2, version, &err), &err);
  ok(h5_read_text_attribute(root, "Type", &type, &err), &err);
  assert_int_equal(version[0], 2);
  assert_string_equal(type, "PolyData");
  free(type);
  H5Gclose(root);
  size_t n_steps = 0;
  VtkStep *steps = NULL;
  ok(vtk_series_read_steps(file, &n_steps, &steps, &err), &err);
  assert_int_equal(n_steps, 3);
  const long long n_points[] = {24, 24, 23}, first[] = {0, 24, 48};
  long long *values_at = integers(file, "VTKHDF/Steps/PointDataOffsets/temperature", 3);
  for (hsize_t s = 0; s < 3; s++) {
    assert_int_equal(steps[s].n_points, n_points[s]);
    assert_int_equal(steps[s].first_point, first[s]);
    assert_int_equal(values_at[s], first[s]);
    assert_close(steps[s].time, 0.5 * (double)s, 0.0);
    check_step(file, 3, s, n_points[s]);
  }
  free(values_at);
  free(steps);
  h5_file_close(&file, &err);
  melt_results_close(&results);
  particles_destroy(&p);
}

static void particles_are_written_in_the_order_of_their_ids(void **state)
{
  (void)state;
  CastError err = {0};
  const double corner[3] = {0, 0, 0};
  Particles p = lattice_melt(corner, (const int[3]){4, 3, 2}, 1e-3);
  MeltResults *results = NULL;
  ok(melt_results_open(casting.folder, &melt, p.n, 0, &results, &err), &err);
  write_three_steps(results, &p);
  hid_t file = -1;
  ok(h5_file_open(melt_results_path(results), &file, &err), &err);
  float *id = NULL, *x = NULL, *T = NULL;
  ok(vtk_series_read_rows(file, "PointData/id", 24, 24, 1, &id, &err), &err);
  ok(vtk_series_read_rows(file, "Points", 24, 24, 3, &x, &err), &err);
  ok(vtk_series_read_rows(file, "PointData/temperature", 24, 24, 1, &T, &err), &err);
  for (int i = 0; i < 24; i++) {
    assert_close((double)id[i], i, 0.0);
    assert_close((double)T[i], 1300.0 + 1e4 * (double)x[3 * i], 1e-3); // a particle's values stay together
  }
  free(id);
  free(x);
  free(T);
  assert_int_equal(vtk_series_read_rows(file, "PointData/temperature", 60, 24, 1, &T, &err), CAST_ERR_FORMAT);
  h5_file_close(&file, &err);
  melt_results_close(&results);
  particles_destroy(&p);
}

static char *whole_file(const char *path)
{
  FILE *file = fopen(path, "rb");
  if (!file) fail_msg("there is no %s", path);
  char *text = calloc(1 << 21, 1);
  assert_non_null(text);
  assert_true(fread(text, 1, (1 << 21) - 1, file) > 0);
  fclose(file);
  return text;
}

static void a_file_that_is_cut_back_and_continued_equals_one_written_at_once(void **state)
{
  (void)state;
  CastError err = {0};
  const double corner[3] = {0, 0, 0};
  Particles p = lattice_melt(corner, (const int[3]){4, 3, 2}, 1e-3);
  MeltResults *results = NULL;
  ok(melt_results_open(casting.folder, &melt, p.n, 0, &results, &err), &err);
  ok(melt_results_append(results, 0.0, &p, &err), &err);
  for (int step = 1; step < 4; step++) ok(melt_results_append(results, 9.0 * step, &p, &err), &err); // to be dropped
  melt_results_close(&results);
  ok(melt_results_open(casting.folder, &melt, p.n, 1, &results, &err), &err);
  p.T[5] = 1234.5;
  ok(melt_results_append(results, 0.25, &p, &err), &err);
  hid_t file = -1;
  size_t n_steps = 0;
  VtkStep *steps = NULL;
  ok(h5_file_open(melt_results_path(results), &file, &err), &err);
  ok(vtk_series_read_steps(file, &n_steps, &steps, &err), &err);
  assert_int_equal(n_steps, 2);
  assert_close(steps[1].time, 0.25, 0.0);
  assert_int_equal(steps[1].first_value, 24);
  check_step(file, 2, 1, 24);
  float *T = NULL;
  ok(vtk_series_read_rows(file, "PointData/temperature", 24, 24, 1, &T, &err), &err);
  assert_close((double)T[5], 1234.5, 1e-3);
  free(T);
  free(steps);
  h5_file_close(&file, &err);
  assert_int_equal(melt_results_open(casting.folder, &melt, p.n, 7, &(MeltResults *){NULL}, &err), CAST_ERR_FORMAT);
  melt_results_close(&results);
  particles_destroy(&p);
}

/* A reader, ParaView say, has the file open while the run goes on. */
static void a_file_that_somebody_reads_is_still_appended_to(void **state)
{
  (void)state;
  CastError err = {0};
  const double corner[3] = {0, 0, 0};
  Particles p = lattice_melt(corner, (const int[3]){4, 3, 2}, 1e-3);
  MeltResults *results = NULL;
  ok(melt_results_open(casting.folder, &melt, p.n, 0, &results, &err), &err);
  ok(melt_results_append(results, 0.0, &p, &err), &err);
  const pid_t reader = fork(); // another process: HDF5 would share the file within one
  assert_true(reader >= 0);
  if (reader == 0) {
    const bool opened = H5Fopen(melt_results_path(results), H5F_ACC_RDONLY, H5P_DEFAULT) >= 0;
    if (opened) pause();
    _exit(1);
  }
  nanosleep(&(struct timespec){0, 300000000}, NULL);   // let it open the file
  assert_int_equal(waitpid(reader, NULL, WNOHANG), 0); // it has
  const CastStatus status = melt_results_append(results, 1.0, &p, &err);
  kill(reader, SIGKILL);
  waitpid(reader, NULL, 0);
  ok(status, &err);
  assert_int_equal(melt_results_n_steps(results), 2);
  melt_results_close(&results);
  particles_destroy(&p);
}

/* ---- the mould ---- */

static void the_mould_is_one_mesh_with_a_temperature_for_each_step(void **state)
{
  (void)state;
  CastError err = {0};
  MouldResults *results = NULL;
  RomState *mould = NULL;
  ok(rom_state_create(rom, ROM_EXPONENTIAL, 1000.0, 300.0, &mould, &err), &err);
  ok(mould_results_open(casting.folder, rom, 0, &results, &err), &err);
  double *q = calloc(rom->m, sizeof *q);
  assert_non_null(q);
  q[0] = 5.0;
  for (int step = 0; step < 3; step++) {
    ok(mould_results_append(results, step, mould, &err), &err);
    rom_state_step(mould, q, 0.1);
  }
  char path[160];
  snprintf(path, sizeof path, "%s/mould.vtkhdf", casting.folder);
  hid_t file = -1;
  ok(h5_file_open(path, &file, &err), &err);
  long long *cells = integers(file, "VTKHDF/Polygons/NumberOfCells", 1);
  assert_int_equal(cells[0], rom->n_triangles);
  free(cells);
  long long *offsets = integers(file, "VTKHDF/Polygons/Offsets", rom->n_triangles + 1);
  assert_int_equal(offsets[rom->n_triangles], 3 * rom->n_triangles);
  free(offsets);
  long long *parts = integers(file, "VTKHDF/Steps/PartOffsets", 3),
            *points = integers(file, "VTKHDF/Steps/PointOffsets", 3);
  long long *values = integers(file, "VTKHDF/Steps/PointDataOffsets/temperature", 3);
  for (int s = 0; s < 3; s++) {
    assert_int_equal(parts[s], 0);
    assert_int_equal(points[s], 0);
    assert_int_equal(values[s], s * (long long)rom->n_points);
  }
  free(parts);
  free(points);
  free(values);
  float *first = NULL, *last = NULL;
  const long long n = (long long)rom->n_points;
  ok(vtk_series_read_rows(file, "PointData/temperature", 0, n, 1, &first, &err), &err);
  ok(vtk_series_read_rows(file, "PointData/temperature", 2 * n, n, 1, &last, &err), &err);
  float warmest = 0.0f;
  for (long long i = 0; i < n; i++) {
    assert_close((double)first[i], 1000.0, 1e-3);
    if (last[i] > warmest) warmest = last[i];
  }
  assert_true((double)warmest > 1000.1); // 5 W for 0.2 s on one patch
  free(first);
  free(last);
  free(q);
  h5_file_close(&file, &err);
  mould_results_close(&results);
  rom_state_destroy(&mould);
}

/* ---- XML ---- */

/* Are all tags closed in order, with quoted attributes? Returns how many elements there are; -1 if not. */
static int count_elements(const char *text, const char *name, int *named)
{
  char open[64][64];
  int depth = 0, elements = 0;
  for (const char *at = strchr(text, '<'); at; at = strchr(at, '<')) {
    const char *end = strchr(at, '>');
    if (!end) return -1;
    int quotes = 0;
    for (const char *c = at; c < end; c++) quotes += *c == '"';
    if (quotes % 2 != 0) return -1;
    char tag[64] = "";
    sscanf(at + 1, "%63[/?A-Za-z]", tag);
    if (tag[0] == '/') {
      if (depth == 0 || strcmp(open[--depth], tag + 1) != 0) return -1;
    } else if (tag[0] != '?') {
      elements++;
      if (strcmp(tag, name) == 0) ++*named;
      if (end[-1] != '/') {
        if (depth == 64) return -1;
        snprintf(open[depth++], sizeof open[0], "%s", tag);
      }
    }
    at = end;
  }
  return depth == 0 ? elements : -1;
}

static void side_files_are_well_formed_and_point_at_the_rows_of_each_step(void **state)
{
  (void)state;
  CastError err = {0};
  const double corner[3] = {0, 0, 0};
  Particles p = lattice_melt(corner, (const int[3]){4, 3, 2}, 1e-3);
  MeltResults *results = NULL;
  ok(melt_results_open(casting.folder, &melt, p.n, 0, &results, &err), &err);
  write_three_steps(results, &p);
  melt_results_close(&results);
  particles_destroy(&p);
  char path[160];
  snprintf(path, sizeof path, "%s/results.xmf", casting.folder);
  char *text = whole_file(path);
  int grids = 0;
  assert_true(count_elements(text, "Grid", &grids) > 0);
  assert_int_equal(grids, 4);                     // the collection and three steps
  assert_non_null(strstr(text, "48 0 1 1 23 3")); // the points of the last step: start, stride, count
  assert_non_null(strstr(text, "results.vtkhdf:/VTKHDF/PointData/velocity"));
  assert_null(strstr(text, casting.folder)); // relative: the folder may be moved
  free(text);
  snprintf(path, sizeof path, "%s/mould.xmf", casting.folder);
  text = whole_file(path);
  grids = 0;
  assert_true(count_elements(text, "Grid", &grids) > 0);
  assert_int_equal(grids, 1 + 3 * 3); // each step a collection of surface and band
  free(text);
}

/* ---- tables ---- */

static void a_table_cut_back_and_continued_equals_one_written_at_once(void **state)
{
  (void)state;
  CastError err = {0};
  Provenance provenance;
  provenance_collect("test", &provenance);
  char path[160];
  snprintf(path, sizeof path, "%s/table.csv", casting.folder);
  CsvFile *csv = NULL;
  ok(csv_create(path, "a table", "a,b", &provenance, &csv, &err), &err);
  csv_number(csv, 1.0 / 3.0);
  csv_number(csv, NAN);
  ok(csv_end_row(csv, &err), &err);
  const long length = csv_length(csv);
  csv_number(csv, 7.0); // a row that is not finished does not count
  csv_close(&csv);
  ok(csv_reopen(path, length, &csv, &err), &err);
  csv_number(csv, 2.0);
  csv_word(csv, "word");
  ok(csv_end_row(csv, &err), &err);
  csv_close(&csv);
  char *text = whole_file(path);
  assert_true(strncmp(text, "# a table\n# program: castrun ", 29) == 0);
  const char *rows = strstr(text, "\na,b\n");
  assert_non_null(rows);
  assert_string_equal(rows, "\na,b\n0.333333333,\n2,word\n");
  free(text);
  assert_int_equal(csv_reopen(path, 1000000, &csv, &err), CAST_ERR_FORMAT);
  provenance_release(&provenance);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(steps_of_different_length_are_read_as_vtk_reads_them),
      cmocka_unit_test(particles_are_written_in_the_order_of_their_ids),
      cmocka_unit_test(a_file_that_is_cut_back_and_continued_equals_one_written_at_once),
      cmocka_unit_test(a_file_that_somebody_reads_is_still_appended_to),
      cmocka_unit_test(the_mould_is_one_mesh_with_a_temperature_for_each_step),
      cmocka_unit_test(side_files_are_well_formed_and_point_at_the_rows_of_each_step),
      cmocka_unit_test(a_table_cut_back_and_continued_equals_one_written_at_once),
  };
  return cmocka_run_group_tests(tests, set_up, clean_up);
}
