#include "tests/support/config_case.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/assert_close.h"
#include "tests/support/assert_ok.h"

const char CONFIG_LEAST[] = "rom: mould.rom.h5\n"
                            "preheat: 800 degC\n"
                            "ambient: 25 degC\n"
                            "melt:\n"
                            "  material: cual10\n"
                            "  temperature: 1150 degC\n"
                            "  blocks: [{ corner: [0 mm, 0 mm, 0 mm], size: [1 mm, 2 mm, 3 mm] }]\n"
                            "forces: { gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2] }\n"
                            "contact: { h: 2000 W/m^2/K }\n"
                            "sph: { spacing: 0.1 mm }\n"
                            "time: { end: 10 ms }\n"
                            "output: { folder: results, every: 1 ms }\n";

CastConfig *config_case_read(const char *text, const char *path)
{
  CastError err = {0};
  CastConfig *config = NULL;
  ok(cast_config_read(path, text, &config, &err), &err);
  return config;
}

CastConfig *config_case_with(const char *old, const char *piece)
{
  char text[4096];
  const char *at = strstr(CONFIG_LEAST, old);
  assert_non_null(at);
  snprintf(text, sizeof text, "%.*s%s%s", (int)(at - CONFIG_LEAST), CONFIG_LEAST, piece, at + strlen(old));
  return config_case_read(text, "cast.yaml");
}

CastConfig *config_case_again(const CastConfig *config)
{
  char *resolved = NULL;
  CastError err = {0};
  ok(cast_config_resolved(config, 0.0, &resolved, &err), &err);
  CastConfig *again = config_case_read(resolved, "/elsewhere/resolved.yaml");
  free(resolved);
  return again;
}

void config_case_same_table(const Table *a, const Table *b)
{
  assert_int_equal(a->n, b->n);
  if (a->n == 0) return;
  assert_memory_equal(a->x, b->x, a->n * sizeof *a->x);
  assert_memory_equal(a->y, b->y, a->n * sizeof *a->y);
}

void config_case_same_drive(const Drive *a, const Drive *b)
{
  assert_int_equal(a->n, b->n);
  assert_memory_equal(a->time, b->time, a->n * sizeof *a->time);
  assert_memory_equal(a->gravity, b->gravity, a->n * sizeof *a->gravity);
  assert_memory_equal(a->acceleration, b->acceleration, sizeof a->acceleration);
  for (int d = 0; d < 3; d++) { // directions are made to have length 1 again: the last bit may differ
    assert_close(a->tilt_axis[d], b->tilt_axis[d], 2.3e-16);
    assert_close(a->spin_axis[d], b->spin_axis[d], 2.3e-16);
  }
  assert_memory_equal(a->spin_point, b->spin_point, sizeof a->spin_point);
  config_case_same_table(&a->tilt, &b->tilt);
  config_case_same_table(&a->speed, &b->speed);
}
