#include "cast/physics/drive.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "common/vector.h"

void drive_destroy(Drive *drive)
{
  free(drive->time);
  free(drive->gravity);
  table_destroy(&drive->tilt);
  table_destroy(&drive->speed);
  *drive = (Drive){0};
}

/* v turned about the unit axis by an angle (Rodrigues). */
static void turn(const double axis[3], double angle, double v[3])
{
  const double c = cos(angle), s = sin(angle), along = vec_dot(axis, v) * (1.0 - c);
  double across[3];
  vec_cross(axis, v, across);
  for (int d = 0; d < 3; d++) v[d] = c * v[d] + s * across[d] + along * axis[d];
}

/* From a to b: the size evenly, the direction along the great circle. Opposite directions, between which there is
 * none, and vectors of no size go straight. */
static void between(const double a[3], const double b[3], double part, double v[3])
{
  const double size_a = vec_norm(a), size_b = vec_norm(b);
  double normal[3];
  vec_cross(a, b, normal);
  const double size_n = vec_normalise(normal);
  if (size_n <= 1e-12 * size_a * size_b) {
    for (int d = 0; d < 3; d++) v[d] = a[d] + part * (b[d] - a[d]);
    return;
  }
  for (int d = 0; d < 3; d++) v[d] = a[d] * (1.0 + part * (size_b / size_a - 1.0));
  turn(normal, part * atan2(size_n, vec_dot(a, b)), v);
}

static void gravity_at(const Drive *drive, double time, double g[3])
{
  const size_t n = drive->n;
  if (n == 1 || time <= drive->time[0]) {
    memcpy(g, drive->gravity[0], sizeof drive->gravity[0]);
  } else if (time >= drive->time[n - 1]) {
    memcpy(g, drive->gravity[n - 1], sizeof drive->gravity[0]);
  } else {
    const size_t i = table_segment(drive->time, n, time);
    const double part = (time - drive->time[i]) / (drive->time[i + 1] - drive->time[i]);
    between(drive->gravity[i], drive->gravity[i + 1], part, g);
  }
}

void drive_at(const Drive *drive, double time, SphParameters *sph)
{
  double g[3] = {0.0, 0.0, 0.0};
  if (drive->n) gravity_at(drive, time, g);
  sph->spin = (Spin){{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  if (drive->tilt.n) turn(drive->tilt_axis, -table_evaluate(&drive->tilt, time), g);
  if (drive->speed.n) {
    const double speed = table_evaluate(&drive->speed, time), slope = table_slope(&drive->speed, time);
    turn(drive->spin_axis, -table_integral(&drive->speed, 0.0, time), g);
    for (int d = 0; d < 3; d++) {
      sph->spin.point[d] = drive->spin_point[d];
      sph->spin.rate[d] = speed * drive->spin_axis[d];
      sph->spin.spin_up[d] = slope * drive->spin_axis[d];
    }
  }
  memcpy(sph->gravity, g, sizeof g);
  memcpy(sph->extra, drive->acceleration, sizeof drive->acceleration);
}

double drive_potential(const SphParameters *sph, const double x[3])
{
  double sum = spin_potential(&sph->spin, x[0], x[1], x[2]);
  for (int d = 0; d < 3; d++) sum += (sph->gravity[d] + sph->extra[d]) * x[d];
  return sum;
}

bool drive_is_steady(const Drive *drive)
{
  // a mould that spins about an axis that is not upright feels gravity go round
  double across[3] = {0.0, 0.0, 0.0};
  if (drive->speed.n && drive->n) vec_cross(drive->gravity[0], drive->spin_axis, across);
  return drive->n <= 1 && drive->tilt.n <= 1 && drive->speed.n <= 1 && vec_norm(across) == 0.0;
}

double drive_kink(const Drive *drive, size_t k)
{
  if (k < drive->n) return drive->time[k];
  k -= drive->n;
  if (k < drive->tilt.n) return drive->tilt.x[k];
  k -= drive->tilt.n;
  return k < drive->speed.n ? drive->speed.x[k] : (double)NAN;
}
