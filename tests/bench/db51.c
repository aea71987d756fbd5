/* The common SPH workload DB51: a column of 51,200 melt particles breaks in an open box of 33,420 wall particles;
 * spacing 0.01 m, kernel support 0.026 m, c0 = 25 m/s, dt = 1e-4 s. Every part of a step that castrun takes without a
 * mould: continuity with density diffusion, pressure, viscosity, artificial viscosity, heat, extrapolated walls,
 * enthalpy to temperature, time-step limits, lists rebuilt as needed. Prints processor time a fluid particle and step,
 * by part. db51 [steps [skin/spacing]]      OMP_NUM_THREADS=1 for the time of one thread */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/bench/bench.h"
#include "tests/bench/lammps.h"
#include "tests/support/lattice_tank.h"

enum { DRIFT, LISTS, RATES, FINISH, LIMITS, PARTS };
static const char *const part_name[PARTS] = {"drift", "neighbour lists", "rates", "finish", "time-step limits"};

static double lap(double *clock)
{
  const double now = bench_cpu_time(), spent = now - *clock;
  *clock = now;
  return spent;
}

/* A bronze with a freezing range; conductivity and viscosity vary with temperature. */
static void make_melt(Material *melt)
{
  const double T[] = {0.0, 1300.0, 1302.0, 1304.0, 1306.0, 1308.0, 1311.0, 2311.0};
  const double E[] = {0.0, 5.7e5, 6.1e5, 6.6e5, 7.0e5, 7.5e5, 8.1e5, 1.37e6};
  const double at[] = {1300.0, 1311.0, 1500.0}, kappa[] = {59.0, 30.0, 32.0}, mu[] = {7e-3, 5e-3, 4e-3};
  CastError err;
  *melt = (Material){.density = 1000.0};
  must(table_create(8, T, E, &melt->enthalpy, &err), &err);
  must(table_create(3, at, kappa, &melt->conductivity_of_t, &err), &err);
  must(table_create(3, at, mu, &melt->viscosity_of_t, &err), &err);
}

static void step(LatticeTank *tank, double dt, double spent[PARTS])
{
  CastError err = {0};
  Particles *p = &tank->particles;
  double clock = bench_cpu_time();
  must(sph_drift(&tank->sph, p, NULL, dt, NULL, &err), &err);
  spent[DRIFT] += lap(&clock);
  must(neighbours_update(tank->neighbours, p, false, NULL, &err), &err);
  spent[LISTS] += lap(&clock);
  sph_rates(&tank->sph, p, tank->neighbours);
  spent[RATES] += lap(&clock);
  must(sph_finish(&tank->sph, p, dt, &err), &err);
  spent[FINISH] += lap(&clock);
  const SphLimits limits = sph_time_step(&tank->sph, p);
  if (!(limits.step > 0.5 * dt)) printf("step %ld: %s allows %g s only\n", tank->steps, limits.which, limits.step);
  spent[LIMITS] += lap(&clock);
  tank->time += dt;
  tank->steps++;
}

/* Processor time a particle of one evaluation of all rates in the plain form: double, one pair after the other. */
static double plain_rates(LatticeTank *tank)
{
  double best = INFINITY;
  for (int run = 0; run < 3; run++) {
    double clock = bench_cpu_time();
    sph_forces(&tank->sph, &tank->particles, tank->neighbours);
    sph_conduction(&tank->sph, &tank->particles, tank->neighbours);
    best = fmin(best, lap(&clock));
  }
  return 1e6 * best / (double)tank->particles.n_fluid;
}

static void report(const LatticeTank *tank, const double spent[PARTS], double wall)
{
  const double particle_steps = (double)tank->steps * (double)tank->particles.n_fluid;
  const PairList *fluid = neighbours_fluid_fluid(tank->neighbours), *walls = neighbours_fluid_wall(tank->neighbours);
  const double n = (double)tank->particles.n_fluid;
  double total = 0.0, front = 0.0, near[2] = {0.0, 0.0};
  for (ptrdiff_t i = 0; i < fluid->n; i++) near[0] += fluid->near[i];
  for (ptrdiff_t i = 0; i < walls->n; i++) near[1] += walls->near[i];
  for (int part = 0; part < PARTS; part++) total += spent[part];
  for (ptrdiff_t i = 0; i < tank->particles.n_fluid; i++) front = fmax(front, tank->particles.x[0][i]);
  printf("DB51: %ld steps to t = %.4f s, front at %.3f m, %d threads\n", tank->steps, tank->time, front,
         omp_get_max_threads());
  printf("pairs listed a fluid particle: %.1f fluid, %.1f wall, of these near %.1f, %.1f; a list lasts %.1f steps\n",
         (double)fluid->start[fluid->n] / n, (double)walls->start[walls->n] / n, near[0] / n, near[1] / n,
         (double)tank->steps / (double)neighbours_builds(tank->neighbours));
  for (int part = 0; part < PARTS; part++)
    printf("  %-18s %.3f us CPU a particle-step\n", part_name[part], 1e6 * spent[part] / particle_steps);
  printf("  %-18s %.3f us CPU a particle-step, %.3f us of wall time\n", "all", 1e6 * total / particle_steps,
         1e6 * wall / particle_steps);
}

int main(int argc, char **argv)
{
  const long steps = argc > 1 ? strtol(argv[1], NULL, 10) : 300;
  const double dx = 0.01;
  Material melt;
  make_melt(&melt);
  LatticeTank tank = {.fluid = {40, 40, 32},
                      .box = {64, 40, 36},
                      .layers = 3,
                      .low = {true, true, true},
                      .high = {true, true, false},
                      .sph = {.kernel = KERNEL_WENDLAND_C2,
                              .h = 0.013,
                              .spacing = dx,
                              .rho0 = 1000.0,
                              .c0 = 25.0,
                              .gamma = 7.0,
                              .delta = 0.1,
                              .alpha = 0.1,
                              .gravity = {0.0, 0.0, -9.81},
                              .melt = &melt}};
  lattice_tank_create(&tank);
  if (argc > 2) {
    CastError err = {0};
    neighbours_destroy(&tank.neighbours);
    must(neighbours_create(0.026, strtod(argv[2], NULL) * dx, NULL, &tank.neighbours, &err), &err);
  }
  Particles *p = &tank.particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) p->E[i] = p->x[0][i] < 0.2 ? 6.8e5 : 8.5e5;
  sph_initialise(&tank.sph, p);
  char note[160];
  const double lammps = lammps_time(&tank, 1e-4, note); // from the same places
  double spent[PARTS] = {0.0};
  const double begun = omp_get_wtime();
  for (long k = 0; k < steps; k++) step(&tank, 1e-4, spent);
  report(&tank, spent, omp_get_wtime() - begun);
  printf("  rates in the plain form, in double: %.3f us CPU a particle\n", plain_rates(&tank));
  if (isnan(lammps))
    printf("  LAMMPS: %s\n", note);
  else
    printf("  LAMMPS (%s): %.3f us CPU a particle-step\n", note, lammps);
  lattice_tank_destroy(&tank);
  material_destroy(&melt);
  return 0;
}
