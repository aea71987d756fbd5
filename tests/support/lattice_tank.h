/* lattice_tank.h - melt on a lattice in a box whose walls are layers of lattice particles: SPH alone, no mould
 * geometry. Cells are counted from the inner corner of the box at the origin; fluid sits at (i + 1/2) spacing. */
#ifndef TESTS_SUPPORT_LATTICE_TANK_H
#define TESTS_SUPPORT_LATTICE_TANK_H

#include "cast/physics/sph.h"

typedef struct LatticeTank {
  int fluid[3];                    // particles along each axis, from the corner
  int box[3];                      // cells of the box
  bool low[3], high[3];            // is there a wall at that end of the axis? (an axis without walls is periodic)
  int block_low[3], block_high[3]; // cells of a block of wall inside the box, without the high end (none: all zero)
  int layers;                      // of wall particles
  SphParameters sph;
  Particles particles;
  Neighbours *neighbours;
  double time; // s
  long steps;
} LatticeTank;

/* Fill in particles and neighbours from the fields above; wall particle k has normal index by wall_axis. Fails the test
 * where anything fails. */
void lattice_tank_create(LatticeTank *tank);
void lattice_tank_destroy(LatticeTank *tank);
/* One step as castrun's, without a mould; dt <= 0: the program's own choice. Returns dt. */
double lattice_tank_step(LatticeTank *tank, double dt);

#endif
