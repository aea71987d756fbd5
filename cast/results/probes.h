/* probes.h - temperatures at fixed places: of the melt where there is melt, of the mould where its near-wall band is.
 */
#ifndef CAST_RESULTS_PROBES_H
#define CAST_RESULTS_PROBES_H

#include "cast/geometry/surface.h"
#include "cast/mould/rom_state.h"
#include "cast/particles/particles.h"
#include "cast/physics/sph.h"

typedef enum ProbeHome { PROBE_CAVITY, PROBE_BAND, PROBE_DEEP } ProbeHome; // DEEP: in the mould, beyond the band

typedef struct Probes Probes;

/*  x     [n][3] m
 *  rom   borrowed while created
 *  sph   the melt's kernel and smoothing length are taken */
CastStatus probes_create(size_t n, const double (*x)[3], const RomData *rom, const Surface *surface,
                         const SphParameters *sph, Probes **probes, CastError *err);
void probes_destroy(Probes **probes);
ProbeHome probes_home(const Probes *probes, size_t i);
/* Melt: sum V_j T_j W_j / sum V_j W_j where sum V_j W_j is at least a quarter (beside a wall half the kernel is mould),
 * else NAN. K. */
double probes_melt_temperature(const Probes *probes, size_t i, const Particles *particles);
/* Mould, K; NAN outside its band. */
double probes_mould_temperature(const Probes *probes, size_t i, const RomState *state);

#endif
