/* The melt's results: VTKHDF structure as VTK's reader takes it, whatever happens to the file meanwhile. */
#define _GNU_SOURCE // fork, kill, nanosleep
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "cast/results/melt_results.h"
#include "tests/support/assert_close.h"
#include "tests/support/assert_ok.h"
#include "tests/support/results_case.h"

/* What vtkHDFReader computes for one step of PolyData: where it reads each list, and that this is in the file. */
static void check_step(hid_t file, hsize_t n_steps, hsize_t step, long long n_points)
{
  static const char *const kinds[] = {"Vertices", "Lines", "Polygons", "Strips"};
  long long *part = results_case_integers(file, "VTKHDF/Steps/PartOffsets", n_steps),
            *parts = results_case_integers(file, "VTKHDF/Steps/NumberOfParts", n_steps);
  long long *cells_at = results_case_integers(file, "VTKHDF/Steps/CellOffsets", n_steps);
  long long *ids_at = results_case_integers(file, "VTKHDF/Steps/ConnectivityIdOffsets", n_steps);
  assert_int_equal(parts[step], 1);
  for (int k = 0; k < 4; k++) {
    char name[96];
    snprintf(name, sizeof name, "VTKHDF/%s/NumberOfCells", kinds[k]);
    long long *cells = results_case_integers(file, name, n_steps);
    snprintf(name, sizeof name, "VTKHDF/%s/NumberOfConnectivityIds", kinds[k]);
    long long *ids = results_case_integers(file, name, n_steps);
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

static void steps_of_different_length_are_read_as_vtk_reads_them(void **state)
{
  (void)state;
  CastError err = {0};
  Particles p;
  MeltResults *results = results_case_begin(&p);
  results_case_three_steps(results, &p);
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
  long long *values_at = results_case_integers(file, "VTKHDF/Steps/PointDataOffsets/temperature", 3);
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
  Particles p;
  MeltResults *results = results_case_begin(&p);
  results_case_three_steps(results, &p);
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

static void a_file_that_is_cut_back_and_continued_equals_one_written_at_once(void **state)
{
  (void)state;
  CastError err = {0};
  Particles p;
  MeltResults *results = results_case_begin(&p);
  ok(melt_results_append(results, 0.0, &p, &err), &err);
  for (int step = 1; step < 4; step++) ok(melt_results_append(results, 9.0 * step, &p, &err), &err); // to be dropped
  melt_results_close(&results);
  ok(melt_results_open(casting.folder, &results_melt, p.n, 1, &results, &err), &err);
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
  assert_int_equal(melt_results_open(casting.folder, &results_melt, p.n, 7, &(MeltResults *){NULL}, &err),
                   CAST_ERR_FORMAT);
  melt_results_close(&results);
  particles_destroy(&p);
}

/* A reader, ParaView say, has the file open while the run goes on. */
static void a_file_that_somebody_reads_is_still_appended_to(void **state)
{
  (void)state;
  CastError err = {0};
  Particles p;
  MeltResults *results = results_case_begin(&p);
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

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(steps_of_different_length_are_read_as_vtk_reads_them),
      cmocka_unit_test(particles_are_written_in_the_order_of_their_ids),
      cmocka_unit_test(a_file_that_is_cut_back_and_continued_equals_one_written_at_once),
      cmocka_unit_test(a_file_that_somebody_reads_is_still_appended_to),
  };
  return cmocka_run_group_tests(tests, results_case_set_up, results_case_clean_up);
}
