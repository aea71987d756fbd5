/* wall_temperature.h - the mould's temperature where the wall particles are (embedded coupling). Internal to mould/. */
#ifndef CAST_COUPLING_WALL_TEMPERATURE_H
#define CAST_COUPLING_WALL_TEMPERATURE_H

#include "cast/mould/rom_state.h"
#include "cast/particles/neighbours.h"

typedef struct WallTemperature WallTemperature;

/* Errors: CAST_ERR_MEMORY; CAST_ERR_INPUT where there is no band, or not even a wall particle's foot lies in it. */
CastStatus wall_temperature_create(const RomData *rom, const Particles *particles, double spacing,
                                   WallTemperature **walls, CastError *err);
void wall_temperature_destroy(WallTemperature **walls);
/* Which wall particles melt is near to: only these are followed until the next call. */
void wall_temperature_select(WallTemperature *walls, const Neighbours *neighbours);
/* From the state, for the walls selected: T = T_preheat + sum_k basis_k z_k. */
void wall_temperature_update(WallTemperature *walls, const RomState *state);
const double *wall_temperature(const WallTemperature *walls); // [n_wall] K
bool wall_temperature_in_use(const WallTemperature *walls, ptrdiff_t wall);
const double *wall_temperature_depth(const WallTemperature *walls); // [n_wall] m below the foot, where it is taken
#endif
