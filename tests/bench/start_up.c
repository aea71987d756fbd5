/* What stands between the command and the first step, by part: processor and wall time of reading the ROM, of the
 * surface and its search grid, of placing melt and walls, of the whole of sim_create. By default a box mould with a
 * ROM of about 90 MB and a million particles; or any case: start_up CAST.yaml. Threads as OMP_NUM_THREADS says. */
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "cast/kernel/kernel.h"
#include "cast/particles/neighbours.h"
#include "cast/sim/sim_private.h"
#include "tests/bench/bench.h"
#include "tests/support/cast_case.h"

typedef struct Clock {
  double cpu, wall; // s
} Clock;

static Clock read_clock(void)
{
  return (Clock){bench_cpu_time(), omp_get_wtime()};
}

static Clock lap(const char *what, Clock since)
{
  const Clock now = read_clock();
  printf("  %-34s %8.2f s of CPU %8.2f s of wall\n", what, now.cpu - since.cpu, now.wall - since.wall);
  fflush(stdout);
  return read_clock();
}

/* Digits as a computed basis has them: one from a closed form would be packed to a fiftieth. */
static void roughen(const char *path)
{
  CastError err = {0};
  RomData *rom = NULL;
  uint32_t random = 1;
  must(rom_read(path, &rom, &err), &err);
  for (size_t k = 0; k < rom->n_points * rom->r; k++) {
    random = random * 1664525u + 1013904223u; // Numerical Recipes, 7.1
    rom->basis[k] = rom->basis[k] * (1.0f + 1e-4f * ((float)(random >> 8) / 16777216.0f - 0.5f)) +
                    1e-7f * (float)(random >> 8) / 16777216.0f / (float)rom->r;
  }
  must(rom_write(rom, path, &err), &err);
  rom_destroy(&rom);
}

/* A million particles of 10 mm in a box, and a band so wide that the file takes some 90 MB. */
static void make_case(CastCase *made, char path[128])
{
  const SyntheticBox box = {.outer = {1.5, 1.3, 1.4},
                            .cavity = {1.2, 1.0, 1.1},
                            .cell = 0.032,
                            .patch_size = 0.28,
                            .kappa = 1.0,
                            .rho = 1800.0,
                            .c = 1100.0,
                            .h_outside = 80.0,
                            .nodes = 8,
                            .band = 0.1};
  const CastCaseInput input = {
      .melt = "  material: cual10\n  temperature: 1150 degC\n"
              "  blocks: [{ corner: [-600 mm, -500 mm, -1100 mm], size: [1000 mm, 1000 mm, 1000 mm] }]\n",
      .sph = "{ spacing: 10 mm }",
      .time = "{ end: 1 s }"};
  CastError err = {0};
  must(cast_case_create_box(made, &box, &err), &err);
  must(cast_case_input(made, "start", &input, path, &err), &err);
  char rom[128];
  snprintf(rom, sizeof rom, "%s/mould.rom.h5", made->folder);
  roughen(rom);
}

static void time_parts(const CastConfig *config)
{
  CastError err = {0};
  RomData *rom = NULL;
  Surface *surface = NULL;
  WallSet walls = {0};
  struct stat file;
  const double reach = kernel_support(config->kernel) * config->smoothing * config->spacing;
  const double corner[3] = {0.0, 0.0, 0.0};
  const Clock begun = read_clock();
  must(rom_read(config->rom_path, &rom, &err), &err);
  const Clock read = lap("reading and checking the ROM", begun);
  must(surface_create(rom, neighbours_range(reach, neighbours_skin(config->spacing)), &surface, &err), &err);
  const Clock made = lap("surface and search grid", read);
  must(walls_generate(surface, config->spacing, reach, config->n_blocks ? config->block[0].corner : corner, &walls,
                      &err),
       &err);
  lap("placing walls", made);
  lap("the three together", begun);
  if (stat(config->rom_path, &file) == 0)
    printf("  (ROM of %.0f MB, %zu states, %zu points, %zu triangles; %td wall particles)\n",
           1e-6 * (double)file.st_size, rom->r, rom->n_points, rom->n_triangles, walls.n);
  walls_destroy(&walls);
  surface_destroy(&surface);
  rom_destroy(&rom);
}

int main(int argc, char **argv)
{
  CastError err = {0};
  CastCase made = {0};
  CastConfig *config = NULL;
  Sim *sim = NULL;
  char path[128];
  if (argc < 2) make_case(&made, path);
  must(cast_config_read(argc > 1 ? argv[1] : path, NULL, &config, &err), &err);
  printf("start-up, %d threads\n", omp_get_max_threads());
  time_parts(config);
  const Clock begun = read_clock();
  must(sim_create(config, NULL, &sim, &err), &err);
  lap("sim_create: these and all the rest", begun);
  struct rusage use;
  getrusage(RUSAGE_SELF, &use);
  printf("  (%td fluid and %td wall particles; %.0f MB at most)\n", sim->particles.n_fluid,
         sim->particles.n - sim->particles.n_fluid, 1e-3 * (double)use.ru_maxrss);
  sim_destroy(&sim);
  cast_config_destroy(&config);
  if (argc < 2) cast_case_remove(&made);
  return 0;
}
