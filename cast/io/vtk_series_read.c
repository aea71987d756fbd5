/* vtk_series_read.c - steps and rows of a VTKHDF file that castrun wrote. */
#include <stdio.h>
#include <stdlib.h>

#include "cast/io/vtk_series.h"

/* A set of /VTKHDF with one integer a row; `rows` must be there. */
static CastStatus read_integers(hid_t file, const char *name, hsize_t *rows, long long **values, CastError *err)
{
  char path[256];
  snprintf(path, sizeof path, "VTKHDF/%s", name);
  void *read = NULL;
  CAST_CALL(h5_read(file, path, H5T_NATIVE_LLONG, 1, rows, &read, err));
  *values = read;
  return CAST_OK;
}

static CastStatus first_field(hid_t file, char *name, size_t size, CastError *err)
{
  const hid_t group = H5Gopen2(file, "VTKHDF/Steps/PointDataOffsets", H5P_DEFAULT);
  CAST_CHECK(group >= 0, err, CAST_ERR_FORMAT, "there is no /VTKHDF/Steps/PointDataOffsets");
  char field[128] = "";
  H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, 0, field, sizeof field, H5P_DEFAULT);
  H5Gclose(group);
  snprintf(name, size, "Steps/PointDataOffsets/%s", field);
  return CAST_OK;
}

static CastStatus fill_steps(hid_t file, size_t n, VtkStep *step, CastError *err)
{
  char offsets[256];
  CAST_CALL(first_field(file, offsets, sizeof offsets, err));
  const char *const names[4] = {"Steps/PartOffsets", "Steps/PointOffsets", offsets, "NumberOfPoints"};
  long long *column[4] = {NULL};
  hsize_t rows[4] = {0};
  CastStatus status = CAST_OK;
  for (int k = 0; k < 4 && status == CAST_OK; k++) {
    status = read_integers(file, names[k], &rows[k], &column[k], err);
    if (status == CAST_OK && k < 3 && rows[k] < n)
      status = cast_error_set(err, CAST_ERR_FORMAT, "/VTKHDF/%s has %llu rows, %zu are expected", names[k],
                              (unsigned long long)rows[k], n);
  }
  for (size_t s = 0; s < n && status == CAST_OK; s++) {
    const long long part = column[0][s];
    if (part < 0 || (hsize_t)part >= rows[3] || column[1][s] < 0 || column[2][s] < 0 || column[3][part] < 0) {
      status = cast_error_set(err, CAST_ERR_FORMAT, "/VTKHDF/Steps: offsets of step %zu point outside the file", s);
      break;
    }
    step[s].first_point = column[1][s];
    step[s].first_value = column[2][s];
    step[s].n_points = column[3][part];
  }
  for (int k = 0; k < 4; k++) free(column[k]);
  return status;
}

CastStatus vtk_series_read_steps(hid_t file, size_t *n_steps, VtkStep **steps, CastError *err)
{
  *n_steps = 0;
  *steps = NULL;
  CAST_CHECK(h5_exists(file, "VTKHDF/Steps"), err, CAST_ERR_FORMAT,
             "there is no /VTKHDF/Steps: not results of castrun");
  const hid_t group = H5Gopen2(file, "VTKHDF/Steps", H5P_DEFAULT);
  long long n = 0;
  CastStatus status = h5_read_attribute(group, "NSteps", H5T_NATIVE_LLONG, 1, &n, err);
  H5Gclose(group);
  CAST_CALL(status);
  hsize_t rows = 0;
  void *read = NULL;
  CAST_CALL(h5_read(file, "VTKHDF/Steps/Values", H5T_NATIVE_DOUBLE, 1, &rows, &read, err));
  double *times = read;
  VtkStep *made = n >= 0 && (hsize_t)n <= rows ? calloc((size_t)n + 1, sizeof *made) : NULL;
  if (!made) {
    free(times);
    return cast_error_set(err, CAST_ERR_FORMAT, "/VTKHDF/Steps: NSteps is %lld, there are %llu times", n,
                          (unsigned long long)rows);
  }
  for (size_t s = 0; s < (size_t)n; s++) made[s].time = times[s];
  free(times);
  status = fill_steps(file, (size_t)n, made, err);
  if (status != CAST_OK) {
    free(made);
    return status;
  }
  *n_steps = (size_t)n;
  *steps = made;
  return CAST_OK;
}

CastStatus vtk_series_read_rows(hid_t file, const char *name, long long first, long long rows, int columns,
                                float **values, CastError *err)
{
  char path[256];
  snprintf(path, sizeof path, "VTKHDF/%s", name);
  *values = NULL;
  CAST_CHECK(h5_exists(file, path), err, CAST_ERR_FORMAT, "there is no /%s", path);
  const hid_t set = H5Dopen2(file, path, H5P_DEFAULT), space = H5Dget_space(set);
  const int rank = columns > 1 ? 2 : 1;
  hsize_t shape[2] = {0, 1};
  const bool fits = H5Sget_simple_extent_ndims(space) == rank && H5Sget_simple_extent_dims(space, shape, NULL) >= 0 &&
                    first >= 0 && rows >= 0 && (hsize_t)(first + rows) <= shape[0] && shape[1] == (hsize_t)columns;
  float *read = fits ? malloc(((size_t)rows * (size_t)columns + 1) * sizeof *read) : NULL;
  bool ok = read != NULL;
  if (ok && rows > 0) {
    const hsize_t start[2] = {(hsize_t)first, 0}, count[2] = {(hsize_t)rows, (hsize_t)columns};
    const hid_t memory = H5Screate_simple(rank, count, NULL);
    ok = H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
         H5Dread(set, H5T_NATIVE_FLOAT, memory, space, H5P_DEFAULT, read) >= 0;
    H5Sclose(memory);
  }
  H5Sclose(space);
  H5Dclose(set);
  if (!ok) free(read);
  CAST_CHECK(ok, err, CAST_ERR_FORMAT, "/%s: rows %lld to %lld cannot be read", path, first, first + rows);
  *values = read;
  return CAST_OK;
}
