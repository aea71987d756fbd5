#include "common/hash.h"

#include <errno.h>
#include <nettle/sha2.h>
#include <stdio.h>
#include <string.h>

static void digest_as_hex(struct sha256_ctx *context, char hex[65])
{
  uint8_t digest[SHA256_DIGEST_SIZE];
  sha256_digest(context, sizeof digest, digest);
  for (size_t i = 0; i < sizeof digest; i++) snprintf(hex + 2 * i, 3, "%02x", digest[i]);
}

void hash_bytes(const void *bytes, size_t n, char hex[65])
{
  struct sha256_ctx context;
  sha256_init(&context);
  sha256_update(&context, n, bytes);
  digest_as_hex(&context, hex);
}

CastStatus hash_file(const char *path, char hex[65], CastError *err)
{
  FILE *file = fopen(path, "rb");
  CAST_CHECK(file, err, CAST_ERR_IO, "'%s' cannot be opened: %s", path, strerror(errno));
  struct sha256_ctx context;
  sha256_init(&context);
  uint8_t buffer[65536];
  size_t n;
  while ((n = fread(buffer, 1, sizeof buffer, file)) > 0) sha256_update(&context, n, buffer);
  const int failed = ferror(file);
  fclose(file);
  CAST_CHECK(!failed, err, CAST_ERR_IO, "'%s' cannot be read: %s", path, strerror(errno));
  digest_as_hex(&context, hex);
  return CAST_OK;
}
