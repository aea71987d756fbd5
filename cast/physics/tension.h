/* tension.h - surface tension of the melt and its contact angle on the mould: a force on particles near the free
 * surface.                                                                           (docs/theory, Surface tension)
 *   a_i += (2 sigma/rho) (kappa_i grad c_i + max(kappa_i, 0) grad c_w)
 * c, c_w: what melt and walls fill of the kernel, so that pressure sigma kappa balances it as long as kappa is uniform;
 * kappa from the normals of particles at the surface, smoothed inwards. On a wall the normal is that of the contact
 * angle: melt that stands otherwise has a curvature there that moves it. No state from step to step: a function of
 * places and temperatures. */
#ifndef CAST_PHYSICS_TENSION_H
#define CAST_PHYSICS_TENSION_H

#include "cast/kernel/kernel.h"
#include "cast/particles/neighbours.h"
#include "common/table.h"

typedef struct Tension Tension;

/*  sigma  N/m over K, borrowed;  contact_angle  rad, in the melt
 * Errors: CAST_ERR_MEMORY. */
CastStatus tension_create(KernelKind kernel, double h, const Table *sigma, double contact_angle, Tension **tension,
                          CastError *err);
void tension_destroy(Tension **tension);
/* Other contact angles on some of the walls. A particle at a wall takes the angle of that wall particle's patch whose
 * foot, its place on the mould's surface, is nearest to it.
 *   angle  [n] rad, in the melt;  of_patch  [patches] into `angle`, or -1: the angle of tension_create
 * Patches beyond those given have the angle of tension_create. Errors: CAST_ERR_MEMORY. */
CastStatus tension_set_angles(Tension *tension, size_t n, const double *angle, size_t patches, const int32_t *of_patch,
                              CastError *err);
/* Add to the accelerations of the fluid. Call after sph_rates. Errors: CAST_ERR_MEMORY. */
CastStatus tension_push(Tension *tension, Particles *particles, const Neighbours *neighbours, CastError *err);
/* s, of a capillary wave as short as h: 0.25 sqrt(rho h^3/(2 pi sigma))            (Brackbill, Kothe & Zemach 1992) */
double tension_step(const Tension *tension, double rho);

#endif
