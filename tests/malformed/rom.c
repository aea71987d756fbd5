/* Files that are no ROM, or not any more, are refused with the data set's name; a full disk leaves nothing behind. */
#define _GNU_SOURCE // memmem
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "common/rom/rom_schema.h"
#include "tests/support/full_disk.h"
#include "tests/support/synthetic_rom.h"

static char folder[32], path[64];

static int make_folder(void **state)
{
  (void)state;
  snprintf(folder, sizeof folder, "/tmp/castrom_XXXXXX");
  if (!mkdtemp(folder)) return 1;
  snprintf(path, sizeof path, "%s/a.rom.h5", folder);
  return 0;
}

static int remove_folder(void **state)
{
  (void)state;
  unlink(path);
  return rmdir(folder); // fails if a temporary file is left
}

static void write_rom(void)
{
  CastError err = {0};
  RomData *rom = synthetic_rom_small();
  if (rom_write(rom, path, &err) != CAST_OK) fail_msg("%s", err.message);
  rom_destroy(&rom);
}

static void expect_message(const CastError *err, const char *part)
{
  if (!strstr(err->message, part)) fail_msg("'%s' does not say '%s'", err->message, part);
}

static void expect_refused(CastStatus code, const char *part)
{
  CastError err = {0};
  RomData *rom = NULL;
  const CastStatus status = rom_read(path, &rom, &err);
  assert_null(rom);
  if (status != code) fail_msg("status %d, %d is expected: %s", status, code, err.message);
  expect_message(&err, part);
}

/* --- files: a valid one, changed set by set --- */

static hid_t open_to_spoil(void)
{
  h5_quiet();
  const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
  assert_true(file >= 0);
  return file;
}

static void missing_set_is_named(void **state)
{
  (void)state;
  for (size_t i = 0; i < rom_field_count; i++) {
    char says[128];
    write_rom();
    const hid_t file = open_to_spoil();
    assert_true(H5Ldelete(file, rom_fields[i].name, H5P_DEFAULT) >= 0);
    H5Fclose(file);
    snprintf(says, sizeof says, "data set %s is missing", rom_fields[i].name);
    expect_refused(CAST_ERR_FORMAT, says);
  }
}

/* Put another set in its place: of a wrong rank, or of a kind that the field cannot be. */
static void replace_set(const char *name, hid_t type, int rank)
{
  const hid_t file = open_to_spoil();
  const hsize_t shape[3] = {2, 2, 2};
  const double zeros[8] = {0};
  CastError err = {0};
  assert_true(H5Ldelete(file, name, H5P_DEFAULT) >= 0);
  if (h5_write(file, name, type, rank, shape, zeros, "1", "wrong", &err) != CAST_OK) fail_msg("%s", err.message);
  H5Fclose(file);
}

static void set_of_wrong_rank_or_kind_is_named(void **state)
{
  (void)state;
  for (size_t i = 0; i < rom_field_count; i++) {
    const RomField *field = &rom_fields[i];
    char says[128];
    snprintf(says, sizeof says, "data set %s ", field->name);
    write_rom();
    replace_set(field->name, field->type == ROM_DOUBLE ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT8, 3);
    expect_refused(CAST_ERR_FORMAT, says);
    write_rom();
    replace_set(field->name, field->type == ROM_DOUBLE || field->type == ROM_FLOAT ? H5T_NATIVE_INT8 : H5T_NATIVE_FLOAT,
                field->rank);
    expect_refused(CAST_ERR_FORMAT, says);
  }
}

static void set_of_wrong_shape_is_named_with_where_the_right_one_stands(void **state)
{
  (void)state;
  write_rom();
  replace_set("model/constant", H5T_NATIVE_DOUBLE, 1);
  expect_refused(CAST_ERR_FORMAT, "data set model/constant has 2 states, 33 are expected (from model/lambda)");
  write_rom();
  replace_set("model/B", H5T_NATIVE_DOUBLE, 2);
  expect_refused(CAST_ERR_FORMAT, "data set model/B has 2 states, 33 are expected (from model/lambda)");
  write_rom();
  replace_set("patches/area", H5T_NATIVE_DOUBLE, 1);
  expect_refused(CAST_ERR_FORMAT, "data set patches/area has 2 patches, 6 are expected (from patches/name)");
  write_rom();
  replace_set("geometry/points", H5T_NATIVE_DOUBLE, 2);
  expect_refused(CAST_ERR_FORMAT, "data set geometry/points has 2 coordinates, 3 are expected (from the format)");
}

/* Overwrite one value in place, the checksum left as it was. */
static void spoil_value(const char *name, hid_t type, const void *value)
{
  const hid_t file = open_to_spoil(), set = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(set);
  const hid_t one = H5Screate(H5S_SCALAR);
  const hsize_t first[2] = {0, 0};
  H5Sselect_elements(space, H5S_SELECT_SET, 1, first);
  assert_true(H5Dwrite(set, type, one, space, H5P_DEFAULT, value) >= 0);
  H5Sclose(one);
  H5Sclose(space);
  H5Dclose(set);
  H5Fclose(file);
}

static void changed_value_breaks_the_checksum(void **state)
{
  (void)state;
  for (size_t i = 0; i < rom_field_count; i++) {
    const RomField *field = &rom_fields[i];
    if (field->rank == 0 || rom_memory_type(field->type) < 0 || field->type == ROM_BOOL) continue;
    write_rom();
    spoil_value(field->name, H5T_NATIVE_DOUBLE, &(double){12345.0});
    expect_refused(CAST_ERR_FORMAT, "the checksum of its data sets differs");
  }
  write_rom();
  spoil_value("patches/outer", H5T_NATIVE_UINT8, &(unsigned char){2});
  expect_refused(CAST_ERR_FORMAT, "patches/outer: 2 is neither 0 nor 1");
}

static void replace_attribute(const char *name, const char *text, const int *version)
{
  const hid_t file = open_to_spoil();
  CastError err = {0};
  assert_true(H5Adelete(file, name) >= 0);
  if (text) assert_int_equal(h5_write_text_attribute(file, name, text, &err), CAST_OK);
  if (version) assert_int_equal(h5_write_attribute(file, name, H5T_NATIVE_INT, 2, version, &err), CAST_OK);
  H5Fclose(file);
}

static void foreign_and_newer_formats_are_refused(void **state)
{
  (void)state;
  write_rom();
  replace_attribute("format", "moldrom", NULL);
  expect_refused(CAST_ERR_FORMAT, "its format is 'moldrom', 'castrom' is expected");
  write_rom();
  replace_attribute("format", NULL, NULL);
  expect_refused(CAST_ERR_FORMAT, "is HDF5 but not a ROM file");
  write_rom();
  replace_attribute("version", NULL, (int[2]){2, 0});
  expect_refused(CAST_ERR_FORMAT, "format version 2.0 is newer than 1.0");
  write_rom();
  replace_attribute("version", NULL, (int[2]){1, 7});
  expect_refused(CAST_ERR_FORMAT, "format version 1.7 is newer than 1.0");
  write_rom();
  replace_attribute("version", NULL, (int[2]){0, 3});
  expect_refused(CAST_ERR_FORMAT, "format version 0.3 is impossible");
  write_rom();
  replace_attribute("version", NULL, NULL);
  expect_refused(CAST_ERR_FORMAT, "attribute version of / is missing");
  write_rom();
  replace_attribute("checksum", NULL, NULL);
  expect_refused(CAST_ERR_FORMAT, "attribute checksum of / is missing");
  write_rom();
  replace_attribute("checksum", "0000", NULL);
  expect_refused(CAST_ERR_FORMAT, "the checksum of its data sets differs");
}

/* --- bytes --- */

static unsigned char *load_bytes(size_t *n)
{
  FILE *stream = fopen(path, "rb");
  assert_non_null(stream);
  fseek(stream, 0, SEEK_END);
  *n = (size_t)ftell(stream);
  rewind(stream);
  unsigned char *bytes = malloc(*n);
  assert_non_null(bytes);
  assert_int_equal(fread(bytes, 1, *n, stream), *n);
  fclose(stream);
  return bytes;
}

static void store_bytes(const unsigned char *bytes, size_t n)
{
  FILE *stream = fopen(path, "wb");
  assert_non_null(stream);
  assert_int_equal(fwrite(bytes, 1, n, stream), n);
  fclose(stream);
}

static void truncated_file_is_refused_at_any_length(void **state)
{
  (void)state;
  size_t n = 0;
  write_rom();
  unsigned char *bytes = load_bytes(&n);
  for (size_t part = 0; part < 64; part++) {
    const size_t length = part * n / 64;
    store_bytes(bytes, length);
    expect_refused(CAST_ERR_FORMAT, length == 0 ? "is empty" : "");
  }
  store_bytes(bytes, n - 1);
  expect_refused(CAST_ERR_FORMAT, "damaged or truncated");
  free(bytes);
}

static void flipped_payload_byte_is_found(void **state)
{
  (void)state;
  size_t n = 0;
  write_rom();
  RomData *rom = synthetic_rom_small();
  unsigned char *bytes = load_bytes(&n);
  // lambda is stored as it is in memory, so its bytes can be found in the file
  unsigned char *found = memmem(bytes, n, rom->lambda, rom->r * sizeof(double));
  assert_non_null(found);
  found[3] ^= 1; // a small change of the first value: still ascending and positive
  store_bytes(bytes, n);
  expect_refused(CAST_ERR_FORMAT, "the checksum of its data sets differs");
  free(bytes);
  rom_destroy(&rom);
}

static void flipped_byte_anywhere_is_found_or_harmless(void **state)
{
  (void)state;
  size_t n = 0, refused = 0, tried = 0;
  write_rom();
  unsigned char *bytes = load_bytes(&n);
  for (size_t at = 0; at < n; at += n / 400 + 1, tried++) {
    CastError err = {0};
    RomData *rom = NULL;
    bytes[at] ^= 0x10;
    store_bytes(bytes, n);
    if (rom_read(path, &rom, &err) != CAST_OK) refused++; // else the byte lies where nothing is stored
    rom_destroy(&rom);
    bytes[at] ^= 0x10;
  }
  free(bytes);
  print_message("%zu of %zu flipped bytes refused\n", refused, tried);
  assert_true(refused > tried / 2);
}

static void files_that_are_no_rom_are_refused(void **state)
{
  (void)state;
  store_bytes((const unsigned char *)"mesh:\n  size: 1 mm\n", 19);
  expect_refused(CAST_ERR_FORMAT, "is not an HDF5 file");
  unlink(path);
  expect_refused(CAST_ERR_IO, "No such file or directory");
}

/* --- writing --- */

static void path_that_cannot_be_written_is_refused(void **state)
{
  (void)state;
  CastError err = {0};
  RomData *rom = synthetic_rom_small();
  assert_int_equal(rom_write(rom, folder, &err), CAST_ERR_IO);
  expect_message(&err, "is a directory");
  assert_int_equal(rom_write(rom, "/nonexistent/a.rom.h5", &err), CAST_ERR_IO);
  expect_message(&err, "No such file or directory");
  if (geteuid() != 0) {
    chmod(folder, 0500);
    assert_int_equal(rom_write(rom, path, &err), CAST_ERR_IO);
    expect_message(&err, "Permission denied");
    chmod(folder, 0700);
  }
  assert_int_equal(access(path, F_OK), -1);
  rom_destroy(&rom);
}

static void full_disk_leaves_the_old_file_and_no_temporary(void **state)
{
  (void)state;
  write_rom();
  RomData *rom = synthetic_rom_small(), *again = NULL;
  int failures = 0;
  for (int good = 0; good < 400; good++) {
    CastError err = {0};
    disk_fill_after(good);
    const CastStatus status = rom_write(rom, path, &err);
    const bool filled = disk_was_full();
    disk_empty();
    assert_int_equal(status, filled ? CAST_ERR_IO : CAST_OK);
    if (!filled) break;
    expect_message(&err, "No space left on device");
    assert_int_equal(rom_read(path, &again, &err), CAST_OK); // the old one
    rom_destroy(&again);
    failures++;
  }
  print_message("%d places for the disk to fill\n", failures);
  assert_in_range(failures, 3, 399);
  rom_destroy(&rom);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, make_folder, remove_folder)

int main(void)
{
  const struct CMUnitTest tests[] = {
      IN_FOLDER(missing_set_is_named),
      IN_FOLDER(set_of_wrong_rank_or_kind_is_named),
      IN_FOLDER(set_of_wrong_shape_is_named_with_where_the_right_one_stands),
      IN_FOLDER(changed_value_breaks_the_checksum),
      IN_FOLDER(foreign_and_newer_formats_are_refused),
      IN_FOLDER(truncated_file_is_refused_at_any_length),
      IN_FOLDER(flipped_payload_byte_is_found),
      IN_FOLDER(flipped_byte_anywhere_is_found_or_harmless),
      IN_FOLDER(files_that_are_no_rom_are_refused),
      IN_FOLDER(path_that_cannot_be_written_is_refused),
      IN_FOLDER(full_disk_leaves_the_old_file_and_no_temporary),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
