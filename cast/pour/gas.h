/* gas.h - gas that presses on the melt's free surface.
 * Void that is connected with a given box, round melt and mould, holds gas at a pressure p above that in the rest of
 * the unfilled cavity: the air over a cup under pressure, or the atmosphere where the cavity is pumped out. Which void
 * that is follows from where the melt stands: as long as gas can pass, it is everywhere and drives nothing; once melt
 * closes a section it drives what lies before it; where it breaks through, the difference is gone. Void that melt has
 * cut off from the box counts as unfilled cavity.
 * Method   lattice cells of the particles' spacing; those within 1.1 spacings of a particle are melt, those whose
 * middle lies in the mould are solid, the rest is flooded from the box through common faces. Particles within GAS_REACH
 * cells of the flooded ones take dv_i/dt = (2 p/rho_i) sum_j V_j grad W_ij over all neighbours, melt and wall. Inside,
 * the sum is zero; summed over the layers under a flat surface it is the traction p, exactly, since a kernel's
 * one-sided integral is one half. It is what the pressure force of (15) misses where neighbours are missing and p_i is
 * p: melt under even pressure p and gas of p is in equilibrium pair by pair. (docs/theory, eq. 15b) A film thinner than
 * GAS_REACH spacings feels the gas on both its sides. */
#ifndef CAST_POUR_GAS_H
#define CAST_POUR_GAS_H

#include "cast/physics/sph.h"
#include "common/table.h"

enum { GAS_REACH = 5 };

typedef struct GasConfig {
  Table pressure;            // s -> Pa, above that in the unfilled cavity, not negative; n = 0: no gas
  double corner[3], size[3]; // m, a box that gas is in wherever there is no melt
} GasConfig;

typedef struct Gas Gas;

/*  low, high  m, the box that is looked at; gas does not pass its faces
 *  surface    borrowed, NULL: no mould
 * Errors: CAST_ERR_INPUT where the box of the input holds nothing but mould; CAST_ERR_MEMORY. */
CastStatus gas_create(const GasConfig *config, const Surface *surface, double spacing, const double low[3],
                      const double high[3], Gas **gas, CastError *err);
void gas_destroy(Gas **gas);
/* Where it is now: after neighbour lists were made anew. Errors: CAST_ERR_MEMORY. */
CastStatus gas_rebuild(Gas *gas, const Particles *particles, CastError *err);
/* Add the acceleration by a pressure (Pa) to a: after sph_rates. */
void gas_push(const Gas *gas, const SphParameters *sph, const Neighbours *neighbours, double pressure,
              Particles *particles);
bool gas_is_at(const Gas *gas, const double x[3]); // in the cell of x

#endif
