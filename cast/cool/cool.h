/* cool.h - the second stage of a casting: melt at rest cools and freezes in place, together with its mould.
 * Particles, neighbours and contacts stand still; enthalpies and the mould's state move in implicit steps whose length
 * follows the error.
 *   coupling_use_surface, coupling_rebuild -> cool_create -> cool_step.. -> cool_destroy */
#ifndef CAST_COOL_COOL_H
#define CAST_COOL_COOL_H

#include "cast/coupling/coupling.h"

typedef struct Cool Cool;

typedef struct CoolParameters {
  double tolerance;  // K, error of a step without extrapolation, root mean square over the melt (enthalpy over the
                     // liquid's specific heat) and over the wetted patches; ten times as much for any one particle
  double first_step; // s
} CoolParameters;

typedef struct CoolSystem { // what cools: all borrowed
  const SphParameters *sph;
  Particles *particles; // keep their number and order while the object lives
  const Neighbours *neighbours;
  Coupling *coupling;
  RomState *state;
} CoolSystem;

typedef struct CoolCounts { // since cool_create or, restored, since the start of the stage
  double steps, rejected, newton, gradients;
  double shortest, longest; // s, steps
} CoolCounts;

/* Errors: CAST_ERR_MEMORY; CAST_ERR_ARGUMENT where sph has no melt. */
CastStatus cool_create(const CoolParameters *parameters, const CoolSystem *system, Cool **cool, CastError *err);
void cool_destroy(Cool **cool);
/* One step of at most `most` s: E, T, kappa and mu of the melt, the mould's state, the coupling's books.
 *   taken  out: its length, s
 * Errors: CAST_ERR_NUMERIC where no step is short enough; CAST_ERR_MEMORY. */
CastStatus cool_step(Cool *cool, double most, double *taken, CastError *err);
CoolCounts cool_counts(const Cool *cool);

/* For checkpoints: what a step leaves for the next. */
enum { COOL_SIZE = 7 };
void cool_save(const Cool *cool, double buffer[COOL_SIZE]);
void cool_restore(Cool *cool, const double buffer[COOL_SIZE]);

#endif
