/* contact_law.h - the conductance of the interface between melt and mould, W/(m2 K): a constant, a function of the
 * temperature of the melt at the wall, or of its solid fraction; for each named cavity surface.
 * A gap that opens as the skin shrinks away from the mould has three stages: the liquid's value up to one solid
 * fraction, the gap's from another on, a line between: a table of two points. */
#ifndef CAST_COUPLING_CONTACT_LAW_H
#define CAST_COUPLING_CONTACT_LAW_H

#include "common/material/material.h"
#include "common/rom/rom.h"

typedef enum ContactBasis { CONTACT_CONSTANT, CONTACT_OF_TEMPERATURE, CONTACT_OF_SOLID_FRACTION } ContactBasis;

typedef struct ContactLaw {
  ContactBasis basis;
  double h;    // W/(m2 K), for CONTACT_CONSTANT; INFINITY: perfect contact
  Table table; // T [K] or solid fraction [1] -> W/(m2 K); constant beyond its ends
} ContactLaw;

typedef struct SurfaceContact {
  char surface[ROM_NAME_LENGTH];
  ContactLaw law;
} SurfaceContact;

typedef struct ContactLaws {
  ContactLaw elsewhere; // on all cavity surfaces but those below
  size_t n;
  SurfaceContact *surface; // [n]
} ContactLaws;

/* W/(m2 K), with the melt at the wall at T, K.   melt  may be NULL for laws that are not of the solid fraction */
double contact_law_at(const ContactLaw *law, const Material *melt, double T);
double contact_law_most(const ContactLaw *law); // W/(m2 K), the largest that can occur
double contact_laws_most(const ContactLaws *laws);
/* The law of each patch, pointers into `laws`: the surface it is part of, or elsewhere (outer patches
 * too: melt may stand on the rim).
 *   law  [rom->m]
 * Errors: CAST_ERR_INPUT for a surface that the ROM does not have, or that is no cavity surface, for an h that is not
 * above zero, for a law of the solid fraction where the melt has none; CAST_ERR_MEMORY. */
CastStatus contact_laws_by_patch(const ContactLaws *laws, const RomData *rom, const Material *melt,
                                 const ContactLaw **law, CastError *err);
void contact_laws_destroy(ContactLaws *laws); // what it owns, not the struct

#endif
