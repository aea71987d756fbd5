/* sim_private.h - what the sim_*.c files share.
 *   sim.c         life, the step, the run        sim_setup.c   melt, walls and lattice at the start
 *   sim_report.c  what is about to be computed   sim_output.c  what is written and when
 *   sim_curves.c  the CSV files                  sim_summary.c the account at the end
 *   sim_cool.c    the second stage               sim_drive.c   the forces of the moment
 *   sim_pour.c    inlets and outlets             sim_defects.c where it may not be sound
 *   sim_resume.c  checkpoints                    sim_escape.c  melt that leaves, melt where none may be */
#ifndef CAST_SIM_SIM_PRIVATE_H
#define CAST_SIM_SIM_PRIVATE_H

#include <jansson.h>
#include <stdio.h>

#include "cast/cool/cool.h"
#include "cast/io/provenance.h"
#include "cast/physics/tension.h"
#include "cast/results/arrival.h"
#include "cast/results/filling.h"
#include "cast/results/freezing.h"
#include "cast/results/mould_results.h"
#include "cast/sim/sim.h"

typedef enum SimPhase {
  PHASE_MOVE,       // time step, drift, end of the step
  PHASE_NEIGHBOURS, // lists, contacts with patches
  PHASE_RATES,      // sums over pairs
  PHASE_MOULD,      // exchange with the mould and its step
  PHASE_OUTPUT,
  PHASE_COOL, // the second stage, but its output
  PHASE_COUNT
} SimPhase;

typedef struct SimOutput SimOutput; // sim_output.c

enum { STAGE_FILL, STAGE_COOL };
typedef enum SwitchReason { SWITCH_NONE, SWITCH_REST, SWITCH_LOCKED, SWITCH_TIME } SwitchReason;

/* What a run counts; all doubles, so that a checkpoint keeps it as one array. */
typedef struct SimCounts {
  double time; // s
  double dt;   // s of the step in progress
  double steps;
  double since_rebuild; // steps
  double particle_steps;
  double guarded;       // times a particle was set back to the wall
  double removed;       // particles that left
  double escaped;       // of them, other than through an outlet
  double removed_mass;  // kg
  double fastest;       // m/s, largest speed seen at an output
  double substeps_most; // of the exchange with the mould
  double limited_by[6]; // steps set by sound, force, viscosity, conduction, the input, capillary waves
  double wall;          // s of wall time in the loop so far
  double seconds[PHASE_COUNT];
  double stage;                        // STAGE_FILL or STAGE_COOL
  double kinetic, kinetic_peak, quiet; // J, J, s: since when it is at rest (below zero: it is not)
  double switched, reason, fill_wall;  // s, SwitchReason, s of wall time: when the second stage began
  double cool[COOL_SIZE];              // what the second stage keeps
} SimCounts;

typedef struct Poured {           // through an inlet since the start (without its buffer at the start), or an outlet
  double particles, mass, joules; // 1, kg, J
} Poured;

struct Sim {
  const CastConfig *config; // borrowed
  Log *log;                 // borrowed
  RomData *rom;
  char rom_sha256[65];
  Surface *surface;
  SphParameters sph;
  double origin[3]; // m, a corner of the lattice
  Particles particles;
  ptrdiff_t n_ids;                // ids of fluid particles are below it
  Inlet *inlet;                   // [config->n_inlets]
  uint8_t **outlet_patches;       // [config->n_outlets]
  Poured *poured;                 // [n_inlets + n_outlets]
  Tension *tension;               // NULL: none acts
  Gas *gas;                       // NULL: none presses
  double box_low[3], box_high[3]; // m; melt outside is taken out
  RomState *mould;
  OuterWalls *walls; // NULL: as in the ROM
  Neighbours *neighbours;
  Coupling *coupling;
  Filling *filling;
  Arrival *arrival;
  Freezing *freezing;
  Cool *cool; // NULL before the second stage
  SimCounts counts;
  bool rebuilt;   // the lists were made anew in the step in progress
  bool lists_stale; // they must be made anew in the next step
  bool under_way; // positions and lists of the step in progress are done, the rest is not
  bool checkpoint_wanted;
  double gap, gap_at[3]; // m, the thinnest place of the cavity
  double seconds_setup;
  SimOutput *output; // NULL: nothing is written
};

/* sim.c */
CastStatus sim_rebuild(Sim *sim, CastError *err); // what goes by the neighbour lists, once they are new

/* sim_setup.c */
CastStatus sim_setup_geometry(Sim *sim, CastError *err);  // rom, surface, lattice, sph
CastStatus sim_setup_particles(Sim *sim, CastError *err); // melt and walls

/* sim_drive.c */
void sim_set_forces(Sim *sim, double time); // gravity and spin of sim->sph
CastStatus sim_gas_create(Sim *sim, CastError *err);
void sim_gas_push(Sim *sim, double time); // after sph_rates
/* m2/s2: the most that gravity, spin and gas may do to a unit of mass on its way from where melt is at the start to the
 * farthest wall of the cavity, at any time of the filling. */
double sim_drive_gain(const Sim *sim);

/* sim_tension.c */
CastStatus sim_tension_create(Sim *sim, CastError *err);
void sim_tension_report(const Sim *sim);

/* sim_pour.c */
CastStatus sim_pour_create(Sim *sim, CastError *err);
CastStatus sim_pour_add_buffers(Sim *sim, PointSet *points, CastError *err); // behind the points there; and ids
void sim_pour_start(Sim *sim);                                               // their enthalpy and velocity
void sim_pour_destroy(Sim *sim);
void sim_pour_place(Sim *sim, double time);                   // after melt has moved
void sim_pour_carry(Sim *sim);                                // after forces are known
CastStatus sim_pour_feed(Sim *sim, CastError *err);           // at the end of a step
bool sim_pour_is_over(const Sim *sim);                        // nothing comes any more
CastStatus sim_pour_end(Sim *sim, CastError *err);            // whatever the input says
double sim_pour_passed(const Sim *sim, size_t k);             // particles, through inlet k so far
ptrdiff_t sim_pour_outlet(const Sim *sim, const double x[3]); // the outlet that melt at x has come to; -1: none
void sim_pour_left(Sim *sim, ptrdiff_t outlet, double mass, double joules); // a particle, through the outlet
size_t sim_pour_size(const Sim *sim);                                       // doubles; for checkpoints
void sim_pour_save(const Sim *sim, double *buffer);
void sim_pour_restore(Sim *sim, const double *buffer);
void sim_pour_print(const Sim *sim, FILE *out);
struct json_t *sim_pour_json(const Sim *sim, bool inlets); // new reference
void sim_pour_report(const Sim *sim);

/* sim_escape.c */
CastStatus sim_remove_escaped(Sim *sim, CastError *err);
void sim_remove_marked(Sim *sim, const uint8_t *leaves, ptrdiff_t gone); // gone: how many are marked
CastStatus sim_check_inside(const Sim *sim, CastError *err); // Errors: CAST_ERR_NUMERIC: melt in the mould's solid

/* sim_curves.c: the CSV files */
typedef struct SimCurves SimCurves;
enum { SIM_CURVES = 3 };
/* Tracers are the particles nearest to their places now, so the melt must stand as at the start.
 *   length  NULL: new files; else go on with those there after so many bytes of each */
CastStatus sim_curves_create(const Sim *sim, const double *length, SimCurves **curves, CastError *err);
void sim_curves_destroy(SimCurves **curves);
CastStatus sim_curves_row(SimCurves *curves, Sim *sim, CastError *err); // at the present time
void sim_curves_lengths(const SimCurves *curves, double length[SIM_CURVES]);

/* sim_output.c */
CastStatus sim_output_due(Sim *sim, CastError *err);    // what is due at the present time
CastStatus sim_output_stage(Sim *sim, CastError *err);  // a frame where a stage ends
CastStatus sim_output_finish(Sim *sim, CastError *err); // a last frame, side files and summary
CastStatus sim_output_record(Sim *sim, CastError *err); // the heat of the step in progress
void sim_output_destroy(SimOutput **output);
const char *sim_output_folder(const Sim *sim);
const Provenance *sim_output_provenance(const Sim *sim);
enum { OUTPUT_STATE = 8 };
void sim_output_save(const Sim *sim, double state[OUTPUT_STATE]);
/* The heat record's part of a checkpoint: 0 doubles where none is kept. */
size_t sim_output_record_size(const Sim *sim);
void sim_output_save_record(const Sim *sim, double *buffer);
CastStatus sim_output_reopen_record(Sim *sim, size_t n, const double *buffer, CastError *err); // after reopen
CastStatus sim_output_reopen(Sim *sim, const char *command, const double state[OUTPUT_STATE], CastError *err);

/* sim_cool.c */
double sim_end(const Sim *sim);                       // s, of the last stage
void sim_watch_rest(Sim *sim);                        // after each step of the filling
SwitchReason sim_fill_is_over(const Sim *sim);        // SWITCH_NONE: it is not
CastStatus sim_cool_begin(Sim *sim, CastError *err);  // the second stage, from now on
CastStatus sim_cool_resume(Sim *sim, CastError *err); // the same after particles, mould and counts were read
CastStatus sim_cool_step(Sim *sim, CastError *err);
CastStatus sim_cool_checkpoint(Sim *sim, CastError *err); // where one is wanted
bool sim_cool_is_over(const Sim *sim);
void sim_cool_keep(Sim *sim);                          // in the counts, what the second stage keeps
double sim_solid_part(const Sim *sim, double *locked); // mean solid fraction; locked (may be NULL): part of the melt

/* sim_resume.c */
CastStatus sim_write_checkpoint(Sim *sim, const char *name, CastError *err);

/* sim_defects.c: misrun and cold shut */
CastStatus sim_write_maps(Sim *sim, const char *results, MouldResults *mould, CastError *err); // mould may be NULL
void sim_print_defects(FILE *out, const Sim *sim);
void sim_add_defects(const Sim *sim, json_t *features); // to the objects of the filling's features

/* sim_summary.c */
CastStatus sim_write_summary(const Sim *sim, const char *outcome, CastError *err);

#endif
