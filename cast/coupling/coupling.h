/* coupling.h - heat between melt and mould: steps 2 and 3 of the loop, and the independent energy ledger.
 * surface:  q_il = A_il (T_i - T_l)/(1/h_contact + d_il/kappa_i): fluid particle i, patch l, d_il the distance to the
 *           wall there, T_l the patch temperature; A_il = 2 V_i sum_j V_j F_ij (r_ij . n_j) over the patch's wall
 *           particles (2 V_i |sum V_j grad W_ij| where the wall is flat), normalised so that a patch's areas add up
 *           to its wetted area. The mould's own conductivity does not enter.
 * embedded: wall particles take the mould's temperature at their own place (ROM basis, band tetrahedra) and exchange by
 *           the pair formula, 1/h_contact in series; the heat goes to the patch of the wall particle's foot.
 * One step of a run:
 *   neighbours_update; if it rebuilt: coupling_rebuild
 *   sph_rates
 *   coupling_advance           heat of the walls added to particles->heat, the mould one step on
 *   sph_finish */
#ifndef CAST_COUPLING_COUPLING_H
#define CAST_COUPLING_COUPLING_H

#include "cast/coupling/contact_law.h"
#include "cast/geometry/surface.h"
#include "cast/mould/rom_state.h"
#include "cast/particles/neighbours.h"
#include "cast/physics/sph.h"

typedef enum CouplingKind { COUPLING_SURFACE, COUPLING_EMBEDDED } CouplingKind;

typedef struct CouplingParameters {
  CouplingKind kind;
  double h_contact;  // W/(m2 K); INFINITY: perfect contact (the paper); not used where `contact` is given
  bool mould_frozen; // the mould keeps its preheat temperature (to measure what the mould solve costs and changes)
  double mould_interval; // s: the mould takes a step with the heat of all the melt's steps in at most this time; 0: with
                         // each of the melt's; INFINITY: as often as accuracy and stability ask and its cost
                         // allows. `surface` only
  const ContactLaws *contact; // borrowed; laws by surface, temperature, solid fraction; NULL: h_contact everywhere
} CouplingParameters;

typedef struct Coupling Coupling;

/* particles' E must be set: the ledger starts here.
 *   sph, rom, surface  borrowed, must outlive the coupling; surface may be NULL for `embedded`, which then tells no
 *                      wetted area
 * Errors: CAST_ERR_ARGUMENT; CAST_ERR_INPUT for h_contact <= 0 and for laws that do not fit the ROM or the melt, and
 * for `embedded` where the ROM has no band or several mould materials of different conductivity; CAST_ERR_MEMORY. */
CastStatus coupling_create(const CouplingParameters *parameters, const SphParameters *sph, const RomData *rom,
                           const Surface *surface, const Particles *particles, Coupling **coupling, CastError *err);
void coupling_destroy(Coupling **coupling);
/* After neighbours_update rebuilt its lists: who touches which patch, wetted areas. Errors: CAST_ERR_MEMORY. */
CastStatus coupling_rebuild(Coupling *coupling, const Particles *particles, const Neighbours *neighbours,
                            CastError *err);

/* The exchange over one step and the mould's step. Adds the (mean) heat from the mould to particles->heat (W) and
 * leaves the (mean) patch flows in coupling_flow. Where the plain staggered exchange would be unstable (stiffness
 * above 0.5, or a particle that the wall would overshoot), exchange and mould take n equal sub-steps: the particles
 * near the wall change their enthalpy by the wall's heat and their share of the heat already in particles->heat
 * (conduction), and take its temperature; all else stands still meanwhile.
 * Errors: CAST_ERR_ARGUMENT where coupling_rebuild was missed; CAST_ERR_NUMERIC where 4096 sub-steps are not enough. */
CastStatus coupling_advance(Coupling *coupling, RomState *state, Particles *particles, const Neighbours *neighbours,
                            double dt, CastError *err);
long coupling_substeps(const Coupling *coupling); // of the last coupling_advance
/* The mould brought up to date with the melt, where it lags behind (mould_interval): before its state is looked at. */
void coupling_settle(Coupling *coupling, RomState *state);
/* Patch temperatures as the melt feels them, K [m]: those of the state, or where it lags behind their prediction. */
const double *coupling_patch_temperature(const Coupling *coupling, const RomState *state);
/* The interval, s, at which the mould would be stepped now with melt steps of dt. */
double coupling_mould_interval(Coupling *coupling, const RomState *state, ptrdiff_t n_fluid, double dt);

/* The two halves of a plain step, for callers that watch stability themselves.
 * exchange: add the heat from the mould to particles->heat (W) and fill the patch flows q [m] W (into the mould). The
 * power the fluid loses equals the sum of q to rounding; sums are in double, in a fixed order. Sets T of wall
 * particles. */
void coupling_exchange(Coupling *coupling, const RomState *state, Particles *particles, const Neighbours *neighbours);
/* Advance the mould by dt with the flows just gathered (the update is exact for constant flows). */
void coupling_step_mould(Coupling *coupling, RomState *state, Particles *particles, double dt);

const double *coupling_flow(const Coupling *coupling);                // [m] W
double coupling_wetted_area(const Coupling *coupling, size_t patch);  // m2, of the last rebuild
double coupling_contact_area(const Coupling *coupling, size_t patch); // m2, sum of the areas A_il (0 for embedded)

/* The largest effective conductance that the mould may meet with the melt where it was in the last exchange, W/(m2 K):
 * over patches, of (sum of a patch's conductances)/(its area), each with the largest h that its contact law has. */
double coupling_conductance(const Coupling *coupling);
/* Is a plain step of dt stable, with the largest conductances that its contacts may have? stiffness: largest eigenvalue
 * of D^(1/2) G(dt) D^(1/2), see rom_state.h; the limit is 0.5. */
bool coupling_check_stability(const Coupling *coupling, const RomState *state, double dt, double *stiffness);

/* Melt + mould (1^T E V z) + lost, against the start: what a run's books show. */
typedef struct EnergyLedger {
  double melt_start, melt_now; // J
  double mould_now;            // J above preheat, from the state, and what is on its way there
  double lost;                 // J to the surroundings; with a frozen mould what went into that
  double exchanged;            // J, sum over steps and patches of |q| dt
  double removed;              // J carried by melt that left through an opening (0 if none)
  double added;                // J carried by melt that came in since the start
  double residual;             // J: melt_now - melt_start + mould_now + lost + removed - added
} EnergyLedger;
EnergyLedger coupling_ledger(const Coupling *coupling, const RomState *state, const Particles *particles);
/* Melt left, or came in, with this enthalpy, J. */
void coupling_record_removed(Coupling *coupling, double joules);
void coupling_record_added(Coupling *coupling, double joules);

/* ---- for the cooling stage, which solves melt and mould together ---- */

/* The melt's contacts with the patches, and their conductances with melt and mould as they are. Borrowed, until the
 * next rebuild; conductances until the next call of coupling_conductances. */
typedef struct CouplingContacts {
  ptrdiff_t n_near;                           // fluid particles with contacts
  const int32_t *near;                        // [n_near] their indices, ascending
  const ptrdiff_t *first;                     // [n_near + 1] into the contacts
  const int32_t *patch;                       // [first[n_near]]
  const double *conductance;                  // [first[n_near]] W/K
  const ptrdiff_t *of_patch_start, *of_patch; // [m + 1], contacts of each patch, ascending
} CouplingContacts;
/* From now on `surface`, whatever the coupling was: its exchange is symmetric, what the melt gives a patch comes back
 * as that patch's temperature, and heat that has gone deeper than the particle spacing makes the two kinds agree.
 * coupling_rebuild must follow. */
void coupling_use_surface(Coupling *coupling);
bool coupling_mould_frozen(const Coupling *coupling);
/* From the particles' T and kappa. */
CouplingContacts coupling_conductances(Coupling *coupling, const Particles *particles);
/* Mean flows q [m] W over the last dt s, after which the mould is in `state`: they go into the books, coupling_flow
 * tells them, and wall particles show the mould's temperature. */
void coupling_record_flows(Coupling *coupling, const RomState *state, Particles *particles, const double *q, double dt);

/* For checkpoints: everything that changes during a run and is not made anew by coupling_rebuild. */
size_t coupling_size(const Coupling *coupling); // doubles
void coupling_save(const Coupling *coupling, double *buffer);
/*  state  restored before */
void coupling_restore(Coupling *coupling, const RomState *state, const double *buffer);
#endif
