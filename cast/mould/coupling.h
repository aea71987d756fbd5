/* coupling.h - heat between melt and mould: steps 2 and 3 of the loop, and the independent energy ledger.
 * surface:  q_i = (T_i - T_l)/(1/h_contact + d_i/kappa_i) on an area A_i, d_i the distance to the wall, T_l the patch
 *           temperature; A_i = 2 V_i |sum_wall V_j grad W_ij|, normalised so that a patch's areas add up to its wetted area.
 * embedded: wall particles take the mould's temperature at their own place (ROM basis, band tetrahedra) and exchange by
 *           the pair formula, 1/h_contact in series. */
#ifndef CAST_MOULD_COUPLING_H
#define CAST_MOULD_COUPLING_H

#include "cast/geometry/surface.h"
#include "cast/mould/rom_state.h"
#include "cast/particles/neighbours.h"
#include "cast/physics/sph.h"

typedef enum CouplingKind { COUPLING_SURFACE, COUPLING_EMBEDDED } CouplingKind;

typedef struct CouplingParameters {
  CouplingKind kind;
  double h_contact; // W/(m2 K); INFINITY: perfect contact (the paper)
  bool mould_frozen; // the mould keeps its preheat temperature (to measure what the mould solve costs and changes)
} CouplingParameters;

typedef struct Coupling Coupling;

/*  surface, rom  borrowed. Wall particles' temperatures (embedded) and nearest triangles are kept inside. */
CastStatus coupling_create(const CouplingParameters *parameters, const SphParameters *sph, const RomData *rom,
                           const Surface *surface, const Particles *particles, Coupling **coupling, CastError *err);
void coupling_destroy(Coupling **coupling);
/* After neighbours_update rebuilt its lists: nearest triangles, wetted areas. */
CastStatus coupling_rebuild(Coupling *coupling, const Particles *particles, const Neighbours *neighbours, CastError *err);
/* Add the heat from the mould to particles->heat (W) and fill the patch flows q [m] W (into the mould). The power the
 * fluid loses equals the sum of q to rounding; sums are in double, in a fixed order. */
void coupling_exchange(Coupling *coupling, const RomState *state, Particles *particles, const Neighbours *neighbours);
const double *coupling_flow(const Coupling *coupling); // [m] W
double coupling_wetted_area(const Coupling *coupling, size_t patch); // m2
/* Advance the mould by dt with the flows just gathered (sub-cycling is not needed for one constant flow: the update is
 * exact); refresh wall temperatures. */
void coupling_step_mould(Coupling *coupling, RomState *state, Particles *particles, double dt);
/* The effective conductance that the exchange presents to the mould, W/(m2 K), for the stability check. */
double coupling_conductance(const Coupling *coupling);

/* Melt + mould (1^T E V z) + lost, against the start: what a run's books show. */
typedef struct EnergyLedger {
  double melt_start, melt_now; // J
  double mould_now;            // J above preheat, from the state
  double lost;                 // J to the surroundings
  double exchanged;            // J, sum over steps and patches of |q| dt
  double removed;              // J carried by melt that left through an opening (0 if none)
  double residual;             // J: melt_now - melt_start + mould_now + lost + removed
} EnergyLedger;
EnergyLedger coupling_ledger(const Coupling *coupling, const RomState *state, const Particles *particles);
#endif
