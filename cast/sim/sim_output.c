/* sim_output.c - what is written during a run, and when.
 * Frames (the results) every output.every, rows of the CSV files every output.curves_every of simulated time: at the
 * end of the first step that reaches the time. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/coupling/wall_heat.h"
#include "cast/results/heat_recorder.h"
#include "cast/results/melt_results.h"
#include "cast/results/mould_results.h"
#include "cast/results/run_record.h"
#include "cast/sim/sim_private.h"
#include "common/hash.h"

struct SimOutput {
  const char *folder; // borrowed from the config
  Provenance provenance;
  MeltResults *melt;
  MouldResults *mould; // NULL: not wanted
  SimCurves *curves;
  HeatRecorder *recorder;      // NULL: not wanted
  WallHeat *wall_heat;         // NULL: heat is recorded by patch only
  double *flow;                // [m] W, the melt's and the outer walls', for the record
  double next_frame, next_row; // s
  double last_frame;           // s; NAN: none yet
};

static void path_in(const SimOutput *out, const char *name, char *path, size_t size)
{
  snprintf(path, size, "%s/%s", out->folder, name);
}

static CastStatus write_rows(Sim *sim, CastError *err)
{
  filling_update(sim->filling, &sim->particles, sim->counts.time);
  return sim->particles.n_fluid > 0 ? sim_curves_row(sim->output->curves, sim, err) : CAST_OK;
}

static CastStatus write_frame(Sim *sim, CastError *err)
{
  SimOutput *out = sim->output;
  CAST_CALL(sim_check_inside(sim, err));
  CAST_CALL(melt_results_append(out->melt, sim->counts.time, &sim->particles, err));
  if (out->mould) CAST_CALL(mould_results_append(out->mould, sim->counts.time, sim->mould, err));
  out->last_frame = sim->counts.time;
  return CAST_OK;
}

/* A mould that lags behind is brought up to date for what is written, and then taken back: a run that writes has the
 * bits of one that does not. */
static CastStatus write_up_to_date(Sim *sim, bool row, bool frame, CastError *err)
{
  const size_t n = rom_state_size(sim->mould);
  double *kept = malloc((n + coupling_size(sim->coupling)) * sizeof *kept);
  CAST_CHECK(kept, err, CAST_ERR_MEMORY, "no memory for the mould's state");
  rom_state_save(sim->mould, kept);
  coupling_save(sim->coupling, kept + n);
  coupling_settle(sim->coupling, sim->mould);
  CastStatus status = row ? write_rows(sim, err) : CAST_OK;
  if (status == CAST_OK && frame) status = write_frame(sim, err);
  rom_state_restore(sim->mould, kept);
  coupling_restore(sim->coupling, sim->mould, kept + n);
  free(kept);
  return status;
}

CastStatus sim_output_record(Sim *sim, CastError *err)
{
  SimOutput *out = sim->output;
  if (!out || !out->recorder) return CAST_OK;
  const double *power = NULL, dt = sim->counts.dt;
  double *flow = out->flow;
  if (out->wall_heat)
    CAST_CALL(wall_heat_power(out->wall_heat, sim->coupling, &sim->particles, sim->neighbours, &power, err));
  for (size_t l = 0; l < sim->rom->m; l++) flow[l] = 0.0;
  rom_state_take_wall_heat(sim->mould, flow);
  for (size_t l = 0; l < sim->rom->m; l++) flow[l] = coupling_flow(sim->coupling)[l] + flow[l] / dt;
  CastStatus (*add)(HeatRecorder *, double, double, const double *, const double *, CastError *) =
      sim->cool ? heat_recorder_add_interval : heat_recorder_add;
  return add(out->recorder, sim->counts.time, dt, flow, power, err);
}

/* The first multiple of `every` after t; every 0: each step. */
static double next_time(double t, double every)
{
  if (every == 0.0) return t * (1.0 + 1e-9); // after the next step, however short
  return every * (floor(t / every * (1.0 + 1e-12)) + 1.0);
}

static double frames_every(const Sim *sim)
{
  return sim->cool ? sim->config->cool.every : sim->config->output.every;
}

/* 0: each step has its row. */
static double rows_every(const Sim *sim)
{
  return sim->cool ? sim->config->cool.curves_every : sim->config->output.curves_every;
}

CastStatus sim_output_stage(Sim *sim, CastError *err)
{
  SimOutput *out = sim->output;
  if (!out) return CAST_OK;
  if (!(out->last_frame == sim->counts.time)) {
    CAST_CALL(write_rows(sim, err));
    CAST_CALL(write_frame(sim, err));
  }
  out->next_row = next_time(sim->counts.time, rows_every(sim));
  out->next_frame = next_time(sim->counts.time, frames_every(sim));
  return CAST_OK;
}

CastStatus sim_output_due(Sim *sim, CastError *err)
{
  SimOutput *out = sim->output;
  if (!out) return CAST_OK;
  const double begun = log_wall_time(), t = sim->counts.time * (1.0 + 1e-12);
  if (sim->under_way) return CAST_OK; // just resumed: the step is not finished
  const bool row = t >= out->next_row, frame = t >= out->next_frame;
  if (row || frame) CAST_CALL(write_up_to_date(sim, row, frame, err));
  if (row) out->next_row = next_time(t, rows_every(sim));
  if (frame) out->next_frame = next_time(t, frames_every(sim));
  sim->counts.seconds[PHASE_OUTPUT] += log_wall_time() - begun;
  return CAST_OK;
}

CastStatus sim_output_finish(Sim *sim, CastError *err)
{
  SimOutput *out = sim->output;
  if (!(out->last_frame == sim->counts.time)) {
    CAST_CALL(write_rows(sim, err));
    CAST_CALL(write_frame(sim, err));
  }
  if (out->recorder) CAST_CALL(heat_recorder_finish(out->recorder, err));
  CAST_CALL(melt_results_finish(out->melt, err));
  CAST_CALL(sim_write_maps(sim, melt_results_path(out->melt), out->mould, err));
  if (out->mould) CAST_CALL(mould_results_finish(out->mould, err));
  return sim_write_summary(sim, sim->particles.n_fluid > 0 ? "finished" : "ended: all melt has left the mould", err);
}

/* ---- opening ---- */

static void fill_provenance(const Sim *sim, const char *command, Provenance *p)
{
  const CastConfig *c = sim->config;
  provenance_collect(command, p);
  snprintf(p->input_path, sizeof p->input_path, "%s", c->input_path);
  snprintf(p->rom_path, sizeof p->rom_path, "%s", c->rom_path);
  hash_bytes(c->input_text, strlen(c->input_text), p->input_sha256);
  memcpy(p->rom_sha256, sim->rom_sha256, sizeof p->rom_sha256);
  memcpy(p->material_sha256, c->melt.sha256, sizeof p->material_sha256);
}

static CastStatus prepare(Sim *sim, const char *command, CastError *err)
{
  SimOutput *out = sim->output = calloc(1, sizeof *out);
  CAST_CHECK(out, err, CAST_ERR_MEMORY, "no memory for the output");
  out->folder = sim->config->output.folder;
  out->last_frame = NAN;
  fill_provenance(sim, command, &out->provenance);
  return CAST_OK;
}

static CastStatus write_inputs(const Sim *sim, CastError *err)
{
  char *resolved = NULL, path[4200];
  CAST_CALL(cast_config_resolved(sim->config, sim->sph.c0, &resolved, err));
  path_in(sim->output, "resolved.yaml", path, sizeof path);
  CastStatus status = run_record_write_text(path, resolved, err);
  const RunInputs inputs = {sim->config->title, sim->config->input_text, sim->config->melt.text, resolved,
                            sim->config->spacing};
  if (status == CAST_OK)
    status = run_record_begin(melt_results_path(sim->output->melt), &inputs, &sim->output->provenance, err);
  free(resolved);
  return status;
}

/* rows NULL: a new record */
static CastStatus open_record(Sim *sim, const size_t *rows, CastError *err)
{
  SimOutput *out = sim->output;
  const CastConfig *c = sim->config;
  if (!(c->output.record_every > 0.0)) return CAST_OK;
  out->flow = calloc(sim->rom->m, sizeof *out->flow);
  CAST_CHECK(out->flow, err, CAST_ERR_MEMORY, "no memory to record the heat of %zu patches", sim->rom->m);
  if (c->output.record_triangles)
    CAST_CALL(wall_heat_create(sim->rom, sim->surface, &sim->particles, &out->wall_heat, err));
  const HeatRecorderSetup setup = {.every = c->output.record_every,
                                   .rom_sha256 = sim->rom_sha256,
                                   .preheat = c->preheat,
                                   .ambient = c->ambient,
                                   .m = sim->rom->m,
                                   .n_triangles = out->wall_heat ? wall_heat_n(out->wall_heat) : 0,
                                   .triangle = out->wall_heat ? wall_heat_triangles(out->wall_heat) : NULL};
  return heat_recorder_open(out->folder, &setup, rows, &out->recorder, err);
}

static void remove_old(const SimOutput *out)
{
  static const char *const names[] = {"checkpoint.h5",
                                      "checkpoint-failed.h5",
                                      "summary.txt",
                                      "summary.json",
                                      "mould.vtkhdf",
                                      "heat.h5",
                                      "mould.xmf",
                                      "probes.csv",
                                      "tracers.csv",
                                      "filling.png",
                                      "speed.png",
                                      "pressure.png",
                                      "curves.png",
                                      "fill-time.png",
                                      "solidification-time.png",
                                      "niyama.png"};
  char path[4200];
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    path_in(out, names[k], path, sizeof path);
    remove(path);
  }
}

CastStatus sim_open_output(Sim *sim, const char *command, CastError *err)
{
  CAST_CALL(prepare(sim, command, err));
  SimOutput *out = sim->output;
  const CastConfig *c = sim->config;
  remove_old(out); // nothing of an earlier run may pass for this one's
  CAST_CALL(melt_results_open(out->folder, &c->melt, sim->n_ids, 0, &out->melt, err));
  melt_results_follow(out->melt, sim->freezing, sim->filling, sim->arrival);
  if (c->output.mould_fields) CAST_CALL(mould_results_open(out->folder, sim->rom, 0, &out->mould, err));
  CAST_CALL(sim_curves_create(sim, NULL, &out->curves, err));
  CAST_CALL(open_record(sim, NULL, err));
  return write_inputs(sim, err);
}

/* ---- checkpoints ---- */

void sim_output_save(const Sim *sim, double state[OUTPUT_STATE])
{
  const SimOutput *out = sim->output;
  state[0] = (double)melt_results_n_steps(out->melt);
  state[1] = out->mould ? (double)mould_results_n_steps(out->mould) : 0.0;
  sim_curves_lengths(out->curves, &state[2]);
  state[5] = out->next_frame;
  state[6] = out->next_row;
  state[7] = out->last_frame;
}

CastStatus sim_output_reopen(Sim *sim, const char *command, const double state[OUTPUT_STATE], CastError *err)
{
  CAST_CALL(prepare(sim, command, err));
  SimOutput *out = sim->output;
  const CastConfig *c = sim->config;
  CAST_CHECK(state[0] >= 1.0, err, CAST_ERR_FORMAT, "the checkpoint knows of no results");
  CAST_CALL(melt_results_open(out->folder, &c->melt, sim->n_ids, (size_t)state[0], &out->melt, err));
  melt_results_follow(out->melt, sim->freezing, sim->filling, sim->arrival);
  if (state[1] > 0.0) CAST_CALL(mould_results_open(out->folder, sim->rom, (size_t)state[1], &out->mould, err));
  CAST_CALL(sim_curves_create(sim, &state[2], &out->curves, err)); // the melt still stands as at the start
  out->next_frame = state[5];
  out->next_row = state[6];
  out->last_frame = state[7];
  return CAST_OK;
}

size_t sim_output_record_size(const Sim *sim)
{
  return sim->output->recorder ? heat_recorder_size(sim->output->recorder) : 0;
}

void sim_output_save_record(const Sim *sim, double *buffer)
{
  if (sim->output->recorder) heat_recorder_save(sim->output->recorder, buffer);
}

CastStatus sim_output_reopen_record(Sim *sim, size_t n, const double *buffer, CastError *err)
{
  if (n == 0) return CAST_OK;
  const size_t rows = heat_recorder_saved_rows(buffer);
  CAST_CALL(open_record(sim, &rows, err));
  CAST_CHECK(sim->output->recorder && heat_recorder_size(sim->output->recorder) == n, err, CAST_ERR_FORMAT,
             "record: %zu numbers do not fit the run's heat record", n);
  heat_recorder_restore(sim->output->recorder, buffer);
  return CAST_OK;
}

void sim_output_destroy(SimOutput **output)
{
  if (!output || !*output) return;
  SimOutput *out = *output;
  melt_results_close(&out->melt);
  mould_results_close(&out->mould);
  sim_curves_destroy(&out->curves);
  heat_recorder_close(&out->recorder);
  wall_heat_destroy(&out->wall_heat);
  free(out->flow);
  provenance_release(&out->provenance);
  free(out);
  *output = NULL;
}

const char *sim_output_folder(const Sim *sim)
{
  return sim->output->folder;
}

const Provenance *sim_output_provenance(const Sim *sim)
{
  return &sim->output->provenance;
}
