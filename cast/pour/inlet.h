/* inlet.h - melt that comes in through an inlet, layer by layer.
 * An inlet is a disc or rectangle in space. Behind it stands a buffer of melt, as many layers of particles as the
 * kernel reaches over, which moves at the inlet's speed, whatever forces act on it. A layer that has passed the inlet
 * is free; when the last has moved by a spacing, a new one is put behind it. So melt in front never sees anything else
 * than melt that goes on evenly behind it, and nothing is ever put into melt that is there: there is no shock. The
 * buffer's pressure is that of the free melt in front, column by column (none where there is no melt or it pulls): its
 * own continuity would follow what walls do behind it. Heat it conducts like all melt.
 * How far the buffer has moved by a time is an integral of the input's table, and a particle's place in it follows from
 * its id: an inlet has next to no state, and a resumed run the same bits. */
#ifndef CAST_POUR_INLET_H
#define CAST_POUR_INLET_H

#include "cast/geometry/placement.h"
#include "cast/physics/sph.h"
#include "common/table.h"

typedef enum InletRate { INLET_VELOCITY, INLET_FLOW, INLET_MASS_FLOW } InletRate;

typedef struct InletConfig {
  bool disc;            // else a rectangle
  double centre[3];     // m
  double direction[3];  // unit, in which melt comes in: the normal
  double radius;        // m, of the disc
  double along[3];      // unit, across the direction: the rectangle's width goes along it
  double width, height; // m
  InletRate kind;       //
  Table rate;           // s -> m/s, m3/s or kg/s, not negative
  Table temperature;    // s -> K
  bool stays;           // the buffer stays as a plug once nothing more comes; else it is taken away
} InletConfig;

typedef struct Inlet {
  const InletConfig *config; // borrowed
  ptrdiff_t n, in_shape;     // particles of a layer; those that there would be without the mould
  double *at[3];             // [n] m, where they pass the inlet
  double *front;             // [n] kg/m3, density in front of each; [n] more: scratch
  int layers;                // of the buffer
  double spacing;            // m
  double speed_per_rate;     // m/s for a rate of 1
  int32_t first_id, next_id; // of the buffer at the start; of layers made later
  // state
  ptrdiff_t made; // layers so far, the buffer's at the start included
  bool over;      // the buffer has been taken away
} Inlet;

/* Where its layers stand.
 *   clear   borrowed: must stay clear of it
 * Errors: CAST_ERR_INPUT where the mould leaves no room for it; CAST_ERR_MEMORY. */
CastStatus inlet_create(const InletConfig *config, const SphParameters *sph, const Surface *surface, Inlet *inlet,
                        CastError *err);
void inlet_destroy(Inlet *inlet);
double inlet_speed(const Inlet *inlet, double time); // m/s
double inlet_way(const Inlet *inlet, double time);   // m, moved since the time 0
double inlet_end(const InletConfig *config);         // s, after which nothing comes any more; INFINITY: none
ptrdiff_t inlet_most_layers(const Inlet *inlet, double end);
/* Append the places of the buffer at the time 0. Errors: CAST_ERR_INPUT where melt stands there already. */
CastStatus inlet_add_buffer(const Inlet *inlet, PointSet *points, CastError *err);

/* Is the particle with this id part of the buffer at this time? layer, column (may be NULL): which. */
bool inlet_holds(const Inlet *inlet, double time, int32_t id, ptrdiff_t *layer, ptrdiff_t *column);
/* Put the buffer where it belongs at this time, with its speed. */
void inlet_place(const Inlet *inlet, double time, Particles *particles);
/* Look at the melt in front: at the end of a step, before the two below. */
void inlet_sense(const Inlet *inlet, const SphParameters *sph, double time, const Particles *particles);
/* Make the buffer's particles go on at the speed that they have, whatever moves others, with the density in front. */
void inlet_carry(const Inlet *inlet, const SphParameters *sph, double time, Particles *particles);
/* Add the layers that are due at this time behind the buffer; returns how many particles in `added` and what enthalpy
 * they bring, J, is added to *joules. Neighbour lists must be made anew. Errors: CAST_ERR_MEMORY. */
CastStatus inlet_feed(Inlet *inlet, const SphParameters *sph, double time, Particles *particles, ptrdiff_t *added,
                      double *joules, CastError *err);

#endif
