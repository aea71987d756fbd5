/* sim_escape.c - melt that has left through an opening, and melt where none may be. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cast/sim/sim_private.h"

static bool has_left(const Sim *sim, ptrdiff_t i)
{
  bool left = false;
  for (int d = 0; d < 3; d++) {
    const double x = sim->particles.x[d][i];
    left = left || x < sim->box_low[d] || x > sim->box_high[d];
  }
  return left;
}

/* Close the gaps in one field of all particles: the fluid that stays moves up, then the walls behind it. */
static void close_gaps(void *field, size_t size, const Particles *p, const uint8_t *leaves, ptrdiff_t stay)
{
  char *bytes = field;
  ptrdiff_t to = 0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    if (leaves[i]) continue;
    if (to != i) memcpy(bytes + (size_t)to * size, bytes + (size_t)i * size, size);
    to++;
  }
  memmove(bytes + (size_t)stay * size, bytes + (size_t)p->n_fluid * size, (size_t)(p->n - p->n_fluid) * size);
}

void sim_remove_marked(Sim *sim, const uint8_t *leaves, ptrdiff_t gone)
{
  Particles *p = &sim->particles;
  ParticleField field[PARTICLE_FIELDS];
  particles_fields(p, field);
  const ptrdiff_t stay = p->n_fluid - gone;
  for (int f = 0; f < PARTICLE_FIELDS; f++) close_gaps(field[f].data, sizeof(double), p, leaves, stay);
  close_gaps(p->id, sizeof *p->id, p, leaves, stay);
  p->n -= gone;
  p->n_fluid = stay;
  if (gone > 0) sim->lists_stale = true;
}

/* What melt leaves through: an outlet's number, or `out`: it got out of the box; -1: it stays. */
static ptrdiff_t exit_of(const Sim *sim, ptrdiff_t i, ptrdiff_t out)
{
  const Particles *p = &sim->particles;
  if (has_left(sim, i)) return out;
  return sim_pour_outlet(sim, (const double[3]){p->x[0][i], p->x[1][i], p->x[2][i]});
}

CastStatus sim_remove_escaped(Sim *sim, CastError *err)
{
  Particles *p = &sim->particles;
  const ptrdiff_t out = (ptrdiff_t)sim->config->n_outlets;
  ptrdiff_t gone = 0, escaped = 0;
#pragma omp parallel for reduction(+ : gone)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) gone += exit_of(sim, i, out) >= 0;
  if (gone == 0) return CAST_OK;
  uint8_t *leaves = calloc((size_t)p->n_fluid, 1);
  CAST_CHECK(leaves, err, CAST_ERR_MEMORY, "no memory to take out %td particles", gone);
  double joules = 0.0, mass = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const ptrdiff_t through = exit_of(sim, i, out);
    if (through < 0) continue;
    leaves[i] = 1;
    joules += p->mass[i] * p->E[i];
    mass += p->mass[i];
    escaped += through == out;
    if (through < out) sim_pour_left(sim, through, p->mass[i], p->mass[i] * p->E[i]);
  }
  sim_remove_marked(sim, leaves, gone);
  free(leaves);
  coupling_record_removed(sim->coupling, joules);
  if (escaped > 0 && sim->counts.escaped == 0.0)
    log_warn(sim->log, "melt leaves the mould: %td particles are taken out at t = %g ms; the summary counts them",
             escaped, 1e3 * sim->counts.time);
  sim->counts.removed += (double)gone;
  sim->counts.escaped += (double)escaped;
  sim->counts.removed_mass += mass;
  return CAST_OK;
}

CastStatus sim_check_inside(const Sim *sim, CastError *err)
{
  const Particles *p = &sim->particles;
  const double deepest = 0.15 * sim->config->spacing; // the guard of sph_drift lets a tenth pass between two steps
  ptrdiff_t bad = p->n_fluid;
#pragma omp parallel for reduction(min : bad)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    if (p->clearance[i] > 0.0) continue; // known to be clear of the surface
    const double x[3] = {p->x[0][i], p->x[1][i], p->x[2][i]};
    SurfaceHit hit;
    const bool near = surface_nearest(sim->surface, x, surface_reach(sim->surface), &hit);
    const bool inside = near ? hit.distance < -deepest : surface_inside_mould(sim->surface, x);
    if (inside) bad = i < bad ? i : bad;
  }
  CAST_CHECK(bad == p->n_fluid, err, CAST_ERR_NUMERIC,
             "particle %d at (%g, %g, %g) mm is inside the mould's solid at t = %g ms", p->id[bad], 1e3 * p->x[0][bad],
             1e3 * p->x[1][bad], 1e3 * p->x[2][bad], 1e3 * sim->counts.time);
  return CAST_OK;
}
