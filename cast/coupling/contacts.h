/* contacts.h - which fluid particle gives heat to which patch, made anew with the neighbour lists. Internal to mould/.
 * A contact is one fluid particle and one patch; its pairs are the sinks its heat goes to: the patch itself (surface,
 * one pair) or the wall particles of that patch (embedded). */
#ifndef CAST_COUPLING_CONTACTS_H
#define CAST_COUPLING_CONTACTS_H

#include "cast/coupling/coupling.h"

/* A particle as far behind a wall particle's tangent plane as this, in spacings, does not see that side of an edge. */
static const double contact_behind = 0.2;

typedef struct WallFacing WallFacing; // what contacts need of a wall particle

typedef struct Contacts {
  ptrdiff_t n_near;                     // fluid particles with contacts
  int32_t *near;                        // [n_near] their indices, ascending
  ptrdiff_t *first;                     // [n_near + 1] into the contacts
  ptrdiff_t n;                          // contacts
  int32_t *patch;                       // [n]
  double *area;                         // [n] m2 (surface)
  double (*plane)[4];                   // [n] distance to the wall = plane . (x, y, z, 1), m (surface)
  double *power;                        // [n] W; after a whole step the mean over it
  double *most;                         // [n] W/K, conductance of its pairs with the largest h of the patch's law
  double *mean_power;                   // [n] W, gathered over sub-steps
  ptrdiff_t *pair_start;                // [n + 1]
  int32_t *sink;                        // [pair_start[n]] patch (surface) or wall index (embedded)
  double *conductance;                  // [pair_start[n]] W/K
  ptrdiff_t *of_patch_start, *of_patch; // [m + 1], [n]: contacts of each patch, ascending
  ptrdiff_t room_near, room_contacts, room_pairs;
  WallFacing *facing; // [n_facing] of all wall particles
  ptrdiff_t n_facing;
} Contacts;

typedef struct ContactRules {
  CouplingKind kind;
  const SphParameters *sph;
  const Surface *surface; // NULL: nothing stands between a particle and a wall's foot
  size_t n_patches;
  double least_distance; // m: nearer particles count as this far: half of where the first layer stands
} ContactRules;

/* Errors: CAST_ERR_MEMORY. */
CastStatus contacts_build(Contacts *contacts, const ContactRules *rules, const Particles *particles,
                          const Neighbours *neighbours, CastError *err);
void contacts_free(Contacts *contacts);
#endif
