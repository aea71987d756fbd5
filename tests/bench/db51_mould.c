/* DB51 with a mould: the same column of 51,200 particles breaks in a cavity of the same size, whose walls are made from
 * the geometry of a ROM of about 100 patches, through the whole program: coupling, contacts, wetted areas, mould and
 * books. Prints processor time a fluid particle and step, the shares of the parts, and what the ledger leaves.
 * db51_mould [steps]      OMP_NUM_THREADS=1 for the time of one thread */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

#include "cast/sim/sim_private.h"
#include "tests/bench/bench.h"
#include "tests/support/cast_case.h"

static CastConfig *make_case(CastCase *made)
{
  const SyntheticBox box = {.outer = {0.9, 0.66, 0.5},
                            .cavity = {0.64, 0.40, 0.36},
                            .cell = 0.04,
                            .patch_size = 0.1,
                            .kappa = 1.0,
                            .rho = 1800.0,
                            .c = 1100.0,
                            .h_outside = 80.0,
                            .nodes = 6, // 600 states and more, as a ROM of 100 patches to 1e-3 has
                            .band = 0.04};
  const CastCaseInput input = {
      .melt = "  material: cual10\n  temperature: 1150 degC\n"
              "  blocks: [{ corner: [-320 mm, -200 mm, -360 mm], size: [400 mm, 400 mm, 320 mm] }]\n",
      .forces = "{ gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2] }",
      .sph = "{ spacing: 10 mm, smoothing: 1.3, sound_speed: 25 m/s, artificial_viscosity: 0.1 }",
      .time = "{ end: 1 s, step: 0.1 ms }"};
  CastError err = {0};
  CastConfig *config = NULL;
  char path[128];
  must(cast_case_create_box(made, &box, &err), &err);
  must(cast_case_input(made, "db51", &input, path, &err), &err);
  must(cast_config_read(path, NULL, &config, &err), &err);
  return config;
}

static void report(const Sim *sim, double cpu, double setup)
{
  static const char *const part[] = {"motion", "neighbours, contacts", "pair sums", "exchange and mould"};
  const SimCounts *n = &sim->counts;
  const EnergyLedger books = sim_ledger(sim);
  double all = 0.0;
  for (int k = 0; k < 4; k++) all += n->seconds[k];
  printf("DB51 in a mould: %td + %td particles, ROM of %zu states and %zu patches, set-up %.2f s; %.0f steps, %ld "
         "builds\n",
         sim->particles.n_fluid, sim->particles.n - sim->particles.n_fluid, sim->rom->r, sim->rom->m, setup, n->steps,
         neighbours_builds(sim->neighbours));
  for (int k = 0; k < 4; k++) printf("  %-20s %5.1f %%\n", part[k], 100.0 * n->seconds[k] / all);
  printf("  %-20s %.3f us CPU a particle-step, %d threads\n", "all", 1e6 * cpu / n->particle_steps,
         omp_get_max_threads());
  printf("  ledger: %.1e of %.3g J exchanged\n", fabs(books.residual) / books.exchanged, books.exchanged);
}

int main(int argc, char **argv)
{
  const long steps = argc > 1 ? strtol(argv[1], NULL, 10) : 200;
  CastError err = {0};
  CastCase made;
  CastConfig *config = make_case(&made);
  Sim *sim = NULL;
  const double begun = bench_cpu_time();
  must(sim_create(config, NULL, &sim, &err), &err);
  const double ready = bench_cpu_time();
  for (long k = 0; k < steps; k++) must(sim_step(sim, &err), &err);
  report(sim, bench_cpu_time() - ready, ready - begun);
  sim_destroy(&sim);
  cast_config_destroy(&config);
  cast_case_remove(&made);
  return 0;
}
