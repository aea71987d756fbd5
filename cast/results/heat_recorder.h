/* heat_recorder.h - writes heat.h5, the heat that the mould received, in intervals (common/heat_record.h). A step that
 * reaches into the next interval is divided in time, its flows being constant over it. Each row is on the disk, in a
 * file that is closed again, before the next begins. */
#ifndef CAST_RESULTS_HEAT_RECORDER_H
#define CAST_RESULTS_HEAT_RECORDER_H

#include "common/rom/heat_record.h"

typedef struct HeatRecorder HeatRecorder;

typedef struct HeatRecorderSetup {
  double every;            // s, length of an interval
  const char *rom_sha256;  // of the ROM file
  double preheat, ambient; // K
  size_t m;                // patches
  size_t n_triangles;      // 0: patches only
  const int32_t *triangle; // [n_triangles] of the ROM, ascending; borrowed
} HeatRecorderSetup;

/* A new file folder/heat.h5, or one that is gone on with after its first `rows` rows. Errors: CAST_ERR_IO,
 * CAST_ERR_MEMORY. */
CastStatus heat_recorder_open(const char *folder, const HeatRecorderSetup *setup, const size_t *rows,
                              HeatRecorder **recorder, CastError *err);
void heat_recorder_close(HeatRecorder **recorder);
/* Flows [m] and powers [n_triangles], W, constant from t to t + dt. Errors: CAST_ERR_IO. */
CastStatus heat_recorder_add(HeatRecorder *recorder, double t, double dt, const double *flow, const double *power,
                             CastError *err);
/* One step that is an interval of its own, however long: of the cooling stage, after which heat_recorder_add is not
 * called any more. The interval begun before it is written as it is. Errors: CAST_ERR_IO. */
CastStatus heat_recorder_add_interval(HeatRecorder *recorder, double t, double dt, const double *flow,
                                      const double *power, CastError *err);
/* The interval begun is written as it is: at the run's end. Errors: CAST_ERR_IO. */
CastStatus heat_recorder_finish(HeatRecorder *recorder, CastError *err);

/* For checkpoints: rows written and the interval begun. */
size_t heat_recorder_size(const HeatRecorder *recorder); // doubles
void heat_recorder_save(const HeatRecorder *recorder, double *buffer);
size_t heat_recorder_saved_rows(const double *buffer);
void heat_recorder_restore(HeatRecorder *recorder, const double *buffer);

#endif
