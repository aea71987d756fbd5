/* What a step of the reduced mould costs: time, arithmetic and memory rates over states r and patches m, for 1 thread
 * and all. B, 8 r m bytes, is read once a step: within the caches the arithmetic decides, beyond them the memory.
 * The last column is what a step of the melt pays when the mould takes one for INTERVAL of them (mould_pace.h). */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "cast/mould/mould_pace.h"

enum { INTERVAL = 10 }; // steps of 5 us in the 50 us that a model from 1 ms on allows

/* One thread's processor time is its wall time on a free machine, and right on one that is not. */
static double now(void)
{
  struct timespec t;
  clock_gettime(omp_get_max_threads() == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* A model of the given size; its numbers matter only in that they are ordinary. */
static void fill_model(RomData *rom, size_t r, size_t m)
{
  *rom = (RomData){.r = r, .m = m};
  rom->lambda = malloc(r * sizeof(double));
  rom->ambient = malloc(r * sizeof(double));
  rom->constant = malloc(r * sizeof(double));
  rom->B = malloc(r * m * sizeof(double));
  rom->patch = calloc(m, sizeof *rom->patch);
  for (size_t l = 0; l < m; l++) rom->patch[l].area = 1e-6;
  for (size_t k = 0; k < r; k++) {
    rom->lambda[k] = 1e-3 * exp2(20.0 * (double)k / (double)r);
    rom->ambient[k] = 1e-3;
    rom->constant[k] = 1.0 / (double)(k + 1);
    for (size_t l = 0; l < m; l++) rom->B[k * m + l] = sin((double)(k * m + l));
  }
}

static void free_model(RomData *rom)
{
  free(rom->lambda);
  free(rom->ambient);
  free(rom->constant);
  free(rom->B);
  free(rom->patch);
}

/* Seconds of one step: the best of several runs of a tenth of a second. */
static double step_seconds(RomState *state, const double *q, bool new_dt)
{
  double best = INFINITY;
  for (int run = 0; run < 4; run++) {
    const double start = now();
    long steps = 0;
    for (; now() - start < 0.1; steps++) rom_state_step(state, q, new_dt ? 1e-5 * (1.0 + 1e-6 * (double)steps) : 1e-5);
    best = fmin(best, (now() - start) / (double)steps);
  }
  return best;
}

/* Seconds of a melt's step, the mould's own spread over INTERVAL. */
static double paced_seconds(const RomData *rom, RomState *state, const double *q)
{
  MouldPace *pace;
  CastError err;
  double best = INFINITY;
  if (mould_pace_create(rom, &pace, &err) != CAST_OK) return NAN;
  for (int run = 0; run < 4; run++) {
    const double start = now();
    long steps = 0;
    for (; now() - start < 0.1 || steps % INTERVAL; steps++) {
      mould_pace_gather(pace, state, q, 5e-6 * (1.0 + 1e-6 * (double)steps)); // no two intervals are the same
      if (steps % INTERVAL == INTERVAL - 1) mould_pace_step(pace, state);
    }
    best = fmin(best, (now() - start) / (double)steps);
  }
  mould_pace_destroy(&pace);
  return best;
}

int main(void)
{
  const size_t sizes[][2] = {{40, 50},    {100, 100},   {200, 100},   {200, 400},  {500, 400},
                             {500, 1600}, {1000, 2000}, {1283, 200}, {5400, 1000}, {8000, 1000}};
  const int most = omp_get_max_threads();
  printf("%6s %6s %8s %12s %10s %10s %10s %14s %14s\n", "r", "m", "threads", "FLOP/step", "us/step", "GFLOP/s", "GB/s",
         "us, new dt", "us, one in 10");
  for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++)
    for (int threads = 1; threads <= most; threads = threads < most ? most : most + 1) {
      RomData rom;
      RomState *state;
      CastError err;
      omp_set_num_threads(threads);
      fill_model(&rom, sizes[n][0], sizes[n][1]);
      if (rom_state_create(&rom, ROM_EXPONENTIAL, 1073.0, 300.0, &state, &err) != CAST_OK) {
        fprintf(stderr, "%s\n", err.message);
        return 1;
      }
      double *q = malloc(rom.m * sizeof *q);
      for (size_t l = 0; l < rom.m; l++) q[l] = cos((double)l);
      const double same = step_seconds(state, q, false), other = step_seconds(state, q, true);
      const double flops = rom_state_flops(state), bytes = 8.0 * (double)(rom.r * rom.m);
      printf("%6zu %6zu %8d %12.3g %10.2f %10.2f %10.2f %14.2f %14.2f\n", rom.r, rom.m, threads, flops, 1e6 * same,
             1e-9 * flops / same, 1e-9 * bytes / same, 1e6 * other, 1e6 * paced_seconds(&rom, state, q));
      free(q);
      rom_state_destroy(&state);
      free_model(&rom);
    }
  return 0;
}
