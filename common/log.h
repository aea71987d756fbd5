/* log.h - what a person reads while a program runs: messages, warnings and the progress of long work.
 * On a terminal the progress line is redrawn in place; in a log file each message is a plain line with the time. */
#ifndef COMMON_LOG_H
#define COMMON_LOG_H

#include <stdbool.h>
#include "common/error.h"

typedef struct Log Log;

/* `path` may be NULL (no log file); `quiet` keeps everything but warnings off the terminal. */
CastStatus log_open(const char *path, bool quiet, Log **log, CastError *err);
void log_close(Log **log);
/* Every call accepts log == NULL and then does nothing, so libraries may be run silently. */
void log_info(Log *log, const char *format, ...) __attribute__((format(printf, 2, 3)));
void log_warn(Log *log, const char *format, ...) __attribute__((format(printf, 2, 3)));
int log_warning_count(const Log *log);
/* Show `fraction` in [0, 1] done, with `note` (rate and the like); time left follows from the start of the work.
 * Cheap to call at every step: redraws at most 4 times a second on a terminal, a line every 5 s in a file. */
void log_progress(Log *log, const char *work, double fraction, const char *note);
void log_progress_end(Log *log);
double log_wall_time(void); // seconds, monotonic
#endif
