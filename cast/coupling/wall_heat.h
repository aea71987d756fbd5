/* wall_heat.h - where on the cavity wall a step's heat came in: the power of each contact, given to the wall particles
 * of its patch in the proportion in which they make up the contact's conductance, and from each to the triangle that
 * its foot is on. Finer than patches, as fine as the melt's own resolution: for the record that tells what lumping
 * costs. */
#ifndef CAST_COUPLING_WALL_HEAT_H
#define CAST_COUPLING_WALL_HEAT_H

#include "cast/coupling/coupling.h"

typedef struct WallHeat WallHeat;

/*  rom  borrowed, must outlive it. Errors: CAST_ERR_MEMORY. */
CastStatus wall_heat_create(const RomData *rom, const Surface *surface, const Particles *particles, WallHeat **heat,
                            CastError *err);
void wall_heat_destroy(WallHeat **heat);
size_t wall_heat_n(const WallHeat *heat);                 // triangles of the cavity
const int32_t *wall_heat_triangles(const WallHeat *heat); // [n] of the ROM, ascending
/* Powers [n], W, of the last coupling_advance; the sum over a patch is its flow to rounding. To be asked in the step of
 * each coupling_rebuild, for that is when the shares are found. Errors: CAST_ERR_MEMORY. */
CastStatus wall_heat_power(WallHeat *heat, const Coupling *coupling, const Particles *particles,
                           const Neighbours *neighbours, const double **power, CastError *err);

#endif
