/* What stands beside the melt's results: the mould's, side files for readers of XDMF, tables. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/io/csv.h"
#include "cast/results/mould_results.h"
#include "tests/support/assert_close.h"
#include "tests/support/assert_ok.h"
#include "tests/support/results_case.h"
#include "tests/support/text_file.h"

/* ---- the mould ---- */

static void the_mould_is_one_mesh_with_a_temperature_for_each_step(void **state)
{
  (void)state;
  CastError err = {0};
  MouldResults *results = NULL;
  RomState *mould = NULL;
  ok(rom_state_create(results_rom, ROM_EXPONENTIAL, 1000.0, 300.0, &mould, &err), &err);
  ok(mould_results_open(casting.folder, results_rom, 0, &results, &err), &err);
  double *q = calloc(results_rom->m, sizeof *q);
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
  long long *cells = results_case_integers(file, "VTKHDF/Polygons/NumberOfCells", 1);
  assert_int_equal(cells[0], results_rom->n_triangles);
  free(cells);
  long long *offsets = results_case_integers(file, "VTKHDF/Polygons/Offsets", results_rom->n_triangles + 1);
  assert_int_equal(offsets[results_rom->n_triangles], 3 * results_rom->n_triangles);
  free(offsets);
  long long *parts = results_case_integers(file, "VTKHDF/Steps/PartOffsets", 3),
            *points = results_case_integers(file, "VTKHDF/Steps/PointOffsets", 3);
  long long *values = results_case_integers(file, "VTKHDF/Steps/PointDataOffsets/temperature", 3);
  for (int s = 0; s < 3; s++) {
    assert_int_equal(parts[s], 0);
    assert_int_equal(points[s], 0);
    assert_int_equal(values[s], s * (long long)results_rom->n_points);
  }
  free(parts);
  free(points);
  free(values);
  float *first = NULL, *last = NULL;
  const long long n = (long long)results_rom->n_points;
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
  Particles p;
  MeltResults *results = results_case_begin(&p);
  results_case_three_steps(results, &p);
  melt_results_close(&results);
  particles_destroy(&p);
  char path[160];
  snprintf(path, sizeof path, "%s/results.xmf", casting.folder);
  char *text = text_file_read(path);
  int grids = 0;
  assert_true(count_elements(text, "Grid", &grids) > 0);
  assert_int_equal(grids, 4);                     // the collection and three steps
  assert_non_null(strstr(text, "48 0 1 1 23 3")); // the points of the last step: start, stride, count
  assert_non_null(strstr(text, "results.vtkhdf:/VTKHDF/PointData/velocity"));
  assert_null(strstr(text, casting.folder)); // relative: the folder may be moved
  free(text);
  snprintf(path, sizeof path, "%s/mould.xmf", casting.folder);
  text = text_file_read(path);
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
  char *text = text_file_read(path);
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
      cmocka_unit_test(the_mould_is_one_mesh_with_a_temperature_for_each_step),
      cmocka_unit_test(side_files_are_well_formed_and_point_at_the_rows_of_each_step),
      cmocka_unit_test(a_table_cut_back_and_continued_equals_one_written_at_once),
  };
  return cmocka_run_group_tests(tests, results_case_set_up, results_case_clean_up);
}
