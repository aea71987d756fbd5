#include "cast/results/cavity_results.h"

#include <stdio.h>
#include <stdlib.h>

#include "cast/io/h5_grow.h"

static const char GROUP[] = "castrun/cavity";

static CastStatus write_column(hid_t file, const char *name, const char *units, const char *description, ptrdiff_t n,
                               const double *values, CastError *err)
{
  char path[128];
  const hsize_t shape[1] = {(hsize_t)n};
  snprintf(path, sizeof path, "%s/%s", GROUP, name);
  return h5_write(file, path, H5T_NATIVE_DOUBLE, 1, shape, values, units, description, err);
}

static CastStatus write_places(hid_t file, const CavityCells *cells, double *room, CastError *err)
{
  const hsize_t shape[2] = {(hsize_t)cells->n, 3}, one[1] = {(hsize_t)cells->n};
  for (ptrdiff_t i = 0; i < cells->n; i++)
    for (int d = 0; d < 3; d++) room[3 * i + d] = cells->x[d][i];
  CAST_CALL(h5_write(file, "castrun/cavity/position", H5T_NATIVE_DOUBLE, 2, shape, room, "m",
                     "middle of the void part of each lattice cell of the cavity", err));
  CAST_CALL(write_column(file, "volume", "m3", "of the void part", cells->n, cells->volume, err));
  return h5_write(file, "castrun/cavity/surface", H5T_NATIVE_INT32, 1, one, cells->surface, "1",
                  "number of the nearest named surface, in the order of the summary", err);
}

static CastStatus write_all(hid_t file, const Filling *filling, const Arrival *arrival, const Defects *defects,
                            double *room, CastError *err)
{
  const CavityCells *cells = filling_cells(filling);
  const ptrdiff_t n = cells->n;
  CAST_CALL(write_places(file, cells, room, err));
  for (ptrdiff_t i = 0; i < n; i++) room[i] = arrival_cell_time(arrival, i);
  CAST_CALL(write_column(file, "fill_time", "s", "when the melt first came; NaN: it did not", n, room, err));
  for (ptrdiff_t i = 0; i < n; i++) room[i] = arrival_cell_temperature(arrival, i);
  CAST_CALL(write_column(file, "front_temperature", "K", "of the melt that first came", n, room, err));
  for (ptrdiff_t i = 0; i < n; i++) room[i] = filling_cell_is_filled(filling, i) ? 1.0 : 0.0;
  CAST_CALL(write_column(file, "filled", "1", "1 where melt stands at the end", n, room, err));
  CAST_CALL(
      write_column(file, "front_solid_fraction", "1", "of the melt that first came", n, defects->front_fraction, err));
  CAST_CALL(write_column(file, "misrun", "1", "index: 1 empty, 0 the melt came liquid", n, defects->misrun, err));
  return write_column(file, "cold_shut", "1", "solid fraction where fronts met; NaN: elsewhere", n, defects->cold_shut,
                      err);
}

CastStatus cavity_results_write(const char *results, const Filling *filling, const Arrival *arrival,
                                const Defects *defects, CastError *err)
{
  double *room = malloc((3 * (size_t)filling_cells(filling)->n + 1) * sizeof *room);
  CAST_CHECK(room, err, CAST_ERR_MEMORY, "no memory for the cavity's results");
  hid_t file = -1;
  CastStatus status = h5_grow_open(results, &file, err);
  if (status == CAST_OK) {
    if (h5_exists(file, GROUP) && H5Ldelete(file, GROUP, H5P_DEFAULT) < 0)
      status = cast_error_set(err, CAST_ERR_IO, "%s: /%s cannot be replaced", results, GROUP);
    if (status == CAST_OK) status = write_all(file, filling, arrival, defects, room, err);
    const CastStatus closed = h5_file_close(&file, status == CAST_OK ? err : NULL);
    if (status == CAST_OK) status = closed;
  }
  free(room);
  return status;
}
