/* The HDF5 helpers: what is written comes back, what is not as expected is refused with its name. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "common/h5/h5.h"
#include "tests/support/assert_ok.h"
#include "tests/support/full_disk.h"

static char path[64];

static int make_path(void **state)
{
  (void)state;
  snprintf(path, sizeof path, "/tmp/h5_XXXXXX");
  const int descriptor = mkstemp(path);
  if (descriptor >= 0) close(descriptor);
  return descriptor < 0;
}

static int remove_path(void **state)
{
  (void)state;
  return unlink(path);
}

static void expect_message(const CastError *err, const char *part)
{
  if (!strstr(err->message, part)) fail_msg("'%s' does not say '%s'", err->message, part);
}

static void arrays_of_each_rank_come_back(void **state)
{
  (void)state;
  CastError err = {0};
  hid_t file = -1;
  double *values = malloc(30000 * sizeof *values), scalar = 2.5;
  assert_non_null(values);
  for (int i = 0; i < 30000; i++) values[i] = 1.0 / (1.0 + i);
  const hsize_t shapes[4][3] = {{0}, {30000}, {100, 300}, {10, 30, 100}};
  ok(h5_file_create(path, &file, &err), &err);
  ok(h5_write(file, "a/scalar", H5T_NATIVE_DOUBLE, 0, NULL, &scalar, "m", "one", &err), &err);
  const char *names[] = {"", "a/one", "a/two", "b/three"};
  for (int rank = 1; rank <= 3; rank++)
    ok(h5_write(file, names[rank], H5T_NATIVE_DOUBLE, rank, shapes[rank], values, "m", "many", &err), &err);
  ok(h5_file_close(&file, &err), &err);
  assert_int_equal(file, -1);
  ok(h5_file_open(path, &file, &err), &err);
  for (int rank = 1; rank <= 3; rank++) {
    hsize_t shape[3] = {0, 0, 0};
    void *data = NULL;
    ok(h5_read(file, names[rank], H5T_NATIVE_DOUBLE, rank, shape, &data, &err), &err);
    for (int d = 0; d < rank; d++) assert_int_equal(shape[d], shapes[rank][d]);
    assert_memory_equal(data, values, 30000 * sizeof *values);
    free(data);
  }
  void *data = NULL;
  ok(h5_read(file, "a/scalar", H5T_NATIVE_DOUBLE, 0, NULL, &data, &err), &err);
  assert_memory_equal(data, &scalar, sizeof scalar);
  free(data);
  assert_true(h5_exists(file, "b/three"));
  assert_false(h5_exists(file, "c/three"));
  ok(h5_file_close(&file, &err), &err);
  free(values);
}

static void texts_names_and_attributes_come_back(void **state)
{
  (void)state;
  CastError err = {0};
  hid_t file = -1;
  const char names[3][H5_NAME_LENGTH] = {"first", "", "a third one"};
  const int numbers[2] = {3, -4};
  ok(h5_file_create(path, &file, &err), &err);
  ok(h5_write_text(file, "text",
                   "two\nlines \xc2\xb0"
                   "C",
                   "a text", &err),
     &err);
  ok(h5_write_text(file, "nothing", "", "an empty text", &err), &err);
  ok(h5_write_names(file, "names", 3, names[0], "names", &err), &err);
  ok(h5_write_attribute(file, "numbers", H5T_NATIVE_INT, 2, numbers, &err), &err);
  ok(h5_write_text_attribute(file, "word", "PolyData", &err), &err);
  ok(h5_file_close(&file, &err), &err);
  ok(h5_file_open(path, &file, &err), &err);
  char *text = NULL;
  ok(h5_read_text(file, "text", &text, &err), &err);
  assert_string_equal(text, "two\nlines \xc2\xb0"
                            "C");
  free(text);
  ok(h5_read_text(file, "nothing", &text, &err), &err);
  assert_string_equal(text, "");
  free(text);
  size_t n = 0;
  ok(h5_read_names(file, "names", &n, &text, &err), &err);
  assert_int_equal(n, 3);
  assert_memory_equal(text, names, sizeof names);
  free(text);
  int again[2] = {0, 0};
  ok(h5_read_attribute(file, "numbers", H5T_NATIVE_INT, 2, again, &err), &err);
  assert_memory_equal(again, numbers, sizeof numbers);
  ok(h5_read_text_attribute(file, "word", &text, &err), &err);
  assert_string_equal(text, "PolyData");
  free(text);
  ok(h5_file_close(&file, &err), &err);
}

static void what_is_not_as_expected_is_refused_by_name(void **state)
{
  (void)state;
  CastError err = {0};
  hid_t file = -1;
  const double values[6] = {1, 2, 3, 4, 5, 6};
  const hsize_t shape[2] = {2, 3};
  void *data = NULL;
  char *text = NULL;
  ok(h5_file_create(path, &file, &err), &err);
  ok(h5_write(file, "g/table", H5T_NATIVE_DOUBLE, 2, shape, values, "K", "values", &err), &err);
  hsize_t found[3] = {0, 4, 0};
  assert_int_equal(h5_read(file, "g/table", H5T_NATIVE_DOUBLE, 2, found, &data, &err), CAST_ERR_FORMAT);
  expect_message(&err, "g/table has 3 entries along dimension 1, 4 are expected");
  assert_null(data);
  assert_int_equal(h5_read(file, "g/table", H5T_NATIVE_DOUBLE, 1, found, &data, &err), CAST_ERR_FORMAT);
  expect_message(&err, "has rank 2, 1 is expected");
  hsize_t any[2] = {0, 0};
  assert_int_equal(h5_read(file, "g/table", H5T_NATIVE_INT, 2, any, &data, &err), CAST_ERR_FORMAT);
  expect_message(&err, "holds floating-point numbers");
  assert_int_equal(h5_read(file, "g/table", H5T_NATIVE_FLOAT, 2, any, &data, &err), CAST_ERR_FORMAT);
  assert_int_equal(h5_read(file, "g/chair", H5T_NATIVE_DOUBLE, 2, any, &data, &err), CAST_ERR_FORMAT);
  expect_message(&err, "g/chair is missing");
  assert_int_equal(h5_read_text(file, "g/table", &text, &err), CAST_ERR_FORMAT);
  assert_int_equal(h5_read_text_attribute(file, "colour", &text, &err), CAST_ERR_FORMAT);
  expect_message(&err, "attribute colour of / is missing");
  assert_int_equal(h5_write(file, "g/table", H5T_NATIVE_DOUBLE, 2, shape, values, "K", "again", &err), CAST_ERR_IO);
  expect_message(&err, "g/table cannot be written");
  ok(h5_file_close(&file, &err), &err);
}

static void set_that_claims_more_than_the_file_holds_costs_no_memory(void **state)
{
  (void)state;
  CastError err = {0};
  hid_t file = -1;
  ok(h5_file_create(path, &file, &err), &err);
  const hsize_t shape[2] = {1u << 20, 1u << 20}, chunk[2] = {1024, 1024};
  const hid_t space = H5Screate_simple(2, shape, NULL), list = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(list, 2, chunk);
  H5Dclose(H5Dcreate2(file, "huge", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, list, H5P_DEFAULT));
  H5Sclose(space);
  H5Pclose(list);
  hsize_t found[2] = {0, 0};
  void *data = NULL;
  assert_int_equal(h5_read(file, "huge", H5T_NATIVE_DOUBLE, 2, found, &data, &err), CAST_ERR_FORMAT);
  expect_message(&err, "huge claims 8796093022208 bytes, but the file holds only 0");
  ok(h5_file_close(&file, &err), &err);
}

static void foreign_and_missing_files_are_told_apart(void **state)
{
  (void)state;
  CastError err = {0};
  hid_t file = -1;
  assert_int_equal(h5_file_open("/nonexistent/a.h5", &file, &err), CAST_ERR_IO);
  expect_message(&err, "No such file or directory");
  assert_int_equal(h5_file_open("/tmp", &file, &err), CAST_ERR_IO);
  expect_message(&err, "is a directory");
  assert_int_equal(h5_file_open(path, &file, &err), CAST_ERR_FORMAT);
  expect_message(&err, "is empty");
  FILE *stream = fopen(path, "w");
  assert_non_null(stream);
  fputs("solid cube\nfacet normal 0 0 1\n", stream);
  fclose(stream);
  assert_int_equal(h5_file_open(path, &file, &err), CAST_ERR_FORMAT);
  expect_message(&err, "is not an HDF5 file");
  assert_int_equal(h5_file_create("/nonexistent/a.h5", &file, &err), CAST_ERR_IO);
  expect_message(&err, "No such file or directory");
}

static void full_disk_is_told_with_the_systems_reason(void **state)
{
  (void)state;
  enum { N = 1 << 18 };
  unsigned *noise = malloc(N * sizeof *noise), seed = 1;
  assert_non_null(noise);
  for (size_t i = 0; i < N; i++) noise[i] = seed = seed * 1664525u + 1013904223u;
  const hsize_t shape[1] = {N};
  int failures = 0;
  for (int good = 0; good < 12; good++) { // the first so many writes succeed
    CastError err = {0};
    hid_t file = -1;
    disk_fill_after(good);
    CastStatus status = h5_file_create(path, &file, &err);
    for (int set = 0; set < 3 && status == CAST_OK; set++)
      status = h5_write(file,
                        set == 0   ? "a"
                        : set == 1 ? "b"
                                   : "c",
                        H5T_NATIVE_UINT, 1, shape, noise, "1", "noise", &err);
    const CastStatus closed = h5_file_close(&file, status == CAST_OK ? &err : NULL);
    const bool filled = disk_was_full();
    disk_empty();
    if (status == CAST_OK) status = closed;
    assert_int_equal(file, -1);
    assert_int_equal(status, filled ? CAST_ERR_IO : CAST_OK);
    if (filled) expect_message(&err, "No space left on device");
    failures += filled;
  }
  assert_true(failures >= 4); // each of the sets takes a write at least
  free(noise);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(arrays_of_each_rank_come_back, make_path, remove_path),
      cmocka_unit_test_setup_teardown(texts_names_and_attributes_come_back, make_path, remove_path),
      cmocka_unit_test_setup_teardown(what_is_not_as_expected_is_refused_by_name, make_path, remove_path),
      cmocka_unit_test_setup_teardown(set_that_claims_more_than_the_file_holds_costs_no_memory, make_path, remove_path),
      cmocka_unit_test_setup_teardown(foreign_and_missing_files_are_told_apart, make_path, remove_path),
      cmocka_unit_test_setup_teardown(full_disk_is_told_with_the_systems_reason, make_path, remove_path),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
