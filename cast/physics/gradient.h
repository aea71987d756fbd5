/* gradient.h - gradients of scalars carried by the melt's particles, exact for linear fields wherever the neighbours
 * stand (docs/theory, eq. 24; kernel gradient correction of Randles & Libersky 1996, Bonet & Lok 1999):
 *   grad A_i = M_i^-1 sum_j V_j F_ij (A_i - A_j) d,   M_i = sum_j V_j F_ij d d^T,   d = x_i - x_j,
 * over melt particles alone: the mould's temperature jumps at the contact. M is 1 inside the melt, one half across a
 * plane surface, one eighth in a corner; directions in which hardly any neighbour stands (a film one particle thick)
 * have no gradient. */
#ifndef CAST_PHYSICS_GRADIENT_H
#define CAST_PHYSICS_GRADIENT_H

#include "cast/physics/sph.h"

/* Of the fields value[0..n), n <= GRADIENT_FIELDS, at fluid particle i. Lists must be up to date with the places.
 *   value  [n] arrays [n_fluid];  gradient  out, [n], unit of the field per m */
enum { GRADIENT_FIELDS = 2 };
void gradient_at(const SphParameters *sph, const Particles *particles, const Neighbours *neighbours, ptrdiff_t i, int n,
                 const double *const value[], double gradient[][3]);

#endif
