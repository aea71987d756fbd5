/* sim_report.c - what is about to be computed, in plain words, with warnings where the numbers do not fit the case. */
#include <math.h>
#include <string.h>

#include "cast/geometry/placement.h"
#include "cast/kernel/pair.h"
#include "cast/sim/sim_private.h"

static void report_mould(const Sim *sim)
{
  const RomData *rom = sim->rom;
  size_t cavity = 0;
  for (size_t l = 0; l < rom->m; l++) cavity += !rom->patch[l].outer;
  log_info(sim->log, "mould     %s: %zu states, %zu cavity patches, %zu outer; preheat %g K, ambient %g K", rom->title,
           rom->r, cavity, rom->m - cavity, sim->config->preheat, sim->config->ambient);
  if (!rom->certificate.met)
    log_warn(sim->log, "the reduced model does not certify its tolerance of %g: see castrun info", rom->tolerance);
  if (sim_end(sim) > rom->t_end)
    log_warn(sim->log, "the run ends at %g s; the reduced model speaks of times up to %g s", sim_end(sim), rom->t_end);
}

static void report_melt(const Sim *sim)
{
  const CastConfig *c = sim->config;
  const Particles *p = &sim->particles;
  const double volume = (double)p->n_fluid * pow(c->spacing, 3.0);
  log_info(sim->log, "melt      %s: %td particles of %g mm, %.4g mm3, %.4g g; %td wall particles", c->melt.name,
           p->n_fluid, 1e3 * c->spacing, 1e9 * volume, 1e3 * volume * c->melt.density, p->n - p->n_fluid);
  const double across = sim->gap / c->spacing;
  log_info(sim->log, "gap       thinnest %.3g mm near (%.3g, %.3g, %.3g) mm: %.1f particles across", 1e3 * sim->gap,
           1e3 * sim->gap_at[0], 1e3 * sim->gap_at[1], 1e3 * sim->gap_at[2], across);
  if (across < 3.75) // facets take a few per cent off a round pin of four
    log_warn(sim->log,
             "%.1f particles across the thinnest gap are too few to flow; at least 4 are needed: spacing %.3g mm",
             across, 1e3 * sim->gap / 4.0);
}

/* Outer walls that are not as the ROM has them. */
static void report_walls(const Sim *sim)
{
  for (size_t i = 0, k = 0; i < sim->config->n_walls; i++) {
    const OuterWall *wall = &sim->config->wall[i];
    while (strcmp(sim->rom->patch[outer_walls_patch(sim->walls, k)].surface, wall->surface) != 0) k++;
    const RomPatch *patch = &sim->rom->patch[outer_walls_patch(sim->walls, k)]; // all of a surface have one coefficient
    log_info(sim->log,
             "wall      %-12s h = %.4g W/(m2 K) (%.4g in the ROM), surroundings at %.1f degC, emissivity %.2g",
             wall->surface, isnan(wall->h) ? patch->h : wall->h, patch->h,
             (isnan(wall->ambient) ? sim->config->ambient : wall->ambient) - 273.15, wall->emissivity);
  }
}

/* Does the melt suffice? Features that hold melt at the start (a pouring cup) need not be full at the end. */
static void report_volumes(const Sim *sim)
{
  const Filling *f = sim->filling;
  const size_t features = filling_n_features(f), surfaces = filling_n_surfaces(f);
  const double melt = (double)sim->n_ids * pow(sim->config->spacing, 3.0); // what comes in included
  double needed = 0.0, in_all = 0.0;
  for (size_t s = 0; s < features; s++) {
    const bool starts_here = filling_fraction(f, s) > 0.05;
    log_info(sim->log, "cavity    %-12s %9.4g mm3%s", filling_name(f, s), 1e9 * filling_volume(f, s),
             starts_here ? ", holds melt at the start" : "");
    if (s >= surfaces) continue; // a box: among the surfaces' already
    if (!starts_here) needed += filling_volume(f, s);
    in_all += filling_volume(f, s);
  }
  log_info(sim->log, "cavity    %-12s %9.4g mm3; the melt is %.0f %% of it", "in all", 1e9 * in_all,
           100.0 * melt / in_all);
  if (sim->config->n_part)
    log_info(sim->log, "part      %-12s %9.4g mm3; \"filled\" is about it", "", 1e9 * filling_volume(f, features));
  if (melt < needed)
    log_warn(sim->log, "%.4g mm3 of melt cannot fill the %.4g mm3 of cavity that are empty at the start", 1e9 * melt,
             1e9 * needed);
}

static void report_forces(const Sim *sim)
{
  const Drive *drive = &sim->config->drive;
  double most = 0.0;
  for (size_t i = 0; i < drive->speed.n; i++) most = fmax(most, fabs(drive->speed.y[i]));
  if (drive->speed.n)
    log_info(sim->log, "spin      up to %.4g rad/s (%.4g rpm) about (%.3g, %.3g, %.3g), through (%.3g, %.3g, %.3g) mm",
             most, most * 60.0 / (2.0 * pair_pi), drive->spin_axis[0], drive->spin_axis[1], drive->spin_axis[2],
             1e3 * drive->spin_point[0], 1e3 * drive->spin_point[1], 1e3 * drive->spin_point[2]);
  const GasConfig *gas = &sim->config->gas;
  if (gas->pressure.n)
    log_info(sim->log, "gas       from %.4g to %.4g kPa over the melt", 1e-3 * gas->pressure.y[0],
             1e-3 * gas->pressure.y[gas->pressure.n - 1]);
  if (drive->tilt.n)
    log_info(sim->log, "tilt      from %.4g to %.4g deg about (%.3g, %.3g, %.3g)", drive->tilt.y[0] * 180.0 / pair_pi,
             drive->tilt.y[drive->tilt.n - 1] * 180.0 / pair_pi, drive->tilt_axis[0], drive->tilt_axis[1],
             drive->tilt_axis[2]);
}

static void report_steps(const Sim *sim)
{
  const CastConfig *c = sim->config;
  const SphLimits limit = sph_time_step(&sim->sph, &sim->particles);
  const double dt = c->step > 0.0 ? c->step : limit.step, steps = ceil(c->end / dt);
  log_info(sim->log, "sound     %.4g m/s%s (forces may bring the melt to %.3g m/s)", sim->sph.c0,
           c->sound_speed > 0.0 ? ", as given" : "", sqrt(2.0 * sim_drive_gain(sim)));
  log_info(sim->log, "steps     about %.0f of %.3g us (limit: %s), %.3g particle-steps", steps, 1e6 * dt,
           c->step > 0.0 ? "input" : limit.which, steps * (double)sim->particles.n_fluid);
  if (c->step > limit.step)
    log_warn(sim->log, "the time step of %.3g us is above the stable %.3g us (limit: %s)", 1e6 * c->step,
             1e6 * limit.step, limit.which);
  const double kappa = c->melt.conductivity;
  const double h = 1.0 / (1.0 / contact_laws_most(&c->contact) + 0.5 * c->spacing / kappa);
  const double stiffness = c->coupling.mould_frozen ? 0.0 : rom_state_stiffness(sim->mould, h, dt);
  log_info(sim->log, "exchange  %.4g W/m2K from melt to wall, stiffness %.2g%s", h, stiffness,
           stiffness > 0.5 ? ": above 0.5, the exchange will take sub-steps" : " (stable below 0.5)");
  const double interval = coupling_mould_interval(sim->coupling, sim->mould, sim->particles.n_fluid, dt);
  if (interval >= 1.5 * dt && !c->coupling.mould_frozen)
    log_info(sim->log, "mould     %zu states for %zu patches take a step for about every %.0f of the melt's",
             sim->rom->r, sim->rom->m, interval / dt);
}

static void report_stages(const Sim *sim)
{
  const CoolConfig *cool = &sim->config->cool;
  if (!cool->wanted) return;
  log_info(sim->log, "stages    filling until %s%g s; cooling in implicit steps until %s%g s, tolerance %g K",
           cool->at_end ? "" : "the melt is at rest or locked, at the latest ", sim->config->end,
           cool->until_solid ? "all is solid, at the latest " : "", cool->end, cool->tolerance);
}

CastStatus sim_report(Sim *sim, CastError *err)
{
  CAST_CALL(cavity_thinnest_gap(sim->surface, &sim->gap, sim->gap_at, err));
  filling_update(sim->filling, &sim->particles, 0.0);
  log_info(sim->log, "%s", sim->config->title);
  report_mould(sim);
  report_walls(sim);
  report_melt(sim);
  sim_pour_report(sim);
  report_volumes(sim);
  report_forces(sim);
  sim_tension_report(sim);
  report_steps(sim);
  report_stages(sim);
  return sim_check_inside(sim, err);
}
