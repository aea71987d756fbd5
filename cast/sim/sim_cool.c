/* sim_cool.c - when the filling is over, and the second stage: melt stands where it is and cools.
 * The switch: kinetic energy below a ten-thousandth of its peak for 10 ms, or all melt locked, or the filling's time is
 * up. What melt still moves then is stopped; the books hold heat alone, so nothing is lost from them. */
#include <math.h>
#include <string.h>

#include "cast/physics/solidification.h"
#include "cast/sim/sim_private.h"

static const double REST = 1e-4, REST_FOR = 10e-3; // of the peak kinetic energy; s
static const double SOLID = 0.999; // a drop that touches nothing keeps its heat, and would keep a run from its end
enum { LOOK_EVERY = 8 };           // steps

double sim_end(const Sim *sim)
{
  return sim->config->cool.wanted ? sim->config->cool.end : sim->config->end;
}

double sim_solid_part(const Sim *sim, double *locked)
{
  const Particles *p = &sim->particles;
  const Material *melt = &sim->config->melt;
  double sum = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid && melt->solid_fraction.n > 0; i++)
    sum += table_evaluate(&melt->solid_fraction, p->T[i]);
  const double n = p->n_fluid > 0 ? (double)p->n_fluid : 1.0;
  if (locked) *locked = (double)solidification_count_locked(melt, p->n_fluid, p->E) / n;
  return sum / n;
}

/* ---- the switch ---- */

void sim_watch_rest(Sim *sim)
{
  SimCounts *n = &sim->counts;
  if (fmod(n->steps, LOOK_EVERY) == 0.0) {
    freezing_update(sim->freezing, &sim->particles, n->time);
    arrival_update(sim->arrival, &sim->particles, n->time);
  }
  if (!sim->config->cool.wanted || fmod(n->steps, LOOK_EVERY) != 0.0) return;
  n->kinetic = sph_kinetic_energy(&sim->particles);
  n->kinetic_peak = fmax(n->kinetic_peak, n->kinetic);
  if (n->kinetic > REST * n->kinetic_peak || n->kinetic_peak == 0.0 || !sim_pour_is_over(sim))
    n->quiet = -1.0;
  else if (n->quiet <= 0.0)
    n->quiet = n->time;
}

SwitchReason sim_fill_is_over(const Sim *sim)
{
  const SimCounts *n = &sim->counts;
  const Particles *p = &sim->particles;
  if (!sim->config->cool.wanted || p->n_fluid == 0) return SWITCH_NONE;
  if (n->time >= sim->config->end * (1.0 - 1e-12)) return SWITCH_TIME;
  if (!sim_pour_is_over(sim)) return SWITCH_NONE;
  if (sim->config->cool.at_end || fmod(n->steps, LOOK_EVERY) != 0.0) return SWITCH_NONE;
  if (n->quiet > 0.0 && n->time - n->quiet >= REST_FOR) return SWITCH_REST;
  return solidification_count_locked(&sim->config->melt, p->n_fluid, p->E) == p->n_fluid ? SWITCH_LOCKED : SWITCH_NONE;
}

static void stop_melt(Particles *p)
{
  const size_t bytes = (size_t)p->n_fluid * sizeof(double);
  for (int d = 0; d < 3; d++) {
    memset(p->v[d], 0, bytes);
    memset(p->a[d], 0, bytes);
  }
}

/* Lists and contacts are those of the places, so that a resumed run has the same. */
static CastStatus create(Sim *sim, CastError *err)
{
  const CoolParameters parameters = {sim->config->cool.tolerance, 10.0 * sim->counts.dt};
  CAST_CALL(neighbours_update(sim->neighbours, &sim->particles, true, &sim->rebuilt, err));
  coupling_use_surface(sim->coupling);
  CAST_CALL(coupling_rebuild(sim->coupling, &sim->particles, sim->neighbours, err));
  const CoolSystem system = {&sim->sph, &sim->particles, sim->neighbours, sim->coupling, sim->mould};
  return cool_create(&parameters, &system, &sim->cool, err);
}

CastStatus sim_cool_begin(Sim *sim, CastError *err)
{
  static const char *const reasons[] = {"", "the melt is at rest", "all melt is locked", "the filling's time is up"};
  SimCounts *n = &sim->counts;
  const SwitchReason reason = sim_fill_is_over(sim);
  CAST_CALL(sim_pour_end(sim, err));
  stop_melt(&sim->particles);
  coupling_settle(sim->coupling, sim->mould);
  CAST_CALL(create(sim, err));
  n->kinetic = sph_kinetic_energy(&sim->particles);
  n->stage = STAGE_COOL;
  n->switched = n->time;
  n->reason = reason;
  n->fill_wall = n->wall;
  log_info(sim->log, "cooling   from t = %.6g ms on: %s", 1e3 * n->time, reasons[reason]);
  return sim_output_stage(sim, err);
}

CastStatus sim_cool_resume(Sim *sim, CastError *err)
{
  CAST_CALL(create(sim, err));
  cool_restore(sim->cool, sim->counts.cool);
  filling_update(sim->filling, &sim->particles, sim->counts.time);
  return CAST_OK;
}

const char *sim_switched(const Sim *sim, double *time)
{
  static const char *const names[] = {"", "rest", "locked", "time"};
  *time = sim->cool ? sim->counts.switched : (double)NAN;
  return names[sim->cool ? (SwitchReason)sim->counts.reason : SWITCH_NONE];
}

/* ---- its steps ---- */

CastStatus sim_cool_step(Sim *sim, CastError *err)
{
  const double begun = log_wall_time();
  SimCounts *n = &sim->counts;
  CAST_CALL(cool_step(sim->cool, sim->config->cool.end - n->time, &n->dt, err));
  CAST_CALL(sim_output_record(sim, err));
  n->time += n->dt;
  freezing_update(sim->freezing, &sim->particles, n->time);
  n->seconds[PHASE_COOL] += log_wall_time() - begun;
  return CAST_OK;
}

bool sim_cool_is_over(const Sim *sim)
{
  if (sim->counts.time >= sim->config->cool.end * (1.0 - 1e-12)) return true;
  return sim->config->cool.until_solid && sim_solid_part(sim, NULL) >= SOLID;
}

void sim_cool_keep(Sim *sim)
{
  if (sim->cool) cool_save(sim->cool, sim->counts.cool);
}

CastStatus sim_cool_checkpoint(Sim *sim, CastError *err)
{
  if (!sim->checkpoint_wanted || !sim->output) return CAST_OK;
  CAST_CALL(sim_write_checkpoint(sim, "checkpoint.h5", err));
  sim->checkpoint_wanted = false;
  return CAST_OK;
}
