/* tension.h - surface tension of the melt and its contact angle on the mould: a force on particles near the free
 * surface.                                                                           (docs/theory, Surface tension)
 *   a_i += (2 sigma/rho) kappa_i (grad c_i + grad c_w)
 * c, c_w: what melt and walls fill of the kernel, so that pressure sigma kappa balances it as long as kappa is uniform.
 * kappa away from walls from the normals of particles at the surface, smoothed inwards; near walls that with which the
 * push is, along the wall, the divergence of the surfaces' stress: sigma in the free one, -sigma cos(theta) in that on
 * the wall. It is antisymmetric between particles, so that what it adds up to at a contact line is exact whatever the
 * line looks like. No state from step to step: a function of places and temperatures. */
#ifndef CAST_PHYSICS_TENSION_H
#define CAST_PHYSICS_TENSION_H

#include "cast/kernel/kernel.h"
#include "cast/particles/neighbours.h"
#include "common/table.h"

typedef struct Tension Tension;

/*  h, spacing  m;  sigma  N/m over K, borrowed;  contact_angle  rad, in the melt
 * Errors: CAST_ERR_MEMORY. */
CastStatus tension_create(KernelKind kernel, double h, double spacing, const Table *sigma, double contact_angle,
                          Tension **tension, CastError *err);
void tension_destroy(Tension **tension);
/* Other contact angles on some of the walls. A particle at a wall takes the angle of that wall particle's patch whose
 * foot, its place on the mould's surface, is nearest to it.
 *   angle  [n] rad, in the melt;  of_patch  [patches] into `angle`, or -1: the angle of tension_create
 * Patches beyond those given have the angle of tension_create. Errors: CAST_ERR_MEMORY. */
CastStatus tension_set_angles(Tension *tension, size_t n, const double *angle, size_t patches, const int32_t *of_patch,
                              CastError *err);
/* Add to the accelerations of the fluid. Call after sph_rates. Errors: CAST_ERR_MEMORY. */
CastStatus tension_push(Tension *tension, Particles *particles, const Neighbours *neighbours, CastError *err);
/* Force per volume, N/m3, of the surfaces' stress on fluid particle i as it was at tension_push: what curvature near
 * walls is found from. Summed over melt between two sections through it, less what walls take across themselves, it is
 * what the contact lines between them add up to. */
void tension_stress_force(const Tension *tension, Particles *particles, const Neighbours *neighbours, ptrdiff_t i,
                          double force[3]);
/* Pa, suction that walls are to stand: that of the most curved meniscus which is told apart, 1.5 sigma/h. */
double tension_wall_pull(const Tension *tension);
/* s, of a capillary wave as short as h: 0.25 sqrt(rho h^3/(2 pi sigma))            (Brackbill, Kothe & Zemach 1992) */
double tension_step(const Tension *tension, double rho);

#endif
