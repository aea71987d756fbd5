/* Heat between melt and mould.
 *
 * Method  An exchange is: conductances of all pairs from where the particles are (conductance.c, once a step); power of
 *         each contact, K (T_i - T_sink), each particle for itself; patch flows as sums over each patch's contacts in
 *         ascending order, in double: same bits at any thread count, and what the patches get is what the particles
 *         give.
 * Stability  The staggered exchange is a fixed-point iteration of T_patch = .. + G(dt) D (T_melt - T_patch). It is
 *         stable while the largest eigenvalue of D^(1/2) G D^(1/2) is below 1, bounded here by max(D_l/A_l) g(dt),
 *         with g that of A^(1/2) G A^(1/2), which grows with dt and is kept in a table of steps a factor 2^(1/4)
 *         apart. A particle is stable while K_i dt/(m_i c) < 1. Both are held below 1/2 by as many equal sub-steps as
 *         it takes, with the largest conductance that a contact's law can give: it may rise before the next look.
 * Pace  A mould of many patches costs more than it is worth at each of the melt's steps: then it takes one for several
 *       of them (mould_pace.h), no farther apart than a twentieth of the earliest time that its model is made for, no
 *       farther than the same stiffness allows, and no farther than brings it to a hundredth of the melt's cost.
 * References  docs/theory, section 5 */
#include "cast/coupling/coupling_private.h"

#include <assert.h>

enum { MOST_SUBSTEPS = 4096 };

/* ---- power ---- */

static const double *sink_temperature(Coupling *c, const RomState *state)
{
  if (!c->walls) return mould_pace_temperature(c->pace, state);
  wall_temperature_update(c->walls, state);
  return wall_temperature(c->walls);
}

/* Contacts' powers and patch flows, from the near particles' temperatures c->T. */
static void set_powers(Coupling *c, const RomState *state)
{
  Contacts *contacts = &c->contacts;
  const double *sink = sink_temperature(c, state);
#pragma omp parallel for schedule(static)
  for (ptrdiff_t k = 0; k < contacts->n_near; k++)
    for (ptrdiff_t e = contacts->first[k]; e < contacts->first[k + 1]; e++) {
      double power = 0.0;
      for (ptrdiff_t pair = contacts->pair_start[e]; pair < contacts->pair_start[e + 1]; pair++)
        power += contacts->conductance[pair] * (c->T[k] - sink[contacts->sink[pair]]);
      contacts->power[e] = power;
    }
#pragma omp parallel for schedule(dynamic, 8)
  for (size_t l = 0; l < c->rom->m; l++) {
    double sum = 0.0;
    for (ptrdiff_t k = contacts->of_patch_start[l]; k < contacts->of_patch_start[l + 1]; k++)
      sum += contacts->power[contacts->of_patch[k]];
    c->flow[l] = sum;
  }
}

static double power_of(const Contacts *contacts, ptrdiff_t k)
{
  double sum = 0.0;
  for (ptrdiff_t e = contacts->first[k]; e < contacts->first[k + 1]; e++) sum += contacts->power[e];
  return sum;
}

/* What the wall particles show in results: the mould at their place, or of their patch where none was worked out. */
static void show_wall_temperatures(const Coupling *c, const RomState *state, Particles *p)
{
  const double *patch = mould_pace_temperature(c->pace, state);
#pragma omp parallel for schedule(static)
  for (ptrdiff_t k = 0; k < p->n - p->n_fluid; k++) {
    const bool own = c->walls && wall_temperature_in_use(c->walls, k);
    p->T[p->n_fluid + k] = own ? wall_temperature(c->walls)[k] : patch[p->patch[k]];
  }
}

static void begin_exchange(Coupling *c, const RomState *state, Particles *p)
{
  coupling_set_conductances(c, p);
#pragma omp parallel for schedule(static)
  for (ptrdiff_t k = 0; k < c->contacts.n_near; k++) c->T[k] = p->T[c->contacts.near[k]];
  set_powers(c, state);
  show_wall_temperatures(c, state, p);
}

void coupling_exchange(Coupling *c, const RomState *state, Particles *p, const Neighbours *neighbours)
{
  assert(c->builds == neighbours_builds(neighbours));
  (void)neighbours;
  begin_exchange(c, state, p);
#pragma omp parallel for schedule(static)
  for (ptrdiff_t k = 0; k < c->contacts.n_near; k++) p->heat[c->contacts.near[k]] -= power_of(&c->contacts, k);
}

static void count_exchanged(Coupling *c, double dt)
{
  double magnitude = 0.0, net = 0.0;
  for (size_t l = 0; l < c->rom->m; l++) {
    magnitude += fabs(c->flow[l]);
    net += c->flow[l];
  }
  total_add(&c->exchanged, magnitude * dt);
  if (c->parameters.mould_frozen) total_add(&c->absorbed, net * dt);
}

void coupling_settle(Coupling *c, RomState *state)
{
  mould_pace_step(c->pace, state);
}

const double *coupling_patch_temperature(const Coupling *c, const RomState *state)
{
  return mould_pace_temperature(c->pace, state);
}

void coupling_step_mould(Coupling *c, RomState *state, Particles *particles, double dt)
{
  count_exchanged(c, dt);
  coupling_settle(c, state);
  mould_pace_forget(c->pace);
  if (!c->parameters.mould_frozen) rom_state_step(state, c->flow, dt);
  if (particles) show_wall_temperatures(c, state, particles);
}

/* ---- sub-steps ---- */

/* g(dt) rounded up to the table's next step. */
static double step_eigenvalue(Coupling *c, const RomState *state, double dt)
{
  const int index = (int)ceil(STEPS_PER_OCTAVE * log2(dt)) + STEP_ZERO;
  if (index < 0 || index >= STEP_TABLE) return rom_state_stiffness(state, 1.0, dt);
  if (isnan(c->eigenvalue[index]))
    c->eigenvalue[index] = rom_state_stiffness(state, 1.0, exp2((double)(index - STEP_ZERO) / STEPS_PER_OCTAVE));
  return c->eigenvalue[index];
}

static bool step_is_stable(Coupling *c, const RomState *state, double conductance, double dt)
{
  if (c->particle_rate * dt > coupling_stable) return false;
  return c->parameters.mould_frozen || conductance * step_eigenvalue(c, state, dt) <= coupling_stable;
}

static CastStatus choose_substeps(Coupling *c, const RomState *state, double dt, CastError *err)
{
  static const double finer[2] = {4.0 / 3.0, 1.5}; // 1, 2, 3, 4, 6, 8, 12..
  const double conductance = coupling_conductance(c);
  c->substeps = 1;
  for (int turn = 0; !step_is_stable(c, state, conductance, dt / (double)c->substeps); turn++) {
    CAST_CHECK(c->substeps < MOST_SUBSTEPS, err, CAST_ERR_NUMERIC,
               "the exchange between melt and mould (%.3g W/(m2 K)) is unstable at a time step of %.3g s even in %ld "
               "sub-steps; a contact conductance below infinity or a smaller step is needed",
               conductance, dt, c->substeps);
    c->substeps = c->substeps < 3 ? c->substeps + 1 : lround((double)c->substeps * finer[turn % 2]);
  }
  return CAST_OK;
}

/* ---- pace ---- */

static const double share_of_start = 0.05; // of t_start
/* A particle's step costs as much as this many of the r m numbers of the mould's, read and multiplied twice, times the
 * share of it that the mould may take: a hundredth of 240 ns over 0.4 ns. */
static const double numbers_per_particle = 6.0;

static double largest_interval(const Coupling *c, ptrdiff_t n_fluid, double dt)
{
  const double given = c->parameters.mould_interval;
  if (c->walls || c->parameters.mould_frozen || isfinite(given)) return c->walls ? 0.0 : given;
  const double steps = ceil((double)c->rom->r * (double)c->rom->m / (numbers_per_particle * (double)n_fluid));
  return fmin(steps * dt, share_of_start * c->rom->t_start);
}

double coupling_mould_interval(Coupling *c, const RomState *state, ptrdiff_t n_fluid, double dt)
{
  const double conductance = coupling_conductance(c);
  double interval = largest_interval(c, n_fluid, dt);
  while (interval > dt && conductance * step_eigenvalue(c, state, interval) > coupling_stable) interval *= 0.5;
  return fmax(interval, dt);
}

/* Is it time, the flows of the melt's step dt being the last to be gathered? */
static bool mould_is_due(Coupling *c, const RomState *state, ptrdiff_t n_fluid, double dt)
{
  const double elapsed = mould_pace_elapsed(c->pace);
  if (elapsed == 0.0) c->interval = coupling_mould_interval(c, state, n_fluid, dt);
  if (elapsed + 1.5 * dt > c->interval) return true; // another step would go beyond
  return coupling_conductance(c) * step_eigenvalue(c, state, c->interval) > coupling_stable;
}

/* The mould's part of a plain step. */
static void pass_to_mould(Coupling *c, RomState *state, ptrdiff_t n_fluid, double dt)
{
  count_exchanged(c, dt);
  if (c->parameters.mould_frozen) return;
  const bool due = mould_is_due(c, state, n_fluid, dt);
  if (due && mould_pace_elapsed(c->pace) == 0.0 && c->interval <= dt) { // each step is the mould's too
    mould_pace_forget(c->pace);
    rom_state_step(state, c->flow, dt);
    return;
  }
  mould_pace_gather(c->pace, state, c->flow, dt);
  if (due) mould_pace_step(c->pace, state);
}

/* The near particles' temperatures after dt of the wall's power and the conduction already in particles->heat. */
static void step_near(Coupling *c, const Particles *p, double share, double dt)
{
  const Contacts *contacts = &c->contacts;
#pragma omp parallel for schedule(static)
  for (ptrdiff_t k = 0; k < contacts->n_near; k++) {
    const ptrdiff_t i = contacts->near[k];
    double power = 0.0;
    for (ptrdiff_t e = contacts->first[k]; e < contacts->first[k + 1]; e++) {
      power += contacts->power[e];
      contacts->mean_power[e] += share * contacts->power[e];
    }
    c->mean[k] += share * power;
    c->E[k] += (p->heat[i] - power) * dt / p->mass[i];
    if (c->sph->melt) c->T[k] = material_temperature(c->sph->melt, c->E[k]);
  }
}

static void advance_in_substeps(Coupling *c, RomState *state, Particles *p, double dt)
{
  const double share = 1.0 / (double)c->substeps, part = dt * share;
  for (ptrdiff_t k = 0; k < c->contacts.n_near; k++) {
    c->mean[k] = 0.0;
    c->E[k] = p->E[c->contacts.near[k]];
  }
  for (ptrdiff_t e = 0; e < c->contacts.n; e++) c->contacts.mean_power[e] = 0.0;
  for (size_t l = 0; l < c->rom->m; l++) c->mean_flow[l] = 0.0;
  for (long s = 0; s < c->substeps; s++) {
    if (s > 0) set_powers(c, state);
    for (size_t l = 0; l < c->rom->m; l++) c->mean_flow[l] += share * c->flow[l];
    step_near(c, p, share, part);
    coupling_step_mould(c, state, NULL, part);
  }
  for (size_t l = 0; l < c->rom->m; l++) c->flow[l] = c->mean_flow[l];
  for (ptrdiff_t e = 0; e < c->contacts.n; e++) c->contacts.power[e] = c->contacts.mean_power[e];
#pragma omp parallel for schedule(static)
  for (ptrdiff_t k = 0; k < c->contacts.n_near; k++) p->heat[c->contacts.near[k]] -= c->mean[k];
}

CastStatus coupling_advance(Coupling *c, RomState *state, Particles *particles, const Neighbours *neighbours, double dt,
                            CastError *err)
{
  CAST_CHECK(c->builds == neighbours_builds(neighbours), err, CAST_ERR_ARGUMENT,
             "coupling: the neighbour lists were rebuilt and coupling_rebuild was not called");
  begin_exchange(c, state, particles);
  CAST_CALL(choose_substeps(c, state, dt, err));
  if (c->substeps > 1) {
    if (mould_pace_elapsed(c->pace) > 0.0) {
      coupling_settle(c, state);
      set_powers(c, state);
    }
    advance_in_substeps(c, state, particles, dt);
  } else {
#pragma omp parallel for schedule(static)
    for (ptrdiff_t k = 0; k < c->contacts.n_near; k++)
      particles->heat[c->contacts.near[k]] -= power_of(&c->contacts, k);
    pass_to_mould(c, state, particles->n_fluid, dt);
  }
  return CAST_OK;
}

/* ---- for the cooling stage ---- */

void coupling_use_surface(Coupling *c)
{
  c->parameters.kind = c->rules.kind = COUPLING_SURFACE;
}

bool coupling_mould_frozen(const Coupling *c)
{
  return c->parameters.mould_frozen;
}

CouplingContacts coupling_conductances(Coupling *c, const Particles *particles)
{
  assert(c->parameters.kind == COUPLING_SURFACE); // one pair for each contact
  coupling_set_conductances(c, particles);
  const Contacts *contacts = &c->contacts;
  return (CouplingContacts){contacts->n_near,      contacts->near,           contacts->first,   contacts->patch,
                            contacts->conductance, contacts->of_patch_start, contacts->of_patch};
}

/* Powers of the contacts at the step's end, brought to the patches' mean flows by a shift of each patch's temperature.
 */
static void share_flows(Coupling *c, const RomState *state, const Particles *p)
{
  Contacts *contacts = &c->contacts;
  const double *T_patch = rom_state_patch_temperature(state);
  for (ptrdiff_t k = 0; k < contacts->n_near; k++)
    for (ptrdiff_t e = contacts->first[k]; e < contacts->first[k + 1]; e++)
      contacts->power[e] = contacts->conductance[e] * (p->T[contacts->near[k]] - T_patch[contacts->patch[e]]);
#pragma omp parallel for schedule(dynamic, 8)
  for (size_t l = 0; l < c->rom->m; l++) {
    double power = 0.0, all = 0.0;
    for (ptrdiff_t k = contacts->of_patch_start[l]; k < contacts->of_patch_start[l + 1]; k++) {
      power += contacts->power[contacts->of_patch[k]];
      all += contacts->conductance[contacts->of_patch[k]];
    }
    for (ptrdiff_t k = contacts->of_patch_start[l]; k < contacts->of_patch_start[l + 1] && all > 0.0; k++) {
      const ptrdiff_t e = contacts->of_patch[k];
      contacts->power[e] += contacts->conductance[e] / all * (c->flow[l] - power);
    }
  }
}

void coupling_record_flows(Coupling *c, const RomState *state, Particles *particles, const double *q, double dt)
{
  for (size_t l = 0; l < c->rom->m; l++) c->flow[l] = q[l];
  count_exchanged(c, dt);
  share_flows(c, state, particles);
  if (c->walls) wall_temperature_update(c->walls, state);
  show_wall_temperatures(c, state, particles);
}
