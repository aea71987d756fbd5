/* sim_pour.c - melt that comes in and melt that leaves. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "cast/sim/sim_private.h"

static const double TOUCH = 0.75; // spacings: melt this near to a surface touches it

/* ---- at the start ---- */

/* Where the input speaks of it. */
static CastStatus say_where(const char *list, size_t k, CastError *err)
{
  char text[64];
  snprintf(text, sizeof text, "melt.%s[%zu]", list, k + 1);
  return cast_error_prefix(err, text);
}

CastStatus sim_pour_create(Sim *sim, CastError *err)
{
  const CastConfig *c = sim->config;
  sim->inlet = calloc(c->n_inlets + 1, sizeof *sim->inlet);
  sim->outlet_patches = calloc(c->n_outlets + 1, sizeof *sim->outlet_patches);
  sim->poured = calloc(c->n_inlets + c->n_outlets + 1, sizeof *sim->poured);
  CAST_CHECK(sim->inlet && sim->outlet_patches && sim->poured, err, CAST_ERR_MEMORY, "no memory");
  for (size_t k = 0; k < c->n_inlets; k++)
    if (inlet_create(&c->inlet[k], &sim->sph, sim->surface, &sim->inlet[k], err) != CAST_OK)
      return say_where("inlets", k, err);
  for (size_t k = 0; k < c->n_outlets; k++)
    if (c->outlet[k].kind == OUTLET_SURFACE &&
        outlet_find_patches(&c->outlet[k], sim->rom, &sim->outlet_patches[k], err) != CAST_OK)
      return say_where("outlets", k, err);
  return CAST_OK;
}

/* Ids for all that can come until the end, so that what is kept by id has its size from the start. */
static CastStatus give_ids(Sim *sim, ptrdiff_t begun, CastError *err)
{
  double ids = (double)begun;
  for (size_t k = 0; k < sim->config->n_inlets; k++) {
    Inlet *inlet = &sim->inlet[k];
    const double more =
        (double)inlet->n * (double)(inlet_most_layers(inlet, sim->config->end) - (ptrdiff_t)inlet->layers);
    inlet->next_id = ids < 2e9 ? (int32_t)ids : 0;
    ids += more;
    CAST_CHECK(ids < 2e9, err, CAST_ERR_INPUT, "melt.inlets[%zu]: %g particles would come in: too many", k + 1, more);
  }
  sim->n_ids = (ptrdiff_t)ids;
  return CAST_OK;
}

CastStatus sim_pour_add_buffers(Sim *sim, PointSet *points, CastError *err)
{
  for (size_t k = 0; k < sim->config->n_inlets; k++) {
    sim->inlet[k].first_id = (int32_t)points->n;
    if (inlet_add_buffer(&sim->inlet[k], points, err) != CAST_OK) return say_where("inlets", k, err);
  }
  return give_ids(sim, points->n, err);
}

void sim_pour_start(Sim *sim)
{
  Particles *p = &sim->particles;
  for (size_t k = 0; k < sim->config->n_inlets; k++) {
    const Inlet *inlet = &sim->inlet[k];
    const double E = material_enthalpy(&sim->config->melt, table_evaluate(&inlet->config->temperature, 0.0));
    for (ptrdiff_t i = 0; i < inlet->n * inlet->layers; i++) p->E[inlet->first_id + i] = E;
    inlet_sense(inlet, &sim->sph, 0.0, p);
    inlet_carry(inlet, &sim->sph, 0.0, p);
  }
}

void sim_pour_destroy(Sim *sim)
{
  for (size_t k = 0; sim->inlet && k < sim->config->n_inlets; k++) inlet_destroy(&sim->inlet[k]);
  for (size_t k = 0; sim->outlet_patches && k < sim->config->n_outlets; k++) free(sim->outlet_patches[k]);
  free(sim->inlet);
  free(sim->outlet_patches);
  free(sim->poured);
}

/* ---- in a step ---- */

void sim_pour_place(Sim *sim, double time)
{
  for (size_t k = 0; k < sim->config->n_inlets; k++) inlet_place(&sim->inlet[k], time, &sim->particles);
}

void sim_pour_carry(Sim *sim)
{
  for (size_t k = 0; k < sim->config->n_inlets; k++) {
    inlet_sense(&sim->inlet[k], &sim->sph, sim->counts.time, &sim->particles);
    inlet_carry(&sim->inlet[k], &sim->sph, sim->counts.time, &sim->particles);
  }
}

/* Take away the buffer of an inlet; it has not come in. */
static CastStatus take_away(Sim *sim, size_t k, CastError *err)
{
  Particles *p = &sim->particles;
  Inlet *inlet = &sim->inlet[k];
  uint8_t *leaves = calloc((size_t)p->n_fluid + 1, 1);
  CAST_CHECK(leaves, err, CAST_ERR_MEMORY, "no memory for an inlet");
  ptrdiff_t gone = 0;
  double joules = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    leaves[i] = inlet_holds(inlet, sim->counts.time, p->id[i], NULL, NULL);
    if (!leaves[i]) continue;
    gone++;
    joules += p->mass[i] * p->E[i];
    sim->poured[k].mass -= p->mass[i];
  }
  inlet->over = true;
  sim_remove_marked(sim, leaves, gone);
  free(leaves);
  sim->poured[k].particles -= (double)gone;
  sim->poured[k].joules -= joules;
  coupling_record_added(sim->coupling, -joules);
  return CAST_OK;
}

CastStatus sim_pour_feed(Sim *sim, CastError *err)
{
  for (size_t k = 0; k < sim->config->n_inlets; k++) {
    Inlet *inlet = &sim->inlet[k];
    ptrdiff_t added;
    double joules = 0.0;
    inlet_sense(inlet, &sim->sph, sim->counts.time, &sim->particles);
    CAST_CALL(inlet_feed(inlet, &sim->sph, sim->counts.time, &sim->particles, &added, &joules, err));
    if (added > 0) {
      sim->lists_stale = true;
      sim->poured[k].particles += (double)added;
      sim->poured[k].mass += (double)added * sim->particles.mass[0];
      sim->poured[k].joules += joules;
      coupling_record_added(sim->coupling, joules);
    }
    const bool done = sim->counts.time >= inlet_end(inlet->config) && !inlet->config->stays;
    if (done && !inlet->over) CAST_CALL(take_away(sim, k, err));
    inlet_carry(inlet, &sim->sph, sim->counts.time, &sim->particles);
  }
  return CAST_OK;
}

bool sim_pour_is_over(const Sim *sim)
{
  for (size_t k = 0; k < sim->config->n_inlets; k++)
    if (sim->counts.time < inlet_end(sim->inlet[k].config)) return false;
  return true;
}

CastStatus sim_pour_end(Sim *sim, CastError *err)
{
  for (size_t k = 0; k < sim->config->n_inlets; k++)
    if (!sim->inlet[k].over && !sim->inlet[k].config->stays) CAST_CALL(take_away(sim, k, err));
  return CAST_OK;
}

double sim_pour_passed(const Sim *sim, size_t k)
{
  const Inlet *inlet = &sim->inlet[k];
  const double layers = floor(inlet_way(inlet, sim->counts.time) / inlet->spacing + 0.5);
  return fmin(layers, (double)inlet->made) * (double)inlet->n;
}

/* ---- outlets ---- */

ptrdiff_t sim_pour_outlet(const Sim *sim, const double x[3])
{
  const CastConfig *c = sim->config;
  for (size_t k = 0; k < c->n_outlets; k++)
    if (outlet_takes(&c->outlet[k], sim->surface, sim->outlet_patches[k], TOUCH * c->spacing, x)) return (ptrdiff_t)k;
  return -1;
}

void sim_pour_left(Sim *sim, ptrdiff_t outlet, double mass, double joules)
{
  Poured *poured = &sim->poured[sim->config->n_inlets + (size_t)outlet];
  poured->particles += 1.0;
  poured->mass += mass;
  poured->joules += joules;
}

/* ---- checkpoints ---- */

size_t sim_pour_size(const Sim *sim)
{
  return 2 * sim->config->n_inlets + 3 * (sim->config->n_inlets + sim->config->n_outlets);
}

void sim_pour_save(const Sim *sim, double *buffer)
{
  const size_t inlets = sim->config->n_inlets, all = inlets + sim->config->n_outlets;
  for (size_t k = 0; k < inlets; k++) {
    *buffer++ = (double)sim->inlet[k].made;
    *buffer++ = sim->inlet[k].over;
  }
  for (size_t k = 0; k < all; k++) {
    *buffer++ = sim->poured[k].particles;
    *buffer++ = sim->poured[k].mass;
    *buffer++ = sim->poured[k].joules;
  }
}

void sim_pour_restore(Sim *sim, const double *buffer)
{
  const size_t inlets = sim->config->n_inlets, all = inlets + sim->config->n_outlets;
  for (size_t k = 0; k < inlets; k++) {
    sim->inlet[k].made = (ptrdiff_t)*buffer++;
    sim->inlet[k].over = *buffer++ != 0.0;
  }
  for (size_t k = 0; k < all; k++) {
    sim->poured[k].particles = *buffer++;
    sim->poured[k].mass = *buffer++;
    sim->poured[k].joules = *buffer++;
  }
}

/* ---- what it tells ---- */

static void outlet_name(const OutletConfig *outlet, char *text, size_t size)
{
  if (outlet->kind == OUTLET_SURFACE)
    snprintf(text, size, "surface %s", outlet->surface);
  else
    snprintf(text, size, "%s", outlet->kind == OUTLET_BOX ? "box" : "plane");
}

void sim_pour_report(const Sim *sim)
{
  const CastConfig *c = sim->config;
  const double dx = c->spacing;
  for (size_t k = 0; k < c->n_inlets; k++) {
    const Inlet *inlet = &sim->inlet[k];
    const double area = (double)inlet->n * dx * dx, end = fmin(inlet_end(inlet->config), c->end);
    const double volume = area * inlet_way(inlet, end);
    log_info(sim->log,
             "inlet     %zu: %td particles across, %.4g mm2; %.3g m/s at first; %.4g mm3, %.4g g until t = %.4g s",
             k + 1, inlet->n, 1e6 * area, inlet_speed(inlet, 0.0), 1e9 * volume, 1e3 * volume * c->melt.density, end);
    if (inlet->n < inlet->in_shape)
      log_warn(sim->log,
               "inlet %zu: the mould takes %td of its %td particles across, which are not clear of it all the way",
               k + 1, inlet->in_shape - inlet->n, inlet->in_shape);
    if (inlet->n < 12)
      log_warn(sim->log, "inlet %zu is only %td particles across: spacing or inlet too coarse for a stream", k + 1,
               inlet->n);
  }
  for (size_t k = 0; k < c->n_outlets; k++) {
    char name[ROM_NAME_LENGTH + 16];
    outlet_name(&c->outlet[k], name, sizeof name);
    log_info(sim->log, "outlet    %zu: %s", k + 1, name);
  }
}

void sim_pour_print(const Sim *sim, FILE *out)
{
  const CastConfig *c = sim->config;
  const double mass = sim->sph.rho0 * c->spacing * c->spacing * c->spacing;
  if (c->n_inlets + c->n_outlets > 0) fputs("Pouring\n", out);
  for (size_t k = 0; k < c->n_inlets; k++)
    fprintf(out, "  through inlet %zu   %12.6g g\n", k + 1, 1e3 * mass * sim_pour_passed(sim, k));
  for (size_t k = 0; k < c->n_outlets; k++) {
    char name[ROM_NAME_LENGTH + 16];
    const Poured *left = &sim->poured[c->n_inlets + k];
    outlet_name(&c->outlet[k], name, sizeof name);
    fprintf(out, "  through outlet %zu  %12.6g g, %.6e J (%s)\n", k + 1, 1e3 * left->mass, left->joules, name);
  }
}

json_t *sim_pour_json(const Sim *sim, bool inlets)
{
  const CastConfig *c = sim->config;
  const double mass = sim->sph.rho0 * c->spacing * c->spacing * c->spacing;
  json_t *all = json_array();
  for (size_t k = 0; k < (inlets ? c->n_inlets : c->n_outlets); k++) {
    const Poured *poured = &sim->poured[inlets ? k : c->n_inlets + k];
    json_array_append_new(all, inlets ? json_pack("{sf sf sf}", "passed_kg", mass * sim_pour_passed(sim, k), "added_kg",
                                                  poured->mass, "added_J", poured->joules)
                                      : json_pack("{sf sf}", "left_kg", poured->mass, "left_J", poured->joules));
  }
  return all;
}
