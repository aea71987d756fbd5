/* filling.h - how full the cavity and each of its named features is. Features: the cavity's named surfaces in the ROM's
 * order, then boxes that the input names.
 * A lattice cell of the cavity counts as filled while a particle is within COVER of its edge length from the middle of
 * its void part: melt at rest on any lattice has a particle within sqrt(3)/2 of every place. Its volume goes to the
 * named surface nearest to it. */
#ifndef CAST_RESULTS_FILLING_H
#define CAST_RESULTS_FILLING_H

#include "cast/geometry/placement.h"
#include "cast/particles/particles.h"

enum { FILLING_LEVELS = 3 }; // 50, 90, 99 %
extern const double filling_levels[FILLING_LEVELS];

typedef struct Filling Filling;

typedef struct FeatureBox { // the cavity's cells in it, whichever surface is nearest
  char name[ROM_NAME_LENGTH];
  double low[3], high[3]; // m
} FeatureBox;

CastStatus filling_create(const Surface *surface, const RomData *rom, double spacing, const double origin[3],
                          Filling **filling, CastError *err);
void filling_destroy(Filling **filling);
/* Tell the filling of these boxes too, behind that of the surfaces. Before filling_set_part.
 * Errors: CAST_ERR_INPUT: a box without a cell of the cavity, or with the name of a surface. */
CastStatus filling_add_boxes(Filling *filling, size_t n, const FeatureBox *box, CastError *err);
/* Say which features make up the part; without it the whole cavity counts. Errors: CAST_ERR_INPUT: no such feature. */
CastStatus filling_set_part(Filling *filling, size_t n, char (*names)[ROM_NAME_LENGTH], CastError *err);
/* Look at the melt at this time (s): refreshes the fractions and notes when a level was reached for the first time. */
void filling_update(Filling *filling, const Particles *particles, double time);
size_t filling_n_features(const Filling *filling);
size_t filling_n_surfaces(const Filling *filling); // the features that do not overlap
const char *filling_name(const Filling *filling, size_t feature);
/* feature == filling_n_features: the part, or the whole cavity where no part is named. */
double filling_volume(const Filling *filling, size_t feature);          // m3
double filling_fraction(const Filling *filling, size_t feature);        // 1
double filling_time(const Filling *filling, size_t feature, int level); // s; NAN: not reached

const CavityCells *filling_cells(const Filling *filling);
bool filling_cell_is_filled(const Filling *filling, ptrdiff_t cell);             // at the last look
bool filling_cell_is_in(const Filling *filling, ptrdiff_t cell, size_t feature); // feature as above
ptrdiff_t filling_cell_of(const Filling *filling, const double x[3]);            // -1: x lies in none
/* The cell `step` lattice steps away, or -1 where the cavity has none. */
ptrdiff_t filling_neighbour(const Filling *filling, ptrdiff_t cell, const int step[3]);

size_t filling_state_size(const Filling *filling); // doubles; for checkpoints
void filling_save(const Filling *filling, double *state);
void filling_restore(Filling *filling, const double *state);

#endif
