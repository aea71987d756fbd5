/* sim.c - life of a simulation, its step, its run. */
#include "cast/sim/sim.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/sim/sim_private.h"

/* Lists are made anew at least this often, so that a checkpoint, which waits for it, never waits long. */
enum { MOST_STEPS_BETWEEN_REBUILDS = 128 };

/* ---- life ---- */

CastStatus sim_rebuild(Sim *sim, CastError *err)
{
  CAST_CALL(coupling_rebuild(sim->coupling, &sim->particles, sim->neighbours, err));
  return sim->gas ? gas_rebuild(sim->gas, &sim->particles, err) : CAST_OK;
}

/* Everything that the places at `time` (s) decide, but the exchange with the mould. */
static CastStatus set_rates(Sim *sim, double time, CastError *err)
{
  sph_rates(&sim->sph, &sim->particles, sim->neighbours);
  if (sim->tension) CAST_CALL(tension_push(sim->tension, &sim->particles, sim->neighbours, err));
  if (sim->gas) sim_gas_push(sim, time);
  return CAST_OK;
}

static CastStatus first_rates(Sim *sim, CastError *err)
{
  CAST_CALL(neighbours_update(sim->neighbours, &sim->particles, true, &sim->rebuilt, err));
  CAST_CALL(sim_rebuild(sim, err));
  CAST_CALL(set_rates(sim, 0.0, err));
  sim_pour_carry(sim);
  return CAST_OK;
}

static CastStatus set_walls(Sim *sim, CastError *err)
{
  const CastConfig *c = sim->config;
  if (c->n_walls == 0) return CAST_OK;
  CAST_CALL(outer_walls_create(sim->rom, c->n_walls, c->wall, c->input_path, c->ambient, &sim->walls, err));
  return rom_state_set_walls(sim->mould, sim->walls, err);
}

static CastStatus build(Sim *sim, CastError *err)
{
  const CastConfig *c = sim->config;
  CAST_CALL(sim_setup_geometry(sim, err));
  CAST_CALL(sim_setup_particles(sim, err));
  CAST_CALL(sim_gas_create(sim, err));
  CAST_CALL(sim_tension_create(sim, err));
  CAST_CALL(rom_state_create(sim->rom, c->scheme, c->preheat, c->ambient, &sim->mould, err));
  CAST_CALL(set_walls(sim, err));
  CAST_CALL(neighbours_create(kernel_support(c->kernel) * sim->sph.h, neighbours_skin(c->spacing), sim->surface,
                              &sim->neighbours, err));
  neighbours_suit_skin(sim->neighbours, c->spacing, sph_sound_step(&sim->sph, 0.0));
  CAST_CALL(coupling_create(&c->coupling, &sim->sph, sim->rom, sim->surface, &sim->particles, &sim->coupling, err));
  CAST_CALL(filling_create(sim->surface, sim->rom, c->spacing, sim->origin, &sim->filling, err));
  CAST_CALL(filling_add_boxes(sim->filling, c->n_features, c->feature, err));
  CAST_CALL(filling_set_part(sim->filling, c->n_part, c->part, err));
  CAST_CALL(arrival_create(filling_cells(sim->filling), sim->rom, c->spacing, sim->n_ids, &sim->arrival, err));
  arrival_update(sim->arrival, &sim->particles, 0.0);
  CAST_CALL(freezing_create(&c->melt, sim->n_ids, &sim->freezing, err));
  freezing_watch_gradient(sim->freezing, &sim->sph, sim->neighbours);
  freezing_update(sim->freezing, &sim->particles, 0.0);
  return first_rates(sim, err);
}

CastStatus sim_create(const CastConfig *config, Log *log, Sim **sim, CastError *err)
{
  const double begun = log_wall_time();
  Sim *made = *sim = calloc(1, sizeof *made);
  CAST_CHECK(made, err, CAST_ERR_MEMORY, "no memory");
  made->config = config;
  made->log = log;
  const CastStatus status = build(made, err);
  made->seconds_setup = log_wall_time() - begun;
  if (status != CAST_OK) sim_destroy(sim);
  return status;
}

void sim_destroy(Sim **sim)
{
  if (!sim || !*sim) return;
  Sim *s = *sim;
  sim_output_destroy(&s->output);
  cool_destroy(&s->cool);
  freezing_destroy(&s->freezing);
  sim_pour_destroy(s);
  arrival_destroy(&s->arrival);
  gas_destroy(&s->gas);
  tension_destroy(&s->tension);
  filling_destroy(&s->filling);
  coupling_destroy(&s->coupling);
  neighbours_destroy(&s->neighbours);
  rom_state_destroy(&s->mould);
  outer_walls_destroy(&s->walls);
  particles_destroy(&s->particles);
  surface_destroy(&s->surface);
  if (s->rom != s->config->loaded_rom) rom_destroy(&s->rom);
  free(s);
  *sim = NULL;
}

/* ---- the step ---- */

/* Adds the time since *begun to a phase and starts anew. */
static void lap(Sim *sim, SimPhase phase, double *begun)
{
  const double now = log_wall_time();
  sim->counts.seconds[phase] += now - *begun;
  *begun = now;
}

static void choose_step(Sim *sim)
{
  static const char *const limits[] = {"sound", "force", "viscosity", "conduction"};
  const CastConfig *c = sim->config;
  SphLimits limit = sph_time_step(&sim->sph, &sim->particles);
  int which = 4;
  for (int k = 0; k < 4 && !(c->step > 0.0); k++)
    if (strcmp(limit.which, limits[k]) == 0) which = k;
  const double capillary = sim->tension ? tension_step(sim->tension, sim->sph.rho0) : (double)INFINITY;
  if (!(c->step > 0.0) && capillary < limit.step) {
    limit.step = capillary;
    which = 5;
  }
  const double step = c->step > 0.0 ? c->step : limit.step;
  sim->counts.limited_by[which]++;
  // two equal steps where one and a sliver would be left
  const double left = c->end - sim->counts.time;
  sim->counts.dt = left <= step * (1.0 + 1e-9) ? left : left < 2.0 * step ? 0.5 * left : step;
}

static CastStatus move(Sim *sim, CastError *err)
{
  choose_step(sim);
  long guarded = 0;
  CAST_CALL(sph_drift(&sim->sph, &sim->particles, sim->surface, sim->counts.dt, &guarded, err));
  sim->counts.guarded += (double)guarded;
  sim_pour_place(sim, sim->counts.time + sim->counts.dt);
  return CAST_OK;
}

static CastStatus update_lists(Sim *sim, CastError *err)
{
  const bool force = sim->lists_stale || sim->counts.since_rebuild >= MOST_STEPS_BETWEEN_REBUILDS;
  CAST_CALL(neighbours_update(sim->neighbours, &sim->particles, force, &sim->rebuilt, err));
  sim->lists_stale = false;
  sim->counts.since_rebuild = sim->rebuilt ? 0.0 : sim->counts.since_rebuild + 1.0;
  return sim->rebuilt ? sim_rebuild(sim, err) : CAST_OK;
}

static CastStatus finish(Sim *sim, CastError *err)
{
  CAST_CALL(sph_finish(&sim->sph, &sim->particles, sim->counts.dt, err));
  sim->counts.time += sim->counts.dt;
  sim->counts.steps += 1.0;
  sim->counts.particle_steps += (double)sim->particles.n_fluid;
  sim_watch_rest(sim);
  if (sim->rebuilt) CAST_CALL(sim_remove_escaped(sim, err));
  return sim_pour_feed(sim, err);
}

/* A checkpoint is taken right after the lists were made anew: made anew from what it holds they are the same, so it
 * neither disturbs the run nor does a resumed one differ. */
static CastStatus first_half(Sim *sim, CastError *err)
{
  double clock = log_wall_time();
  CAST_CALL(move(sim, err));
  lap(sim, PHASE_MOVE, &clock);
  CAST_CALL(update_lists(sim, err));
  lap(sim, PHASE_NEIGHBOURS, &clock);
  sim->under_way = true;
  if (!sim->rebuilt || !sim->checkpoint_wanted || !sim->output) return CAST_OK;
  CAST_CALL(sim_write_checkpoint(sim, "checkpoint.h5", err));
  sim->checkpoint_wanted = false;
  lap(sim, PHASE_OUTPUT, &clock);
  return CAST_OK;
}

static CastStatus second_half(Sim *sim, CastError *err)
{
  double clock = log_wall_time();
  const double end = sim->counts.time + sim->counts.dt;
  sim_set_forces(sim, end);
  CAST_CALL(set_rates(sim, end, err));
  lap(sim, PHASE_RATES, &clock);
  CAST_CALL(coupling_advance(sim->coupling, sim->mould, &sim->particles, sim->neighbours, sim->counts.dt, err));
  CAST_CALL(sim_output_record(sim, err));
  sim->counts.substeps_most = fmax(sim->counts.substeps_most, (double)coupling_substeps(sim->coupling));
  lap(sim, PHASE_MOULD, &clock);
  CAST_CALL(finish(sim, err));
  lap(sim, PHASE_MOVE, &clock);
  sim->under_way = false;
  return CAST_OK;
}

/* Add to what went wrong when it did. */
static CastStatus say_when(const Sim *sim, CastStatus status, CastError *err)
{
  if (status != CAST_ERR_NUMERIC) return status;
  char text[96];
  snprintf(text, sizeof text, "step %.0f, t = %.6g ms, dt = %.3g us", sim->counts.steps + 1.0, 1e3 * sim->counts.time,
           1e6 * sim->counts.dt);
  return cast_error_prefix(err, text);
}

CastStatus sim_step(Sim *sim, CastError *err)
{
  if (sim->cool) return say_when(sim, sim_cool_step(sim, err), err);
  const CastStatus status = sim->under_way ? CAST_OK : first_half(sim, err);
  return say_when(sim, status == CAST_OK ? second_half(sim, err) : status, err);
}

/* ---- the run ---- */

static void show_progress(const Sim *sim)
{
  const SimCounts *n = &sim->counts;
  char note[160];
  if (sim->cool)
    snprintf(note, sizeof note, "t = %.4g s, dt = %.3g s, %.1f %% solid", n->time, n->dt,
             100.0 * sim_solid_part(sim, NULL));
  else
    snprintf(note, sizeof note, "t = %.3f ms, dt = %.2f us, filled %.1f %%, %.2f million particle-steps/s",
             1e3 * n->time, 1e6 * n->dt, 100.0 * sim_filled_fraction(sim),
             n->wall > 0.0 ? 1e-6 * n->particle_steps / n->wall : 0.0);
  const double end = sim->cool ? sim_end(sim) : sim->config->end;
  log_progress(sim->log, sim->cool ? "cooling" : "casting", n->time / end, note);
}

static bool at_end(const Sim *sim)
{
  if (sim->config->cool.wanted) return sim->cool && sim_cool_is_over(sim);
  return !sim->under_way && sim->counts.time >= sim->config->end * (1.0 - 1e-12);
}

static CastStatus run_steps(Sim *sim, const volatile sig_atomic_t *stop, SimEnd *end, CastError *err)
{
  double last_checkpoint = log_wall_time(), clock = last_checkpoint;
  while (!at_end(sim)) {
    if (!sim->cool && !sim->under_way && sim_fill_is_over(sim)) CAST_CALL(sim_cool_begin(sim, err));
    const bool stopping = stop && *stop;
    const bool due = log_wall_time() - last_checkpoint > sim->config->output.checkpoint_every;
    if (sim->output && (stopping || due)) sim->checkpoint_wanted = true;
    const bool wanted = sim->checkpoint_wanted;
    if (sim->cool)
      CAST_CALL(sim_cool_checkpoint(sim, err));
    else if (!sim->under_way)
      CAST_CALL(say_when(sim, first_half(sim, err), err));
    const bool written = wanted && !sim->checkpoint_wanted;
    if (written) last_checkpoint = log_wall_time();
    if (stopping && (written || !sim->output)) {
      *end = SIM_INTERRUPTED;
      return CAST_OK;
    }
    CAST_CALL(sim_step(sim, err));
    const double now = log_wall_time();
    sim->counts.wall += now - clock;
    clock = now;
    CAST_CALL(sim_output_due(sim, err));
    show_progress(sim);
    if (sim->particles.n_fluid == 0) {
      *end = SIM_EMPTY;
      return CAST_OK;
    }
  }
  *end = SIM_FINISHED;
  return CAST_OK;
}

/* Bring the files up to date after an error, without hiding the error. */
static void save_what_there_is(Sim *sim, const CastError *err)
{
  if (!sim->output) return;
  coupling_settle(sim->coupling, sim->mould);
  CastError other;
  if (err->code == CAST_ERR_NUMERIC && sim_write_checkpoint(sim, "checkpoint-failed.h5", &other) == CAST_OK)
    log_info(sim->log, "the state at the failure is in %s/checkpoint-failed.h5", sim_output_folder(sim));
  if (sim_write_summary(sim, err->message, &other) != CAST_OK) log_warn(sim->log, "%s", other.message);
}

CastStatus sim_run(Sim *sim, const volatile sig_atomic_t *stop, SimEnd *end, CastError *err)
{
  *end = SIM_FINISHED;
  CastStatus status = sim_output_due(sim, err);
  if (status == CAST_OK) status = run_steps(sim, stop, end, err);
  log_progress_end(sim->log);
  if (status == CAST_OK && *end != SIM_INTERRUPTED) coupling_settle(sim->coupling, sim->mould);
  if (status == CAST_OK && sim->output && *end != SIM_INTERRUPTED) status = sim_output_finish(sim, err);
  if (status != CAST_OK) save_what_there_is(sim, err);
  return status;
}

void sim_request_checkpoint(Sim *sim)
{
  sim->checkpoint_wanted = true;
}

/* ---- what it holds ---- */

double sim_time(const Sim *sim)
{
  return sim->counts.time;
}

long sim_steps(const Sim *sim)
{
  return (long)sim->counts.steps;
}

const Particles *sim_particles(const Sim *sim)
{
  return &sim->particles;
}

const RomState *sim_mould(const Sim *sim)
{
  return sim->mould;
}

EnergyLedger sim_ledger(const Sim *sim)
{
  return coupling_ledger(sim->coupling, sim->mould, &sim->particles);
}

double sim_filled_fraction(const Sim *sim)
{
  return filling_fraction(sim->filling, filling_n_features(sim->filling));
}
