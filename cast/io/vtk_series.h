/* vtk_series.h - a VTKHDF file of PolyData over time (VTKHDF 2.0 with Steps, ParaView 5.12 and newer).
 * Two kinds: points that move and whose number may change (melt: one vertex a point), or a mesh that stays as it is
 * (the mould's surface: triangles) with fields that change. Between two appends the file is closed, so that an
 * interrupted run leaves a file that opens, and a run can be watched.
 *
 * Vertices are the same for every step: vertex i is point i, so steps share one list, as long as the largest of them,
 * and read its beginning. All offsets into it are zero, which every reader understands alike.
 *   /VTKHDF           Version, Type; NumberOfPoints, Points; Vertices, Lines, Polygons, Strips; PointData, CellData
 *   /VTKHDF/Steps     NSteps; Values [s]; part, point, cell and connectivity offsets; PointDataOffsets, CellDataOffsets
 *   /castrun          ours; VTK ignores it */
#ifndef CAST_IO_VTK_SERIES_H
#define CAST_IO_VTK_SERIES_H

#include <stdint.h>
#include "common/h5/h5.h"

typedef struct VtkField { // a value or vector at each point
  const char *name, *units, *description;
  int components; // 1 or 3
  bool integer;   // int32_t; else float
} VtkField;

typedef struct VtkMesh { // borrowed while the series is created
  size_t n_points, n_triangles;
  const double *points;     // [n_points*3] m
  const int32_t *triangles; // [n_triangles*3]
  const int32_t *patch;     // [n_triangles] becomes cell data
} VtkMesh;

typedef struct VtkStep {
  double time; // s
  long long n_points;
  long long first_point; // where the step's points begin in Points
  long long first_value; // and its values in each field
} VtkStep;

typedef struct VtkSeries VtkSeries;

/*  mesh   NULL: points move
 *  field  borrowed, must outlive the series (names and texts too)
 *  rows   points that a step is likely to have; any number will do
 * Errors: CAST_ERR_IO, CAST_ERR_MEMORY. */
CastStatus vtk_series_create(const char *path, size_t n_fields, const VtkField *field, const VtkMesh *mesh, size_t rows,
                             VtkSeries **series, CastError *err);
/* Go on with a file after its first n_steps; later ones are dropped. Errors: CAST_ERR_IO, CAST_ERR_FORMAT. */
CastStatus vtk_series_reopen(const char *path, size_t n_fields, const VtkField *field, size_t n_steps,
                             VtkSeries **series, CastError *err);
void vtk_series_destroy(VtkSeries **series);

/*  points  [n_points*3] m; ignored for a mesh that stays
 *  values  one array for each field: float or int32_t, n_points x components
 * Errors: CAST_ERR_IO with the system's reason. */
CastStatus vtk_series_append(VtkSeries *series, double time, size_t n_points, const float *points,
                             const void *const *values, CastError *err);

/* Values of the triangles of a mesh that stays, the same at all steps so far; replaces those there. No step may follow.
 *   values  one array [n_cells] for each field: float or int32_t
 * Errors: CAST_ERR_IO, CAST_ERR_MEMORY. */
CastStatus vtk_series_set_cells(const VtkSeries *series, size_t n_cells, size_t n_fields, const VtkField *field,
                                void *const *values, CastError *err);

size_t vtk_series_n_steps(const VtkSeries *series);
const VtkStep *vtk_series_steps(const VtkSeries *series); // [n_steps]
const char *vtk_series_path(const VtkSeries *series);
size_t vtk_series_n_fields(const VtkSeries *series);
const VtkField *vtk_series_fields(const VtkSeries *series);
long long vtk_series_n_values(const VtkSeries *series); // rows of each field so far
long long vtk_series_n_points(const VtkSeries *series); // rows of Points so far

/* The steps of any such file, for reading. Caller frees. Errors: CAST_ERR_FORMAT. */
CastStatus vtk_series_read_steps(hid_t file, size_t *n_steps, VtkStep **steps, CastError *err);
/* Rows [first, first + rows) of a set of /VTKHDF ("Points", "PointData/temperature") as floats, [rows*columns].
 * Caller frees. Errors: CAST_ERR_FORMAT. */
CastStatus vtk_series_read_rows(hid_t file, const char *name, long long first, long long rows, int columns,
                                float **values, CastError *err);
#endif
