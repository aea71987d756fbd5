/* cast_case.h - a small casting for tests of castrun: a synthetic mould with a box cavity and a pin, written with its
 * cast.yaml into a folder of its own under /tmp. */
#ifndef TESTS_SUPPORT_CAST_CASE_H
#define TESTS_SUPPORT_CAST_CASE_H

#include "common/error.h"
#include "tests/support/synthetic_rom.h"

typedef struct CastCase {
  char folder[64]; // holds mould.rom.h5 and the inputs; results go to folders in it
} CastCase;

typedef struct CastCaseInput { // NULL: the default
  const char *melt;            // lines of `melt:`, each behind two spaces
  const char *forces;          // "{ gravity: ... }"
  const char *contact;         // "{ h: 2000 W/m^2/K }"
  const char *coupling;        // "{ kind: surface }"
  const char *sph;             // "{ spacing: 0.4 mm }"
  const char *time;            // "{ end: 3 ms }"
  const char *output;          // more lines of `output:`, each behind two spaces
} CastCaseInput;

/* Make the folder and the ROM. Errors: as rom_write; CAST_ERR_IO. */
CastStatus cast_case_create(CastCase *made, CastError *err);
CastStatus cast_case_create_box(CastCase *made, const SyntheticBox *box, CastError *err); // another mould
/* Write NAME.yaml, whose output folder is NAME; its path goes to `path`. */
CastStatus cast_case_input(const CastCase *made, const char *name, const CastCaseInput *input, char path[128],
                           CastError *err);
CastStatus cast_case_rom(const CastCase *made, RomData **rom, CastError *err); // read it; the caller destroys it
void cast_case_remove(const CastCase *made); // the folder and all in it

/* One case for all tests of a program, made and removed by cmocka's group. */
extern CastCase casting;
int cast_case_set_up(void **state);
int cast_case_clean_up(void **state);

#endif
