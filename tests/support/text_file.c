#include "tests/support/text_file.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

char *text_file_read(const char *path)
{
  FILE *file = fopen(path, "rb");
  if (!file) fail_msg("there is no %s", path);
  fseek(file, 0, SEEK_END);
  const long size = ftell(file);
  if (size <= 0) fail_msg("%s is empty", path);
  rewind(file);
  char *text = malloc((size_t)size + 1);
  assert_non_null(text);
  assert_int_equal(fread(text, 1, (size_t)size, file), size);
  text[size] = '\0';
  fclose(file);
  return text;
}
