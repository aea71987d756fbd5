/* config_forces.c - `forces:` of cast.yaml, read and written.
 *   forces:
 *     gravity: [0, 0, -9.81 m/s^2]  |  [[0 s, [..]], [2 s, [..]]]
 *     acceleration: [..]                                            besides gravity, fixed to the mould
 *     tilt: { axis: [0, 1, 0], angle: [[0 s, 0 deg], [2 s, 90 deg]] }
 *     gas: { pressure: 30 kPa  |  [[0 s, 0 kPa], [50 ms, 30 kPa]], from: { corner: [..], size: [..] } }
 *     spin: { point: [..], axis: [0, 0, 1], speed: 600 rpm  |  [[0 s, 0 rpm], [0.3 s, 600 rpm]] } */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cast/config/config_private.h"

/* ---- reading ---- */

static CastStatus read_gravity(YamlNode node, Drive *drive, CastError *err)
{
  const bool timed = yaml_is_sequence(node) && yaml_is_sequence(yaml_item(node, 0));
  const size_t n = timed ? yaml_count(node) : 1;
  drive->time = calloc(n, sizeof *drive->time);
  drive->gravity = calloc(n, sizeof *drive->gravity);
  CAST_CHECK(drive->time && drive->gravity, err, CAST_ERR_MEMORY, "no memory for %zu points of gravity", n);
  drive->n = n;
  if (!timed) {
    config_read_vector(node, "m/s^2", drive->gravity[0]);
    return CAST_OK;
  }
  for (size_t i = 0; i < n; i++) {
    const YamlNode pair = yaml_item(node, i);
    if (!yaml_is_sequence(pair) || yaml_count(pair) != 2) {
      yaml_problem(pair, "a time and a vector are expected: [2 s, [9.81 m/s^2, 0 m/s^2, 0 m/s^2]]");
      continue;
    }
    drive->time[i] = yaml_quantity(yaml_item(pair, 0), "s", YAML_ANY, 0.0);
    config_read_vector(yaml_item(pair, 1), "m/s^2", drive->gravity[i]);
    if (i > 0 && !(drive->time[i] > drive->time[i - 1]))
      yaml_problem(pair, "%g s follows %g s: times must rise strictly", drive->time[i], drive->time[i - 1]);
  }
  return CAST_OK;
}

static void read_tilt(YamlNode node, Drive *drive)
{
  if (!yaml_exists(node)) return;
  config_read_direction(yaml_require(node, "axis"), drive->tilt_axis);
  config_read_timed(yaml_require(node, "angle"), "rad", YAML_ANY, &drive->tilt);
}

static void read_spin(YamlNode node, Drive *drive)
{
  if (!yaml_exists(node)) return;
  config_read_vector(yaml_require(node, "point"), "m", drive->spin_point);
  config_read_direction(yaml_require(node, "axis"), drive->spin_axis);
  config_read_timed(yaml_require(node, "speed"), "rad/s", YAML_ANY, &drive->speed);
}

static void read_gas(YamlNode node, GasConfig *gas)
{
  if (!yaml_exists(node)) return;
  config_read_timed(yaml_require(node, "pressure"), "Pa", YAML_NON_NEGATIVE, &gas->pressure);
  const YamlNode from = yaml_require(node, "from");
  if (yaml_exists(from)) config_read_box(from, gas->corner, gas->size);
}

CastStatus config_read_forces(YamlNode node, CastConfig *config, CastError *err)
{
  Drive *drive = &config->drive;
  const YamlNode acceleration = yaml_get(node, "acceleration"), tilt = yaml_get(node, "tilt"),
                 spin = yaml_get(node, "spin");
  CAST_CALL(read_gravity(yaml_require(node, "gravity"), drive, err));
  if (yaml_exists(acceleration) && !yaml_vector(acceleration, "m/s^2", drive->acceleration))
    memset(drive->acceleration, 0, sizeof drive->acceleration);
  read_tilt(tilt, drive);
  read_spin(spin, drive);
  read_gas(yaml_get(node, "gas"), &config->gas);
  if (yaml_exists(tilt) && drive->n > 1) yaml_problem(tilt, "gravity changes with time already; give one of the two");
  if (yaml_exists(tilt) && yaml_exists(spin))
    yaml_problem(tilt, "a mould that spins cannot be tilted as well: about which axis first?");
  return CAST_OK;
}

/* ---- the resolved input ---- */

void config_put_forces(FILE *out, const CastConfig *config)
{
  const Drive *drive = &config->drive;
  fputs("forces:\n  gravity: ", out);
  if (drive->n == 1) config_put_vector(out, drive->gravity[0], "m/s^2");
  for (size_t i = 0; i < drive->n && drive->n > 1; i++) {
    fprintf(out, "%s[%.17g s, ", i ? ", " : "[", drive->time[i]);
    config_put_vector(out, drive->gravity[i], "m/s^2");
    fputs(i + 1 < drive->n ? "]" : "]]", out);
  }
  fputs("\n  acceleration: ", out);
  config_put_vector(out, drive->acceleration, "m/s^2");
  if (drive->tilt.n) {
    fputs("\n  tilt:\n    axis: ", out);
    config_put_direction(out, drive->tilt_axis);
    fputs("\n    angle: ", out);
    config_put_timed(out, &drive->tilt, "rad");
  }
  if (drive->speed.n) {
    fputs("\n  spin:\n    point: ", out);
    config_put_vector(out, drive->spin_point, "m");
    fputs("\n    axis: ", out);
    config_put_direction(out, drive->spin_axis);
    fputs("\n    speed: ", out);
    config_put_timed(out, &drive->speed, "rad/s");
  }
  if (config->gas.pressure.n) {
    fputs("\n  gas:\n    pressure: ", out);
    config_put_timed(out, &config->gas.pressure, "Pa");
    fputs("\n    from:\n      corner: ", out);
    config_put_vector(out, config->gas.corner, "m");
    fputs("\n      size: ", out);
    config_put_vector(out, config->gas.size, "m");
  }
  fputc('\n', out);
}
