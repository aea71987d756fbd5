/* properties.h - temperature, conductivity and viscosity of the melt from its enthalpy. For physics/ and cool/. */
#ifndef CAST_PHYSICS_PROPERTIES_H
#define CAST_PHYSICS_PROPERTIES_H

#include "cast/particles/particles.h"
#include "common/material/material.h"

/* T, kappa and mu of particles [first, end) from E; melt NULL: left alone. */
void properties_of_rows(const Material *melt, Particles *particles, ptrdiff_t first, ptrdiff_t end);
void properties_update(const Material *melt, Particles *particles); // of all fluid particles

#endif
