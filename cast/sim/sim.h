/* sim.h - one casting: melt, mould and what is written of them.
 *   sim_create -> sim_report -> sim_open_output -> sim_run -> sim_destroy            castrun run
 *   sim_create -> sim_report -> sim_destroy                                          castrun check
 *   sim_resume -> sim_run -> sim_destroy                                             castrun resume */
#ifndef CAST_SIM_SIM_H
#define CAST_SIM_SIM_H

#include <signal.h>
#include "cast/config/config.h"
#include "common/log.h"

typedef struct Sim Sim;

typedef enum SimEnd { SIM_FINISHED, SIM_INTERRUPTED, SIM_EMPTY } SimEnd; // EMPTY: all melt has left

/* Read the ROM, place walls and melt, and evaluate the first forces. Writes nothing.
 *   config, log  borrowed, must outlive sim; log NULL: silent
 * Errors: those of rom_read and of the geometry; CAST_ERR_INPUT where melt and mould do not fit together. */
CastStatus sim_create(const CastConfig *config, Log *log, Sim **sim, CastError *err);
void sim_destroy(Sim **sim);

/* What is about to be computed, to the log: particles, thinnest gap, volumes, sound speed, time step, number of steps;
 * with warnings where the numbers do not fit the case. */
CastStatus sim_report(Sim *sim, CastError *err);

/* Make (or replace) the files of a run in config->output.folder, which exists.
 *   command  the command line, for provenance */
CastStatus sim_open_output(Sim *sim, const char *command, CastError *err);

/* One time step. Errors: CAST_ERR_NUMERIC, naming the particle, its place, the value and the time. */
CastStatus sim_step(Sim *sim, CastError *err);

/* Step to the end, writing what is due. *stop (may be NULL) set by a signal handler: a checkpoint is written at the
 * next rebuild of the neighbour lists, where it does not disturb the run, and the run ends as SIM_INTERRUPTED. On an
 * error a state for inspection is left in checkpoint-failed.h5 and the files are brought up to date. */
CastStatus sim_run(Sim *sim, const volatile sig_atomic_t *stop, SimEnd *end, CastError *err);

/* Read FOLDER/checkpoint.h5 and go on from there with the same bits as a run that was never interrupted. ROM and
 * material must be those of the run. *config is made from the run's own input text; the caller destroys it after the
 * sim. */
CastStatus sim_resume(const char *folder, Log *log, const char *command, CastConfig **config, Sim **sim,
                      CastError *err);

/* Write folder/checkpoint.h5 the next time the lists are rebuilt. */
void sim_request_checkpoint(Sim *sim);

double sim_time(const Sim *sim);
/* Why and when, s, the second stage began: "rest", "locked", "time"; "" and NAN: it has not. */
const char *sim_switched(const Sim *sim, double *time);
long sim_steps(const Sim *sim);
const Particles *sim_particles(const Sim *sim);
const RomState *sim_mould(const Sim *sim);
EnergyLedger sim_ledger(const Sim *sim);
double sim_filled_fraction(const Sim *sim);

#endif
