/* What the mould costs in a run: a step of the reduced model against a step of a full model of the same slab, and
 * against the melt's step. The paper: 1e6 operations for the full model, 1e4 for the reduced one.
 * The full model is finite volumes on a grid (the cheapest of its kind: 7 entries a row, no mesh), implicit as in the
 * paper, solved by conjugate gradients with Jacobi preconditioning from the last state to 1e-6. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "tests/support/melt_on_mould.h"
#include "tests/support/validation.h"
#include "tests/support/voxel_mould.h"

enum { N = 32, CELLS = N * N * N, STEPS = 20 };
static const double dt = 1e-5, spacing = 1e-4; // s, m

static double now(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- the full model: (E/dt + K) T' = E/dt T + Q, all cells alike ---- */

typedef struct FullModel {
  double capacity, link; // W/K: E/dt of a cell, kappa dx of a face
  double *T, *b, *r, *p, *Ap;
  double operations;
} FullModel;

static double entry(const double *x, ptrdiff_t i, ptrdiff_t step, int at, int towards)
{
  return at + towards >= 0 && at + towards < N ? x[i] - x[i + towards * step] : 0.0;
}

static void multiply(FullModel *full, const double *x, double *y)
{
  for (int k = 0; k < N; k++)
    for (int j = 0; j < N; j++)
      for (int i = 0; i < N; i++) {
        const ptrdiff_t c = ((ptrdiff_t)k * N + j) * N + i;
        const double flow = entry(x, c, 1, i, -1) + entry(x, c, 1, i, 1) + entry(x, c, N, j, -1) +
                            entry(x, c, N, j, 1) + entry(x, c, N * N, k, -1) + entry(x, c, N * N, k, 1);
        y[c] = full->capacity * x[c] + full->link * flow;
      }
  full->operations += 14.0 * CELLS;
}

static double product(FullModel *full, const double *x, const double *y)
{
  double sum = 0.0;
  for (int c = 0; c < CELLS; c++) sum += x[c] * y[c];
  full->operations += 2.0 * CELLS;
  return sum;
}

/* The diagonal is (nearly) the same for all cells, so Jacobi's preconditioner is a number and drops out. */
static int full_step(FullModel *full, double power)
{
  for (int c = 0; c < CELLS; c++) full->b[c] = full->capacity * full->T[c];
  for (int c = 0; c < N * N; c++) full->b[CELLS - 1 - c] += power / (N * N);
  multiply(full, full->T, full->Ap);
  for (int c = 0; c < CELLS; c++) full->p[c] = full->r[c] = full->b[c] - full->Ap[c];
  double rr = product(full, full->r, full->r);
  const double enough = 1e-12 * rr;
  int turns = 0;
  for (; rr > enough && turns < 1000; turns++) {
    multiply(full, full->p, full->Ap);
    const double a = rr / product(full, full->p, full->Ap), last = rr;
    for (int c = 0; c < CELLS; c++) {
      full->T[c] += a * full->p[c];
      full->r[c] -= a * full->Ap[c];
    }
    rr = product(full, full->r, full->r);
    for (int c = 0; c < CELLS; c++) full->p[c] = full->r[c] + rr / last * full->p[c];
    full->operations += 6.0 * CELLS;
  }
  return turns;
}

static void measure_full(double *operations, double *seconds)
{
  const double edge = 16.0 * spacing / N;
  FullModel full = {.capacity = 1800.0 * 1100.0 * edge * edge * edge / dt, .link = 1.0 * edge};
  double **const arrays[] = {&full.T, &full.b, &full.r, &full.p, &full.Ap};
  for (size_t a = 0; a < 5; a++) *arrays[a] = synthetic_array(CELLS, sizeof(double));
  const double start = now();
  for (int n = 0; n < STEPS; n++) assert_true(full_step(&full, 1.0) < 1000);
  *seconds = (now() - start) / STEPS;
  *operations = full.operations / STEPS;
  for (size_t a = 0; a < 5; a++) free(*arrays[a]);
}

/* ---- the reduced model and the melt ---- */

static double seconds_of_mould_step(MeltOnMould *melt)
{
  double *q = synthetic_array(melt->rom->m, sizeof *q), best = INFINITY;
  q[0] = 0.1;
  for (int run = 0; run < 5; run++) {
    const double start = now();
    for (int n = 0; n < 2000; n++) rom_state_step(melt->mould, q, dt);
    best = fmin(best, (now() - start) / 2000.0);
  }
  free(q);
  return best;
}

static double seconds_of_melt_step(MeltOnMould *melt)
{
  double best = INFINITY;
  melt->sph.frozen_flow = false; // what flow costs; the particles are not moved
  for (int run = 0; run < 5; run++) {
    const double start = now();
    for (int n = 0; n < 5; n++) sph_rates(&melt->sph, &melt->particles, melt->neighbours);
    best = fmin(best, (now() - start) / 5.0);
  }
  return best / (double)melt->particles.n_fluid;
}

static void a_reduced_step_is_a_hundredth_of_a_full_one(void **state)
{
  (void)state;
  const MeltCase given = {.spacing = spacing,
                          .corner = {1.5 * spacing, 1.5 * spacing, 0.0},
                          .count = {13, 13, 13},
                          .slab = {.size = {16.0 * spacing, 16.0 * spacing},
                                   .depth = 16.0 * spacing,
                                   .kappa = 1.0,
                                   .rho = 1800.0,
                                   .c = 1100.0,
                                   .modes = 10,
                                   .modes_lateral = {2, 2},
                                   .patches = {7, 7},
                                   .band = 4.0 * spacing,
                                   .band_layers = 4,
                                   .cells = {1, 1}},
                          .coupling = {.kind = COUPLING_SURFACE, .h_contact = 2000.0},
                          .kappa = 30.0,
                          .rho = 7000.0,
                          .c = 560.0,
                          .hot = 1423.0,
                          .preheat = 1073.0,
                          .ambient = 300.0};
  MeltOnMould melt;
  const double begin = validation_cpu_time();
  melt_on_mould_create(&given, &melt);
  double full_operations, full_seconds;
  measure_full(&full_operations, &full_seconds);
  const double operations = rom_state_flops(melt.mould), seconds = seconds_of_mould_step(&melt);
  const double per_particle = seconds_of_melt_step(&melt);
  const ValidationRow against_full = {
      "COST",
      "mould step: reduced against full model",
      "1e4 against 1e6 operations (paper)",
      validation_text("%.1e against %.1e; %.3g against %.3g us", operations, full_operations, 1e6 * seconds,
                      1e6 * full_seconds),
      validation_text("a factor of %.0f (time %.0f)", full_operations / operations, full_seconds / seconds),
      "100",
      validation_text("r = %zu, m = %zu; full: %d unknowns, conjugate gradients", melt.rom->r, melt.rom->m, CELLS),
      validation_cpu_time() - begin};
  validation_write(&against_full);
  const ValidationRow against_melt = {
      "COST",
      "mould step against the melt's",
      "negligible (paper)",
      validation_text("%.3g us against %.3g us a particle", 1e6 * seconds, 1e6 * per_particle),
      validation_text("%.2g %% of a step of 1e5 particles", 100.0 * seconds / (1e5 * per_particle)),
      "1 %",
      validation_text("r = %zu, m = %zu, 1 thread", melt.rom->r, melt.rom->m),
      validation_cpu_time() - begin};
  validation_write(&against_melt);
  assert_true(operations <= 1.1e4);
  assert_true(full_operations > 100.0 * operations);
  assert_true(full_seconds > 20.0 * seconds); // timings under load: only that it is far
  melt_on_mould_destroy(&melt);
}

int main(void)
{
  omp_set_num_threads(1);
  validation_begin("COST");
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_reduced_step_is_a_hundredth_of_a_full_one)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
