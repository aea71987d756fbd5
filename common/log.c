#include "common/log.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

struct Log {
  FILE *file; // NULL: none
  bool quiet, terminal;
  int warnings;
  bool line_open;    // a progress line stands on the terminal
  char work[64];     // name of the work in progress; empty: none
  double work_start; // when it began, s
  double work_from;  // and at which fraction: a resumed run does not begin at 0
  double last_screen, last_file;
};

double log_wall_time(void)
{
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

CastStatus log_open(const char *path, bool quiet, Log **log, CastError *err)
{
  *log = NULL;
  Log *made = calloc(1, sizeof *made);
  CAST_CHECK(made, err, CAST_ERR_MEMORY, "no memory for the log");
  made->quiet = quiet;
  made->terminal = isatty(fileno(stderr)) == 1;
  if (path && !(made->file = fopen(path, "a"))) {
    free(made);
    return cast_error_set(err, CAST_ERR_IO, "log file '%s' cannot be written: %s", path, strerror(errno));
  }
  *log = made;
  return CAST_OK;
}

void log_close(Log **log)
{
  if (!log || !*log) return;
  log_progress_end(*log);
  if ((*log)->file) fclose((*log)->file);
  free(*log);
  *log = NULL;
}

static void clear_line(Log *log)
{
  if (!log->line_open) return;
  fputs("\r\033[K", stderr);
  log->line_open = false;
}

static void file_line(Log *log, const char *prefix, const char *text)
{
  if (!log->file) return;
  const time_t now = time(NULL);
  struct tm utc;
  gmtime_r(&now, &utc);
  char stamp[32];
  strftime(stamp, sizeof stamp, "%Y-%m-%dT%H:%M:%SZ", &utc);
  fprintf(log->file, "%s %s%s\n", stamp, prefix, text);
  if (fflush(log->file) == 0) return;
  fprintf(stderr, "warning: the log file cannot be written and ends here: %s\n", strerror(errno));
  fclose(log->file);
  log->file = NULL;
  log->warnings++;
}

__attribute__((format(printf, 3, 0))) static void write_message(Log *log, const char *prefix, const char *format,
                                                                va_list arguments)
{
  char text[4096];
  vsnprintf(text, sizeof text, format, arguments);
  file_line(log, prefix, text);
  if (log->quiet && prefix[0] == '\0') return;
  clear_line(log);
  fprintf(stderr, "%s%s\n", prefix, text);
}

void log_info(Log *log, const char *format, ...)
{
  if (!log) return;
  va_list arguments;
  va_start(arguments, format);
  write_message(log, "", format, arguments);
  va_end(arguments);
}

void log_warn(Log *log, const char *format, ...)
{
  if (!log) return;
  log->warnings++;
  va_list arguments;
  va_start(arguments, format);
  write_message(log, "warning: ", format, arguments);
  va_end(arguments);
}

int log_warning_count(const Log *log)
{
  return log ? log->warnings : 0;
}

static void format_duration(double seconds, char *buffer, size_t size)
{
  const long s = (long)(seconds + 0.5);
  if (s < 120)
    snprintf(buffer, size, "%ld s", s);
  else if (s < 7200)
    snprintf(buffer, size, "%ld min %02ld s", s / 60, s % 60);
  else
    snprintf(buffer, size, "%ld h %02ld min", s / 3600, s % 3600 / 60);
}

/* Time left if the work goes on as fast as since it began here. */
static double seconds_left(const Log *log, double fraction, double now)
{
  const double done = fraction - log->work_from;
  return done > 0.0 ? (now - log->work_start) * (1.0 - fraction) / done : (double)NAN;
}

static void format_progress(const Log *log, double fraction, double now, const char *note, char *text, size_t size)
{
  const double seconds = seconds_left(log, fraction, now);
  char left[64];
  int used = snprintf(text, size, "%s: %5.1f %%", log->work, 100.0 * fraction);
  if (note && note[0]) used += snprintf(text + used, size - (size_t)used, ", %.300s", note);
  if (fraction >= 1.0 || !isfinite(seconds)) return;
  format_duration(seconds, left, sizeof left);
  snprintf(text + used, size - (size_t)used, ", %s left", left);
}

/* Redraw the line in place; one that wraps could not be taken back. */
static void draw_line(Log *log, const char *text)
{
  struct winsize window;
  const bool known = ioctl(fileno(stderr), TIOCGWINSZ, &window) == 0 && window.ws_col > 1;
  fprintf(stderr, "\r\033[K%.*s", known ? window.ws_col - 1 : 79, text);
  fflush(stderr);
  log->line_open = true;
}

static void begin_work(Log *log, const char *work, double fraction, double now)
{
  log_progress_end(log);
  snprintf(log->work, sizeof log->work, "%s", work);
  log->work_start = log->last_file = now;
  log->work_from = fraction;
  log->last_screen = -INFINITY;
}

void log_progress(Log *log, const char *work, double fraction, const char *note)
{
  if (!log) return;
  const double now = log_wall_time(), shown = fmin(fmax(fraction, 0.0), 1.0); // a NaN counts as nothing done
  if (strncmp(work, log->work, sizeof log->work - 1) != 0) begin_work(log, work, shown, now);
  const bool to_screen = log->terminal && !log->quiet && (now - log->last_screen > 0.25 || shown >= 1.0);
  const bool to_file = now - log->last_file > 5.0;
  if (!to_screen && !to_file) return;
  char text[512];
  format_progress(log, shown, now, note, text, sizeof text);
  if (to_screen) {
    draw_line(log, text);
    log->last_screen = now;
  }
  if (to_file) {
    file_line(log, "", text);
    if (!log->terminal && !log->quiet) fprintf(stderr, "%s\n", text);
    log->last_file = now;
  }
}

void log_progress_end(Log *log)
{
  if (!log || log->work[0] == '\0') return;
  if (log->line_open) fputc('\n', stderr);
  log->line_open = false;
  log->work[0] = '\0';
}
