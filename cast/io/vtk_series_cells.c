/* vtk_series_cells.c - values of a mesh's triangles that hold for the whole run: written once it is over, read from row
 * 0 at every step. */
#include <stdio.h>
#include <stdlib.h>

#include "cast/io/h5_grow.h"
#include "cast/io/vtk_series.h"

static CastStatus replace(hid_t root, const char *name, hid_t type, hsize_t rows, const void *values, const char *units,
                          const char *description, CastError *err)
{
  if (h5_exists(root, name) && H5Ldelete(root, name, H5P_DEFAULT) < 0)
    return cast_error_set(err, CAST_ERR_IO, "data set %s cannot be replaced", name);
  return h5_write(root, name, type, 1, &rows, values, units, description, err);
}

static CastStatus write_field(hid_t root, const VtkField *field, size_t n_cells, const void *values, size_t n_steps,
                              const long long *zeros, CastError *err)
{
  char name[256];
  snprintf(name, sizeof name, "CellData/%s", field->name);
  CAST_CALL(replace(root, name, field->integer ? H5T_NATIVE_INT32 : H5T_NATIVE_FLOAT, n_cells, values, field->units,
                    field->description, err));
  snprintf(name, sizeof name, "Steps/CellDataOffsets/%s", field->name);
  return replace(root, name, H5T_NATIVE_LLONG, n_steps, zeros, "1", "row at which each step's values begin", err);
}

CastStatus vtk_series_set_cells(const VtkSeries *series, size_t n_cells, size_t n_fields, const VtkField *field,
                                void *const *values, CastError *err)
{
  const size_t n_steps = vtk_series_n_steps(series);
  long long *zeros = calloc(n_steps + 1, sizeof *zeros);
  CAST_CHECK(zeros, err, CAST_ERR_MEMORY, "no memory");
  hid_t file = -1;
  CastStatus status = h5_grow_open(vtk_series_path(series), &file, err);
  if (status == CAST_OK) {
    const hid_t root = H5Gopen2(file, "VTKHDF", H5P_DEFAULT);
    for (size_t f = 0; f < n_fields && status == CAST_OK; f++)
      status = write_field(root, &field[f], n_cells, values[f], n_steps, zeros, err);
    if (root >= 0) H5Gclose(root);
    const CastStatus closed = h5_file_close(&file, status == CAST_OK ? err : NULL);
    if (status == CAST_OK) status = closed;
  }
  free(zeros);
  return status;
}
