/* contact_row.h - the contacts of one fluid particle, found among the wall particles of its row. Internal to mould/. */
#ifndef CAST_COUPLING_CONTACT_ROW_H
#define CAST_COUPLING_CONTACT_ROW_H

#include "cast/coupling/contacts.h"

/* What is asked of a wall particle for every pair, side by side in one cache line: walls never move. */
struct WallFacing {
  double x[3], normal[3], lift, volume; // m; lift: from the foot to x along the normal, m; m3
};

typedef struct ContactBuild {
  const ContactRules *rules;
  const Particles *p;
  const WallFacing *facing; // [walls]
  const PairList *list;
  double period[3], slope, reach2; // m; 1/m5; m2
} ContactBuild;

typedef struct ContactTouch { // one wall particle within reach of the row's fluid particle
  int32_t wall, contact;      // contact: its number within the row
  double r2, across;          // m2, m: the way between them, squared and along the wall's normal
  double area, distance;      // m2, m
} ContactTouch;

typedef struct RowContact {
  int32_t particle, patch;
  ptrdiff_t n_pairs;
  double area, plane[4];
} RowContact;

/* What one thread finds in its share of the rows, in their order. */
typedef struct ContactShare {
  RowContact *contact;
  int32_t *pair; // sinks of the contacts, one after the other
  ptrdiff_t n, n_pairs, n_near, room, room_pairs;
  ContactTouch *touch; // [longest row] scratch
  ptrdiff_t n_touch;
  bool failed;
} ContactShare;

/* Without the facings, which only rows need. */
ContactBuild contact_build_begin(const ContactRules *rules, const Particles *particles, const Neighbours *neighbours);
WallFacing contact_face_wall(const Particles *particles, ptrdiff_t k);
/* Appends the contacts of fluid particle i and their sinks to the share, which has room for as many of each as the row
 * has entries. */
void contact_row_fill(const ContactBuild *build, ptrdiff_t i, ContactShare *share);
/* Wall particle k's part of the conductance between fluid particle i and k's patch, up to a factor of i's; 0: none. */
double contact_row_part(const ContactRules *rules, const Particles *particles, const Neighbours *neighbours,
                        ptrdiff_t i, ptrdiff_t k);
#endif
