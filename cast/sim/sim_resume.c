/* sim_resume.c - checkpoints: all that changes during a run, as it is in the middle of a step, right after the
 * neighbour lists were made anew (see first_half in sim.c). */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cast/sim/sim_private.h"
#include "common/h5/h5.h"

static const char FORMAT[] = "castrun checkpoint";
enum { FORMAT_VERSION = 5 };

static CastStatus write_doubles(hid_t file, const char *name, size_t n, const double *values, const char *units,
                                const char *description, CastError *err)
{
  const hsize_t shape[1] = {n};
  return h5_write(file, name, H5T_NATIVE_DOUBLE, 1, shape, values, units, description, err);
}

static CastStatus read_doubles(hid_t file, const char *name, size_t n, double *values, CastError *err)
{
  hsize_t shape[1] = {n};
  void *read = NULL;
  CAST_CALL(h5_read(file, name, H5T_NATIVE_DOUBLE, 1, shape, &read, err));
  memcpy(values, read, n * sizeof *values);
  free(read);
  return CAST_OK;
}

/* ---- states that their owners pack into doubles ---- */

static size_t mould_size(const Sim *sim)
{
  return rom_state_size(sim->mould);
}
static void mould_save(const Sim *sim, double *state)
{
  rom_state_save(sim->mould, state);
}
static void mould_restore(Sim *sim, const double *state)
{
  rom_state_restore(sim->mould, state);
}

static size_t exchange_size(const Sim *sim)
{
  return coupling_size(sim->coupling);
}
static void exchange_save(const Sim *sim, double *state)
{
  coupling_save(sim->coupling, state);
}
static void exchange_restore(Sim *sim, const double *state) // after the mould
{
  coupling_restore(sim->coupling, sim->mould, state);
}

static size_t frozen_size(const Sim *sim)
{
  return freezing_size(sim->freezing);
}
static void frozen_save(const Sim *sim, double *state)
{
  freezing_save(sim->freezing, state);
}
static void frozen_restore(Sim *sim, const double *state)
{
  freezing_restore(sim->freezing, state);
}

static size_t arrived_size(const Sim *sim)
{
  return arrival_size(sim->arrival);
}
static void arrived_save(const Sim *sim, double *state)
{
  arrival_save(sim->arrival, state);
}
static void arrived_restore(Sim *sim, const double *state)
{
  arrival_restore(sim->arrival, state);
}

static size_t filled_size(const Sim *sim)
{
  return filling_state_size(sim->filling);
}
static void filled_save(const Sim *sim, double *state)
{
  filling_save(sim->filling, state);
}
static void filled_restore(Sim *sim, const double *state)
{
  filling_restore(sim->filling, state);
}

static size_t counts_size(const Sim *sim)
{
  return sizeof sim->counts / sizeof(double);
}
static void counts_save(const Sim *sim, double *state)
{
  memcpy(state, &sim->counts, sizeof sim->counts);
}
static void counts_restore(Sim *sim, const double *state)
{
  memcpy(&sim->counts, state, sizeof sim->counts);
}

typedef struct PackedState {
  const char *name, *unit, *description;
  size_t (*size)(const Sim *sim); // doubles; 0: there is none, and none is kept
  void (*save)(const Sim *sim, double *state);
  void (*restore)(Sim *sim, const double *state);
} PackedState;

/* In the order in which they are restored. */
static const PackedState PACKED[] = {
    {"mould", "", "state of the reduced model, as rom_state packs it", mould_size, mould_save, mould_restore},
    {"coupling", "", "the ledger's sums and heat on its way to the mould, as coupling packs them", exchange_size,
     exchange_save, exchange_restore},
    {"freezing", "", "when particles froze, as freezing packs it", frozen_size, frozen_save, frozen_restore},
    {"arrival", "", "when melt came, how warm, as arrival packs it", arrived_size, arrived_save, arrived_restore},
    {"pouring", "", "inlets and outlets, as sim_pour packs it", sim_pour_size, sim_pour_save, sim_pour_restore},
    {"filling", "s", "when each level was reached", filled_size, filled_save, filled_restore},
    {"counts", "", "time, steps and sums", counts_size, counts_save, counts_restore},
};
enum { N_PACKED = sizeof PACKED / sizeof PACKED[0] };

static CastStatus make_room(const Sim *sim, const PackedState *packed, double **state, CastError *err)
{
  *state = malloc(packed->size(sim) * sizeof **state + 1);
  CAST_CHECK(*state, err, CAST_ERR_MEMORY, "no memory for the state of '%s'", packed->name);
  return CAST_OK;
}

static CastStatus write_packed(const Sim *sim, const PackedState *packed, hid_t file, CastError *err)
{
  double *state;
  if (packed->size(sim) == 0) return CAST_OK;
  CAST_CALL(make_room(sim, packed, &state, err));
  packed->save(sim, state);
  const CastStatus status =
      write_doubles(file, packed->name, packed->size(sim), state, packed->unit, packed->description, err);
  free(state);
  return status;
}

static CastStatus read_packed(Sim *sim, const PackedState *packed, hid_t file, CastError *err)
{
  double *state;
  if (packed->size(sim) == 0) return CAST_OK;
  CAST_CALL(make_room(sim, packed, &state, err));
  const CastStatus status = read_doubles(file, packed->name, packed->size(sim), state, err);
  if (status == CAST_OK) packed->restore(sim, state);
  free(state);
  return status;
}

/* ---- writing ---- */

static CastStatus write_identity(const Sim *sim, hid_t file, CastError *err)
{
  const CastConfig *c = sim->config;
  const int version = FORMAT_VERSION;
  char *absolute = realpath(c->input_path, NULL);
  const char *path = absolute ? absolute : c->input_path;
  CastStatus status = h5_write_text_attribute(file, "format", FORMAT, err);
  if (status == CAST_OK) status = h5_write_attribute(file, "version", H5T_NATIVE_INT, 1, &version, err);
  if (status == CAST_OK) status = h5_write_text(file, "input", c->input_text, "cast.yaml as it was read", err);
  if (status == CAST_OK) status = h5_write_text(file, "input_path", path, "where it was", err);
  if (status == CAST_OK) status = h5_write_text(file, "rom_sha256", sim->rom_sha256, "of the ROM file", err);
  if (status == CAST_OK) status = h5_write_text(file, "material_sha256", c->melt.sha256, "of the melt's material", err);
  free(absolute);
  return status;
}

static CastStatus write_particles(const Sim *sim, hid_t file, CastError *err)
{
  const Particles *p = &sim->particles;
  ParticleField field[PARTICLE_FIELDS];
  particles_fields(p, field);
  for (int f = 0; f < PARTICLE_FIELDS; f++) {
    char name[64];
    snprintf(name, sizeof name, "particles/%s", field[f].name);
    CAST_CALL(write_doubles(file, name, (size_t)p->n, field[f].data, field[f].unit, "melt, then walls", err));
  }
  const hsize_t shape[1] = {(hsize_t)p->n};
  CAST_CALL(h5_write(file, "particles/id", H5T_NATIVE_INT32, 1, shape, p->id, "1", "a particle's number", err));
  const long long n_fluid = p->n_fluid;
  return h5_write(file, "particles/n_melt", H5T_NATIVE_LLONG, 0, NULL, &n_fluid, "1", "how many of them are melt", err);
}

/* Of the heat record: rows written and the interval begun. */
static CastStatus write_record(const Sim *sim, hid_t file, CastError *err)
{
  const size_t n = sim_output_record_size(sim);
  if (n == 0) return CAST_OK;
  double *state = malloc(n * sizeof *state);
  CAST_CHECK(state, err, CAST_ERR_MEMORY, "no memory for the heat record");
  sim_output_save_record(sim, state);
  const CastStatus status =
      write_doubles(file, "record", n, state, "", "the heat record's rows and open interval", err);
  free(state);
  return status;
}

static CastStatus write_output(const Sim *sim, hid_t file, CastError *err)
{
  double output[OUTPUT_STATE] = {0};
  sim_output_save(sim, output);
  CAST_CALL(write_record(sim, file, err));
  return write_doubles(file, "output", OUTPUT_STATE, output, "", "steps and bytes written, times of the next ones",
                       err);
}

static CastStatus write_all(const Sim *sim, hid_t file, CastError *err)
{
  CAST_CALL(write_identity(sim, file, err));
  CAST_CALL(write_particles(sim, file, err));
  for (int k = 0; k < N_PACKED; k++) CAST_CALL(write_packed(sim, &PACKED[k], file, err));
  return write_output(sim, file, err);
}

CastStatus sim_write_checkpoint(Sim *sim, const char *name, CastError *err)
{
  char path[4200], temporary[4300];
  snprintf(path, sizeof path, "%s/%s", sim_output_folder(sim), name);
  snprintf(temporary, sizeof temporary, "%s.part", path);
  hid_t file = -1;
  sim_cool_keep(sim);
  CAST_CALL(h5_file_create(temporary, &file, err));
  CastStatus status = write_all(sim, file, err);
  const CastStatus closed = h5_file_close(&file, status == CAST_OK ? err : NULL);
  if (status == CAST_OK) status = closed;
  if (status == CAST_OK && rename(temporary, path) != 0)
    status = cast_error_set(err, CAST_ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
  if (status != CAST_OK) remove(temporary);
  return status;
}

/* ---- reading ---- */

static CastStatus check_format(hid_t file, const char *path, CastError *err)
{
  char *format = NULL;
  int version = 0;
  CAST_CALL(h5_read_text_attribute(file, "format", &format, err));
  const bool ours = strcmp(format, FORMAT) == 0;
  free(format);
  CAST_CHECK(ours, err, CAST_ERR_FORMAT, "%s: is not a checkpoint of castrun", path);
  CAST_CALL(h5_read_attribute(file, "version", H5T_NATIVE_INT, 1, &version, err));
  CAST_CHECK(version == FORMAT_VERSION, err, CAST_ERR_FORMAT, "%s: is of version %d, this castrun reads %d", path,
             version, FORMAT_VERSION);
  return CAST_OK;
}

static CastStatus read_config(hid_t file, CastConfig **config, CastError *err)
{
  char *text = NULL, *path = NULL;
  CastStatus status = h5_read_text(file, "input", &text, err);
  if (status == CAST_OK) status = h5_read_text(file, "input_path", &path, err);
  if (status == CAST_OK) status = cast_config_read(path, text, config, err);
  free(text);
  free(path);
  return status;
}

static CastStatus same_text(hid_t file, const char *name, const char *expected, const char *what, CastError *err)
{
  char *text = NULL;
  CAST_CALL(h5_read_text(file, name, &text, err));
  const bool same = strcmp(text, expected) == 0;
  free(text);
  CAST_CHECK(same, err, CAST_ERR_INPUT, "%s is not the one the run began with (its hash differs): the run cannot go on",
             what);
  return CAST_OK;
}

static CastStatus restore_particles(Sim *sim, hid_t file, CastError *err)
{
  Particles *p = &sim->particles;
  void *read = NULL;
  CAST_CALL(h5_read(file, "particles/n_melt", H5T_NATIVE_LLONG, 0, NULL, &read, err));
  const ptrdiff_t n_melt = (ptrdiff_t) * (long long *)read, n_wall = p->n - p->n_fluid;
  free(read);
  CAST_CHECK(n_melt >= 0 && n_melt <= sim->n_ids, err, CAST_ERR_FORMAT,
             "particles/n_melt is %td, at most %td are expected", n_melt, sim->n_ids);
  if (n_melt > p->n_fluid) CAST_CALL(particles_add(p, n_melt - p->n_fluid, err));
  p->n_fluid = n_melt;
  p->n = n_melt + n_wall;
  ParticleField field[PARTICLE_FIELDS];
  particles_fields(p, field);
  for (int f = 0; f < PARTICLE_FIELDS; f++) {
    char name[64];
    snprintf(name, sizeof name, "particles/%s", field[f].name);
    CAST_CALL(read_doubles(file, name, (size_t)p->n, field[f].data, err));
  }
  hsize_t shape[1] = {(hsize_t)p->n};
  CAST_CALL(h5_read(file, "particles/id", H5T_NATIVE_INT32, 1, shape, &read, err));
  memcpy(p->id, read, (size_t)p->n * sizeof *p->id);
  free(read);
  for (ptrdiff_t i = 0; i < n_melt; i++)
    CAST_CHECK(p->id[i] >= 0 && p->id[i] < sim->n_ids, err, CAST_ERR_FORMAT, "particles/id[%td] is %d", i, p->id[i]);
  return CAST_OK;
}

static CastStatus restore_record(Sim *sim, hid_t file, CastError *err)
{
  hsize_t shape[1] = {0};
  void *state = NULL;
  if (!h5_exists(file, "record")) return CAST_OK;
  CAST_CALL(h5_read(file, "record", H5T_NATIVE_DOUBLE, 1, shape, &state, err));
  const CastStatus status = sim_output_reopen_record(sim, shape[0], state, err);
  free(state);
  return status;
}

/* Lists and contacts made anew from the restored places are those that the run had. */
static CastStatus restore(Sim *sim, hid_t file, const char *command, CastError *err)
{
  double output[OUTPUT_STATE];
  CAST_CALL(same_text(file, "rom_sha256", sim->rom_sha256, sim->config->rom_path, err));
  CAST_CALL(same_text(file, "material_sha256", sim->config->melt.sha256, "the melt's material", err));
  CAST_CALL(read_doubles(file, "output", OUTPUT_STATE, output, err));
  CAST_CALL(sim_output_reopen(sim, command, output, err));
  CAST_CALL(restore_record(sim, file, err));
  CAST_CALL(restore_particles(sim, file, err));
  for (int k = 0; k < N_PACKED; k++) CAST_CALL(read_packed(sim, &PACKED[k], file, err));
  if (sim->counts.stage == STAGE_COOL) return sim_cool_resume(sim, err);
  CAST_CALL(neighbours_update(sim->neighbours, &sim->particles, true, &sim->rebuilt, err));
  CAST_CALL(sim_rebuild(sim, err));
  filling_update(sim->filling, &sim->particles, sim->counts.time);
  sim->rebuilt = true;
  sim->under_way = true;
  return CAST_OK;
}

/* The run goes on in the folder that the checkpoint lies in, wherever that has been moved to. */
static CastStatus set_folder(CastConfig *config, const char *folder, CastError *err)
{
  free(config->output.folder);
  config->output.folder = strdup(folder);
  CAST_CHECK(config->output.folder, err, CAST_ERR_MEMORY, "no memory");
  return CAST_OK;
}

CastStatus sim_resume(const char *folder, Log *log, const char *command, CastConfig **config, Sim **sim, CastError *err)
{
  char path[4200];
  snprintf(path, sizeof path, "%s/checkpoint.h5", folder);
  *config = NULL;
  *sim = NULL;
  CAST_CHECK(access(path, R_OK) == 0, err, CAST_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
  hid_t file = -1;
  CAST_CALL(h5_file_open(path, &file, err));
  CastStatus status = check_format(file, path, err);
  if (status == CAST_OK) status = read_config(file, config, err);
  if (status == CAST_OK) status = set_folder(*config, folder, err);
  if (status == CAST_OK) status = sim_create(*config, log, sim, err);
  if (status == CAST_OK) status = restore(*sim, file, command, err);

  const CastStatus closed = h5_file_close(&file, status == CAST_OK ? err : NULL);
  if (status == CAST_OK) status = closed;
  if (status != CAST_OK) {
    sim_destroy(sim);
    cast_config_destroy(config);
  }
  return status;
}
