/* hash.h - SHA-256 of bytes and files, as 64 hexadecimal digits (nettle). */
#ifndef COMMON_HASH_H
#define COMMON_HASH_H

#include <stddef.h>
#include "common/error.h"

void hash_bytes(const void *bytes, size_t n, char hex[65]);
CastStatus hash_file(const char *path, char hex[65], CastError *err);
#endif
