/* h5_attribute.c - attributes of files, groups and data sets. */
#include "common/h5/h5.h"
#include "common/h5/h5_private.h"

#include <stdlib.h>
#include <string.h>

static CastStatus attribute_failed(hid_t object, const char *name, const char *fault, CastStatus code, CastError *err)
{
  char path[4096], owner[256];
  h5_file_name(object, path, sizeof path);
  if (H5Iget_name(object, owner, sizeof owner) <= 0) snprintf(owner, sizeof owner, "/");
  return cast_error_set(err, code, "%s: attribute %s of %s %s", path, name, owner, fault);
}

static CastStatus write_value(hid_t object, const char *name, hid_t type, hid_t space, const void *values,
                              CastError *err)
{
  const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  const bool ok = attribute >= 0 && H5Awrite(attribute, type, values) >= 0;
  char reason[512] = "", fault[600];
  if (!ok && h5_reason(reason, sizeof reason)) h5_abandon(object);
  if (attribute >= 0) H5Aclose(attribute);
  if (ok) return CAST_OK;
  snprintf(fault, sizeof fault, "cannot be written: %s", reason);
  return attribute_failed(object, name, fault, CAST_ERR_IO, err);
}

CastStatus h5_write_attribute(hid_t object, const char *name, hid_t type, size_t n, const void *values, CastError *err)
{
  h5_quiet();
  const hsize_t shape[1] = {n};
  const hid_t space = H5Screate_simple(1, shape, NULL);
  const CastStatus status = write_value(object, name, type, space, values, err);
  H5Sclose(space);
  return status;
}

CastStatus h5_write_text_attribute(hid_t object, const char *name, const char *text, CastError *err)
{
  h5_quiet();
  const size_t length = strlen(text);
  const hid_t space = H5Screate(H5S_SCALAR), type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, length > 0 ? length : 1);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  for (size_t i = 0; i < length; i++)
    if ((unsigned char)text[i] >= 0x80) H5Tset_cset(type, H5T_CSET_UTF8);
  const CastStatus status = write_value(object, name, type, space, text, err);
  H5Tclose(type);
  H5Sclose(space);
  return status;
}

static CastStatus open_attribute(hid_t object, const char *name, hid_t *attribute, CastError *err)
{
  h5_quiet();
  if (H5Aexists(object, name) <= 0) return attribute_failed(object, name, "is missing", CAST_ERR_FORMAT, err);
  *attribute = H5Aopen(object, name, H5P_DEFAULT);
  return *attribute >= 0 ? CAST_OK : attribute_failed(object, name, "cannot be opened", CAST_ERR_FORMAT, err);
}

CastStatus h5_read_attribute(hid_t object, const char *name, hid_t type, size_t n, void *values, CastError *err)
{
  hid_t attribute = -1;
  CAST_CALL(open_attribute(object, name, &attribute, err));
  const hid_t space = H5Aget_space(attribute), stored = H5Aget_type(attribute);
  const hssize_t found = H5Sget_simple_extent_npoints(space);
  const bool fits = found == (hssize_t)n && H5Tget_class(stored) == H5Tget_class(type);
  const bool ok = fits && H5Aread(attribute, type, values) >= 0;
  H5Tclose(stored);
  H5Sclose(space);
  H5Aclose(attribute);
  char fault[128];
  snprintf(fault, sizeof fault, "has %lld values or another kind of value, %zu are expected", (long long)found, n);
  return ok ? CAST_OK : attribute_failed(object, name, fits ? "cannot be read" : fault, CAST_ERR_FORMAT, err);
}

static CastStatus read_text(hid_t object, hid_t attribute, hid_t stored, const char *name, char **text, CastError *err)
{
  enum { LARGEST = 64 << 10 }; // HDF5's own limit for an attribute in an object header
  const bool is_text = H5Tget_class(stored) == H5T_STRING && H5Tis_variable_str(stored) <= 0;
  const size_t length = H5Tget_size(stored);
  const hid_t space = H5Aget_space(attribute);
  const bool single = H5Sget_simple_extent_npoints(space) == 1;
  H5Sclose(space);
  if (!is_text || !single || length > LARGEST)
    return attribute_failed(object, name, "is not one fixed-length text", CAST_ERR_FORMAT, err);
  *text = calloc(length + 1, 1);
  CAST_CHECK(*text, err, CAST_ERR_MEMORY, "no memory for attribute %s", name);
  if (H5Aread(attribute, stored, *text) >= 0) return CAST_OK;
  free(*text);
  *text = NULL;
  return attribute_failed(object, name, "cannot be read", CAST_ERR_FORMAT, err);
}

CastStatus h5_read_text_attribute(hid_t object, const char *name, char **text, CastError *err)
{
  hid_t attribute = -1;
  *text = NULL;
  CAST_CALL(open_attribute(object, name, &attribute, err));
  const hid_t stored = H5Aget_type(attribute);
  const CastStatus status = read_text(object, attribute, stored, name, text, err);
  H5Tclose(stored);
  H5Aclose(attribute);
  return status;
}
