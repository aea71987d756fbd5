#define _GNU_SOURCE // gethostname
#include "cast/io/provenance.h"

#include <hdf5.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "cast_build_config.h"
#include "revision.h"

void provenance_now(char stamp[32])
{
  const time_t now = time(NULL);
  struct tm utc;
  gmtime_r(&now, &utc);
  strftime(stamp, 32, "%Y-%m-%dT%H:%M:%SZ", &utc);
}

void provenance_collect(const char *command, Provenance *provenance)
{
  *provenance = (Provenance){.program = "castrun", .version = CAST_VERSION, .revision = CAST_REVISION};
  provenance->command = strdup(command ? command : "");
  if (gethostname(provenance->host, sizeof provenance->host - 1) != 0) provenance->host[0] = '\0';
  provenance->threads = omp_get_max_threads();
  provenance_now(provenance->started);
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  snprintf(provenance->libraries, sizeof provenance->libraries, "HDF5 %u.%u.%u, compiled with %.150s", major, minor,
           release, __VERSION__);
}

void provenance_release(Provenance *provenance)
{
  free(provenance->command);
  provenance->command = NULL;
}

void provenance_print(FILE *out, const char *prefix, const Provenance *p)
{
  fprintf(out, "%sprogram: %s %s (%s)\n", prefix, p->program, p->version, p->revision);
  fprintf(out, "%scommand: %s\n", prefix, p->command ? p->command : "");
  fprintf(out, "%sstarted: %s on %s, %d thread%s\n", prefix, p->started, p->host, p->threads,
          p->threads == 1 ? "" : "s");
  fprintf(out, "%sinput: %s, sha256 %s\n", prefix, p->input_path, p->input_sha256);
  fprintf(out, "%srom: %s, sha256 %s\n", prefix, p->rom_path, p->rom_sha256);
  fprintf(out, "%smaterial: sha256 %s\n", prefix, p->material_sha256);
  fprintf(out, "%slibraries: %s\n", prefix, p->libraries);
}
