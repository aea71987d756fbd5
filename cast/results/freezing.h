/* freezing.h - when and how each particle of the melt froze (docs/theory, section 8).
 *   liquidus time        when its temperature last fell below the liquidus, s
 *   solidus time         when it last fell below the solidus, s
 *   solidification time  local: from the one to the other, s
 *   cooling rate         mean over the freezing range, (T_liquidus - T_solidus)/solidification time, K/s
 *   final cooling rate   mean over the last fifth of the range, about T_N = T_solidus + 0.1 (T_liquidus - T_solidus)
 *   gradient             |grad T| when the particle fell through T_N, K/m
 *   Niyama               gradient/sqrt(final cooling rate), K^0.5 s^0.5/m
 *   arm spacing          estimate for the secondary dendrite arms, from the solidification time and the material, m
 *   remelted             how often it was solid and became mushy again
 * NAN where that has not come about. A particle that is remelted loses what it had: above the solidus its solidus time,
 * above T_N its gradient, above the liquidus all but the count. Times are interpolated linearly between two updates;
 * the gradient is that of the temperatures interpolated to that time. */
#ifndef CAST_RESULTS_FREEZING_H
#define CAST_RESULTS_FREEZING_H

#include "cast/physics/sph.h"

typedef struct Freezing Freezing;

typedef enum FreezingField {
  FREEZING_LIQUIDUS_TIME,
  FREEZING_SOLIDUS_TIME,
  FREEZING_SOLIDIFICATION_TIME,
  FREEZING_COOLING_RATE,
  FREEZING_FINAL_RATE,
  FREEZING_GRADIENT,
  FREEZING_NIYAMA,
  FREEZING_ARM_SPACING,
  FREEZING_REMELTED,
  FREEZING_FIELDS
} FreezingField;
typedef struct FreezingText {
  const char *name, *units, *description; // as results and summaries have them
} FreezingText;
extern const FreezingText freezing_texts[FREEZING_FIELDS];

/*  melt  borrowed; of a melt that has no freezing range nothing is ever known
 *  n_ids  ids of particles are below it.   Errors: CAST_ERR_MEMORY */
CastStatus freezing_create(const Material *melt, ptrdiff_t n_ids, Freezing **freezing, CastError *err);
void freezing_destroy(Freezing **freezing);
/* From now on gradients are taken too. Both are borrowed; at each update the lists must fit the particles' places. */
void freezing_watch_gradient(Freezing *freezing, const SphParameters *sph, const Neighbours *neighbours);
/* After a step or a few; the first call takes note of the temperatures. */
void freezing_update(Freezing *freezing, const Particles *particles, double time);
double freezing_value(const Freezing *freezing, FreezingField field, ptrdiff_t id);

/* For checkpoints. */
size_t freezing_size(const Freezing *freezing); // doubles
void freezing_save(const Freezing *freezing, double *buffer);
void freezing_restore(Freezing *freezing, const double *buffer);

#endif
