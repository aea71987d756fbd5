#include "tests/support/results_case.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "tests/support/assert_ok.h"
#include "tests/support/lattice_melt.h"

RomData *results_rom;
Material results_melt;

static CastStatus read_melt(CastError *err)
{
  YamlInput *input = NULL;
  CAST_CALL(yaml_input_parse("material: cual10\n", "test", &input, err));
  const CastStatus status = material_read(yaml_get(yaml_root(input), "material"), &results_melt, err);
  yaml_input_destroy(&input);
  return status;
}

int results_case_set_up(void **state)
{
  (void)state;
  CastError err = {0};
  CastStatus status = cast_case_create(&casting, &err);
  if (status == CAST_OK) status = cast_case_rom(&casting, &results_rom, &err);
  if (status == CAST_OK) status = read_melt(&err);
  if (status != CAST_OK) fprintf(stderr, "%s\n", err.message);
  return status != CAST_OK;
}

int results_case_clean_up(void **state)
{
  (void)state;
  material_destroy(&results_melt);
  rom_destroy(&results_rom);
  cast_case_remove(&casting);
  return 0;
}

MeltResults *results_case_begin(Particles *particles)
{
  CastError err = {0};
  const double corner[3] = {0, 0, 0};
  MeltResults *results = NULL;
  *particles = lattice_melt(corner, (const int[3]){4, 3, 2}, 1e-3);
  ok(melt_results_open(casting.folder, &results_melt, particles->n, 0, &results, &err), &err);
  return results;
}

void results_case_three_steps(MeltResults *results, Particles *p)
{
  CastError err = {0};
  for (int step = 0; step < 3; step++) {
    for (ptrdiff_t i = 0; i + 1 < p->n_fluid; i += 2) {
      const int32_t id = p->id[i];
      const double x = p->x[0][i], T = p->T[i];
      p->id[i] = p->id[i + 1], p->x[0][i] = p->x[0][i + 1], p->T[i] = p->T[i + 1];
      p->id[i + 1] = id, p->x[0][i + 1] = x, p->T[i + 1] = T;
    }
    if (step == 2) p->n = --p->n_fluid;
    ok(melt_results_append(results, 0.5 * step, p, &err), &err);
  }
}

long long *results_case_integers(hid_t file, const char *name, hsize_t expected)
{
  CastError err = {0};
  hsize_t shape[2] = {expected, 0};
  void *values = NULL;
  const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
  assert_true(set >= 0);
  const hid_t space = H5Dget_space(set);
  const int rank = H5Sget_simple_extent_ndims(space);
  H5Sclose(space);
  H5Dclose(set);
  ok(h5_read(file, name, H5T_NATIVE_LLONG, rank, shape, &values, &err), &err);
  assert_true(shape[0] == expected);
  return values;
}
