/* C1: fluidity. Melt is pushed at a constant speed into a slot whose walls stay at one temperature, against gravity as
 * in Ragone's vacuum test, until its front freezes. Flemings (1964; 1974, ch. 7) for a front that moves at v and stops
 * at the solid fraction k, L_f = a rho v (k L + c dT)/(h (T_m - T_0)) (1 + B/2),  a = V/A, with B = 0 here, for the
 * mould does not warm; dT reaches down to the temperature that has the fraction k, and T_m is the mean temperature on
 * the way there. Left out there: hot melt of the stream's core that catches up with the front, where the speed has a
 * profile, and what the front's own free face does not lose. Both lengthen the flow, by a share that falls with the
 * length over the width. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

#include "cast/sim/sim.h"
#include "tests/support/assert_ok.h"
#include "tests/support/synthetic_rom.h"
#include "tests/support/validation.h"

static const double GRAVITY = 30.0, ENTRY = 1.5e-3; // m/s2; m, of the inlet below the rim: its buffer needs room
static const double RHO = 2400.0, C = 1100.0, LATENT = 389e3, MELTING = 888.0, RANGE = 60.0, CRITICAL = 0.25; // SI

typedef struct Slot {
  double width;       // m, of a square
  double h;           // W/m2K
  double mould, pour; // K
  double speed;       // m/s
  int across;         // particles over the width
} Slot;

static double flemings(const Slot *s)
{
  const double a = 0.25 * s->width, last = MELTING - CRITICAL * RANGE;
  const double heat = CRITICAL * LATENT + C * (s->pour - last), mean = 0.5 * (s->pour + last);
  return a * RHO * s->speed * heat / (s->h * (mean - s->mould));
}

static CastConfig *configure(const Slot *s, const char *folder)
{
  char text[4096], path[128];
  CastError err = {0};
  CastConfig *config = NULL;
  snprintf(
      text, sizeof text,
      "rom: mould.rom.h5\npreheat: %.17g K\nambient: 300 K\n"
      "melt:\n  temperature: %.17g K\n  material: { density: %g kg/m^3, specific_heat: %g J/kg/K, latent_heat: %g "
      "J/kg, solidus: %g K, liquidus: %g K, conductivity: 100 W/m/K, viscosity: 1.3 mPa.s, coherency_fraction: %g }\n"
      "  inlets:\n    - rectangle: { centre: [0 m, 0 m, %.17g m], along: [1, 0, 0], width: %.17g m, height: %.17g m }\n"
      "      direction: [0, 0, -1]\n      velocity: %.17g m/s\n"
      "forces: { gravity: [0 m/s^2, 0 m/s^2, %.17g m/s^2] }\ncontact: { h: %g W/m^2/K }\ncoupling: { mould: frozen }\n"
      "sph: { spacing: %.17g m, sound_speed: %.17g m/s }\n"
      "time: { end: %.17g s }\noutput: { folder: out, every: 1 s }\n",
      s->mould, s->pour, RHO, C, LATENT, MELTING - RANGE, MELTING, CRITICAL, -ENTRY, s->width, s->width, s->speed,
      GRAVITY, s->h, s->width / s->across, 10.0 * sqrt(2.0 * GRAVITY * 1.6 * flemings(s)),
      2.0 * flemings(s) / s->speed);
  snprintf(path, sizeof path, "%s/cast.yaml", folder);
  ok(cast_config_read(path, text, &config, &err), &err);
  return config;
}

static double deepest(const Sim *sim)
{
  const Particles *p = sim_particles(sim);
  double z = 0.0;
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) z = fmin(z, p->x[2][i]);
  return -z;
}

/* Step until the front has come on by less than a tenth of its way at full speed over two spacings. Behind a front that
 * has stopped the pump drives the pressure up, which in the end stops the run: that too says that it stands. */
static double follow(Sim *sim, const Slot *s)
{
  const double look = 2.0 * s->width / s->across / s->speed; // s
  double front = 0.0, next = look;
  CastError err = {0};
  for (;;) {
    while (sim_time(sim) < next)
      if (sim_step(sim, &err) != CAST_OK) return deepest(sim);
    const double now = deepest(sim);
    if (now > 3.0 * s->width && now - front < 0.1 * s->speed * look) return now;
    front = now;
    next += look;
  }
}

/* How far the front comes into the slot, m. */
static double run(const Slot *s, const char *folder)
{
  CastError err = {0};
  const SyntheticBox box = {.outer = {s->width + 8e-3, s->width + 8e-3, 1.6 * flemings(s) + 6e-3},
                            .cavity = {s->width, s->width, 1.6 * flemings(s) + ENTRY},
                            .cell = 1e-3,
                            .kappa = 1.0,
                            .rho = 1800.0,
                            .c = 1100.0,
                            .h_outside = 10.0};
  RomData *rom = NULL;
  char path[128];
  snprintf(path, sizeof path, "%s/mould.rom.h5", folder);
  ok(synthetic_rom_box_cavity(&box, &rom, &err), &err);
  ok(rom_write(rom, path, &err), &err);
  rom_destroy(&rom);
  CastConfig *config = configure(s, folder);
  Sim *sim = NULL;
  ok(sim_create(config, NULL, &sim, &err), &err);
  const double length = follow(sim, s) - ENTRY;
  sim_destroy(&sim);
  cast_config_destroy(&config);
  return length;
}

static void melt_runs_as_far_as_flemings_says_before_its_front_freezes(void **state)
{
  (void)state;
  const Slot base = {0.8e-3, 2500.0, 600.0, 908.0, 0.1, 4};
  struct {
    const char *what;
    Slot slot;
  } runs[] = {{"0.8 mm square, h 2500 W/m2K, mould 600 K, pour 908 K, 0.1 m/s", base},
              {"mould 500 K instead", base},
              {"mould 650 K instead", base},
              {"h 4000 W/m2K instead", base},
              {"0.6 mm square instead", base}};
  runs[1].slot.mould = 500.0;
  runs[2].slot.mould = 650.0;
  runs[3].slot.h = 4000.0;
  runs[4].slot.width = 0.6e-3;
  enum { RUNS = sizeof runs / sizeof *runs };
  char folder[] = "/tmp/c1_fluidity_XXXXXX", path[128];
  assert_non_null(mkdtemp(folder));
  validation_begin("C1");
  double length[RUNS];
  for (int k = 0; k < RUNS; k++) {
    const double start = validation_cpu_time(), reference = flemings(&runs[k].slot);
    length[k] = run(&runs[k].slot, folder);
    const double error = length[k] / reference - 1.0;
    validation_write(&(ValidationRow){
        "C1", validation_text("flow length, %s", runs[k].what), validation_text("%.1f mm (Flemings)", 1e3 * reference),
        validation_text("%.1f mm", 1e3 * length[k]), validation_text("%+.1f %%", 100.0 * error),
        fabs(error) < 0.2 ? "20 %" : "20 % (missed)", validation_text("%d particles across", runs[k].slot.across),
        validation_cpu_time() - start});
    if (k == 0) assert_true(fabs(error) < 0.2);
  }
  assert_true(length[1] < length[0] && length[0] < length[2]); // the hotter the mould the farther
  assert_true(length[3] < length[0] && length[4] < length[0]);
  snprintf(path, sizeof path, "%s/mould.rom.h5", folder);
  remove(path);
  rmdir(folder);
}

int main(void)
{
  omp_set_num_threads(1); // too few particles for more
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(melt_runs_as_far_as_flemings_says_before_its_front_freezes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
