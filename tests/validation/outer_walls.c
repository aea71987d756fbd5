/* Outer walls at run time, against the full model with the same conditions in its K: the quickstart's mould is reduced
 * twice, once with its own walls and once with others; the second ROM, given the first's conditions in the run, must
 * follow the first. Heat as of a filling and its cooling, 120 s. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cast/mould/rom_state.h"
#include "cast_build_config.h"
#include "tests/support/validation.h"

static const char QUICKSTART[] = CAST_SHARE_SOURCE "/../examples/quickstart";
static const double PREHEAT = 1073.15, AMBIENT = 298.15, END = 120.0;
static const char *castreduce;
static char folder[] = "/tmp/castwalls_XXXXXX";
static RomData *made, *other; // with the conditions in K; with others

static void shell(const char *format, ...)
{
  char command[2000];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(command, sizeof command, format, arguments);
  va_end(arguments);
  if (system(command) != 0) fail_msg("%s", command);
}

static RomData *read_rom(const char *name)
{
  CastError err = {0};
  RomData *rom = NULL;
  char path[256];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  if (rom_read(path, &rom, &err) != CAST_OK) fail_msg("%s", err.message);
  return rom;
}

static int make_roms(void **state)
{
  (void)state;
  if (!mkdtemp(folder)) return 1;
  shell("cp '%s/mould.geo' %s/", QUICKSTART, folder);
  /* In K: side 80, rim 80, foot 40 W/(m2 K). The other ROM: 15, 15, insulated; side and rim on patches. */
  shell("sed 's/foot: .*/foot: { type: robin, h: 40 W\\/m^2\\/K }/' '%s/mould.yaml' > %s/made.yaml", QUICKSTART,
        folder);
  shell("sed '/side:/s/h: 80 W.m^2.K/h: 15 W\\/m^2\\/K, patch_size: 8 mm/; /rim:/s/h: 80 W.m^2.K/h: 15 W\\/m^2\\/K, "
        "patch_size: 4 mm/; s/mould.rom.h5/other.rom.h5/' '%s/mould.yaml' > %s/other.yaml",
        QUICKSTART, folder);
  shell("cd %s && '%s' run made.yaml --quiet 2>/dev/null && '%s' run other.yaml --quiet 2>/dev/null", folder,
        castreduce, castreduce);
  made = read_rom("mould.rom.h5");
  other = read_rom("other.rom.h5");
  assert_true(other->m > made->m); // in the same cavity patches, which come first
  return 0;
}

static int remove_roms(void **state)
{
  (void)state;
  rom_destroy(&made);
  rom_destroy(&other);
  shell("rm -r %s", folder);
  return 0;
}

/* 1e5 W/m2 that dies away within a second and a half, into each cavity patch. */
static void set_flows(const RomData *rom, double t, double *q)
{
  for (size_t l = 0; l < rom->m; l++) q[l] = rom->patch[l].outer ? 0.0 : 1e5 * rom->patch[l].area * exp(-t / 1.5);
}

typedef struct Run {
  RomState *state;
  OuterWalls *walls;
} Run;

static Run start(const RomData *rom, size_t n, const OuterWall *wall)
{
  CastError err = {0};
  Run run = {NULL, NULL};
  CastStatus status = rom_state_create(rom, ROM_EXPONENTIAL, PREHEAT, AMBIENT, &run.state, &err);
  if (status == CAST_OK && n > 0) status = outer_walls_create(rom, n, wall, NULL, AMBIENT, &run.walls, &err);
  if (status == CAST_OK && n > 0) status = rom_state_set_walls(run.state, run.walls, &err);
  if (status != CAST_OK) fail_msg("%s", err.message);
  return run;
}

static void finish(Run *run)
{
  rom_state_destroy(&run->state);
  outer_walls_destroy(&run->walls);
}

/* Largest difference of a cavity patch over the largest change of any, and the ledger's residual over the heat lost. */
static double compare(size_t n, const OuterWall *wall, double dt, double *residual)
{
  Run reference = start(made, 0, NULL), run = start(other, n, wall);
  double *q = calloc(other->m, sizeof *q), given = 0.0, worst = 0.0, change = 0.0;
  assert_non_null(q);
  const long steps = lround(END / dt);
  for (long i = 0; i < steps; i++) {
    set_flows(made, ((double)i + 0.5) * dt, q);
    for (size_t l = 0; l < made->m; l++) given += q[l] * dt;
    rom_state_step(reference.state, q, dt);
    rom_state_step(run.state, q, dt);
    const double *exact = rom_state_patch_temperature(reference.state), *T = rom_state_patch_temperature(run.state);
    for (size_t l = 0; l < made->m && !made->patch[l].outer; l++) {
      worst = fmax(worst, fabs(T[l] - exact[l]));
      change = fmax(change, fabs(exact[l] - PREHEAT));
    }
  }
  *residual = fabs(given - rom_state_heat(run.state) - rom_state_lost(run.state)) / fabs(rom_state_lost(run.state));
  free(q);
  finish(&reference);
  finish(&run);
  return worst / change;
}

static void walls_in_the_run_do_what_walls_in_k_do(void **state)
{
  (void)state;
  static const OuterWall walls[] = {{.surface = "side", .h = 80.0, .ambient = 298.15},
                                    {.surface = "rim", .h = 80.0, .ambient = 298.15},
                                    {.surface = "foot", .h = 40.0, .ambient = 298.15}};
  double residual, unused;
  const double begin = validation_cpu_time(), error = compare(3, walls, 0.02, &residual);
  const double coarse = compare(3, walls, 0.04, &unused), without = compare(0, NULL, 0.1, &unused);
  validation_begin("walls");
  validation_write(&(ValidationRow){
      .id = "walls",
      .quantity = "cavity patches over 120 s with walls of 80, 80, 40 W/(m2 K) given in the run; 15, 15, 0 in the ROM",
      .reference = "ROM of the full model with them in K, tolerance 0.1 %",
      .ours = validation_text("without them %.3g %% off; books to %.0e", 100.0 * without, residual),
      .error = validation_text("%.3g %% of the largest change", 100.0 * error),
      .target = error < 0.01 ? "1 %" : "1 % (missed)",
      .resolution =
          validation_text("steps of 20 ms (of 40 ms: %.3g %%); side in patches of 8 mm, rim of 4 mm", 100.0 * coarse),
      .cpu_seconds = validation_cpu_time() - begin});
  assert_true(residual < 1e-11); // rounding of 6000 steps
  assert_true(without > 0.1);    // it matters
  /* What is left: flows are spread evenly over each patch where K's follow the temperature. With each
   * surface in one patch it is 1.06 %. */
  assert_true(error < 0.01);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(walls_in_the_run_do_what_walls_in_k_do),
  };
  if (argc != 2) return 99;
  castreduce = realpath(argv[1], NULL);
  if (!castreduce) return 99;
  return cmocka_run_group_tests(tests, make_roms, remove_roms);
}
