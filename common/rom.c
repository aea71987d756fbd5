/* rom.c - the end of a ROM's life; rom_read.c begins it. */
#include "common/rom.h"

#include <stdlib.h>

static void free_provenance(RomProvenance *provenance)
{
  char *texts[] = {provenance->program,    provenance->version,    provenance->command,
                   provenance->input_text, provenance->input_path, provenance->geometry_sha256,
                   provenance->created,    provenance->libraries,  provenance->host};
  for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) free(texts[i]);
}

void rom_destroy(RomData **rom)
{
  if (!rom || !*rom) return;
  RomData *data = *rom;
  RomCertificate *certificate = &data->certificate;
  void *arrays[] = {data->title,       data->lambda,           data->B,
                    data->ambient,     data->constant,         data->patch,
                    data->material,    data->points,           data->basis,
                    data->triangles,   data->triangle_patch,   data->tetrahedra,
                    data->shifts,      certificate->frequency, certificate->transfer_bound,
                    certificate->time, certificate->step_error};
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++) free(arrays[i]);
  free_provenance(&data->provenance);
  free(data);
  *rom = NULL;
}
