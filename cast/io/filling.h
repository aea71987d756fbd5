/* filling.h - how full the cavity and each of its named features is.
 * A lattice cell of the cavity counts as filled while a particle is within COVER of its edge length from the middle of
 * its void part: melt at rest on any lattice has a particle within sqrt(3)/2 of every place. Its volume goes to the
 * named surface nearest to it. */
#ifndef CAST_IO_FILLING_H
#define CAST_IO_FILLING_H

#include "cast/geometry/surface.h"
#include "cast/particles/particles.h"

enum { FILLING_LEVELS = 3 }; // 50, 90, 99 %
extern const double filling_levels[FILLING_LEVELS];

typedef struct Filling Filling;

CastStatus filling_create(const Surface *surface, const RomData *rom, double spacing, const double origin[3],
                          Filling **filling, CastError *err);
void filling_destroy(Filling **filling);
/* Say which features make up the part; without it the whole cavity counts. Errors: CAST_ERR_INPUT: no such feature. */
CastStatus filling_set_part(Filling *filling, size_t n, char (*names)[ROM_NAME_LENGTH], CastError *err);
/* Look at the melt at this time (s): refreshes the fractions and notes when a level was reached for the first time. */
void filling_update(Filling *filling, const Particles *particles, double time);
size_t filling_n_features(const Filling *filling);
const char *filling_name(const Filling *filling, size_t feature);
/* feature == filling_n_features: the part, or the whole cavity where no part is named. */
double filling_volume(const Filling *filling, size_t feature);          // m3
double filling_fraction(const Filling *filling, size_t feature);        // 1
double filling_time(const Filling *filling, size_t feature, int level); // s; NAN: not reached

size_t filling_state_size(const Filling *filling); // doubles; for checkpoints
void filling_save(const Filling *filling, double *state);
void filling_restore(Filling *filling, const double *state);

#endif
