/* wetting.h - how much of each patch the melt covers. Internal to mould/. */
#ifndef CAST_COUPLING_WETTING_H
#define CAST_COUPLING_WETTING_H

#include "cast/coupling/contacts.h"
#include "cast/geometry/surface.h"

typedef struct Wetting Wetting;

/*  surface, sph  borrowed. Errors: CAST_ERR_MEMORY. */
CastStatus wetting_create(const Surface *surface, const SphParameters *sph, const Particles *particles,
                          Wetting **wetting, CastError *err);
void wetting_destroy(Wetting **wetting);
/* Wetted area, m2, of each cavity patch; outer patches, which have no samples, keep what `area` holds.
 *   area  [m] in and out */
CastStatus wetting_measure(Wetting *wetting, const Contacts *contacts, const Particles *particles,
                           const Neighbours *neighbours, double *area, CastError *err);
#endif
