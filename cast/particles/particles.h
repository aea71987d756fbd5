/* particles.h - storage of the melt's and the wall's particles, arrays of fields.
 * Fluid particles are [0, n_fluid), wall particles [n_fluid, n). Fluid particles are re-sorted in space when neighbour
 * lists are rebuilt; `id` keeps a particle's identity for its whole life. */
#ifndef CAST_PARTICLES_PARTICLES_H
#define CAST_PARTICLES_PARTICLES_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "cast/geometry/walls.h"
#include "common/error.h"

enum { RECORD_SIZE = 12 };
typedef union RecordField {
  float value;
  uint32_t place; // a position as an integer
} RecordField;

typedef struct Particles {
  ptrdiff_t n, n_fluid, capacity_fluid;
  double *x[3];   // [n] m
  double *v[3];   // [n] m/s (wall: the velocity extrapolated for no slip)
  double *a[3];   // [n] m/s2
  double *rho;    // [n] kg/m3 (wall: from the extrapolated pressure)
  double *drho;   // [n] kg/(m3 s)
  double *p;      // [n] Pa
  double *mass;   // [n] kg; one value for all fluid particles
  double *volume; // [n] m3: fluid mass/rho (of torn melt at most mass/(0.95 rho0)), refreshed with rho; wall constant
  double *E;      // [n] J/kg enthalpy
  double *heat;   // [n] W, rate of change of mass*E
  double *T;      // [n] K (wall: of the mould there)
  double *kappa;  // [n] W/(m K)
  double *mu;     // [n] Pa s
  double *rho_start; // [n] kg/m3 at the start of the step; drho is applied to it once it is known (sph.h)
  double *drho_last; // [n] kg/(m3 s), drho of the step before (NaN: there was none): predicts the density for forces
  double *clearance; // [n] m, at least this far from the mould's surface (may be too small; 0: not known)
  int32_t *id;       // [n]
  // wall only, index k = i - n_fluid
  double *foot[3], *normal[3], *depth; // see walls.h
  double *wall_v[3];                   // m/s, the wall's own velocity (zero; tests move walls)
  int32_t *patch;
  uint8_t *echo;       // see walls.h
  RecordField *record; // [n * RECORD_SIZE] what pair sums need of a particle; scratch of physics/, stale elsewhere
} Particles;

/* The fields that belong to a fluid particle and move with it when particles are re-sorted: all of the [n] ones but id.
 * What a checkpoint must keep of the fluid is these and id. */
enum { PARTICLE_FIELDS = 22 };
typedef struct ParticleField {
  const char *name; // "x", "rho_start"..
  const char *unit; // "m", "kg/m3"..
  double *data;     // [n], borrowed
} ParticleField;
void particles_fields(const Particles *particles, ParticleField field[PARTICLE_FIELDS]);

/* Fluid at rest at the n_fluid points given, followed by the walls (NULL: none). Fields other than x, mass, volume,
 * rho, id and the wall's own are zero. mass = rho0 spacing^3; walls have mass = rho0 volume. Errors: CAST_ERR_MEMORY.
 */
CastStatus particles_create(ptrdiff_t n_fluid, double *const x[3], double spacing, double rho0, const WallSet *walls,
                            Particles *particles, CastError *err);
/* `more` fluid particles behind those there, all their fields zero; walls stay what they are, at higher indices, and
 * pointers into the arrays become stale. Errors: CAST_ERR_MEMORY, CAST_ERR_ARGUMENT (too many); nothing has changed
 * then. */
CastStatus particles_add(Particles *particles, ptrdiff_t more, CastError *err);
void particles_destroy(Particles *particles);

/* A way along one axis to the nearest image where the axis repeats (period > 0). */
static inline double particles_image(double way, double period)
{
  return period > 0.0 ? way - period * floor(way / period + 0.5) : way;
}

/* d = x_i - x_j, m, of the nearest image where an axis repeats (period > 0); returns |d|^2. */
static inline double particles_offset(const Particles *p, ptrdiff_t i, ptrdiff_t j, const double period[3], double d[3])
{
  double r2 = 0.0;
  for (int a = 0; a < 3; a++) {
    d[a] = particles_image(p->x[a][i] - p->x[a][j], period[a]);
    r2 += d[a] * d[a];
  }
  return r2;
}

#endif
