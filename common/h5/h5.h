/* h5.h - thin helpers over HDF5: data sets that carry their unit and description, errors that name file and set.
 * HDF5 itself prints nothing: what it has to say (a full disk, a damaged chunk) becomes part of the message. */
#ifndef COMMON_H5_H5_H
#define COMMON_H5_H5_H

#include <hdf5.h>
#include <stdbool.h>
#include <stddef.h>
#include "common/error.h"

enum { H5_NAME_LENGTH = 64 }; // bytes of each entry of an array of names, the closing zero included

/* Make a new file (replacing one that is there). Its metadata carries checksums (HDF5 1.10 and newer read it).
 * Errors: CAST_ERR_IO with the system's reason. */
CastStatus h5_file_create(const char *path, hid_t *file, CastError *err);
/* Open for reading. Errors: CAST_ERR_IO (cannot be opened), CAST_ERR_FORMAT (not HDF5, damaged, truncated). */
CastStatus h5_file_open(const char *path, hid_t *file, CastError *err);
/* Close; for a file that was written, everything is on the disk (fsync) on success. `file` becomes -1 in any case. A
 * negative one is accepted and nothing is done. Errors: CAST_ERR_IO with the system's reason, such as a full disk. */
CastStatus h5_file_close(hid_t *file, CastError *err);
/* Keep HDF5 from printing its error stack; done by every function here, wanted before direct calls of H5 functions. */
void h5_quiet(void);
/* Make a group (and those above it), close it with H5Gclose. */
CastStatus h5_group_create(hid_t parent, const char *name, hid_t *group, CastError *err);

/* Write a whole data set of rank 0..3 (rank 0: one value, shape may be NULL), chunked and compressed with a fletcher32
 * checksum where it is larger than 4 KiB. A name with slashes makes the groups it names.
 * `type` is the memory type (H5T_NATIVE_DOUBLE, ...). `units` and `description` become attributes. */
CastStatus h5_write(hid_t group, const char *name, hid_t type, int rank, const hsize_t *shape, const void *data,
                    const char *units, const char *description, CastError *err);
/* Read a whole data set into malloc'ed memory after checking its rank and, where shape[i] != 0, its extent;
 * shape is filled in. A set that claims more than the file can hold is refused before memory is asked for.
 * Errors: CAST_ERR_FORMAT, naming the set. */
CastStatus h5_read(hid_t group, const char *name, hid_t type, int rank, hsize_t *shape, void **data, CastError *err);
/* An array of n names, each H5_NAME_LENGTH bytes with its closing zero inside. */
CastStatus h5_write_names(hid_t group, const char *name, size_t n, const char *names, const char *description,
                          CastError *err);
CastStatus h5_read_names(hid_t group, const char *name, size_t *n, char **names, CastError *err);
CastStatus h5_write_text(hid_t group, const char *name, const char *text, const char *description, CastError *err);
CastStatus h5_read_text(hid_t group, const char *name, char **text, CastError *err);
bool h5_exists(hid_t group, const char *name); // each link on the way is there
CastStatus h5_write_attribute(hid_t object, const char *name, hid_t type, size_t n, const void *values, CastError *err);
/* Text of fixed length without a closing zero, as VTK wants it. */
CastStatus h5_write_text_attribute(hid_t object, const char *name, const char *text, CastError *err);
CastStatus h5_read_attribute(hid_t object, const char *name, hid_t type, size_t n, void *values, CastError *err);
CastStatus h5_read_text_attribute(hid_t object, const char *name, char **text, CastError *err);
#endif
