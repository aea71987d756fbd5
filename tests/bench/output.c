/* What writing results costs: a casting of the quickstart's size, once without output and once with frames and rows of
 * the CSV files, the two step by step in turns. Both have the same bits, so the difference is the output's. Prints
 * processor time of both and the share of the run that goes to the output.
 * output [ms of the casting, 3 [ms between frames, 0.5]]      OMP_NUM_THREADS=1 for the time of one thread */
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "cast/sim/sim_private.h"
#include "tests/bench/bench.h"
#include "tests/support/cast_case.h"

typedef struct Casting {
  CastConfig *config;
  Sim *sim;
  char folder[128];
  double stepping, writing; // s of processor time
} Casting;

static void start(const CastCase *made, const char *name, double every, bool writes, Casting *run)
{
  CastError err = {0};
  char path[128];
  const CastCaseInput input = {.melt = "  material: cual10\n  temperature: 1150 degC\n"
                                       "  blocks: [{ corner: [-4 mm, -4 mm, -4.5 mm], size: [8 mm, 8 mm, 3.75 mm] }]\n",
                               .sph = "{ spacing: 0.25 mm }",
                               .time = "{ end: 1 s }"};
  *run = (Casting){0};
  must(cast_case_input(made, name, &input, path, &err), &err);
  must(cast_config_read(path, NULL, &run->config, &err), &err);
  run->config->output.every = every;
  run->config->output.curves_every = 0.1 * every;
  must(sim_create(run->config, NULL, &run->sim, &err), &err);
  snprintf(run->folder, sizeof run->folder, "%.60s/%.60s", made->folder, name);
  if (!writes) return;
  mkdir(run->folder, 0777);
  must(sim_open_output(run->sim, "bench", &err), &err);
  must(sim_output_due(run->sim, &err), &err); // the first frame stands before the first step
}

static void step(Casting *run)
{
  CastError err = {0};
  const double begun = bench_cpu_time();
  must(sim_step(run->sim, &err), &err);
  const double stepped = bench_cpu_time();
  if (run->sim->output) must(sim_output_due(run->sim, &err), &err);
  run->stepping += stepped - begun;
  run->writing += bench_cpu_time() - stepped;
}

static void report(const Casting *with, const Casting *without, double every)
{
  struct stat file = {0};
  char path[160];
  const double plain = without->stepping, all = with->stepping + with->writing;
  snprintf(path, sizeof path, "%s/results.vtkhdf", with->folder);
  if (stat(path, &file) != 0) fprintf(stderr, "no %s\n", path);
  printf("output: %td + %td particles, %ld steps to t = %.2f ms, a frame every %g ms, %d threads\n",
         with->sim->particles.n_fluid, with->sim->particles.n - with->sim->particles.n_fluid, sim_steps(with->sim),
         1e3 * sim_time(with->sim), 1e3 * every, omp_get_max_threads());
  printf("  %-28s %8.2f s of CPU\n  %-28s %8.2f s of CPU, %.2f MB of results\n", "without output", plain, "with output",
         all, 1e-6 * (double)file.st_size);
  printf("  %-28s %8.2f %% of the run (%.3f s)\n  %-28s %8.2f %%\n", "in the output itself",
         100.0 * with->writing / all, with->writing, "with against without", 100.0 * (all / plain - 1.0));
}

int main(int argc, char **argv)
{
  const double end = 1e-3 * (argc > 1 ? strtod(argv[1], NULL) : 3.0);
  const double every = 1e-3 * (argc > 2 ? strtod(argv[2], NULL) : 0.5);
  const SyntheticBox box = {.outer = {16e-3, 16e-3, 18e-3},
                            .cavity = {8.5e-3, 8.5e-3, 8e-3},
                            .pin_width = 3e-3,
                            .pin_depth = 5e-3,
                            .cell = 0.6e-3,
                            .patch_size = 2.5e-3,
                            .kappa = 1.0,
                            .rho = 1800.0,
                            .c = 1100.0,
                            .h_outside = 80.0,
                            .nodes = 6,
                            .band = 1.2e-3};
  CastError err = {0};
  CastCase made;
  Casting with, without;
  must(cast_case_create_box(&made, &box, &err), &err);
  start(&made, "with", every, true, &with);
  start(&made, "without", every, false, &without);
  while (sim_time(with.sim) < end) {
    step(&without);
    step(&with);
  }
  report(&with, &without, every);
  if (sim_steps(with.sim) != sim_steps(without.sim) || sim_time(with.sim) != sim_time(without.sim)) {
    fprintf(stderr, "the run that writes is another one\n");
    return 1;
  }
  sim_destroy(&with.sim);
  sim_destroy(&without.sim);
  cast_config_destroy(&with.config);
  cast_config_destroy(&without.config);
  cast_case_remove(&made);
  return 0;
}
