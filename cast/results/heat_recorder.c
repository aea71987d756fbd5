#include "cast/results/heat_recorder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/io/h5_grow.h"

struct HeatRecorder {
  char path[4200];
  double every; // s
  size_t m, n_triangles, rows;
  double now, written;          // s, up to where heat was added, and rows are written
  double *heat, *triangle_heat; // [m], [n_triangles] J of the interval begun
};

/* A wide row is a compressed chunk of its own; narrow ones share chunks of 64 KiB, which are not compressed. */
static GrowingSet heat_set(const char *name, size_t columns, const char *description)
{
  enum { WIDE = 512, CHUNK_BYTES = 65536 };
  const bool wide = columns >= WIDE;
  return (GrowingSet){name, H5T_IEEE_F64LE, columns, wide ? 1 : CHUNK_BYTES / (8 * columns), "J", description};
}

static CastStatus write_head(hid_t file, const HeatRecorderSetup *setup, CastError *err)
{
  const int version = HEAT_RECORD_VERSION;
  CAST_CALL(h5_write_text_attribute(file, "format", HEAT_RECORD_FORMAT, err));
  CAST_CALL(h5_write_attribute(file, "version", H5T_NATIVE_INT, 1, &version, err));
  CAST_CALL(h5_write_text_attribute(file, HEAT_RECORD_ROM, setup->rom_sha256, err));
  CAST_CALL(h5_write_attribute(file, HEAT_RECORD_PREHEAT, H5T_NATIVE_DOUBLE, 1, &setup->preheat, err));
  CAST_CALL(h5_write_attribute(file, HEAT_RECORD_AMBIENT, H5T_NATIVE_DOUBLE, 1, &setup->ambient, err));
  const GrowingSet time = {
      HEAT_RECORD_TIME, H5T_IEEE_F64LE, 0, 512, "s", "end of each interval; the first begins at 0"};
  const GrowingSet heat =
      heat_set(HEAT_RECORD_HEAT, setup->m, "heat into the mould through each patch (columns) in each interval (rows)");
  CAST_CALL(h5_grow_create(file, &time, err));
  CAST_CALL(h5_grow_create(file, &heat, err));
  if (setup->n_triangles == 0) return CAST_OK;
  const hsize_t shape[1] = {setup->n_triangles};
  CAST_CALL(h5_write(file, HEAT_RECORD_TRIANGLE, H5T_NATIVE_INT32, 1, shape, setup->triangle, "1",
                     "triangles of the ROM's surface that the cavity's wall is made of", err));
  const GrowingSet by_triangle = heat_set(HEAT_RECORD_TRIANGLE_HEAT, setup->n_triangles,
                                          "heat through each of these triangles (columns) in each interval (rows)");
  return h5_grow_create(file, &by_triangle, err);
}

static CastStatus create_file(const HeatRecorder *recorder, const HeatRecorderSetup *setup, CastError *err)
{
  hid_t file = -1;
  CAST_CALL(h5_file_create(recorder->path, &file, err));
  CastStatus status = write_head(file, setup, err);
  const CastStatus closed = h5_file_close(&file, status == CAST_OK ? err : NULL);
  return status == CAST_OK ? closed : status;
}

static CastStatus cut_file(const HeatRecorder *recorder, size_t rows, CastError *err)
{
  hid_t file = -1;
  CAST_CALL(h5_grow_open(recorder->path, &file, err));
  CastStatus status = h5_grow_cut(file, HEAT_RECORD_TIME, rows, err);
  if (status == CAST_OK) status = h5_grow_cut(file, HEAT_RECORD_HEAT, rows, err);
  if (status == CAST_OK && recorder->n_triangles > 0) status = h5_grow_cut(file, HEAT_RECORD_TRIANGLE_HEAT, rows, err);
  const CastStatus closed = h5_file_close(&file, status == CAST_OK ? err : NULL);
  return status == CAST_OK ? closed : status;
}

CastStatus heat_recorder_open(const char *folder, const HeatRecorderSetup *setup, const size_t *rows,
                              HeatRecorder **out, CastError *err)
{
  HeatRecorder *recorder = *out = calloc(1, sizeof *recorder);
  CAST_CHECK(recorder, err, CAST_ERR_MEMORY, "no memory");
  snprintf(recorder->path, sizeof recorder->path, "%.4000s/heat.h5", folder);
  recorder->every = setup->every;
  recorder->m = setup->m;
  recorder->n_triangles = setup->n_triangles;
  recorder->rows = rows ? *rows : 0;
  recorder->heat = calloc(setup->m + 1, sizeof(double));
  recorder->triangle_heat = calloc(setup->n_triangles + 1, sizeof(double));
  CastStatus status = CAST_OK;
  if (!recorder->heat || !recorder->triangle_heat)
    status = cast_error_set(err, CAST_ERR_MEMORY, "no memory to record the heat of %zu patches", setup->m);
  if (status == CAST_OK) status = rows ? cut_file(recorder, *rows, err) : create_file(recorder, setup, err);
  if (status != CAST_OK) heat_recorder_close(out);
  return status;
}

void heat_recorder_close(HeatRecorder **recorder)
{
  if (!recorder || !*recorder) return;
  free((*recorder)->heat);
  free((*recorder)->triangle_heat);
  free(*recorder);
  *recorder = NULL;
}

/* `time` last: a row whose time is there is whole. */
static CastStatus append_row(const HeatRecorder *recorder, hid_t file, double time, CastError *err)
{
  CAST_CALL(h5_grow_append(file, HEAT_RECORD_HEAT, H5T_NATIVE_DOUBLE, 1, recorder->heat, err));
  if (recorder->n_triangles > 0)
    CAST_CALL(h5_grow_append(file, HEAT_RECORD_TRIANGLE_HEAT, H5T_NATIVE_DOUBLE, 1, recorder->triangle_heat, err));
  return h5_grow_append(file, HEAT_RECORD_TIME, H5T_NATIVE_DOUBLE, 1, &time, err);
}

static CastStatus write_row(HeatRecorder *recorder, double time, CastError *err)
{
  hid_t file = -1;
  CAST_CALL(h5_grow_open(recorder->path, &file, err));
  CastStatus status = append_row(recorder, file, time, err);
  const CastStatus closed = h5_file_close(&file, status == CAST_OK ? err : NULL);
  if (status == CAST_OK) status = closed;
  CAST_CALL(status);
  recorder->rows++;
  recorder->written = time;
  memset(recorder->heat, 0, recorder->m * sizeof(double));
  memset(recorder->triangle_heat, 0, recorder->n_triangles * sizeof(double));
  return CAST_OK;
}

static void collect(HeatRecorder *recorder, double dt, const double *flow, const double *power)
{
  for (size_t l = 0; l < recorder->m; l++) recorder->heat[l] += flow[l] * dt;
  for (size_t i = 0; i < recorder->n_triangles; i++) recorder->triangle_heat[i] += power[i] * dt;
}

CastStatus heat_recorder_add(HeatRecorder *recorder, double t, double dt, const double *flow, const double *power,
                             CastError *err)
{
  const double end = t + dt;
  for (double edge = recorder->every * (double)(recorder->rows + 1); end >= edge * (1.0 - 1e-12);
       edge = recorder->every * (double)(recorder->rows + 1)) {
    const double part = fmin(edge, end);
    collect(recorder, part - t, flow, power);
    t = part;
    CAST_CALL(write_row(recorder, edge, err));
  }
  if (end > t) collect(recorder, end - t, flow, power);
  recorder->now = end;
  return CAST_OK;
}

CastStatus heat_recorder_add_interval(HeatRecorder *recorder, double t, double dt, const double *flow,
                                      const double *power, CastError *err)
{
  recorder->now = t;
  CAST_CALL(heat_recorder_finish(recorder, err));
  collect(recorder, dt, flow, power);
  recorder->now = t + dt;
  return write_row(recorder, recorder->now, err);
}

CastStatus heat_recorder_finish(HeatRecorder *recorder, CastError *err)
{
  return recorder->now > recorder->written * (1.0 + 1e-12) ? write_row(recorder, recorder->now, err) : CAST_OK;
}

size_t heat_recorder_size(const HeatRecorder *recorder)
{
  return 3 + recorder->m + recorder->n_triangles;
}

void heat_recorder_save(const HeatRecorder *recorder, double *buffer)
{
  buffer[0] = (double)recorder->rows;
  buffer[1] = recorder->now;
  buffer[2] = recorder->written;
  memcpy(buffer + 3, recorder->heat, recorder->m * sizeof *buffer);
  memcpy(buffer + 3 + recorder->m, recorder->triangle_heat, recorder->n_triangles * sizeof *buffer);
}

size_t heat_recorder_saved_rows(const double *buffer)
{
  return (size_t)buffer[0];
}

void heat_recorder_restore(HeatRecorder *recorder, const double *buffer)
{
  recorder->rows = heat_recorder_saved_rows(buffer);
  recorder->now = buffer[1];
  recorder->written = buffer[2];
  memcpy(recorder->heat, buffer + 3, recorder->m * sizeof *buffer);
  memcpy(recorder->triangle_heat, buffer + 3 + recorder->m, recorder->n_triangles * sizeof *buffer);
}
