/* Messages and progress: on a terminal (a pseudo-terminal here), in a pipe and in the log file. */
#define _GNU_SOURCE // pseudo-terminals
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "common/log.h"

static char path[64];
static int true_stderr;

static int divert_stderr(int descriptor)
{
  fflush(stderr);
  return dup2(descriptor, 2) < 0;
}

static int prepare(void **state)
{
  (void)state;
  snprintf(path, sizeof path, "/tmp/log_XXXXXX");
  const int descriptor = mkstemp(path);
  if (descriptor >= 0) close(descriptor);
  true_stderr = dup(2);
  return descriptor < 0 || true_stderr < 0;
}

static int restore(void **state)
{
  (void)state;
  divert_stderr(true_stderr);
  close(true_stderr);
  unlink(path);
  return 0;
}

static void read_all(int descriptor, char *text, size_t size)
{
  size_t used = 0;
  ssize_t n;
  do { // a terminal hands over what it has; every test's output ends with a line
    n = read(descriptor, text + used, size - 1 - used);
    if (n > 0) used += (size_t)n;
  } while (n > 0 && used < size - 1 && text[used - 1] != '\n');
  text[used] = '\0';
}

static void read_file(char *text, size_t size)
{
  const int descriptor = open(path, O_RDONLY);
  read_all(descriptor, text, size);
  close(descriptor);
}

static void sleep_for(double seconds)
{
  const time_t whole = (time_t)seconds;
  const struct timespec time = {whole, (long)(1e9 * (seconds - (double)whole))};
  nanosleep(&time, NULL);
}

/* A terminal `columns` wide as stderr; returns the end that reads what is written there. */
static int open_terminal(unsigned short columns)
{
  const int master = posix_openpt(O_RDWR | O_NOCTTY);
  assert_true(master >= 0 && grantpt(master) == 0 && unlockpt(master) == 0);
  const int slave = open(ptsname(master), O_RDWR | O_NOCTTY);
  assert_true(slave >= 0);
  const struct winsize size = {.ws_row = 24, .ws_col = columns};
  assert_int_equal(ioctl(slave, TIOCSWINSZ, &size), 0);
  assert_int_equal(divert_stderr(slave), 0);
  close(slave);
  return master;
}

static void file_gets_stamped_lines_at_once(void **state)
{
  (void)state;
  Log *log;
  CastError err;
  char text[1024];
  assert_int_equal(log_open(path, true, &log, &err), CAST_OK);
  log_info(log, "patches: %d", 12);
  log_warn(log, "layer too thick");
  read_file(text, sizeof text); // before the log is closed: a crash must lose nothing
  int year, month, day, hour, minute, second;
  assert_int_equal(sscanf(text, "%d-%d-%dT%d:%d:%dZ patches: 12", &year, &month, &day, &hour, &minute, &second), 6);
  assert_non_null(strstr(text, "Z patches: 12\n"));
  assert_non_null(strstr(text, "Z warning: layer too thick\n"));
  assert_int_equal(log_warning_count(log), 1);
  log_close(&log);
  assert_null(log);
}

static void quiet_log_lets_only_warnings_through(void **state)
{
  (void)state;
  Log *log;
  CastError err;
  char text[1024];
  int ends[2];
  assert_int_equal(pipe(ends), 0);
  divert_stderr(ends[1]);
  assert_int_equal(log_open(NULL, true, &log, &err), CAST_OK);
  log_info(log, "nobody hears this");
  log_warn(log, "but this");
  log_close(&log);
  divert_stderr(true_stderr);
  read_all(ends[0], text, sizeof text);
  assert_string_equal(text, "warning: but this\n");
  close(ends[0]);
  close(ends[1]);
}

static void terminal_line_is_redrawn_in_place_and_cut_to_the_width(void **state)
{
  (void)state;
  Log *log;
  CastError err;
  char text[4096];
  const int terminal = open_terminal(40);
  assert_int_equal(log_open(NULL, false, &log, &err), CAST_OK);
  log_progress(log, "filling", 0.25, "a note that is much longer than the terminal is wide");
  log_progress(log, "filling", 1.0, "done");
  log_info(log, "a message");
  log_close(&log);
  divert_stderr(true_stderr);
  read_all(terminal, text, sizeof text);
  assert_string_equal(text, "\r\033[Kfilling:  25.0 %, a note that is much l"
                            "\r\033[Kfilling: 100.0 %, done"
                            "\r\033[Ka message\r\n");
  close(terminal);
}

static void terminal_is_redrawn_at_most_four_times_a_second(void **state)
{
  (void)state;
  Log *log;
  CastError err;
  char text[16384];
  const int terminal = open_terminal(40);
  assert_int_equal(log_open(NULL, false, &log, &err), CAST_OK);
  const double start = log_wall_time();
  for (int i = 0; i < 100000; i++) log_progress(log, "filling", 0.5, NULL);
  const double elapsed = log_wall_time() - start;
  log_close(&log);
  divert_stderr(true_stderr);
  read_all(terminal, text, sizeof text);
  int drawn = 0;
  for (const char *c = text; (c = strstr(c, "\033[K")); c++) drawn++;
  assert_true(drawn >= 1 && drawn <= 1 + (int)(elapsed / 0.25));
  close(terminal);
}

static void time_left_counts_from_where_a_resumed_run_began(void **state)
{
  (void)state;
  Log *log;
  CastError err;
  char text[4096];
  const int terminal = open_terminal(120);
  assert_int_equal(log_open(NULL, false, &log, &err), CAST_OK);
  log_progress(log, "filling", 0.5, NULL);
  sleep_for(0.3);
  log_progress(log, "filling", 0.501, NULL); // 0.3 s for a thousandth: some 150 s or more for the other half
  log_close(&log);
  divert_stderr(true_stderr);
  read_all(terminal, text, sizeof text);
  assert_non_null(strstr(text, "filling:  50.1 %, "));
  const char *left = strstr(text, "50.1 %, ") + strlen("50.1 %, ");
  int minutes = 0, seconds = 0;
  assert_int_equal(sscanf(left, "%d min %d s left", &minutes, &seconds), 2);
  assert_true(60 * minutes + seconds >= 149); // 0.3 s * 0.499/0.001, rounded; later if the machine is busy
  close(terminal);
}

static void pipe_and_file_get_a_progress_line_every_five_seconds(void **state)
{
  (void)state;
  Log *log;
  CastError err;
  char text[4096];
  int ends[2];
  assert_int_equal(pipe(ends), 0);
  divert_stderr(ends[1]);
  assert_int_equal(log_open(path, false, &log, &err), CAST_OK);
  log_progress(log, "cooling", 0.0, NULL);
  log_progress(log, "cooling", 0.1, NULL);
  sleep_for(5.2);
  for (int i = 0; i < 1000; i++) log_progress(log, "cooling", 0.5, "12 steps/s");
  log_close(&log);
  divert_stderr(true_stderr);
  read_all(ends[0], text, sizeof text);
  assert_true(strncmp(text, "cooling:  50.0 %, 12 steps/s, ", 30) == 0);
  assert_ptr_equal(strchr(text, '\n'), text + strlen(text) - 1); // one line
  read_file(text, sizeof text);
  assert_non_null(strstr(text, "Z cooling:  50.0 %, 12 steps/s, "));
  assert_ptr_equal(strchr(text, '\n'), text + strlen(text) - 1);
  close(ends[0]);
  close(ends[1]);
}

static void file_that_cannot_be_written_is_reported(void **state)
{
  (void)state;
  Log *log;
  CastError err;
  char text[1024];
  int ends[2];
  assert_int_equal(log_open("/nowhere/at/all.log", true, &log, &err), CAST_ERR_IO);
  assert_null(log);
  assert_non_null(strstr(err.message, "/nowhere/at/all.log"));
  assert_int_equal(pipe(ends), 0);
  divert_stderr(ends[1]);
  assert_int_equal(log_open("/dev/full", true, &log, &err), CAST_OK);
  log_info(log, "first");
  log_info(log, "second");
  assert_int_equal(log_warning_count(log), 1); // once, not with every line
  log_close(&log);
  divert_stderr(true_stderr);
  read_all(ends[0], text, sizeof text);
  assert_non_null(strstr(text, "the log file cannot be written and ends here: No space left on device"));
  close(ends[0]);
  close(ends[1]);
}

static void absent_log_is_silent(void **state)
{
  (void)state;
  Log *none = NULL;
  log_info(none, "x");
  log_warn(none, "x");
  log_progress(none, "x", 0.5, NULL);
  log_progress_end(none);
  log_close(&none);
  assert_int_equal(log_warning_count(none), 0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(file_gets_stamped_lines_at_once, prepare, restore),
      cmocka_unit_test_setup_teardown(quiet_log_lets_only_warnings_through, prepare, restore),
      cmocka_unit_test_setup_teardown(terminal_line_is_redrawn_in_place_and_cut_to_the_width, prepare, restore),
      cmocka_unit_test_setup_teardown(terminal_is_redrawn_at_most_four_times_a_second, prepare, restore),
      cmocka_unit_test_setup_teardown(time_left_counts_from_where_a_resumed_run_began, prepare, restore),
      cmocka_unit_test_setup_teardown(pipe_and_file_get_a_progress_line_every_five_seconds, prepare, restore),
      cmocka_unit_test_setup_teardown(file_that_cannot_be_written_is_reported, prepare, restore),
      cmocka_unit_test(absent_log_is_silent),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
