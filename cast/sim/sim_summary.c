/* sim_summary.c - the account of a run: summary.txt for people, summary.json for programs, both kept in the results. */
#define _GNU_SOURCE // open_memstream
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/results/run_record.h"
#include "cast/sim/sim_private.h"

static const char *const PHASE_NAMES[PHASE_COUNT] = {"motion", "neighbours", "pair sums", "mould", "output", "cooling"};
static const char *const LIMIT_NAMES[6] = {"sound", "force", "viscosity", "conduction", "input", "capillarity"};

typedef struct Range {
  double least, mean, most;
} Range;

typedef struct Account {
  const char *outcome;
  Range melt, wall; // K; wall: cavity wall, mean by area
  EnergyLedger ledger;
  double mould_flops; // of one step of the reduced model
} Account;

static Range melt_temperature(const Particles *p)
{
  Range range = {INFINITY, 0.0, -INFINITY};
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    range.least = fmin(range.least, p->T[i]);
    range.most = fmax(range.most, p->T[i]);
    range.mean += p->T[i] / (double)p->n_fluid;
  }
  return range;
}

static Range wall_temperature(const Sim *sim)
{
  const RomData *rom = sim->rom;
  Range range = {INFINITY, 0.0, -INFINITY};
  double area = 0.0;
  double *T = malloc(rom->n_points * sizeof *T);
  if (!T) return (Range){NAN, NAN, NAN};
  rom_state_point_temperature(sim->mould, T);
  for (size_t t = 0; t < rom->n_triangles; t++) {
    if (rom->patch[rom->triangle_patch[t]].outer) continue;
    for (int k = 0; k < 3; k++) {
      range.least = fmin(range.least, T[rom->triangles[3 * t + (size_t)k]]);
      range.most = fmax(range.most, T[rom->triangles[3 * t + (size_t)k]]);
    }
  }
  free(T);
  for (size_t l = 0; l < rom->m; l++) {
    if (rom->patch[l].outer) continue;
    range.mean += rom->patch[l].area * rom_state_patch_temperature(sim->mould)[l];
    area += rom->patch[l].area;
  }
  range.mean /= area;
  return range;
}

/* ---- for people ---- */

static void print_filling(FILE *out, const Sim *sim)
{
  const Filling *f = sim->filling;
  fputs("Filling        filled      volume      50 % at      90 % at      99 % at\n", out);
  for (size_t s = 0; s <= filling_n_features(f); s++) {
    fprintf(out, "  %-12s %5.1f %%  %7.4g mm3", filling_name(f, s), 100.0 * filling_fraction(f, s),
            1e9 * filling_volume(f, s));
    for (int l = 0; l < FILLING_LEVELS; l++) {
      const double t = filling_time(f, s, l);
      if (isnan(t))
        fputs("           --", out);
      else
        fprintf(out, "  %8.3f ms", 1e3 * t);
    }
    fputc('\n', out);
  }
}

static void print_energy(FILE *out, const EnergyLedger *e)
{
  fprintf(out, "Energy\n");
  fprintf(out, "  melt has given up        %14.6e J\n", e->melt_start + e->added - e->melt_now - e->removed);
  if (e->added != 0.0) fprintf(out, "  came in with melt        %14.6e J\n", e->added);
  fprintf(out, "  mould holds more         %14.6e J   (from its state, 1^T E V z)\n", e->mould_now);
  fprintf(out, "  lost to the surroundings %14.6e J\n", e->lost);
  if (e->removed != 0.0) fprintf(out, "  left with melt           %14.6e J\n", e->removed);
  fprintf(out, "  exchanged at the wall    %14.6e J\n", e->exchanged);
  fprintf(out, "  residual                 %14.6e J = %.1e of the heat exchanged\n", e->residual,
          e->exchanged > 0.0 ? fabs(e->residual) / e->exchanged : 0.0);
}

static void print_work(FILE *out, const Sim *sim, const Account *account)
{
  const SimCounts *n = &sim->counts;
  double total = 0.0;
  for (int k = 0; k < PHASE_COUNT; k++) total += n->seconds[k];
  fprintf(out, "Work\n  %.0f steps, %.4g particle-steps in %.1f s on %d thread%s: %.3g particle-steps/s\n", n->steps,
          n->particle_steps, n->wall, sim_output_provenance(sim)->threads,
          sim_output_provenance(sim)->threads == 1 ? "" : "s", n->wall > 0.0 ? n->particle_steps / n->wall : 0.0);
  fprintf(out, "  set-up %.2f s; lists rebuilt %ld times; last step %.3g us\n", sim->seconds_setup,
          neighbours_builds(sim->neighbours), 1e6 * n->dt);
  for (int k = 0; k < PHASE_COUNT; k++)
    fprintf(out, "  %-12s %8.2f s  %5.1f %%\n", PHASE_NAMES[k], n->seconds[k],
            total > 0.0 ? 100.0 * n->seconds[k] / total : 0.0);
  fputs("  time step set by", out);
  for (int k = 0; k < 6; k++)
    if (n->limited_by[k] > 0.0)
      fprintf(out, " %s %.0f %%", LIMIT_NAMES[k], 100.0 * n->limited_by[k] / fmax(n->steps, 1.0));
  fprintf(out, "\n  mould's step: %.3g multiplications and additions; exchange in %.0f sub-step%s at most\n",
          account->mould_flops, fmax(n->substeps_most, 1.0), n->substeps_most > 1.0 ? "s" : "");
}

/* Over the particles that have it. */
static Range freezing_range(const Sim *sim, FreezingField field)
{
  const Particles *p = &sim->particles;
  Range range = {INFINITY, 0.0, -INFINITY};
  double n = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const double value = freezing_value(sim->freezing, field, p->id[i]);
    if (isnan(value)) continue;
    range.least = fmin(range.least, value);
    range.most = fmax(range.most, value);
    range.mean += value;
    n += 1.0;
  }
  range.mean /= n;
  return range;
}

static void print_freezing(FILE *out, const Sim *sim)
{
  bool any = false;
  for (int f = 0; f < FREEZING_FIELDS; f++) {
    const Range r = freezing_range(sim, (FreezingField)f);
    if (r.least > r.most || (f == FREEZING_REMELTED && r.most == 0.0)) continue; // nothing froze, nothing remelted
    if (!any) fprintf(out, "Freezing                      least        mean        most\n");
    any = true;
    fprintf(out, "  %-22s%11.5g %11.5g %11.5g %s\n", freezing_texts[f].name, r.least, r.mean, r.most,
            freezing_texts[f].units);
  }
}

static void print_stages(FILE *out, const Sim *sim)
{
  if (!sim->config->cool.wanted) return;
  double switched, locked;
  const char *why = sim_switched(sim, &switched);
  const double solid = sim_solid_part(sim, &locked);
  if (!sim->cool) {
    fprintf(out, "Stages\n  filling; cooling has not begun\n");
    return;
  }
  const SimCounts *n = &sim->counts;
  const CoolCounts c = cool_counts(sim->cool);
  fprintf(out, "Stages\n  filling until %.6g ms (%s), %.1f s of work\n", 1e3 * switched, why, n->fill_wall);
  fprintf(out, "  cooling until %.6g s, %.1f s of work: %.0f steps of %.3g to %.3g s, %.0f more rejected;\n", n->time,
          n->wall - n->fill_wall, c.steps, c.shortest, c.longest, c.rejected);
  fprintf(out, "  %.0f iterations of Newton's method, %.0f of conjugate gradients\n", c.newton, c.gradients);
  fprintf(out, "  solid %.1f %%, locked %.1f %% of the melt\n", 100.0 * solid, 100.0 * locked);
}

static void print_text(FILE *out, const Sim *sim, const Account *a)
{
  const SimCounts *n = &sim->counts;
  fprintf(out, "%s\n%s at t = %.6g ms of %.6g ms\n\n", sim->config->title, a->outcome, 1e3 * n->time,
          1e3 * sim_end(sim));
  print_filling(out, sim);
  sim_print_defects(out, sim);
  fprintf(out, "Temperature      least       mean       most\n");
  fprintf(out, "  melt       %9.2f  %9.2f  %9.2f K\n", a->melt.least, a->melt.mean, a->melt.most);
  fprintf(out, "  cavity wall%9.2f  %9.2f  %9.2f K\n", a->wall.least, a->wall.mean, a->wall.most);
  print_energy(out, &a->ledger);
  fprintf(out, "Melt\n  %td particles; %.0f left the mould (%.3g g); set back to the wall %.0f times\n",
          sim->particles.n_fluid, n->removed, 1e3 * n->removed_mass, n->guarded);
  fprintf(out, "  largest speed seen %.3g m/s, %.1f %% of the numerical sound speed %.4g m/s\n", n->fastest,
          100.0 * n->fastest / sim->sph.c0, sim->sph.c0);
  sim_pour_print(sim, out);
  print_freezing(out, sim);
  print_stages(out, sim);
  print_work(out, sim, a);
  fprintf(out, "Warnings: %d (see castrun.log)\n", log_warning_count(sim->log));
  fputs("Provenance\n", out);
  provenance_print(out, "  ", sim_output_provenance(sim));
}

/* ---- for programs ---- */

/* JSON has no NaN: null. */
static json_t *number(double value)
{
  return isfinite(value) ? json_real(value) : json_null();
}

static json_t *range_object(Range r)
{
  return json_pack("{so so so}", "min", number(r.least), "mean", number(r.mean), "max", number(r.most));
}

static json_t *filling_object(const Filling *f, size_t s)
{
  return json_pack("{so so so so so}", "fraction", number(filling_fraction(f, s)), "volume_m3",
                   number(filling_volume(f, s)), "t50_s", number(filling_time(f, s, 0)), "t90_s",
                   number(filling_time(f, s, 1)), "t99_s", number(filling_time(f, s, 2)));
}

static json_t *ledger_object(const EnergyLedger *e)
{
  return json_pack("{so so so so so so so so so}", "melt_start", number(e->melt_start), "melt_now", number(e->melt_now),
                   "mould", number(e->mould_now), "lost", number(e->lost), "removed", number(e->removed), "added",
                   number(e->added), "exchanged", number(e->exchanged), "residual", number(e->residual),
                   "residual_relative", number(e->exchanged > 0.0 ? fabs(e->residual) / e->exchanged : 0.0));
}

static json_t *work_object(const Sim *sim, const Account *a)
{
  const SimCounts *n = &sim->counts;
  json_t *phases = json_object(), *limits = json_object();
  for (int k = 0; k < PHASE_COUNT; k++) json_object_set_new(phases, PHASE_NAMES[k], number(n->seconds[k]));
  for (int k = 0; k < 6; k++) json_object_set_new(limits, LIMIT_NAMES[k], number(n->limited_by[k]));
  return json_pack("{so so so so so so so so so sI}", "steps", number(n->steps), "particle_steps",
                   number(n->particle_steps), "wall_s", number(n->wall), "setup_s", number(sim->seconds_setup),
                   "particle_steps_per_s", number(n->wall > 0.0 ? n->particle_steps / n->wall : 0.0), "phases_s",
                   phases, "steps_limited_by", limits, "mould_step_flops", number(a->mould_flops), "substeps_most",
                   number(n->substeps_most), "list_rebuilds", (json_int_t)neighbours_builds(sim->neighbours));
}

static json_t *provenance_object(const Provenance *p)
{
  return json_pack("{ss ss ss ss ss ss si ss ss ss ss ss}", "program", p->program, "version", p->version, "revision",
                   p->revision, "command", p->command, "host", p->host, "started", p->started, "threads", p->threads,
                   "input", p->input_path, "input_sha256", p->input_sha256, "rom", p->rom_path, "rom_sha256",
                   p->rom_sha256, "material_sha256", p->material_sha256);
}

static json_t *freezing_object(const Sim *sim)
{
  static const char *const JSON_NAMES[FREEZING_FIELDS] = {
      "liquidus_time_s",  "solidus_time_s", "solidification_time_s", "cooling_rate_K_s", "final_cooling_rate_K_s",
      "gradient_K_per_m", "niyama_SI",      "arm_spacing_m",         "remelted"};
  json_t *all = json_object();
  for (int f = 0; f < FREEZING_FIELDS; f++)
    json_object_set_new(all, JSON_NAMES[f], range_object(freezing_range(sim, (FreezingField)f)));
  return all;
}

static json_t *stages_object(const Sim *sim)
{
  double switched, locked;
  const char *why = sim_switched(sim, &switched);
  const double solid = sim_solid_part(sim, &locked);
  const CoolCounts c = sim->cool ? cool_counts(sim->cool) : (CoolCounts){0};
  const SimCounts *n = &sim->counts;
  return json_pack("{ss so so so so so so so so so}", "switch_reason", why, "switch_s", number(switched), "fill_wall_s",
                   number(sim->cool ? n->fill_wall : n->wall), "cool_wall_s",
                   number(sim->cool ? n->wall - n->fill_wall : 0.0), "cool_steps", number(c.steps), "cool_rejected",
                   number(c.rejected), "newton", number(c.newton), "conjugate_gradients", number(c.gradients),
                   "solid_fraction", number(solid), "locked", number(locked));
}

static char *json_text(const Sim *sim, const Account *a)
{
  json_t *features = json_object();
  for (size_t s = 0; s <= filling_n_features(sim->filling); s++)
    json_object_set_new(features, filling_name(sim->filling, s), filling_object(sim->filling, s));
  sim_add_defects(sim, features);
  const SimCounts *n = &sim->counts;
  json_t *root =
      json_pack("{ss ss so so so so so so so so so so so so sI so so so si so}", "title", sim->config->title, "outcome",
                a->outcome, "time_s", number(n->time), "end_s", number(sim_end(sim)), "filling", features, "melt_K",
                range_object(a->melt), "cavity_wall_K", range_object(a->wall), "energy_J", ledger_object(&a->ledger),
                "stages", stages_object(sim), "freezing", freezing_object(sim), "removed_particles", number(n->removed),
                "removed_kg", number(n->removed_mass), "set_back", number(n->guarded), "largest_speed_m_s",
                number(n->fastest), "particles", (json_int_t)sim->particles.n_fluid, "spacing_m",
                number(sim->config->spacing), "sound_speed_m_s", number(sim->sph.c0), "work", work_object(sim, a),
                "warnings", log_warning_count(sim->log), "provenance", provenance_object(sim_output_provenance(sim)));
  if (root) {
    json_object_set_new(root, "inlets", sim_pour_json(sim, true));
    json_object_set_new(root, "outlets", sim_pour_json(sim, false));
  }
  char *text = root ? json_dumps(root, JSON_INDENT(2) | JSON_PRESERVE_ORDER | JSON_REAL_PRECISION(15)) : NULL;
  json_decref(root);
  return text;
}

CastStatus sim_write_summary(const Sim *sim, const char *outcome, CastError *err)
{
  const Account account = {outcome, melt_temperature(&sim->particles), wall_temperature(sim), sim_ledger(sim),
                           rom_state_flops(sim->mould)};
  char *text = NULL, path[4200], results[4200];
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  CAST_CHECK(out, err, CAST_ERR_MEMORY, "no memory for the summary");
  print_text(out, sim, &account);
  fclose(out);
  char *json = json_text(sim, &account);
  CastStatus status = json ? CAST_OK : cast_error_set(err, CAST_ERR_MEMORY, "the summary cannot be put together");
  const char *folder = sim_output_folder(sim);
  snprintf(path, sizeof path, "%s/summary.txt", folder);
  if (status == CAST_OK) status = run_record_write_text(path, text, err);
  snprintf(path, sizeof path, "%s/summary.json", folder);
  if (status == CAST_OK) status = run_record_write_text(path, json, err);
  snprintf(results, sizeof results, "%s/results.vtkhdf", folder);
  if (status == CAST_OK) status = run_record_end(results, text, json, err);
  free(text);
  free(json);
  return status;
}
