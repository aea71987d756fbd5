#include "reduce/io/provenance.h"

#include <gmshc.h>
#include <hdf5.h>
#include <petscversion.h>
#include <slepcversion.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <time.h>
#include <yaml.h>

#include "cast_build_config.h"
#include "revision.h"

static char *describe_libraries(void)
{
  char text[512];
  unsigned major, minor, release;
  H5get_libversion(&major, &minor, &release);
  snprintf(text, sizeof text, "PETSc %d.%d.%d, SLEPc %d.%d.%d, gmsh %s, HDF5 %u.%u.%u, libyaml %s", PETSC_VERSION_MAJOR,
           PETSC_VERSION_MINOR, PETSC_VERSION_SUBMINOR, SLEPC_VERSION_MAJOR, SLEPC_VERSION_MINOR,
           SLEPC_VERSION_SUBMINOR, GMSH_API_VERSION, major, minor, release, yaml_get_version_string());
  return strdup(text);
}

static char *describe_host(void)
{
  struct utsname host;
  if (uname(&host) != 0) return strdup("unknown");
  char text[512];
  snprintf(text, sizeof text, "%.120s (%.80s %.80s)", host.nodename, host.sysname, host.machine);
  return strdup(text);
}

static char *describe_time(void)
{
  const time_t now = time(NULL);
  struct tm utc;
  char text[64];
  gmtime_r(&now, &utc);
  strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return strdup(text);
}

CastStatus provenance_create(const ReduceConfig *config, const char *command, RomProvenance *provenance, CastError *err)
{
  *provenance = (RomProvenance){.program = strdup("castreduce"),
                                .version = strdup(CAST_VERSION " (" CAST_REVISION ")"),
                                .command = strdup(command),
                                .input_text = strdup(config->input_text),
                                .input_path = strdup(config->input_path),
                                .geometry_sha256 = strdup(config->geometry_sha256),
                                .created = describe_time(),
                                .libraries = describe_libraries(),
                                .host = describe_host()};
  const bool whole = provenance->program && provenance->version && provenance->command && provenance->input_text &&
                     provenance->input_path && provenance->geometry_sha256 && provenance->created &&
                     provenance->libraries && provenance->host;
  if (!whole) provenance_destroy(provenance);
  CAST_CHECK(whole, err, CAST_ERR_MEMORY, "no memory for the ROM's provenance");
  return CAST_OK;
}

void provenance_destroy(RomProvenance *provenance)
{
  char *const texts[] = {provenance->program,    provenance->version,    provenance->command,
                         provenance->input_text, provenance->input_path, provenance->geometry_sha256,
                         provenance->created,    provenance->libraries,  provenance->host};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) free(texts[i]);
  *provenance = (RomProvenance){0};
}
