/* particles.h - storage of the melt's and the wall's particles, arrays of fields.
 * Fluid particles are [0, n_fluid), wall particles [n_fluid, n). Fluid particles are re-sorted in space when neighbour
 * lists are rebuilt; `id` keeps a particle's identity for its whole life. */
#ifndef CAST_PARTICLES_PARTICLES_H
#define CAST_PARTICLES_PARTICLES_H

#include <stddef.h>
#include <stdint.h>
#include "cast/geometry/walls.h"
#include "common/error.h"

typedef struct Particles {
  ptrdiff_t n, n_fluid, capacity_fluid;
  double *x[3];    // [n] m
  double *v[3];    // [n] m/s (wall: the velocity extrapolated for no slip)
  double *a[3];    // [n] m/s2
  double *rho;     // [n] kg/m3 (wall: from the extrapolated pressure)
  double *drho;    // [n] kg/(m3 s)
  double *p;       // [n] Pa
  double *mass;    // [n] kg
  double *volume;  // [n] m3: fluid mass/rho, refreshed with rho; wall constant
  double *E;       // [n] J/kg enthalpy
  double *heat;    // [n] W, rate of change of mass*E
  double *T;       // [n] K (wall: of the mould there)
  double *kappa;   // [n] W/(m K)
  double *mu;      // [n] Pa s
  int32_t *id;     // [n]
  // wall only, index k = i - n_fluid
  double *foot[3], *normal[3], *depth; // see walls.h
  int32_t *patch;
} Particles;

/* Fluid at rest at the n_fluid points given, followed by the walls. Fields other than x, mass, volume, rho, id and the
 * wall's own are zero. mass = rho0 spacing^3. Errors: CAST_ERR_MEMORY. */
CastStatus particles_create(ptrdiff_t n_fluid, double *const x[3], double spacing, double rho0, const WallSet *walls,
                            Particles *particles, CastError *err);
void particles_destroy(Particles *particles);

#endif
