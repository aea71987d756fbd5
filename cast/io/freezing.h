/* freezing.h - when each particle of the melt froze.
 *   liquidus time        when its temperature last fell below the liquidus, s
 *   solidus time         when it last fell below the solidus, s
 *   solidification time  local: from the one to the other, s
 *   cooling rate         mean over the freezing range, (T_liquidus - T_solidus)/solidification time, K/s
 * NAN where that has not come about. A particle that is remelted loses what it had: above the solidus its solidus time,
 * above the liquidus both. Times are interpolated linearly between two updates. */
#ifndef CAST_IO_FREEZING_H
#define CAST_IO_FREEZING_H

#include "cast/particles/particles.h"
#include "common/material.h"

typedef struct Freezing Freezing;

typedef enum FreezingField {
  FREEZING_LIQUIDUS_TIME,
  FREEZING_SOLIDUS_TIME,
  FREEZING_SOLIDIFICATION_TIME,
  FREEZING_COOLING_RATE,
  FREEZING_FIELDS
} FreezingField;

/*  melt  borrowed; of a melt that has no freezing range nothing is ever known
 *  n_ids  ids of particles are below it.   Errors: CAST_ERR_MEMORY */
CastStatus freezing_create(const Material *melt, ptrdiff_t n_ids, Freezing **freezing, CastError *err);
void freezing_destroy(Freezing **freezing);
/* After a step or a few; the first call takes note of the temperatures. */
void freezing_update(Freezing *freezing, const Particles *particles, double time);
double freezing_value(const Freezing *freezing, FreezingField field, ptrdiff_t id);

/* For checkpoints. */
size_t freezing_size(const Freezing *freezing); // doubles
void freezing_save(const Freezing *freezing, double *buffer);
void freezing_restore(Freezing *freezing, const double *buffer);

#endif
