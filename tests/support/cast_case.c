#define _GNU_SOURCE // nftw
#include "tests/support/cast_case.h"

#include <errno.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

CastCase casting;

CastStatus cast_case_create_box(CastCase *made, const SyntheticBox *box, CastError *err)
{
  snprintf(made->folder, sizeof made->folder, "/tmp/cast_case_XXXXXX");
  CAST_CHECK(mkdtemp(made->folder), err, CAST_ERR_IO, "no folder under /tmp: %s", strerror(errno));
  RomData *rom = NULL;
  char path[128];
  snprintf(path, sizeof path, "%s/mould.rom.h5", made->folder);
  CAST_CALL(synthetic_rom_box_cavity(box, &rom, err));
  const CastStatus status = rom_write(rom, path, err);
  rom_destroy(&rom);
  return status;
}

CastStatus cast_case_create(CastCase *made, CastError *err)
{
  const SyntheticBox box = {.outer = {9e-3, 9e-3, 9e-3},
                            .cavity = {4e-3, 4e-3, 4e-3},
                            .pin_width = 1.6e-3,
                            .pin_depth = 2e-3,
                            .cell = 0.5e-3,
                            .patch_size = 2e-3,
                            .kappa = 1.0,
                            .rho = 1800.0,
                            .c = 1100.0,
                            .h_outside = 80.0,
                            .band = 1.5e-3};
  return cast_case_create_box(made, &box, err);
}

static const char *or_default(const char *given, const char *standard)
{
  return given ? given : standard;
}

CastStatus cast_case_input(const CastCase *made, const char *name, const CastCaseInput *input, char path[128],
                           CastError *err)
{
  static const CastCaseInput none = {NULL};
  const CastCaseInput *in = input ? input : &none;
  snprintf(path, 128, "%s/%s.yaml", made->folder, name);
  FILE *out = fopen(path, "w");
  CAST_CHECK(out, err, CAST_ERR_IO, "%s: %s", path, strerror(errno));
  fprintf(out, "title: %s\nrom: mould.rom.h5\npreheat: 800 degC\nambient: 25 degC\nmelt:\n%s", name,
          or_default(in->melt, "  material: cual10\n  temperature: 1150 degC\n"
                               "  blocks: [{ corner: [-1.6 mm, -1.6 mm, -4 mm], size: [3.2 mm, 3.2 mm, 2.4 mm] }]\n"));
  fprintf(out, "forces: %s\n", or_default(in->forces, "{ gravity: [0 m/s^2, 0 m/s^2, -100 m/s^2] }"));
  fprintf(out, "contact: %s\n", or_default(in->contact, "{ h: 2000 W/m^2/K }"));
  fprintf(out, "coupling: %s\n", or_default(in->coupling, "{ kind: surface }"));
  fprintf(out, "sph: %s\n", or_default(in->sph, "{ spacing: 0.4 mm }"));
  fprintf(out, "time: %s\n", or_default(in->time, "{ end: 3 ms }"));
  fprintf(out, "output:\n  folder: %s\n  every: 1 ms\n%s", name, or_default(in->output, ""));
  CAST_CHECK(fclose(out) == 0, err, CAST_ERR_IO, "%s: %s", path, strerror(errno));
  return CAST_OK;
}

CastStatus cast_case_rom(const CastCase *made, RomData **rom, CastError *err)
{
  char path[128];
  snprintf(path, sizeof path, "%s/mould.rom.h5", made->folder);
  return rom_read(path, rom, err);
}

static int remove_one(const char *path, const struct stat *info, int type, struct FTW *walk)
{
  (void)info;
  (void)type;
  (void)walk;
  return remove(path);
}

void cast_case_remove(const CastCase *made)
{
  nftw(made->folder, remove_one, 16, FTW_DEPTH | FTW_PHYS);
}

int cast_case_set_up(void **state)
{
  (void)state;
  CastError err = {0};
  if (cast_case_create(&casting, &err) == CAST_OK) return 0;
  fprintf(stderr, "%s\n", err.message);
  return 1;
}

int cast_case_clean_up(void **state)
{
  (void)state;
  cast_case_remove(&casting);
  return 0;
}
