#define _GNU_SOURCE // popen
#include "tests/support/program.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

char said[65536];

int run(const char *format, ...)
{
  char command[2000];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(command, sizeof command, format, arguments);
  va_end(arguments);
  FILE *pipe = popen(command, "r");
  assert_non_null(pipe);
  said[fread(said, 1, sizeof said - 1, pipe)] = '\0';
  const int status = pclose(pipe);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void expect_said(const char *text)
{
  if (!strstr(said, text)) fail_msg("'%s' does not say '%s'", said, text);
}

pid_t launch(const char *const argument[], const char *output)
{
  const pid_t child = fork();
  assert_true(child >= 0);
  if (child > 0) return child;
  const int out = open(output, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  dup2(out, STDOUT_FILENO);
  dup2(out, STDERR_FILENO);
  execv(argument[0], (char *const *)(uintptr_t)argument); // execv does not write to them
  _exit(127);
}

int exit_code(pid_t child)
{
  int status = 0;
  assert_true(waitpid(child, &status, 0) == child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}
