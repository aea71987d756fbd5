/* h5.c - data sets and attributes. */
#include "common/h5/h5.h"
#include "common/h5/h5_private.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { SMALL_SET = 4096, CHUNK_BYTES = 1 << 20, DEFLATE_LEVEL = 4 };
static const hsize_t LARGEST_TEXT = 64u << 20;

/* An error that quotes HDF5's reason. */
static CastStatus set_failed(hid_t group, const char *name, const char *action, CastStatus code, CastError *err)
{
  char path[4096], reason[512];
  const bool system = h5_reason(reason, sizeof reason);
  h5_file_name(group, path, sizeof path);
  if (system && code == CAST_ERR_IO) h5_abandon(group);
  return cast_error_set(err, code, "%s: data set %s cannot be %s: %s", path, name, action, reason);
}

static CastStatus set_refused(hid_t group, const char *name, const char *fault, CastError *err)
{
  char path[4096];
  h5_file_name(group, path, sizeof path);
  return cast_error_set(err, CAST_ERR_FORMAT, "%s: data set %s %s", path, name, fault);
}

/* Whole rows, about a megabyte of them; a row longer than that is cut. */
static void choose_chunk(int rank, const hsize_t *shape, size_t size, hsize_t *chunk)
{
  hsize_t left = CHUNK_BYTES / size;
  for (int d = rank - 1; d >= 0; d--) {
    chunk[d] = shape[d] < left ? shape[d] : left;
    left /= chunk[d];
    if (left == 0) left = 1;
  }
}

static hid_t creation_list(int rank, const hsize_t *shape, size_t size)
{
  const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
  hsize_t bytes = size;
  for (int d = 0; d < rank; d++) bytes *= shape[d];
  if (list < 0 || rank == 0 || bytes <= SMALL_SET) return list;
  hsize_t chunk[3];
  choose_chunk(rank, shape, size, chunk);
  H5Pset_chunk(list, rank, chunk);
  H5Pset_shuffle(list);
  H5Pset_deflate(list, DEFLATE_LEVEL);
  H5Pset_fletcher32(list); // last: it covers the bytes as they lie on the disk
  return list;
}

static CastStatus write_set(hid_t group, const char *name, hid_t type, int rank, const hsize_t *shape, const void *data,
                            CastError *err)
{
  h5_quiet();
  const hid_t space = rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, shape, NULL);
  const hid_t creation = creation_list(rank, shape, H5Tget_size(type));
  const hid_t links = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  const hid_t set = H5Dcreate2(group, name, type, space, links, creation, H5P_DEFAULT);
  hsize_t n = 1;
  for (int d = 0; d < rank; d++) n *= shape[d];
  bool ok = set >= 0 && (n == 0 || H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0);
  if (ok) ok = H5Dflush(set) >= 0; // what the cache holds is written here, not on closing, which cannot fail well
  const CastStatus status = ok ? CAST_OK : set_failed(group, name, "written", CAST_ERR_IO, err);
  if (set >= 0) H5Dclose(set);
  H5Pclose(links);
  H5Pclose(creation);
  H5Sclose(space);
  return status;
}

static CastStatus describe_set(hid_t group, const char *name, const char *units, const char *description,
                               CastError *err)
{
  const hid_t set = H5Dopen2(group, name, H5P_DEFAULT);
  if (set < 0) return set_failed(group, name, "reopened", CAST_ERR_IO, err);
  CastStatus status = h5_write_text_attribute(set, "units", units, err);
  if (status == CAST_OK) status = h5_write_text_attribute(set, "description", description, err);
  H5Dclose(set);
  return status;
}

CastStatus h5_write(hid_t group, const char *name, hid_t type, int rank, const hsize_t *shape, const void *data,
                    const char *units, const char *description, CastError *err)
{
  CAST_CHECK(rank >= 0 && rank <= 3, err, CAST_ERR_ARGUMENT, "data set %s has rank %d, 0 to 3 is expected", name, rank);
  CAST_CALL(write_set(group, name, type, rank, shape, data, err));
  return describe_set(group, name, units, description, err);
}

/* A fixed-length text type; the closing zero is stored only where `terminated`. */
static hid_t text_type(size_t length, bool terminated)
{
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, length > 0 ? length : 1);
  H5Tset_strpad(type, terminated ? H5T_STR_NULLTERM : H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

CastStatus h5_write_text(hid_t group, const char *name, const char *text, const char *description, CastError *err)
{
  h5_quiet();
  const hid_t type = text_type(strlen(text), false);
  const CastStatus status = write_set(group, name, type, 0, NULL, text, err);
  H5Tclose(type);
  return status == CAST_OK ? describe_set(group, name, "", description, err) : status;
}

CastStatus h5_write_names(hid_t group, const char *name, size_t n, const char *names, const char *description,
                          CastError *err)
{
  h5_quiet();
  const hid_t type = text_type(H5_NAME_LENGTH, false);
  const hsize_t shape[1] = {n};
  const CastStatus status = write_set(group, name, type, 1, shape, names, err);
  H5Tclose(type);
  return status == CAST_OK ? describe_set(group, name, "", description, err) : status;
}

bool h5_exists(hid_t group, const char *name)
{
  h5_quiet();
  char *path = strdup(name);
  bool found = path != NULL;
  // H5Lexists fails unless every link before the last exists
  for (char *slash = path; found && (slash = strchr(slash, '/')) != NULL; slash++) {
    *slash = '\0';
    if (slash != path) found = H5Lexists(group, path, H5P_DEFAULT) > 0;
    *slash = '/';
  }
  found = found && H5Lexists(group, name, H5P_DEFAULT) > 0;
  free(path);
  return found;
}

/* Deflate shrinks 1032 times at most, so a set that claims more came from a damaged or hostile file. */
static CastStatus check_claim(hid_t group, hid_t set, const char *name, hsize_t bytes, CastError *err)
{
  enum { DEFLATE_BEST = 1032 };
  const hsize_t stored = H5Dget_storage_size(set);
  if (bytes / DEFLATE_BEST <= stored) return CAST_OK;
  char fault[160];
  snprintf(fault, sizeof fault, "claims %llu bytes, but the file holds only %llu for it", (unsigned long long)bytes,
           (unsigned long long)stored);
  return set_refused(group, name, fault, err);
}

static CastStatus check_shape(hid_t group, hid_t set, const char *name, int rank, hsize_t *shape, CastError *err)
{
  char fault[256];
  const hid_t space = H5Dget_space(set);
  const int found = H5Sget_simple_extent_ndims(space);
  hsize_t extent[H5S_MAX_RANK] = {0};
  if (found >= 0) H5Sget_simple_extent_dims(space, extent, NULL);
  const bool null_space = H5Sget_simple_extent_type(space) == H5S_NULL;
  H5Sclose(space);
  if (found != rank || null_space) {
    snprintf(fault, sizeof fault, "has rank %d, %d is expected", null_space ? -1 : found, rank);
    return set_refused(group, name, fault, err);
  }
  for (int d = 0; d < rank; d++) {
    if (shape[d] != 0 && shape[d] != extent[d]) {
      snprintf(fault, sizeof fault, "has %llu entries along dimension %d, %llu are expected",
               (unsigned long long)extent[d], d, (unsigned long long)shape[d]);
      return set_refused(group, name, fault, err);
    }
    shape[d] = extent[d];
  }
  return CAST_OK;
}

static const char *class_name(H5T_class_t class)
{
  return class == H5T_INTEGER  ? "integers"
         : class == H5T_FLOAT  ? "floating-point numbers"
         : class == H5T_STRING ? "text"
                               : "values of another kind";
}

static CastStatus check_class(hid_t group, hid_t set, const char *name, hid_t type, CastError *err)
{
  const hid_t stored = H5Dget_type(set);
  const H5T_class_t found = H5Tget_class(stored), expected = H5Tget_class(type);
  // HDF5 clamps what does not fit, silently: a wider type is not read into a narrower one
  const bool fits = found == expected && (found == H5T_STRING || H5Tget_size(stored) <= H5Tget_size(type));
  const size_t width = H5Tget_size(stored);
  const bool variable = found == H5T_STRING && H5Tis_variable_str(stored) > 0;
  H5Tclose(stored);
  if (fits && !variable) return CAST_OK;
  char fault[160];
  snprintf(fault, sizeof fault, "holds %s%s of %zu bytes, %s of up to %zu are expected",
           variable ? "variable-length " : "", class_name(found), width, class_name(expected), H5Tget_size(type));
  return set_refused(group, name, fault, err);
}

static CastStatus open_set(hid_t group, const char *name, hid_t *set, CastError *err)
{
  if (!h5_exists(group, name)) return set_refused(group, name, "is missing", err);
  *set = H5Dopen2(group, name, H5P_DEFAULT);
  return *set >= 0 ? CAST_OK : set_failed(group, name, "opened", CAST_ERR_FORMAT, err);
}

static CastStatus read_open_set(hid_t group, hid_t set, const char *name, hid_t type, int rank, hsize_t *shape,
                                void **data, CastError *err)
{
  CAST_CALL(check_class(group, set, name, type, err));
  CAST_CALL(check_shape(group, set, name, rank, shape, err));
  hsize_t bytes = H5Tget_size(type);
  for (int d = 0; d < rank; d++) {
    if (shape[d] > 0 && bytes > SIZE_MAX / 2 / shape[d])
      return set_refused(group, name, "claims too many entries", err);
    bytes *= shape[d];
  }
  CAST_CALL(check_claim(group, set, name, bytes, err));
  *data = malloc(bytes > 0 ? (size_t)bytes : 1);
  CAST_CHECK(*data, err, CAST_ERR_MEMORY, "no memory for the %llu bytes of data set %s", (unsigned long long)bytes,
             name);
  if (bytes == 0 || H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, *data) >= 0) return CAST_OK;
  const CastStatus status = set_failed(group, name, "read, the file is damaged", CAST_ERR_FORMAT, err);
  free(*data);
  *data = NULL;
  return status;
}

CastStatus h5_read(hid_t group, const char *name, hid_t type, int rank, hsize_t *shape, void **data, CastError *err)
{
  hid_t set = -1;
  *data = NULL;
  CAST_CALL(open_set(group, name, &set, err));
  const CastStatus status = read_open_set(group, set, name, type, rank, shape, data, err);
  H5Dclose(set);
  return status;
}

CastStatus h5_read_names(hid_t group, const char *name, size_t *n, char **names, CastError *err)
{
  h5_quiet();
  void *data = NULL;
  hsize_t shape[1] = {*n};
  const hid_t type = text_type(H5_NAME_LENGTH, false);
  const CastStatus status = h5_read(group, name, type, 1, shape, &data, err);
  H5Tclose(type);
  *n = (size_t)shape[0];
  *names = data;
  return status;
}

static CastStatus read_text(hid_t group, hid_t set, const char *name, char **text, CastError *err)
{
  const hid_t stored = H5Dget_type(set);
  const bool is_text = H5Tget_class(stored) == H5T_STRING && H5Tis_variable_str(stored) <= 0;
  const hsize_t length = H5Tget_size(stored);
  H5Tclose(stored);
  if (!is_text) return set_refused(group, name, "is not a fixed-length text", err);
  if (length > LARGEST_TEXT) return set_refused(group, name, "is a text longer than 64 MiB", err);
  void *data = NULL;
  const hid_t type = text_type((size_t)length + 1, true);
  const CastStatus status = read_open_set(group, set, name, type, 0, NULL, &data, err);
  H5Tclose(type);
  *text = data;
  return status;
}

CastStatus h5_read_text(hid_t group, const char *name, char **text, CastError *err)
{
  hid_t set = -1;
  *text = NULL;
  CAST_CALL(open_set(group, name, &set, err));
  const CastStatus status = read_text(group, set, name, text, err);
  H5Dclose(set);
  return status;
}
