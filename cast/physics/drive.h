/* drive.h - the forces that drive a filling, over time: gravity, the mould's tilting and its spinning. */
#ifndef CAST_PHYSICS_DRIVE_H
#define CAST_PHYSICS_DRIVE_H

#include "cast/physics/sph.h"
#include "common/table.h"

typedef struct Drive {
  size_t n;               // points of gravity over time, at least 1
  double *time;           // [n] s, rising
  double (*gravity)[3];   // [n] m/s2; between points size and direction change evenly
  double acceleration[3]; // m/s2, besides gravity, fixed to the mould
  double tilt_axis[3];    // unit; the mould is turned about it by tilt, so slowly that gravity alone feels it
  Table tilt;             // s -> rad; n = 0: it is not tilted
  double spin_point[3];   // m, on the axis
  double spin_axis[3];    // unit
  Table speed;            // s -> rad/s; n = 0: it does not spin
} Drive;
void drive_destroy(Drive *drive);

/* gravity, extra and spin of `sph` as they are at this time (s), in the frame of the mould. Gravity is given as it is
 * at the time 0; a mould that spins turns away from it by the angle that it has gone through. */
void drive_at(const Drive *drive, double time, SphParameters *sph);
/* gravity.x + extra.x + |w x r|^2/2, m2/s2: melt gains at most as much as this rises. */
double drive_potential(const SphParameters *sph, const double x[3]);
/* Does anything change with time? Then the times at which its course has a kink: the n-th, NAN behind the last. */
bool drive_is_steady(const Drive *drive);
double drive_kink(const Drive *drive, size_t n);

#endif
