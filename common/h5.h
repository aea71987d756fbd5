/* h5.h - thin helpers over HDF5: data sets that carry their unit and description, errors that name file and set. */
#ifndef COMMON_H5_H
#define COMMON_H5_H

#include <hdf5.h>
#include <stddef.h>
#include "common/error.h"

/* Write a whole data set of rank 1..3, chunked and compressed with a fletcher32 checksum where it is larger than 4 KiB.
 * `type` is the memory type (H5T_NATIVE_DOUBLE, ...). `units` and `description` become attributes. */
CastStatus h5_write(hid_t group, const char *name, hid_t type, int rank, const hsize_t *shape, const void *data,
                    const char *units, const char *description, CastError *err);
/* Read a whole data set into malloc'ed memory after checking its rank and, where shape[i] != 0, its extent;
 * shape is filled in. Errors: CAST_ERR_FORMAT, naming the set. */
CastStatus h5_read(hid_t group, const char *name, hid_t type, int rank, hsize_t *shape, void **data, CastError *err);
CastStatus h5_write_text(hid_t group, const char *name, const char *text, const char *description, CastError *err);
CastStatus h5_read_text(hid_t group, const char *name, char **text, CastError *err);
CastStatus h5_write_attribute(hid_t object, const char *name, hid_t type, size_t n, const void *values, CastError *err);
CastStatus h5_write_text_attribute(hid_t object, const char *name, const char *text, CastError *err);
CastStatus h5_read_attribute(hid_t object, const char *name, hid_t type, size_t n, void *values, CastError *err);
CastStatus h5_read_text_attribute(hid_t object, const char *name, char **text, CastError *err);
#endif
