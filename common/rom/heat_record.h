/* heat_record.h - the heat that a run gave to its mould: castrun writes it, castreduce replays it on the full model.
 * An HDF5 file; row i holds the joules of the interval from time[i - 1] (0 for the first) to time[i], so that sums are
 * exact however the steps fell. docs/user-guide describes the data sets. */
#ifndef COMMON_ROM_HEAT_RECORD_H
#define COMMON_ROM_HEAT_RECORD_H

#include <stddef.h>
#include <stdint.h>
#include "common/error.h"

enum { HEAT_RECORD_VERSION = 1 };
#define HEAT_RECORD_FORMAT "castrun heat record"
#define HEAT_RECORD_TIME "time"                   // s, ends of the intervals
#define HEAT_RECORD_HEAT "heat"                   // J, [intervals x patches]
#define HEAT_RECORD_TRIANGLE "triangle"           // triangles of the ROM's surface that have a column below
#define HEAT_RECORD_TRIANGLE_HEAT "triangle_heat" // J, [intervals x triangles]
#define HEAT_RECORD_ROM "rom_sha256"              // attributes
#define HEAT_RECORD_PREHEAT "preheat"             // K
#define HEAT_RECORD_AMBIENT "ambient"             // K

typedef struct HeatRecord {
  char rom_sha256[65];     // of the ROM file that the run used
  double preheat, ambient; // K
  size_t n, m;             // intervals, patches
  double *time;            // [n] s
  double *heat;            // [n*m] J
  size_t n_triangles;      // 0: not recorded
  int32_t *triangle;       // [n_triangles] of the ROM
  double *triangle_heat;   // [n*n_triangles] J; a patch's add up to its heat
} HeatRecord;

/* Read and check: times ascend, numbers are finite, triangles are in range. A run that was cut off leaves whole rows;
 * the last may lack a part and is then dropped. Errors: CAST_ERR_IO, CAST_ERR_FORMAT. */
CastStatus heat_record_read(const char *path, HeatRecord *record, CastError *err);
void heat_record_free(HeatRecord *record);

#endif
