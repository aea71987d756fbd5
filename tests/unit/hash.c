/* SHA-256 against the examples of FIPS 180-4. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "common/hash.h"

static void bytes_have_the_digest_of_the_standard(void **state)
{
  (void)state;
  char hex[65];
  hash_bytes("abc", 3, hex);
  assert_string_equal(hex, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  hash_bytes("", 0, hex);
  assert_string_equal(hex, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

static void file_longer_than_a_buffer_has_the_digest_of_the_standard(void **state)
{
  (void)state;
  char path[] = "/tmp/hash_XXXXXX", hex[65];
  FILE *file = fdopen(mkstemp(path), "wb");
  assert_non_null(file);
  for (int i = 0; i < 1000000; i++) fputc('a', file);
  fclose(file);
  CastError err;
  assert_int_equal(hash_file(path, hex, &err), CAST_OK);
  assert_string_equal(hex, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  unlink(path);
  assert_int_equal(hash_file(path, hex, &err), CAST_ERR_IO);
  assert_non_null(strstr(err.message, path));
  assert_int_equal(hash_file("/tmp", hex, &err), CAST_ERR_IO); // a folder opens but cannot be read
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bytes_have_the_digest_of_the_standard),
      cmocka_unit_test(file_longer_than_a_buffer_has_the_digest_of_the_standard),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
