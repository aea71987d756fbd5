/* provenance.h - who made a result, with what, where and when. */
#ifndef CAST_IO_PROVENANCE_H
#define CAST_IO_PROVENANCE_H

#include <stdio.h>

typedef struct Provenance {
  const char *program, *version, *revision;
  char *command; // owned
  char host[256];
  char started[32]; // ISO 8601, UTC
  char libraries[256];
  int threads;
  char rom_sha256[65], material_sha256[65], input_sha256[65];
  char rom_path[4096], input_path[4096];
} Provenance;

/* Fill in all but the paths and hashes. */
void provenance_collect(const char *command, Provenance *provenance);
void provenance_release(Provenance *provenance);
void provenance_now(char stamp[32]); // ISO 8601, UTC
/* "key: value" lines, each behind `prefix`. */
void provenance_print(FILE *out, const char *prefix, const Provenance *provenance);

#endif
