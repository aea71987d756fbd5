#include "cast/io/h5_grow.h"

#include <string.h>
#include "common/h5/h5_private.h"

enum { WIDE_ROW = 512, DEFLATE_LEVEL = 1 }; // level 4 takes thrice the time for 3 % less on particle data

static CastStatus failed(hid_t group, const char *name, const char *action, CastError *err)
{
  char path[4096], reason[512];
  const bool system = h5_reason(reason, sizeof reason);
  h5_file_name(group, path, sizeof path);
  if (system) h5_abandon(group);
  return cast_error_set(err, CAST_ERR_IO, "%s: data set %s cannot be %s: %s", path, name, action, reason);
}

CastStatus h5_grow_open(const char *path, hid_t *file, CastError *err)
{
  CAST_CALL(h5_file_open(path, file, err)); // says in plain words what is wrong with a file that cannot be read
  CAST_CALL(h5_file_close(file, err));
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
#if H5_VERSION_GE(1, 10, 7)
  H5Pset_file_locking(access, false, true); // somebody who looks at the file must not stop the run
#endif
  *file = H5Fopen(path, H5F_ACC_RDWR, access);
  char reason[512] = "";
  if (*file < 0) h5_reason(reason, sizeof reason);
  H5Pclose(access);
  CAST_CHECK(*file >= 0, err, CAST_ERR_IO, "%s: cannot be opened for writing: %s", path, reason);
  return CAST_OK;
}

static CastStatus describe(hid_t set, const GrowingSet *given, CastError *err)
{
  if (given->units) CAST_CALL(h5_write_text_attribute(set, "units", given->units, err));
  return given->description ? h5_write_text_attribute(set, "description", given->description, err) : CAST_OK;
}

CastStatus h5_grow_create(hid_t group, const GrowingSet *given, CastError *err)
{
  h5_quiet();
  const int rank = given->columns > 0 ? 2 : 1;
  const hsize_t shape[2] = {0, given->columns}, most[2] = {H5S_UNLIMITED, given->columns};
  const hsize_t chunk[2] = {given->chunk, given->columns};
  const hid_t space = H5Screate_simple(rank, shape, most), creation = H5Pcreate(H5P_DATASET_CREATE),
              links = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_chunk(creation, rank, chunk);
  if (given->chunk > 1024 || (given->chunk == 1 && given->columns >= WIDE_ROW)) {
    H5Pset_shuffle(creation);
    H5Pset_deflate(creation, DEFLATE_LEVEL);
  }
  H5Pset_create_intermediate_group(links, 1);
  const hid_t set = H5Dcreate2(group, given->name, given->type, space, links, creation, H5P_DEFAULT);
  CastStatus status = set >= 0 ? describe(set, given, err) : failed(group, given->name, "made", err);
  if (set >= 0) H5Dclose(set);
  H5Pclose(links);
  H5Pclose(creation);
  H5Sclose(space);
  return status;
}

/* Rows of the set, and its rank. */
static int extent_of(hid_t set, hsize_t shape[2])
{
  const hid_t space = H5Dget_space(set);
  shape[0] = shape[1] = 0;
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank == 1 || rank == 2) H5Sget_simple_extent_dims(space, shape, NULL);
  H5Sclose(space);
  return rank;
}

static bool write_rows(hid_t set, hid_t type, hsize_t rows, const void *data)
{
  hsize_t shape[2];
  const int rank = extent_of(set, shape);
  const hsize_t start[2] = {shape[0], 0}, count[2] = {rows, shape[1]};
  shape[0] += rows;
  if (H5Dset_extent(set, shape) < 0) return false;
  const hid_t space = H5Dget_space(set), memory = H5Screate_simple(rank, count, NULL);
  const bool ok = H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
                  H5Dwrite(set, type, memory, space, H5P_DEFAULT, data) >= 0;
  H5Sclose(memory);
  H5Sclose(space);
  return ok && H5Dflush(set) >= 0;
}

CastStatus h5_grow_append(hid_t group, const char *name, hid_t type, hsize_t rows, const void *data, CastError *err)
{
  h5_quiet();
  if (rows == 0) return CAST_OK;
  const hid_t set = H5Dopen2(group, name, H5P_DEFAULT);
  const bool ok = set >= 0 && write_rows(set, type, rows, data);
  const CastStatus status = ok ? CAST_OK : failed(group, name, "written", err);
  if (set >= 0) H5Dclose(set);
  return status;
}

CastStatus h5_grow_cut(hid_t group, const char *name, hsize_t rows, CastError *err)
{
  h5_quiet();
  const hid_t set = H5Dopen2(group, name, H5P_DEFAULT);
  if (set < 0) return failed(group, name, "opened", err);
  hsize_t shape[2];
  extent_of(set, shape);
  const hsize_t found = shape[0];
  shape[0] = rows;
  const bool ok = found >= rows && H5Dset_extent(set, shape) >= 0;
  CastStatus status = CAST_OK;
  if (found < rows)
    status = cast_error_set(err, CAST_ERR_FORMAT, "data set %s has %llu rows, at least %llu are expected", name,
                            (unsigned long long)found, (unsigned long long)rows);
  else if (!ok)
    status = failed(group, name, "cut", err);
  H5Dclose(set);
  return status;
}
