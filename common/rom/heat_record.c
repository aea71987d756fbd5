#include "common/rom/heat_record.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "common/h5/h5.h"

static CastStatus check_format(hid_t file, const char *path, HeatRecord *record, CastError *err)
{
  char *format = NULL, *rom = NULL;
  int version = 0;
  CAST_CALL(h5_read_text_attribute(file, "format", &format, err));
  const bool ours = strcmp(format, HEAT_RECORD_FORMAT) == 0;
  free(format);
  CAST_CHECK(ours, err, CAST_ERR_FORMAT, "%s: is no record of heat flows (castrun writes one with output.record)",
             path);
  CAST_CALL(h5_read_attribute(file, "version", H5T_NATIVE_INT, 1, &version, err));
  CAST_CHECK(version == HEAT_RECORD_VERSION, err, CAST_ERR_FORMAT, "%s: is of version %d, version %d can be read", path,
             version, HEAT_RECORD_VERSION);
  CAST_CALL(h5_read_text_attribute(file, HEAT_RECORD_ROM, &rom, err));
  snprintf(record->rom_sha256, sizeof record->rom_sha256, "%s", rom);
  free(rom);
  CAST_CALL(h5_read_attribute(file, HEAT_RECORD_PREHEAT, H5T_NATIVE_DOUBLE, 1, &record->preheat, err));
  return h5_read_attribute(file, HEAT_RECORD_AMBIENT, H5T_NATIVE_DOUBLE, 1, &record->ambient, err);
}

/* Rows are appended set by set: the shortest tells how many are whole. */
static CastStatus read_rows(hid_t file, HeatRecord *record, CastError *err)
{
  hsize_t shape[2] = {0, 0};
  CAST_CALL(h5_read(file, HEAT_RECORD_TIME, H5T_NATIVE_DOUBLE, 1, shape, (void **)&record->time, err));
  record->n = shape[0];
  shape[0] = 0;
  CAST_CALL(h5_read(file, HEAT_RECORD_HEAT, H5T_NATIVE_DOUBLE, 2, shape, (void **)&record->heat, err));
  record->m = shape[1];
  if (shape[0] < record->n) record->n = shape[0];
  if (!h5_exists(file, HEAT_RECORD_TRIANGLE)) return CAST_OK;
  shape[0] = 0;
  CAST_CALL(h5_read(file, HEAT_RECORD_TRIANGLE, H5T_NATIVE_INT32, 1, shape, (void **)&record->triangle, err));
  record->n_triangles = shape[0];
  shape[0] = 0;
  shape[1] = record->n_triangles;
  CAST_CALL(
      h5_read(file, HEAT_RECORD_TRIANGLE_HEAT, H5T_NATIVE_DOUBLE, 2, shape, (void **)&record->triangle_heat, err));
  if (shape[0] < record->n) record->n = shape[0];
  return CAST_OK;
}

static CastStatus check_finite(const char *path, const char *set, const double *values, size_t n, CastError *err)
{
  for (size_t i = 0; i < n; i++)
    CAST_CHECK(isfinite(values[i]), err, CAST_ERR_FORMAT, "%s: %s: entry %zu is %g, a finite number is expected", path,
               set, i, values[i]);
  return CAST_OK;
}

static CastStatus check_contents(const char *path, const HeatRecord *record, CastError *err)
{
  CAST_CHECK(record->n > 0, err, CAST_ERR_FORMAT, "%s: holds no interval yet", path);
  CAST_CHECK(isfinite(record->preheat) && record->preheat > 0.0 && isfinite(record->ambient) && record->ambient > 0.0,
             err, CAST_ERR_FORMAT, "%s: preheat %g K and ambient %g K: positive numbers are expected", path,
             record->preheat, record->ambient);
  CAST_CALL(check_finite(path, HEAT_RECORD_TIME, record->time, record->n, err));
  CAST_CALL(check_finite(path, HEAT_RECORD_HEAT, record->heat, record->n * record->m, err));
  CAST_CALL(check_finite(path, HEAT_RECORD_TRIANGLE_HEAT, record->triangle_heat, record->n * record->n_triangles, err));
  for (size_t i = 0; i < record->n; i++)
    CAST_CHECK(record->time[i] > (i > 0 ? record->time[i - 1] : 0.0), err, CAST_ERR_FORMAT,
               "%s: time: entry %zu, %g s, is not after the one before", path, i, record->time[i]);
  for (size_t t = 0; t < record->n_triangles; t++)
    CAST_CHECK(record->triangle[t] > (t > 0 ? record->triangle[t - 1] : -1), err, CAST_ERR_FORMAT,
               "%s: triangle: entry %zu is %d, ascending numbers from 0 are expected", path, t,
               (int)record->triangle[t]);
  return CAST_OK;
}

CastStatus heat_record_read(const char *path, HeatRecord *record, CastError *err)
{
  hid_t file = -1;
  *record = (HeatRecord){0};
  CAST_CALL(h5_file_open(path, &file, err));
  CastStatus status = check_format(file, path, record, err);
  if (status == CAST_OK) status = read_rows(file, record, err);
  h5_file_close(&file, NULL);
  if (status == CAST_OK) status = check_contents(path, record, err);
  if (status != CAST_OK) heat_record_free(record);
  return status;
}

void heat_record_free(HeatRecord *record)
{
  free(record->time);
  free(record->heat);
  free(record->triangle);
  free(record->triangle_heat);
  *record = (HeatRecord){0};
}
