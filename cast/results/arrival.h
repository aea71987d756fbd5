/* arrival.h - when the melt first came to each place of the cavity, and how warm it was there and then.
 * Places: the cells of the cavity (filling.h), reached while a particle is within 0.9 of their edge of the middle of
 * their void part; and the triangles of the cavity wall, reached when a particle stands before their middle: less than
 * 1.25 spacings high over the plane (melt at rest on any lattice has its first layer below 1.4), less than 0.87 beside
 * (half a lattice square's diagonal and a little). Temperature: of the particle nearest to the place in the first look
 * that found one. Times are those of the looks. */
#ifndef CAST_RESULTS_ARRIVAL_H
#define CAST_RESULTS_ARRIVAL_H

#include "cast/geometry/placement.h"
#include "cast/particles/particles.h"

typedef struct Arrival Arrival;

/*  cells  borrowed, must outlive the arrival;  rom  borrowed for the call only;  spacing m;  n_fluid  at most so many
 * particles will be Errors: CAST_ERR_MEMORY. */
CastStatus arrival_create(const CavityCells *cells, const RomData *rom, double spacing, ptrdiff_t n_fluid,
                          Arrival **arrival, CastError *err);
void arrival_destroy(Arrival **arrival);
void arrival_update(Arrival *arrival, const Particles *particles, double time); // s; after a step or a few

size_t arrival_n_triangles(const Arrival *arrival);                      // of the cavity wall
const int32_t *arrival_triangles(const Arrival *arrival);                // [n_triangles] of the ROM, ascending
double arrival_cell_time(const Arrival *arrival, ptrdiff_t cell);        // s; NAN: not reached
double arrival_cell_temperature(const Arrival *arrival, ptrdiff_t cell); // K
double arrival_triangle_time(const Arrival *arrival, ptrdiff_t i);       // of arrival_triangles[i]
double arrival_triangle_temperature(const Arrival *arrival, ptrdiff_t i);
const double *arrival_triangle_place(const Arrival *arrival, ptrdiff_t i);  // [3] m, its middle
const double *arrival_triangle_normal(const Arrival *arrival, ptrdiff_t i); // [3] into the cavity

/* For checkpoints. */
size_t arrival_size(const Arrival *arrival); // doubles
void arrival_save(const Arrival *arrival, double *buffer);
void arrival_restore(Arrival *arrival, const double *buffer);

#endif
