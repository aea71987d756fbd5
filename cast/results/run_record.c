#define _GNU_SOURCE // open_memstream
#include "cast/results/run_record.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "cast/io/h5_grow.h"

static CastStatus write_provenance(hid_t file, const Provenance *provenance, CastError *err)
{
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  CAST_CHECK(out, err, CAST_ERR_MEMORY, "no memory");
  provenance_print(out, "", provenance);
  fclose(out);
  const CastStatus status = h5_write_text(file, "castrun/provenance", text, "program, host, command and hashes", err);
  free(text);
  return status;
}

static CastStatus write_inputs(hid_t file, const RunInputs *inputs, CastError *err)
{
  CAST_CALL(h5_write_text(file, "castrun/title", inputs->title, "of the run", err));
  CAST_CALL(h5_write_text(file, "castrun/input", inputs->input, "cast.yaml as it was read", err));
  CAST_CALL(h5_write_text(file, "castrun/material", inputs->material, "the melt's material as it was read", err));
  CAST_CALL(
      h5_write_text(file, "castrun/resolved", inputs->resolved, "the input with every default filled in, SI", err));
  return h5_write(file, "castrun/spacing", H5T_NATIVE_DOUBLE, 0, NULL, &inputs->spacing, "m", "of the particles", err);
}

CastStatus run_record_begin(const char *results, const RunInputs *inputs, const Provenance *provenance, CastError *err)
{
  hid_t file = -1;
  CAST_CALL(h5_grow_open(results, &file, err));
  CastStatus status = write_inputs(file, inputs, err);
  if (status == CAST_OK) status = write_provenance(file, provenance, err);
  const CastStatus closed = h5_file_close(&file, status == CAST_OK ? err : NULL);
  return status == CAST_OK ? closed : status;
}

static CastStatus replace_text(hid_t file, const char *name, const char *text, const char *description, CastError *err)
{
  if (h5_exists(file, name) && H5Ldelete(file, name, H5P_DEFAULT) < 0)
    return cast_error_set(err, CAST_ERR_IO, "data set %s cannot be replaced", name);
  return h5_write_text(file, name, text, description, err);
}

CastStatus run_record_end(const char *results, const char *summary_text, const char *summary_json, CastError *err)
{
  hid_t file = -1;
  CAST_CALL(h5_grow_open(results, &file, err));
  CastStatus status = replace_text(file, "castrun/summary", summary_text, "how the run went, for people", err);
  if (status == CAST_OK)
    status = replace_text(file, "castrun/summary_json", summary_json, "the same for programs, JSON", err);
  const CastStatus closed = h5_file_close(&file, status == CAST_OK ? err : NULL);
  return status == CAST_OK ? closed : status;
}

CastStatus run_record_read_summary(const char *results, char **text, CastError *err)
{
  hid_t file = -1;
  *text = NULL;
  CAST_CALL(h5_file_open(results, &file, err));
  CastStatus status = CAST_OK;
  if (h5_exists(file, "castrun/summary"))
    status = h5_read_text(file, "castrun/summary", text, err);
  else if (h5_exists(file, "castrun/provenance"))
    status = h5_read_text(file, "castrun/provenance", text, err);
  else
    status = cast_error_set(err, CAST_ERR_FORMAT, "%s: holds no /castrun/summary: not results of castrun", results);
  const CastStatus closed = h5_file_close(&file, status == CAST_OK ? err : NULL);
  return status == CAST_OK ? closed : status;
}

CastStatus run_record_write_text(const char *path, const char *text, CastError *err)
{
  char temporary[4300];
  snprintf(temporary, sizeof temporary, "%s.part", path);
  FILE *out = fopen(temporary, "w");
  CAST_CHECK(out, err, CAST_ERR_IO, "%s: cannot be created: %s", temporary, strerror(errno));
  const bool written = fputs(text, out) >= 0 && fflush(out) == 0;
  const int reason = errno;
  const bool closed = fclose(out) == 0;
  if (written && closed && rename(temporary, path) == 0) return CAST_OK;
  remove(temporary);
  return cast_error_set(err, CAST_ERR_IO, "%s: cannot be written: %s", path, strerror(written ? errno : reason));
}
