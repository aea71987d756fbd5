/* sim_curves.c - probes.csv, tracers.csv and ledger.csv. */
#define _GNU_SOURCE // open_memstream
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/io/csv.h"
#include "cast/results/probes.h"
#include "cast/sim/sim_private.h"

enum { CURVE_PROBES, CURVE_TRACERS, CURVE_LEDGER };
static const char *const FILES[SIM_CURVES] = {"probes.csv", "tracers.csv", "ledger.csv"};

struct SimCurves {
  CsvFile *csv[SIM_CURVES]; // NULL: not wanted
  Probes *probes;
  int32_t *tracer; // [n_tracers] ids
};

/* The particle nearest to a place at the start; ids are places in the order of creation then. */
static int32_t nearest_particle(const Particles *p, const double x[3])
{
  double best = INFINITY;
  int32_t id = -1;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const double dx = p->x[0][i] - x[0], dy = p->x[1][i] - x[1], dz = p->x[2][i] - x[2];
    const double r2 = dx * dx + dy * dy + dz * dz;
    if (r2 < best || (r2 == best && p->id[i] < id)) { // ties by id: the order of particles may differ, the id not
      best = r2;
      id = p->id[i];
    }
  }
  return id;
}

static ptrdiff_t find_id(const Particles *p, int32_t id)
{
  for (ptrdiff_t i = 0; i < p->n_fluid; i++)
    if (p->id[i] == id) return i;
  return -1;
}

/* ---- rows ---- */

static CastStatus write_probes(const SimCurves *curves, Sim *sim, CastError *err)
{
  CsvFile *csv = curves->csv[CURVE_PROBES];
  if (!csv) return CAST_OK;
  csv_number(csv, sim->counts.time);
  for (size_t i = 0; i < sim->config->output.n_probes; i++) {
    csv_number(csv, probes_melt_temperature(curves->probes, i, &sim->particles));
    csv_number(csv, probes_mould_temperature(curves->probes, i, sim->mould));
  }
  return csv_end_row(csv, err);
}

static CastStatus write_tracers(const SimCurves *curves, Sim *sim, CastError *err)
{
  CsvFile *csv = curves->csv[CURVE_TRACERS];
  const Particles *p = &sim->particles;
  for (size_t k = 0; csv && k < sim->config->output.n_tracers; k++) {
    const ptrdiff_t i = find_id(p, curves->tracer[k]);
    if (i < 0) continue; // has left
    csv_number(csv, sim->counts.time);
    csv_word(csv, sim->config->output.tracer[k].name);
    csv_number(csv, p->id[i]);
    for (int d = 0; d < 3; d++) csv_number(csv, p->x[d][i]);
    for (int d = 0; d < 3; d++) csv_number(csv, p->v[d][i]);
    csv_number(csv, p->T[i]);
    csv_number(csv, p->E[i]);
    csv_number(csv, p->p[i]);
    CAST_CALL(csv_end_row(csv, err));
  }
  return CAST_OK;
}

static CastStatus write_ledger(const SimCurves *curves, Sim *sim, CastError *err)
{
  CsvFile *csv = curves->csv[CURVE_LEDGER];
  const EnergyLedger ledger = sim_ledger(sim);
  double wetted = 0.0, coldest = INFINITY, hottest = -INFINITY, sum = 0.0;
  for (size_t l = 0; l < sim->rom->m; l++)
    if (!sim->rom->patch[l].outer) wetted += coupling_wetted_area(sim->coupling, l);
  const Particles *p = &sim->particles;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    coldest = fmin(coldest, p->T[i]);
    hottest = fmax(hottest, p->T[i]);
    sum += p->T[i];
    const double v2 = p->v[0][i] * p->v[0][i] + p->v[1][i] * p->v[1][i] + p->v[2][i] * p->v[2][i];
    sim->counts.fastest = fmax(sim->counts.fastest, sqrt(v2));
  }
  const double values[] = {
      sim->counts.time, sim->counts.steps, sim->counts.dt,           ledger.melt_now - ledger.melt_start,
      ledger.mould_now, ledger.lost,       ledger.removed,           ledger.added,
      ledger.exchanged, ledger.residual,   sph_kinetic_energy(p),    (double)p->n_fluid,
      wetted,           coldest,           sum / (double)p->n_fluid, hottest};
  for (size_t k = 0; k < sizeof values / sizeof *values; k++) csv_number(csv, values[k]);
  for (size_t s = 0; s <= filling_n_features(sim->filling); s++) csv_number(csv, filling_fraction(sim->filling, s));
  return csv_end_row(csv, err);
}

CastStatus sim_curves_row(SimCurves *curves, Sim *sim, CastError *err)
{
  CAST_CALL(write_probes(curves, sim, err));
  CAST_CALL(write_tracers(curves, sim, err));
  return write_ledger(curves, sim, err);
}

/* ---- opening ---- */

static void warn_about_points(const SimCurves *curves, const Sim *sim)
{
  const OutputConfig *o = &sim->config->output;
  for (size_t i = 0; i < o->n_probes; i++)
    if (probes_home(curves->probes, i) == PROBE_DEEP)
      log_warn(sim->log, "probe '%s' is in the mould beyond the ROM's band of %g mm: it will stay empty",
               o->probe[i].name, 1e3 * sim->rom->band);
  for (size_t k = 0; k < o->n_tracers; k++) {
    const Particles *p = &sim->particles;
    const ptrdiff_t i = find_id(p, curves->tracer[k]);
    double far2 = 0.0;
    for (int d = 0; d < 3; d++) far2 += (p->x[d][i] - o->tracer[k].x[d]) * (p->x[d][i] - o->tracer[k].x[d]);
    if (sqrt(far2) > 2.0 * sim->config->spacing)
      log_warn(sim->log, "tracer '%s': the nearest melt is %.3g mm away", o->tracer[k].name, 1e3 * sqrt(far2));
  }
}

static CastStatus create_points(SimCurves *curves, const Sim *sim, CastError *err)
{
  const CastConfig *c = sim->config;
  curves->tracer = calloc(c->output.n_tracers + 1, sizeof *curves->tracer);
  double(*x)[3] = calloc(c->output.n_probes + 1, sizeof *x);
  CastStatus status = CAST_OK;
  if (!curves->tracer || !x) status = cast_error_set(err, CAST_ERR_MEMORY, "no memory for probes and tracers");
  for (size_t i = 0; i < c->output.n_probes && x; i++) memcpy(x[i], c->output.probe[i].x, sizeof *x);
  if (status == CAST_OK)
    status = probes_create(c->output.n_probes, (const double(*)[3])x, sim->rom, sim->surface, &sim->sph,
                           &curves->probes, err);
  free(x);
  for (size_t k = 0; k < c->output.n_tracers && status == CAST_OK; k++)
    curves->tracer[k] = nearest_particle(&sim->particles, c->output.tracer[k].x);
  return status;
}

static void put_header(FILE *out, int kind, const Sim *sim)
{
  const OutputConfig *o = &sim->config->output;
  if (kind == CURVE_PROBES) {
    fputs("time_s", out);
    for (size_t i = 0; i < o->n_probes; i++) fprintf(out, ",%s melt_K,%s mould_K", o->probe[i].name, o->probe[i].name);
  } else if (kind == CURVE_TRACERS) {
    fputs("time_s,name,id,x_m,y_m,z_m,vx_m/s,vy_m/s,vz_m/s,temperature_K,enthalpy_J/kg,pressure_Pa", out);
  } else {
    fputs("time_s,step,dt_s,melt_gain_J,mould_J,lost_J,removed_J,added_J,exchanged_J,residual_J,kinetic_J,particles,"
          "wetted_m2,"
          "melt_min_K,melt_mean_K,melt_max_K",
          out);
    for (size_t s = 0; s <= filling_n_features(sim->filling); s++)
      fprintf(out, ",filled %s", filling_name(sim->filling, s));
  }
}

static CastStatus create_file(const Sim *sim, int kind, const char *path, CsvFile **csv, CastError *err)
{
  static const char *const about[SIM_CURVES] = {
      "temperatures at fixed places: of the melt where there is melt, of the mould near the cavity",
      "particles followed through the run", "energies, melt temperatures and filled fractions"};
  char *header = NULL;
  size_t size = 0;
  FILE *text = open_memstream(&header, &size);
  CAST_CHECK(text, err, CAST_ERR_MEMORY, "no memory for '%s'", path);
  put_header(text, kind, sim);
  fclose(text);
  const CastStatus status = csv_create(path, about[kind], header, sim_output_provenance(sim), csv, err);
  free(header);
  return status;
}

static CastStatus open_files(SimCurves *curves, const Sim *sim, const double *length, CastError *err)
{
  const OutputConfig *o = &sim->config->output;
  const bool wanted[SIM_CURVES] = {o->n_probes > 0, o->n_tracers > 0, true};
  for (int k = 0; k < SIM_CURVES; k++) {
    char path[4200];
    snprintf(path, sizeof path, "%s/%s", o->folder, FILES[k]);
    if (!wanted[k]) continue;
    if (length)
      CAST_CALL(csv_reopen(path, (long)length[k], &curves->csv[k], err));
    else
      CAST_CALL(create_file(sim, k, path, &curves->csv[k], err));
  }
  return CAST_OK;
}

CastStatus sim_curves_create(const Sim *sim, const double *length, SimCurves **curves, CastError *err)
{
  SimCurves *made = *curves = calloc(1, sizeof *made);
  CAST_CHECK(made, err, CAST_ERR_MEMORY, "no memory for the curves");
  CastStatus status = create_points(made, sim, err);
  if (status == CAST_OK && !length) warn_about_points(made, sim);
  if (status == CAST_OK) status = open_files(made, sim, length, err);
  if (status != CAST_OK) sim_curves_destroy(curves);
  return status;
}

void sim_curves_destroy(SimCurves **curves)
{
  if (!curves || !*curves) return;
  for (int k = 0; k < SIM_CURVES; k++) csv_close(&(*curves)->csv[k]);
  probes_destroy(&(*curves)->probes);
  free((*curves)->tracer);
  free(*curves);
  *curves = NULL;
}

void sim_curves_lengths(const SimCurves *curves, double length[SIM_CURVES])
{
  for (int k = 0; k < SIM_CURVES; k++) length[k] = curves->csv[k] ? (double)csv_length(curves->csv[k]) : 0.0;
}
