#include "cast/io/vtk_series.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/io/h5_grow.h"

/* Rows of a chunk: large ones compress and read well, steps are few. A frame that begins within a chunk has to unpack
 * and pack it again: where a frame is about as large as a chunk, the chunk is a frame. */
enum { CHUNK_ROWS = 16384, CHUNK_STEPS = 256, LEAST_FRAME = 1025, MOST_FRAME = 2 * CHUNK_ROWS };

static const char *const TOPOLOGIES[] = {"Vertices", "Lines", "Polygons", "Strips"};
enum { N_TOPOLOGIES = 4, VERTICES = 0, POLYGONS = 2 };

struct VtkSeries {
  char *path;
  size_t n_fields;
  const VtkField *field;
  bool fixed;           // the mesh stays
  long long n_vertices; // entries of the shared vertex list
  long long mesh_points;
  size_t n_steps, capacity;
  VtkStep *step;
  hsize_t chunk; // rows, of what a new file gets
};

/* ---- making the file ---- */

static CastStatus grow(hid_t root, const char *name, hid_t type, hsize_t columns, hsize_t chunk, CastError *err)
{
  return h5_grow_create(root, &(GrowingSet){name, type, columns, chunk, NULL, NULL}, err);
}

static CastStatus append_integers(hid_t root, const char *name, hsize_t rows, const long long *values, CastError *err)
{
  return h5_grow_append(root, name, H5T_NATIVE_LLONG, rows, values, err);
}

static CastStatus make_topology(hid_t root, int kind, CastError *err)
{
  static const char *const parts[] = {"NumberOfCells", "NumberOfConnectivityIds", "Offsets", "Connectivity"};
  for (int k = 0; k < 4; k++) {
    char name[64];
    snprintf(name, sizeof name, "%s/%s", TOPOLOGIES[kind], parts[k]);
    CAST_CALL(grow(root, name, H5T_NATIVE_LLONG, 0, k < 2 ? CHUNK_STEPS : CHUNK_ROWS, err));
  }
  char offsets[64];
  snprintf(offsets, sizeof offsets, "%s/Offsets", TOPOLOGIES[kind]);
  return append_integers(root, offsets, 1, (const long long[]){0}, err);
}

static CastStatus make_steps(const VtkSeries *series, hid_t root, CastError *err)
{
  static const char *const scalars[] = {"PartOffsets", "NumberOfParts", "PointOffsets"};
  CAST_CALL(h5_grow_create(root, &(GrowingSet){"Steps/Values", H5T_NATIVE_DOUBLE, 0, CHUNK_STEPS, "s", "time"}, err));
  char name[256];
  for (int k = 0; k < 3; k++) {
    snprintf(name, sizeof name, "Steps/%s", scalars[k]);
    CAST_CALL(grow(root, name, H5T_NATIVE_LLONG, 0, CHUNK_STEPS, err));
  }
  CAST_CALL(grow(root, "Steps/CellOffsets", H5T_NATIVE_LLONG, N_TOPOLOGIES, CHUNK_STEPS, err));
  CAST_CALL(grow(root, "Steps/ConnectivityIdOffsets", H5T_NATIVE_LLONG, N_TOPOLOGIES, CHUNK_STEPS, err));
  for (size_t f = 0; f < series->n_fields; f++) {
    snprintf(name, sizeof name, "Steps/PointDataOffsets/%s", series->field[f].name);
    CAST_CALL(grow(root, name, H5T_NATIVE_LLONG, 0, CHUNK_STEPS, err));
  }
  if (series->fixed) CAST_CALL(grow(root, "Steps/CellDataOffsets/patch", H5T_NATIVE_LLONG, 0, CHUNK_STEPS, err));
  const hid_t steps = H5Gopen2(root, "Steps", H5P_DEFAULT);
  const long long none = 0;
  const CastStatus status = h5_write_attribute(steps, "NSteps", H5T_NATIVE_LLONG, 1, &none, err);
  H5Gclose(steps);
  return status;
}

static hsize_t choose_chunk(size_t rows)
{
  return rows >= LEAST_FRAME && rows <= MOST_FRAME ? rows : CHUNK_ROWS;
}

static CastStatus make_fields(const VtkSeries *series, hid_t root, CastError *err)
{
  CAST_CALL(grow(root, "NumberOfPoints", H5T_NATIVE_LLONG, 0, CHUNK_STEPS, err));
  CAST_CALL(h5_grow_create(root, &(GrowingSet){"Points", H5T_NATIVE_FLOAT, 3, series->chunk, "m", "positions"}, err));
  for (size_t f = 0; f < series->n_fields; f++) {
    const VtkField *field = &series->field[f];
    char name[256];
    snprintf(name, sizeof name, "PointData/%s", field->name);
    const GrowingSet set = {name,
                            field->integer ? H5T_NATIVE_INT32 : H5T_NATIVE_FLOAT,
                            field->components > 1 ? (hsize_t)field->components : 0,
                            series->chunk,
                            field->units,
                            field->description};
    CAST_CALL(h5_grow_create(root, &set, err));
  }
  return CAST_OK;
}

/* The mesh that stays: its points, triangles and patches, once. */
static CastStatus write_mesh(hid_t root, const VtkMesh *mesh, CastError *err)
{
  const size_t n = mesh->n_triangles > mesh->n_points ? mesh->n_triangles : mesh->n_points;
  long long *numbers = malloc((3 * n + 1) * sizeof *numbers);
  CAST_CHECK(numbers, err, CAST_ERR_MEMORY, "no memory for %zu triangles", mesh->n_triangles);
  for (size_t i = 0; i < mesh->n_triangles; i++) numbers[i] = 3 * (long long)(i + 1);
  CastStatus status = append_integers(root, "Polygons/Offsets", mesh->n_triangles, numbers, err);
  for (size_t i = 0; i < 3 * mesh->n_triangles; i++) numbers[i] = mesh->triangles[i];
  if (status == CAST_OK) status = append_integers(root, "Polygons/Connectivity", 3 * mesh->n_triangles, numbers, err);
  free(numbers);
  CAST_CALL(status);
  CAST_CALL(h5_grow_append(root, "Points", H5T_NATIVE_DOUBLE, mesh->n_points, mesh->points, err));
  CAST_CALL(append_integers(root, "NumberOfPoints", 1, (const long long[]){(long long)mesh->n_points}, err));
  for (int k = 0; k < N_TOPOLOGIES; k++) {
    const long long cells = k == POLYGONS ? (long long)mesh->n_triangles : 0, ids = 3 * cells;
    char name[64];
    snprintf(name, sizeof name, "%s/NumberOfCells", TOPOLOGIES[k]);
    CAST_CALL(append_integers(root, name, 1, &cells, err));
    snprintf(name, sizeof name, "%s/NumberOfConnectivityIds", TOPOLOGIES[k]);
    CAST_CALL(append_integers(root, name, 1, &ids, err));
  }
  const GrowingSet patch = {"CellData/patch", H5T_NATIVE_INT32, 0, CHUNK_ROWS, "", "patch of the reduced model"};
  CAST_CALL(h5_grow_create(root, &patch, err));
  return h5_grow_append(root, "CellData/patch", H5T_NATIVE_INT32, mesh->n_triangles, mesh->patch, err);
}

static CastStatus make_root(const VtkSeries *series, hid_t root, const VtkMesh *mesh, CastError *err)
{
  CAST_CALL(h5_write_attribute(root, "Version", H5T_NATIVE_LLONG, 2, (const long long[]){2, 0}, err));
  CAST_CALL(h5_write_text_attribute(root, "Type", "PolyData", err));
  CAST_CALL(make_fields(series, root, err));
  for (int k = 0; k < N_TOPOLOGIES; k++) CAST_CALL(make_topology(root, k, err));
  CAST_CALL(make_steps(series, root, err));
  return mesh ? write_mesh(root, mesh, err) : CAST_OK;
}

static CastStatus make_file(const VtkSeries *series, const VtkMesh *mesh, CastError *err)
{
  hid_t file = -1, root = -1;
  CAST_CALL(h5_file_create(series->path, &file, err));
  CastStatus status = h5_group_create(file, "VTKHDF", &root, err);
  if (status == CAST_OK) {
    status = make_root(series, root, mesh, err);
    H5Gclose(root);
  }
  const CastStatus closed = h5_file_close(&file, status == CAST_OK ? err : NULL);
  return status == CAST_OK ? closed : status;
}

static CastStatus allocate(const char *path, size_t n_fields, const VtkField *field, VtkSeries **series, CastError *err)
{
  *series = calloc(1, sizeof **series);
  CAST_CHECK(*series, err, CAST_ERR_MEMORY, "no memory for '%s'", path);
  (*series)->path = strdup(path);
  (*series)->n_fields = n_fields;
  (*series)->field = field;
  CAST_CHECK((*series)->path, err, CAST_ERR_MEMORY, "no memory for '%s'", path);
  return CAST_OK;
}

CastStatus vtk_series_create(const char *path, size_t n_fields, const VtkField *field, const VtkMesh *mesh, size_t rows,
                             VtkSeries **series, CastError *err)
{
  CastStatus status = allocate(path, n_fields, field, series, err);
  if (status == CAST_OK) {
    (*series)->fixed = mesh != NULL;
    (*series)->chunk = choose_chunk(rows);
    (*series)->mesh_points = mesh ? (long long)mesh->n_points : 0;
    status = make_file(*series, mesh, err);
  }
  if (status != CAST_OK) vtk_series_destroy(series);
  return status;
}

void vtk_series_destroy(VtkSeries **series)
{
  if (!series || !*series) return;
  free((*series)->path);
  free((*series)->step);
  free(*series);
  *series = NULL;
}

/* ---- appending ---- */

static CastStatus append_points(VtkSeries *series, hid_t root, size_t n_points, const float *points, CastError *err)
{
  const long long n = (long long)n_points, zero = 0;
  CAST_CALL(h5_grow_append(root, "Points", H5T_NATIVE_FLOAT, n_points, points, err));
  CAST_CALL(append_integers(root, "NumberOfPoints", 1, &n, err));
  for (int k = 0; k < N_TOPOLOGIES; k++) {
    char name[64];
    snprintf(name, sizeof name, "%s/NumberOfCells", TOPOLOGIES[k]);
    CAST_CALL(append_integers(root, name, 1, k == VERTICES ? &n : &zero, err));
    snprintf(name, sizeof name, "%s/NumberOfConnectivityIds", TOPOLOGIES[k]);
    CAST_CALL(append_integers(root, name, 1, k == VERTICES ? &n : &zero, err));
  }
  const long long more = n - series->n_vertices;
  if (more <= 0) return CAST_OK;
  long long *numbers = malloc((size_t)more * sizeof *numbers);
  CAST_CHECK(numbers, err, CAST_ERR_MEMORY, "no memory for %lld vertices", more);
  for (long long i = 0; i < more; i++) numbers[i] = series->n_vertices + i;
  CastStatus status = append_integers(root, "Vertices/Connectivity", (hsize_t)more, numbers, err);
  for (long long i = 0; i < more; i++) numbers[i]++;
  if (status == CAST_OK) status = append_integers(root, "Vertices/Offsets", (hsize_t)more, numbers, err);
  free(numbers);
  if (status == CAST_OK) series->n_vertices = n;
  return status;
}

static CastStatus append_fields(const VtkSeries *series, hid_t root, const VtkStep *step, const void *const *values,
                                CastError *err)
{
  for (size_t f = 0; f < series->n_fields; f++) {
    const VtkField *field = &series->field[f];
    char name[256];
    snprintf(name, sizeof name, "PointData/%s", field->name);
    CAST_CALL(h5_grow_append(root, name, field->integer ? H5T_NATIVE_INT32 : H5T_NATIVE_FLOAT, (hsize_t)step->n_points,
                             values[f], err));
    snprintf(name, sizeof name, "Steps/PointDataOffsets/%s", field->name);
    CAST_CALL(append_integers(root, name, 1, &step->first_value, err));
  }
  return CAST_OK;
}

static CastStatus set_n_steps(hid_t root, long long n, CastError *err)
{
  const hid_t steps = H5Gopen2(root, "Steps", H5P_DEFAULT);
  const hid_t attribute = steps >= 0 ? H5Aopen(steps, "NSteps", H5P_DEFAULT) : -1;
  const bool ok = attribute >= 0 && H5Awrite(attribute, H5T_NATIVE_LLONG, &n) >= 0;
  if (attribute >= 0) H5Aclose(attribute);
  if (steps >= 0) H5Gclose(steps);
  CAST_CHECK(ok, err, CAST_ERR_IO, "the number of steps cannot be written");
  return CAST_OK;
}

static CastStatus append_step(VtkSeries *series, hid_t root, const VtkStep *step, CastError *err)
{
  const long long zeros[N_TOPOLOGIES] = {0}, one = 1;
  const long long part = series->fixed ? 0 : (long long)series->n_steps;
  CAST_CALL(h5_grow_append(root, "Steps/Values", H5T_NATIVE_DOUBLE, 1, &step->time, err));
  CAST_CALL(append_integers(root, "Steps/PartOffsets", 1, &part, err));
  CAST_CALL(append_integers(root, "Steps/NumberOfParts", 1, &one, err));
  CAST_CALL(append_integers(root, "Steps/PointOffsets", 1, &step->first_point, err));
  CAST_CALL(append_integers(root, "Steps/CellOffsets", 1, zeros, err));
  CAST_CALL(append_integers(root, "Steps/ConnectivityIdOffsets", 1, zeros, err));
  if (series->fixed) CAST_CALL(append_integers(root, "Steps/CellDataOffsets/patch", 1, zeros, err));
  return set_n_steps(root, (long long)series->n_steps + 1, err); // last: until then the step does not exist
}

static CastStatus reserve(VtkSeries *series, CastError *err)
{
  if (series->n_steps < series->capacity) return CAST_OK;
  const size_t capacity = 2 * series->capacity + 64;
  VtkStep *larger = realloc(series->step, capacity * sizeof *larger);
  CAST_CHECK(larger, err, CAST_ERR_MEMORY, "no memory for %zu steps", capacity);
  series->step = larger;
  series->capacity = capacity;
  return CAST_OK;
}

CastStatus vtk_series_append(VtkSeries *series, double time, size_t n_points, const float *points,
                             const void *const *values, CastError *err)
{
  CAST_CHECK(!series->fixed || (long long)n_points == series->mesh_points, err, CAST_ERR_ARGUMENT,
             "%s: %zu points, the mesh has %lld", series->path, n_points, series->mesh_points);
  CAST_CALL(reserve(series, err));
  const VtkStep step = {time, (long long)n_points, series->fixed ? 0 : vtk_series_n_points(series),
                        vtk_series_n_values(series)};
  hid_t file = -1;
  CAST_CALL(h5_grow_open(series->path, &file, err));
  const hid_t root = H5Gopen2(file, "VTKHDF", H5P_DEFAULT);
  CastStatus status = series->fixed ? CAST_OK : append_points(series, root, n_points, points, err);
  if (status == CAST_OK) status = append_fields(series, root, &step, values, err);
  if (status == CAST_OK) status = append_step(series, root, &step, err);
  if (root >= 0) H5Gclose(root);
  const CastStatus closed = h5_file_close(&file, status == CAST_OK ? err : NULL);
  if (status == CAST_OK) status = closed;
  if (status == CAST_OK) series->step[series->n_steps++] = step;
  return status;
}

/* ---- going on with a file ---- */

/* Rows that the first n steps take: of Points, of fields and of the sets with one row a step or part. */
static CastStatus cut_steps(const VtkSeries *series, hid_t root, CastError *err)
{
  static const char *const by_step[] = {"Values",       "PartOffsets", "NumberOfParts",
                                        "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"};
  const hsize_t n = series->n_steps;
  char name[256];
  for (size_t k = 0; k < sizeof by_step / sizeof *by_step; k++) {
    snprintf(name, sizeof name, "Steps/%s", by_step[k]);
    CAST_CALL(h5_grow_cut(root, name, n, err));
  }
  for (size_t f = 0; f < series->n_fields; f++) {
    snprintf(name, sizeof name, "PointData/%s", series->field[f].name);
    CAST_CALL(h5_grow_cut(root, name, (hsize_t)vtk_series_n_values(series), err));
    snprintf(name, sizeof name, "Steps/PointDataOffsets/%s", series->field[f].name);
    CAST_CALL(h5_grow_cut(root, name, n, err));
  }
  if (series->fixed) return h5_grow_cut(root, "Steps/CellDataOffsets/patch", n, err);
  CAST_CALL(h5_grow_cut(root, "Points", (hsize_t)vtk_series_n_points(series), err));
  CAST_CALL(h5_grow_cut(root, "NumberOfPoints", n, err));
  for (int k = 0; k < N_TOPOLOGIES; k++) {
    snprintf(name, sizeof name, "%s/NumberOfCells", TOPOLOGIES[k]);
    CAST_CALL(h5_grow_cut(root, name, n, err));
    snprintf(name, sizeof name, "%s/NumberOfConnectivityIds", TOPOLOGIES[k]);
    CAST_CALL(h5_grow_cut(root, name, n, err));
  }
  // each vertex list may have been left at a length of its own by an append that was cut off
  CAST_CALL(h5_grow_cut(root, "Vertices/Connectivity", (hsize_t)series->n_vertices, err));
  return h5_grow_cut(root, "Vertices/Offsets", (hsize_t)series->n_vertices + 1, err);
}

static CastStatus take_over(VtkSeries *series, hid_t file, size_t n_steps, CastError *err)
{
  size_t found = 0;
  CAST_CALL(vtk_series_read_steps(file, &found, &series->step, err));
  series->capacity = found;
  CAST_CHECK(found >= n_steps, err, CAST_ERR_FORMAT, "%s: holds %zu steps, at least %zu are expected", series->path,
             found, n_steps);
  series->n_steps = n_steps;
  for (size_t s = 0; s < n_steps; s++)
    if (series->step[s].n_points > series->n_vertices) series->n_vertices = series->step[s].n_points;
  const hid_t root = H5Gopen2(file, "VTKHDF", H5P_DEFAULT);
  series->fixed = h5_exists(root, "CellData/patch");
  if (series->fixed && n_steps > 0) series->mesh_points = series->step[0].n_points;
  CastStatus status = cut_steps(series, root, err);
  if (status == CAST_OK) status = set_n_steps(root, (long long)n_steps, err);
  H5Gclose(root);
  return status;
}

CastStatus vtk_series_reopen(const char *path, size_t n_fields, const VtkField *field, size_t n_steps,
                             VtkSeries **series, CastError *err)
{
  hid_t file = -1;
  *series = NULL;
  CAST_CALL(h5_grow_open(path, &file, err));
  CastStatus status = allocate(path, n_fields, field, series, err);
  if (status == CAST_OK) status = take_over(*series, file, n_steps, err);
  const CastStatus closed = h5_file_close(&file, status == CAST_OK ? err : NULL);
  if (status == CAST_OK) status = closed;
  if (status != CAST_OK) vtk_series_destroy(series);
  return status;
}

/* ---- what it holds ---- */

size_t vtk_series_n_steps(const VtkSeries *series)
{
  return series->n_steps;
}

const VtkStep *vtk_series_steps(const VtkSeries *series)
{
  return series->step;
}

const char *vtk_series_path(const VtkSeries *series)
{
  return series->path;
}

size_t vtk_series_n_fields(const VtkSeries *series)
{
  return series->n_fields;
}

const VtkField *vtk_series_fields(const VtkSeries *series)
{
  return series->field;
}

long long vtk_series_n_values(const VtkSeries *series)
{
  const VtkStep *last = series->n_steps ? &series->step[series->n_steps - 1] : NULL;
  return last ? last->first_value + last->n_points : 0;
}

long long vtk_series_n_points(const VtkSeries *series)
{
  const VtkStep *last = series->n_steps ? &series->step[series->n_steps - 1] : NULL;
  if (series->fixed) return series->mesh_points;
  return last ? last->first_point + last->n_points : 0;
}
