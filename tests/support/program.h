/* program.h - programs as a user runs them: a command line, what it said, how it ended. */
#ifndef TESTS_SUPPORT_PROGRAM_H
#define TESTS_SUPPORT_PROGRAM_H

#include <sys/types.h>

extern char said[65536]; // by the last command that was run

/* Run a shell's command line, printf-like, and keep its standard output in `said`.
 * returns  its exit status, -1 if a signal ended it */
int run(const char *format, ...) __attribute__((format(printf, 1, 2)));
void expect_said(const char *text);

/* Start a program in the background; arguments up to NULL, argument[0] its path; output and errors go to the file
 * `output`. */
pid_t launch(const char *const argument[], const char *output);
/* Wait for it. returns  its exit status, 128 + the signal that ended it */
int exit_code(pid_t child);

#endif
