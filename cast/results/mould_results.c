#include "cast/results/mould_results.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/io/h5_grow.h"
#include "cast/io/xmf.h"

static const VtkField TEMPERATURE = {"temperature", "K", "temperature, reprojected from the reduced state", 1, false};
enum { XMF_EACH = 128, MOST_MAPS = 32 };

struct MouldResults {
  VtkSeries *series;
  char path[4096], xmf_path[4096];
  const RomData *rom;
  double *temperature; // [n_points] K
  float *values;
  size_t n_maps;
  VtkField map[MOST_MAPS];
};

/* The connectivity as the side file wants it: a table with one row a cell. */
static CastStatus write_cells(const MouldResults *results, CastError *err)
{
  const RomData *rom = results->rom;
  const hsize_t triangles[2] = {rom->n_triangles, 3}, tetrahedra[2] = {rom->n_tetrahedra, 4};
  hid_t file = -1;
  CAST_CALL(h5_grow_open(results->path, &file, err));
  CastStatus status = h5_write(file, "castrun/triangles", H5T_NATIVE_INT32, 2, triangles, rom->triangles, "1",
                               "points of each triangle of the mould's surface", err);
  if (status == CAST_OK && rom->n_tetrahedra > 0)
    status = h5_write(file, "castrun/tetrahedra", H5T_NATIVE_INT32, 2, tetrahedra, rom->tetrahedra, "1",
                      "points of each tetrahedron of the near-wall band", err);
  const CastStatus closed = h5_file_close(&file, status == CAST_OK ? err : NULL);
  return status == CAST_OK ? closed : status;
}

static CastStatus open_files(MouldResults *made, size_t n_steps, CastError *err)
{
  const RomData *rom = made->rom;
  CAST_CHECK(made->temperature && made->values, err, CAST_ERR_MEMORY, "no memory for the mould's temperatures");
  if (n_steps > 0) return vtk_series_reopen(made->path, 1, &TEMPERATURE, n_steps, &made->series, err);
  const VtkMesh mesh = {rom->n_points, rom->n_triangles, rom->points, rom->triangles, rom->triangle_patch};
  CAST_CALL(vtk_series_create(made->path, 1, &TEMPERATURE, &mesh, mesh.n_points, &made->series, err));
  return write_cells(made, err);
}

CastStatus mould_results_open(const char *folder, const RomData *rom, size_t n_steps, MouldResults **results,
                              CastError *err)
{
  MouldResults *made = *results = calloc(1, sizeof *made);
  CAST_CHECK(made, err, CAST_ERR_MEMORY, "no memory for the mould's results");
  made->rom = rom;
  snprintf(made->path, sizeof made->path, "%.4000s/mould.vtkhdf", folder);
  snprintf(made->xmf_path, sizeof made->xmf_path, "%.4000s/mould.xmf", folder);
  made->temperature = malloc(rom->n_points * sizeof *made->temperature);
  made->values = malloc(rom->n_points * sizeof *made->values);
  const CastStatus status = open_files(made, n_steps, err);
  if (status != CAST_OK) mould_results_close(results);
  return status;
}

void mould_results_close(MouldResults **results)
{
  if (!results || !*results) return;
  vtk_series_destroy(&(*results)->series);
  free((*results)->temperature);
  free((*results)->values);
  free(*results);
  *results = NULL;
}

CastStatus mould_results_append(MouldResults *r, double time, const RomState *state, CastError *err)
{
  rom_state_point_temperature(state, r->temperature);
  for (size_t i = 0; i < r->rom->n_points; i++) r->values[i] = (float)r->temperature[i];
  const void *const values[1] = {r->values};
  CAST_CALL(vtk_series_append(r->series, time, r->rom->n_points, NULL, values, err));
  const size_t steps = vtk_series_n_steps(r->series);
  return steps <= XMF_EACH || steps % XMF_EACH == 0 ? mould_results_finish(r, err) : CAST_OK;
}

CastStatus mould_results_set_maps(MouldResults *r, size_t n, const VtkField *field, void *const *values, CastError *err)
{
  CAST_CHECK(n <= MOST_MAPS, err, CAST_ERR_ARGUMENT, "%zu maps, at most %d are allowed", n, MOST_MAPS);
  CAST_CALL(vtk_series_set_cells(r->series, r->rom->n_triangles, n, field, values, err));
  memcpy(r->map, field, n * sizeof *field);
  r->n_maps = n;
  return CAST_OK;
}

CastStatus mould_results_finish(MouldResults *r, CastError *err)
{
  const XmfPart parts[2] = {{"surface", "Triangle", "/castrun/triangles", r->rom->n_triangles, 3, r->n_maps, r->map},
                            {"band", "Tetrahedron", "/castrun/tetrahedra", r->rom->n_tetrahedra, 4, 0, NULL}};
  return xmf_write(r->xmf_path, r->series, r->rom->n_tetrahedra > 0 ? 2 : 1, parts, err);
}

size_t mould_results_n_steps(const MouldResults *results)
{
  return vtk_series_n_steps(results->series);
}
