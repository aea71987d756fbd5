#include "tests/support/cast_run.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

#include "tests/support/assert_ok.h"

CastRun cast_run_start(const char *name, const CastCaseInput *input, bool with_output)
{
  CastError err = {0};
  CastRun run = {0};
  char path[128];
  ok(cast_case_input(&casting, name, input, path, &err), &err);
  snprintf(run.folder, sizeof run.folder, "%.60s/%.60s", casting.folder, name);
  ok(cast_config_read(path, NULL, &run.config, &err), &err);
  ok(sim_create(run.config, NULL, &run.sim, &err), &err);
  if (!with_output) return run;
  mkdir(run.folder, 0777);
  ok(sim_open_output(run.sim, "test", &err), &err);
  return run;
}

SimEnd cast_run_all(const CastRun *run)
{
  CastError err = {0};
  SimEnd end;
  ok(sim_run(run->sim, NULL, &end, &err), &err);
  return end;
}

void cast_run_finish(CastRun *run)
{
  sim_destroy(&run->sim);
  cast_config_destroy(&run->config);
}

void cast_run_assert_same_melt(const Sim *a, const Sim *b)
{
  const Particles *p = sim_particles(a), *q = sim_particles(b);
  assert_int_equal(p->n, q->n);
  ParticleField field[PARTICLE_FIELDS], other[PARTICLE_FIELDS];
  particles_fields(p, field);
  particles_fields(q, other);
  for (int f = 0; f < PARTICLE_FIELDS; f++)
    if (memcmp(field[f].data, other[f].data, (size_t)p->n_fluid * sizeof(double)) != 0)
      fail_msg("%s differs", field[f].name);
  assert_memory_equal(p->id, q->id, (size_t)p->n_fluid * sizeof *p->id);
}
