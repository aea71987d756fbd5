/* h5_grow.h - data sets that get longer while a run goes on. */
#ifndef CAST_IO_H5_GROW_H
#define CAST_IO_H5_GROW_H

#include "common/h5/h5.h"

typedef struct GrowingSet {
  const char *name; // path in the file
  hid_t type;       // as stored
  hsize_t columns;  // 0: rank 1; else rank 2
  hsize_t chunk;    // rows of a chunk; compressed where above 1024, or 1 and wide: a chunk rewritten leaves a hole
  const char *units, *description;
} GrowingSet;

/* Open a file that h5_file_create made, to go on writing. Errors: CAST_ERR_IO, CAST_ERR_FORMAT. */
CastStatus h5_grow_open(const char *path, hid_t *file, CastError *err);
/* An empty set. Errors: CAST_ERR_IO. */
CastStatus h5_grow_create(hid_t group, const GrowingSet *set, CastError *err);
/* Put `rows` rows behind those there; `type` is that of the memory. Errors: CAST_ERR_IO with the system's reason. */
CastStatus h5_grow_append(hid_t group, const char *name, hid_t type, hsize_t rows, const void *data, CastError *err);
/* Drop the rows from `rows` on. Errors: CAST_ERR_FORMAT if there are fewer. */
CastStatus h5_grow_cut(hid_t group, const char *name, hsize_t rows, CastError *err);

#endif
