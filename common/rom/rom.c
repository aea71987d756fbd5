/* rom.c - the end of a ROM's life; rom_read.c begins it. And what its certificate says. */
#include "common/rom/rom.h"

#include <math.h>
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

double rom_certificate_bound(const RomCertificate *certificate, double w)
{
  const size_t n = certificate->n_frequencies;
  const double *at = certificate->frequency, *bound = certificate->transfer_bound;
  if (n < 2 || !(w >= at[0] && w <= at[n - 1])) return (double)NAN;
  size_t i = 0;
  while (i + 2 < n && at[i + 1] <= w) i++;
  const double share = log(w / at[i]) / log(at[i + 1] / at[i]);
  return exp((1.0 - share) * log(bound[i]) + share * log(bound[i + 1]));
}
