/* The coupling's life, what it makes anew with the neighbour lists, and the books. The exchange is in exchange.c. */
#include "cast/coupling/coupling_private.h"

#include <stdlib.h>

static const double most_correction = 2.0; // of a patch's areas, upwards

/* ---- life ---- */

static double melt_enthalpy(const Particles *p)
{
  Total total = {0.0, 0.0};
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) total_add(&total, p->mass[i] * p->E[i]);
  return total_of(&total);
}

static CastStatus check_parameters(const CouplingParameters *parameters, const RomData *rom, const Surface *surface,
                                   CastError *err)
{
  if (parameters->kind == COUPLING_SURFACE) {
    CAST_CHECK(surface, err, CAST_ERR_ARGUMENT, "coupling: `surface` needs the mould's surface");
    return CAST_OK;
  }
  CAST_CHECK(rom->n_materials > 0, err, CAST_ERR_INPUT, "the ROM names no material: `embedded` needs its conductivity");
  for (size_t k = 1; k < rom->n_materials; k++)
    CAST_CHECK(
        rom->material[k].conductivity == rom->material[0].conductivity, err, CAST_ERR_INPUT,
        "the mould's materials '%s' and '%s' conduct %g and %g W/(m K), and the ROM does not tell which is where: "
        "`embedded` coupling cannot be used, `surface` can",
        rom->material[0].name, rom->material[k].name, rom->material[0].conductivity, rom->material[k].conductivity);
  return CAST_OK;
}

static CastStatus build(Coupling *c, const Surface *surface, const Particles *particles, CastError *err)
{
  const size_t m = c->rom->m;
  double **const by_patch[] = {&c->flow, &c->sum, &c->wetted, &c->touched, &c->mean_flow};
  bool ok = true;
  for (size_t a = 0; a < sizeof by_patch / sizeof *by_patch; a++) ok = (*by_patch[a] = calloc(m, sizeof(double))) && ok;
  c->law = calloc(m, sizeof *c->law);
  CAST_CHECK(ok && c->law, err, CAST_ERR_MEMORY, "coupling: no memory for %zu patches", m);
  c->uniform.elsewhere.h = c->parameters.h_contact;
  const ContactLaws *laws = c->parameters.contact ? c->parameters.contact : &c->uniform;
  CAST_CALL(mould_pace_create(c->rom, &c->pace, err));
  CAST_CALL(contact_laws_by_patch(laws, c->rom, c->sph->melt, c->law, err));
  if (surface) CAST_CALL(wetting_create(surface, c->sph, particles, &c->wetting, err));
  if (c->parameters.kind == COUPLING_SURFACE) return CAST_OK;
  c->mould_kappa = c->rom->material[0].conductivity;
  return wall_temperature_create(c->rom, particles, c->sph->spacing, &c->walls, err);
}

CastStatus coupling_create(const CouplingParameters *parameters, const SphParameters *sph, const RomData *rom,
                           const Surface *surface, const Particles *particles, Coupling **out, CastError *err)
{
  *out = NULL;
  CAST_CALL(check_parameters(parameters, rom, surface, err));
  Coupling *c = calloc(1, sizeof *c);
  CAST_CHECK(c, err, CAST_ERR_MEMORY, "coupling: no memory");
  c->parameters = *parameters;
  c->sph = sph;
  c->rom = rom;
  c->rules = (ContactRules){parameters->kind, sph, surface, rom->m, 0.25 * sph->spacing};
  c->builds = -1;
  c->substeps = 1;
  c->least_heat = sph->melt ? material_specific_heat_min(sph->melt) : 0.0;
  for (int k = 0; k < STEP_TABLE; k++) c->eigenvalue[k] = NAN;
  c->melt_start = melt_enthalpy(particles);
  const CastStatus status = build(c, surface, particles, err);
  if (status != CAST_OK) coupling_destroy(&c);
  *out = c;
  return status;
}

void coupling_destroy(Coupling **coupling)
{
  if (!coupling || !*coupling) return;
  Coupling *c = *coupling;
  contacts_free(&c->contacts);
  wetting_destroy(&c->wetting);
  wall_temperature_destroy(&c->walls);
  mould_pace_destroy(&c->pace);
  free(c->law);
  free(c->flow);
  free(c->sum);
  free(c->wetted);
  free(c->touched);
  free(c->mean_flow);
  free(c->T);
  free(c->E);
  free(c->mean);
  free(c);
  *coupling = NULL;
}

/* ---- after a rebuild ---- */

static CastStatus reserve_near(Coupling *c, CastError *err)
{
  const ptrdiff_t n = c->contacts.n_near;
  if (n <= c->room) return CAST_OK;
  const ptrdiff_t room = n + n / 4 + 64;
  double **const arrays[] = {&c->T, &c->E, &c->mean};
  bool ok = true;
  for (size_t a = 0; a < sizeof arrays / sizeof *arrays; a++) {
    free(*arrays[a]);
    ok = (*arrays[a] = malloc((size_t)room * sizeof(double))) && ok;
  }
  c->room = ok ? room : 0;
  CAST_CHECK(ok, err, CAST_ERR_MEMORY, "coupling: no memory for %td particles near the wall", n);
  return CAST_OK;
}

/* Bring the areas of each patch to its wetted area: down, to nothing where melt is near but does not touch; up by at
 * most a factor of two, as beyond that samples and particles speak of different things (a lone particle in a crack). */
static void normalise_areas(Coupling *c)
{
  Contacts *contacts = &c->contacts;
#pragma omp parallel for schedule(dynamic, 8)
  for (size_t l = 0; l < c->rom->m; l++) {
    const double wanted = c->wetted[l], factor = c->touched[l] > 0.0 ? wanted / c->touched[l] : 1.0;
    const double used = fmin(factor, most_correction);
    double sum = 0.0;
    for (ptrdiff_t k = contacts->of_patch_start[l]; k < contacts->of_patch_start[l + 1]; k++) {
      contacts->area[contacts->of_patch[k]] *= used;
      sum += contacts->area[contacts->of_patch[k]];
    }
    c->touched[l] = sum;
  }
}

CastStatus coupling_rebuild(Coupling *c, const Particles *particles, const Neighbours *neighbours, CastError *err)
{
  CAST_CALL(contacts_build(&c->contacts, &c->rules, particles, neighbours, err));
  CAST_CALL(reserve_near(c, err));
  const Contacts *contacts = &c->contacts;
  for (size_t l = 0; l < c->rom->m; l++) c->touched[l] = 0.0;
  for (ptrdiff_t e = 0; e < contacts->n; e++) c->touched[contacts->patch[e]] += contacts->area[e];
  for (size_t l = 0; l < c->rom->m; l++) c->wetted[l] = c->touched[l];
  if (c->wetting) CAST_CALL(wetting_measure(c->wetting, contacts, particles, neighbours, c->wetted, err));
  if (c->parameters.kind == COUPLING_SURFACE) normalise_areas(c);
  if (c->walls) wall_temperature_select(c->walls, neighbours);
  for (int d = 0; d < 3; d++) c->period[d] = neighbours_period(neighbours)[d];
  c->builds = neighbours_builds(neighbours);
  return CAST_OK;
}

/* ---- what it tells ---- */

long coupling_substeps(const Coupling *c)
{
  return c->substeps;
}

const double *coupling_flow(const Coupling *c)
{
  return c->flow;
}

double coupling_wetted_area(const Coupling *c, size_t patch)
{
  return c->wetted[patch];
}

double coupling_contact_area(const Coupling *c, size_t patch)
{
  return c->touched[patch];
}

double coupling_conductance(const Coupling *c)
{
  return c->conductance;
}

bool coupling_check_stability(const Coupling *c, const RomState *state, double dt, double *stiffness)
{
  *stiffness = c->parameters.mould_frozen ? 0.0 : rom_state_stiffness_of(state, c->sum, dt);
  return *stiffness <= coupling_stable;
}

/* ---- books ---- */

EnergyLedger coupling_ledger(const Coupling *c, const RomState *state, const Particles *particles)
{
  EnergyLedger ledger = {.melt_start = c->melt_start,
                         .melt_now = melt_enthalpy(particles),
                         .mould_now = rom_state_heat(state) + mould_pace_heat(c->pace),
                         .lost = rom_state_lost(state) + total_of(&c->absorbed),
                         .exchanged = total_of(&c->exchanged),
                         .removed = total_of(&c->removed),
                         .added = total_of(&c->added)};
  ledger.residual =
      (ledger.melt_now - ledger.melt_start) + ledger.mould_now + ledger.lost + ledger.removed - ledger.added;
  return ledger;
}

void coupling_record_removed(Coupling *c, double joules)
{
  total_add(&c->removed, joules);
}

void coupling_record_added(Coupling *c, double joules)
{
  total_add(&c->added, joules);
}

enum { OWN_SIZE = 10 };

size_t coupling_size(const Coupling *c)
{
  return OWN_SIZE + mould_pace_size(c->pace);
}

void coupling_save(const Coupling *c, double *buffer)
{
  const double all[OWN_SIZE] = {c->melt_start,  c->exchanged.value, c->exchanged.low, c->removed.value,
                                c->removed.low, c->absorbed.value,  c->absorbed.low,  c->added.value,
                                c->added.low,   c->interval};
  for (int k = 0; k < OWN_SIZE; k++) buffer[k] = all[k];
  mould_pace_save(c->pace, buffer + OWN_SIZE);
}

void coupling_restore(Coupling *c, const RomState *state, const double *buffer)
{
  c->melt_start = buffer[0];
  c->exchanged = (Total){buffer[1], buffer[2]};
  c->removed = (Total){buffer[3], buffer[4]};
  c->absorbed = (Total){buffer[5], buffer[6]};
  c->added = (Total){buffer[7], buffer[8]};
  c->interval = buffer[9];
  mould_pace_restore(c->pace, state, buffer + OWN_SIZE);
}
