/* R6, threads: a coupled run has the same bits on 1, 2 and 4 threads. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/sim/sim.h"
#include "tests/support/assert_ok.h"
#include "tests/support/cast_case.h"
#include "tests/support/validation.h"

static int set_up(void **state)
{
  validation_begin("R6-threads");
  return cast_case_set_up(state);
}

typedef struct Run {
  CastConfig *config;
  Sim *sim;
} Run;

static Run run_with(int threads, const char *path)
{
  CastError err = {0};
  Run run = {NULL, NULL};
  SimEnd end;
  omp_set_num_threads(threads);
  ok(cast_config_read(path, NULL, &run.config, &err), &err);
  ok(sim_create(run.config, NULL, &run.sim, &err), &err);
  ok(sim_run(run.sim, NULL, &end, &err), &err);
  return run;
}

static void destroy(Run *run)
{
  sim_destroy(&run->sim);
  cast_config_destroy(&run->config);
}

/* How many of the fields (all of the fluid's, ids, the mould's state, the ledger) differ in any bit. */
static int differing(const Sim *a, const Sim *b)
{
  const Particles *p = sim_particles(a), *q = sim_particles(b);
  if (p->n_fluid != q->n_fluid) return 1;
  ParticleField field[PARTICLE_FIELDS], other[PARTICLE_FIELDS];
  particles_fields(p, field);
  particles_fields(q, other);
  int differ = memcmp(p->id, q->id, (size_t)p->n_fluid * sizeof *p->id) != 0;
  for (int f = 0; f < PARTICLE_FIELDS; f++)
    differ += memcmp(field[f].data, other[f].data, (size_t)p->n_fluid * sizeof(double)) != 0;
  const size_t n = rom_state_size(sim_mould(a));
  double *z = malloc(2 * n * sizeof *z);
  assert_non_null(z);
  rom_state_save(sim_mould(a), z);
  rom_state_save(sim_mould(b), z + n);
  differ += memcmp(z, z + n, n * sizeof *z) != 0;
  free(z);
  const EnergyLedger e = sim_ledger(a), g = sim_ledger(b);
  return differ + (memcmp(&e, &g, sizeof e) != 0);
}

static void check(const char *name, const char *coupling)
{
  const double begun = validation_cpu_time();
  // several thousand particles, so that every parallel loop has work for four threads
  const CastCaseInput input = {.melt = "  material: cual10\n  temperature: 1150 degC\n"
                                       "  blocks: [{ corner: [-2 mm, -2 mm, -4 mm], size: [4 mm, 4 mm, 3 mm] }]\n",
                               .coupling = coupling,
                               .sph = "{ spacing: 0.2 mm }",
                               .time = "{ end: 0.5 ms }"};
  CastError err = {0};
  char path[128];
  ok(cast_case_input(&casting, name, &input, path, &err), &err);
  Run one = run_with(1, path);
  const long steps = sim_steps(one.sim);
  const ptrdiff_t n = sim_particles(one.sim)->n_fluid;
  const double exchanged = sim_ledger(one.sim).exchanged;
  int differ = 0;
  for (int threads = 2; threads <= 4; threads *= 2) {
    Run more = run_with(threads, path);
    differ += differing(one.sim, more.sim);
    destroy(&more);
  }
  destroy(&one);
  const ValidationRow row = {.id = "R6-threads",
                             .quantity =
                                 validation_text("all fields of melt and mould on 1, 2, 4 threads, %s coupling", name),
                             .reference = "1 thread",
                             .ours = differ ? validation_text("%d fields differ", differ) : "same bits",
                             .error = differ ? "not 0" : "0",
                             .target = "same bits",
                             .resolution = validation_text("%td particles, %ld steps", n, steps),
                             .cpu_seconds = validation_cpu_time() - begun};
  validation_write(&row);
  assert_true(exchanged > 1e-6); // the run did touch the mould, else it shows nothing of the coupling
  assert_int_equal(differ, 0);
}

static void a_run_with_surface_coupling_has_the_same_bits_on_any_number_of_threads(void **state)
{
  (void)state;
  check("surface", "{ kind: surface }");
}

static void a_run_with_embedded_coupling_has_the_same_bits_on_any_number_of_threads(void **state)
{
  (void)state;
  check("embedded", "{ kind: embedded }");
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_run_with_surface_coupling_has_the_same_bits_on_any_number_of_threads),
      cmocka_unit_test(a_run_with_embedded_coupling_has_the_same_bits_on_any_number_of_threads),
  };
  return cmocka_run_group_tests(tests, set_up, cast_case_clean_up);
}
