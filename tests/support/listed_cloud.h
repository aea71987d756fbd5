/* listed_cloud.h - melt and walls at random in the unit cube with their neighbour lists. */
#ifndef TESTS_SUPPORT_LISTED_CLOUD_H
#define TESTS_SUPPORT_LISTED_CLOUD_H

#include "cast/particles/neighbours.h"

#define CLOUD_SPACING 0.05 // m
#define CLOUD_REACH 0.13   // m

enum { CLOUD_FLUID = 1500, CLOUD_WALLS = 700 };

/* Fluid in [0, 1]^3 with E = its number, walls in the part of that below z = `height`. */
Particles cloud_create(uint64_t seed, double height); // caller: particles_destroy

typedef struct ListedCloud {
  Particles p;
  Neighbours *neighbours;
  double skin; // m
} ListedCloud;

ListedCloud listed_cloud_create(uint64_t seed, double skin); // walls in the lower half, lists not made yet
bool listed_cloud_update(ListedCloud *cloud);                // were lists made anew?
void listed_cloud_destroy(ListedCloud *cloud);

/* Each row of the lists holds exactly the pairs nearer than reach and skin, each once. */
void listed_cloud_check(const ListedCloud *cloud);

/* Squared distance of particles i and j, of nearest images, m2. */
double cloud_distance2(const Particles *p, ptrdiff_t i, ptrdiff_t j, const double period[3]);

#endif
