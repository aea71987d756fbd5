#include "cast/physics/drive.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void drive_destroy(Drive *drive)
{
  free(drive->time);
  free(drive->gravity);
  table_destroy(&drive->tilt);
  table_destroy(&drive->speed);
  *drive = (Drive){0};
}

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* v turned about the unit axis by an angle (Rodrigues). */
static void turn(const double axis[3], double angle, double v[3])
{
  const double c = cos(angle), s = sin(angle), along = dot(axis, v) * (1.0 - c);
  const double u[3] = {v[0], v[1], v[2]};
  for (int d = 0; d < 3; d++) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    v[d] = c * u[d] + s * (axis[e] * u[f] - axis[f] * u[e]) + along * axis[d];
  }
}

/* From a to b: the size evenly, the direction along the great circle. Opposite directions, between which there is
 * none, and vectors of no size go straight. */
static void between(const double a[3], const double b[3], double part, double v[3])
{
  const double size_a = sqrt(dot(a, a)), size_b = sqrt(dot(b, b));
  double normal[3];
  for (int d = 0; d < 3; d++) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    normal[d] = a[e] * b[f] - a[f] * b[e];
  }
  const double size_n = sqrt(dot(normal, normal));
  if (size_n <= 1e-12 * size_a * size_b) {
    for (int d = 0; d < 3; d++) v[d] = a[d] + part * (b[d] - a[d]);
    return;
  }
  const double size = size_a + part * (size_b - size_a);
  for (int d = 0; d < 3; d++) {
    normal[d] /= size_n;
    v[d] = a[d] / size_a * size;
  }
  turn(normal, part * atan2(size_n, dot(a, b)), v);
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
  double across = 0.0;
  for (int d = 0; d < 3 && drive->speed.n && drive->n; d++) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    const double *g = drive->gravity[0], *w = drive->spin_axis;
    across = fmax(across, fabs(g[e] * w[f] - g[f] * w[e]));
  }
  return drive->n <= 1 && drive->tilt.n <= 1 && drive->speed.n <= 1 && across == 0.0;
}

double drive_kink(const Drive *drive, size_t k)
{
  if (k < drive->n) return drive->time[k];
  k -= drive->n;
  if (k < drive->tilt.n) return drive->tilt.x[k];
  k -= drive->tilt.n;
  return k < drive->speed.n ? drive->speed.x[k] : (double)NAN;
}
