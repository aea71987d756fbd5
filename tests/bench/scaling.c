/* How a step grows with the number of particles and shrinks with the number of threads: breaking columns of melt like
 * DB51's, of any size. Processor and wall time a fluid particle and step, parallel efficiency, memory a particle.
 * scaling [most particles, 400000 [steps, 20]] */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "tests/bench/bench.h"
#include "tests/support/lattice_tank.h"

/* Memory of this process, B. */
static double resident_bytes(void)
{
  long pages = 0, resident = 0;
  FILE *file = fopen("/proc/self/statm", "r");
  if (!file) return NAN;
  if (fscanf(file, "%ld %ld", &pages, &resident) != 2) resident = 0;
  fclose(file);
  return (double)resident * (double)sysconf(_SC_PAGESIZE);
}

/* A column of about n particles, 5:5:4, in a box half as long again. */
static void make_tank(double n, LatticeTank *tank)
{
  const double dx = 0.01;
  const int edge = (int)lround(cbrt(n / 100.0)); // 5 x 5 x 4 = 100 blocks of edge^3
  *tank = (LatticeTank){.fluid = {5 * edge, 5 * edge, 4 * edge},
                        .box = {8 * edge, 5 * edge, 5 * edge},
                        .layers = 3,
                        .low = {true, true, true},
                        .high = {true, true, false},
                        .sph = {.kernel = KERNEL_WENDLAND_C2,
                                .h = 1.3 * dx,
                                .spacing = dx,
                                .rho0 = 1000.0,
                                .c0 = 10.0 * sqrt(2.0 * 9.81 * 4.0 * edge * dx),
                                .gamma = 7.0,
                                .delta = 0.1,
                                .alpha = 0.1,
                                .gravity = {0.0, 0.0, -9.81}}};
  lattice_tank_create(tank);
  for (ptrdiff_t i = 0; i < tank->particles.n_fluid; i++) {
    tank->particles.kappa[i] = 30.0;
    tank->particles.mu[i] = 5e-3;
  }
}

/* Seconds of wall and of processor time a step: least of five runs of `steps` steps, the first step (lists from
 * nothing) left out. */
static void time_steps(LatticeTank *tank, int steps, double *wall, double *cpu)
{
  *wall = *cpu = INFINITY;
  lattice_tank_step(tank, 0.0);
  for (int run = 0; run < 5; run++) {
    const double begun = omp_get_wtime(), cpu_begun = bench_cpu_time();
    for (int k = 0; k < steps; k++) lattice_tank_step(tank, 0.0);
    *wall = fmin(*wall, (omp_get_wtime() - begun) / steps);
    *cpu = fmin(*cpu, (bench_cpu_time() - cpu_begun) / steps);
  }
}

int main(int argc, char **argv)
{
  const double most = argc > 1 ? strtod(argv[1], NULL) : 400000.0;
  const int steps = argc > 2 ? (int)strtol(argv[2], NULL, 10) : 20, threads = omp_get_max_threads();
  printf("%10s %10s %8s %12s %12s %11s %28s\n", "fluid", "walls", "threads", "us of CPU", "us of wall", "efficiency",
         "bytes a particle, with lists");
  for (double n = fmin(50000.0, most), next; n <= most; n = next) {
    next = n < most ? fmin(4.0 * n, most) : (double)INFINITY;
    double alone = NAN;
    for (int t = 1; t <= threads; t *= 2) {
      LatticeTank tank;
      omp_set_num_threads(t);
      const double before = resident_bytes();
      make_tank(n, &tank);
      const Particles *p = &tank.particles;
      double wall, cpu;
      time_steps(&tank, steps, &wall, &cpu);
      const double us = 1e6 * wall / (double)p->n_fluid;
      const double bytes = (resident_bytes() - before) / (double)p->n;
      if (t == 1) alone = us;
      printf("%10td %10td %8d %12.3f %12.3f %9.0f %% %28.0f\n", p->n_fluid, p->n - p->n_fluid, t,
             1e6 * cpu / (double)p->n_fluid, us, 100.0 * alone / (us * t), bytes);
      fflush(stdout);
      lattice_tank_destroy(&tank);
    }
  }
  return 0;
}
