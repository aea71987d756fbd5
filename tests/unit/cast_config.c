/* cast.yaml: defaults, every option, and a resolved input that reads again to the same bits. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/assert_close.h"
#include "tests/support/config_case.h"

static const char EVERYTHING[] =
    "title: 'all: \"options\"'\n"
    "rom: /models/mould.rom.h5\n"
    "preheat: 700.1 degC\n"
    "ambient: 300.3 K\n"
    "melt:\n"
    "  material:\n"
    "    name: home-made\n"
    "    density: 1000 kg/m^3\n"
    "    specific_heat: 1 J/kg/K\n"
    "    identity: true\n"
    "    conductivity:\n"
    "      value: 0.003 W/m/K\n"
    "      note: a guess\n"
    "    viscosity: 5 mPa.s\n"
    "    surface_tension: 0.9 N/m\n"
    "  temperature: 900.7 degC\n"
    "  cavity_below: 3.3 mm\n"
    "  blocks:\n"
    "    - { corner: [1 mm, 0 mm, 7 mm], size: 1 2 3 mm, temperature: 1000 K, velocity: [0 m/s, 0 m/s, -1.7 m/s] }\n"
    "    - { corner: [-9 mm, 0 mm, 7 mm], size: [1 mm, 1 mm, 1 mm] }\n"
    "forces:\n"
    "  gravity: [0.1 m/s^2, 0 m/s^2, -9.81 m/s^2]\n"
    "  acceleration: [0 m/s^2, 33.3 m/s^2, 0 m/s^2]\n"
    "contact: { perfect: true }\n"
    "coupling: { kind: embedded, mould: frozen }\n"
    "surface_tension: { contact_angle: 101.3 deg, surfaces: { disc: { contact_angle: 60.6 deg } } }\n"
    "sph:\n"
    "  spacing: 0.3 mm\n"
    "  kernel: quintic-spline\n"
    "  smoothing: 1.1\n"
    "  sound_speed: 17.7 m/s\n"
    "  density: summation\n"
    "  artificial_viscosity: 0.07\n"
    "  negative_pressure: cut\n"
    "time: { end: 11.1 ms, step: 1.3 us, scheme: backward-euler, cool: { end: 99.9 s, begin: at-end, tolerance: 0.7 K, "
    "every: 3.3 s, curves_every: 0.2 s } }\n"
    "features: [{ name: tips, low: [-4 mm, -4 mm, 8 mm], high: [4 mm, 4 mm, 9 mm] }]\n"
    "part: [disc, thin pins]\n"
    "output:\n"
    "  folder: /tmp/there\n"
    "  every: 1.7 ms\n"
    "  curves_every: 0.3 ms\n"
    "  checkpoint_every: 7 min\n"
    "  mould_fields: false\n"
    "  probes: [{ name: a \\ b, position: [1 mm, 2 mm, 3 mm] }]\n"
    "  tracers: [{ name: '1', nearest: [0.1 mm, 0.2 mm, 0.3 mm] }, { name: '2', nearest: [0 mm, 0 mm, 0 mm] }]\n";

static void an_input_of_the_least_keys_gets_the_defaults(void **state)
{
  (void)state;
  CastConfig *c = config_case_read(CONFIG_LEAST, "case/cast.yaml");
  assert_string_equal(c->rom_path, "case/mould.rom.h5");
  assert_string_equal(c->output.folder, "case/results");
  assert_close(c->preheat, 1073.15, 1e-9);
  assert_int_equal(c->kernel, KERNEL_WENDLAND_C2);
  assert_close(c->smoothing * kernel_support(c->kernel), 3.0, 1e-15);
  assert_int_equal(c->coupling.kind, COUPLING_SURFACE);
  assert_false(c->coupling.mould_frozen);
  assert_close(c->coupling.h_contact, 2000.0, 1e-9);
  assert_true(c->sound_speed == 0.0 && c->step == 0.0); // both from the case
  assert_int_equal(c->scheme, ROM_EXPONENTIAL);
  assert_int_equal(c->density, SPH_CONTINUITY);
  assert_close(c->output.curves_every, 1e-4, 1e-16);
  assert_true(c->output.mould_fields);
  assert_close(c->block[0].temperature, 1423.15, 1e-9); // the melt's
  assert_false(c->has_level);
  cast_config_destroy(&c);
  assert_null(c);
}

static void every_option_arrives(void **state)
{
  (void)state;
  CastConfig *c = config_case_read(EVERYTHING, "cast.yaml");
  assert_string_equal(c->title, "all: \"options\"");
  assert_string_equal(c->melt.name, "home-made");
  assert_true(isinf(c->coupling.h_contact));
  assert_int_equal(c->coupling.kind, COUPLING_EMBEDDED);
  assert_true(c->coupling.mould_frozen);
  assert_close(c->level, 3.3e-3, 1e-18);
  assert_int_equal(c->n_blocks, 2);
  assert_close(c->block[0].velocity[2], -1.7, 1e-15);
  assert_close(c->block[0].size[1], 2e-3, 1e-18);
  assert_close(c->drive.acceleration[1], 33.3, 1e-14);
  assert_close(c->drive.gravity[0][2], -9.81, 1e-14);
  assert_int_equal(c->kernel, KERNEL_QUINTIC_SPLINE);
  assert_close(c->sound_speed, 17.7, 1e-14);
  assert_int_equal(c->density, SPH_SUMMATION);
  assert_close(c->artificial_viscosity, 0.07, 1e-17);
  assert_true(c->cut_tension);
  assert_close(c->step, 1.3e-6, 1e-21);
  assert_int_equal(c->scheme, ROM_BACKWARD_EULER);
  assert_true(c->cool.wanted && c->cool.at_end && !c->cool.until_solid);
  assert_close(c->output.checkpoint_every, 420.0, 1e-12);
  assert_false(c->output.mould_fields);
  assert_int_equal(c->n_features, 1);
  assert_string_equal(c->feature[0].name, "tips");
  assert_close(c->feature[0].low[2], 8e-3, 1e-15);
  assert_close(c->feature[0].high[0], 4e-3, 1e-15);
  assert_int_equal(c->n_part, 2);
  assert_string_equal(c->part[1], "thin pins");
  assert_int_equal(c->output.n_probes, 1);
  assert_int_equal(c->output.n_tracers, 2);
  assert_string_equal(c->output.tracer[1].name, "2");
  cast_config_destroy(&c);
}

enum { NUMBERS = 20 };

static void list_numbers(const CastConfig *c, double number[NUMBERS])
{
  const double all[NUMBERS] = {c->preheat,
                               c->ambient,
                               c->melt_temperature,
                               c->coupling.h_contact,
                               c->spacing,
                               c->smoothing,
                               c->sound_speed,
                               c->density_diffusion,
                               c->artificial_viscosity,
                               c->end,
                               c->step,
                               c->output.every,
                               c->output.curves_every,
                               c->output.checkpoint_every,
                               c->cool.end,
                               c->cool.tolerance,
                               c->cool.every,
                               c->cool.curves_every,
                               c->melt.density,
                               c->melt.conductivity};
  memcpy(number, all, sizeof all);
}

static void assert_same_numbers(const CastConfig *a, const CastConfig *b)
{
  double u[NUMBERS], w[NUMBERS];
  list_numbers(a, u);
  list_numbers(b, w);
  assert_memory_equal(u, w, sizeof u);
  config_case_same_drive(&a->drive, &b->drive);
  assert_int_equal(a->n_blocks, b->n_blocks);
  assert_memory_equal(a->block, b->block, a->n_blocks * sizeof *a->block);
  assert_int_equal(a->n_features, b->n_features);
  assert_memory_equal(a->feature, b->feature, a->n_features * sizeof *a->feature);
  assert_int_equal(a->n_part, b->n_part);
  for (size_t i = 0; i < a->n_part; i++) assert_string_equal(a->part[i], b->part[i]);
  assert_int_equal(a->output.n_tracers, b->output.n_tracers);
  for (size_t i = 0; i < a->output.n_tracers; i++) {
    assert_string_equal(a->output.tracer[i].name, b->output.tracer[i].name);
    assert_memory_equal(a->output.tracer[i].x, b->output.tracer[i].x, sizeof a->output.tracer[i].x);
  }
}

static void the_resolved_input_reads_again_to_the_same_bits(void **state)
{
  (void)state;
  const char *const texts[] = {CONFIG_LEAST, EVERYTHING};
  for (int k = 0; k < 2; k++) {
    CastConfig *first = config_case_read(texts[k], "cast.yaml");
    CastConfig *second = config_case_again(first);
    assert_same_numbers(first, second);
    assert_string_equal(first->title, second->title);
    assert_int_equal(first->kernel, second->kernel);
    assert_int_equal(first->density, second->density);
    assert_int_equal(first->coupling.kind, second->coupling.kind);
    assert_int_equal(first->coupling.mould_frozen, second->coupling.mould_frozen);
    assert_true(first->coupling.mould_interval == second->coupling.mould_interval);
    assert_int_equal(first->cut_tension, second->cut_tension);
    assert_int_equal(first->scheme, second->scheme);
    assert_int_equal(first->tension, second->tension);
    assert_int_equal(first->tension, k == 1);
    assert_true(k == 0 || first->contact_angle == second->contact_angle);
    assert_int_equal(first->n_angles, k == 1 ? 1 : 0);
    assert_int_equal(second->n_angles, first->n_angles);
    if (first->n_angles) {
      assert_string_equal(second->angle->surface, "disc");
      assert_close(first->angle->contact_angle, 60.6 * 3.14159265358979323846 / 180.0, 1e-14);
      assert_true(first->angle->contact_angle == second->angle->contact_angle);
    }
    assert_int_equal(first->has_level, second->has_level);
    assert_int_equal(first->output.mould_fields, second->output.mould_fields);
    assert_string_equal(first->melt.name, second->melt.name);
    if (k == 0) assert_string_equal(first->melt.sha256, second->melt.sha256); // a named material: the same file
    cast_config_destroy(&first);
    cast_config_destroy(&second);
  }
}

static void a_sound_speed_that_was_chosen_stands_in_the_resolved_input(void **state)
{
  (void)state;
  CastConfig *config = config_case_read(CONFIG_LEAST, "cast.yaml");
  char *resolved = NULL;
  CastError err = {0};
  assert_int_equal(cast_config_resolved(config, 12.5, &resolved, &err), CAST_OK);
  assert_non_null(strstr(resolved, "sound_speed: 12.5 m/s"));
  free(resolved);
  cast_config_destroy(&config);
}

static void all_faults_are_told_at_once(void **state)
{
  (void)state;
  const char text[] = "rom: mould.rom.h5\n"
                      "preheat: 800 mm\n"
                      "ambient: 25 degC\n"
                      "melt: { material: no-such-alloy, temperature: 1150 degC }\n"
                      "forces: { gravty: [0 m/s^2, 0 m/s^2, -9.81 m/s^2] }\n"
                      "contact: { h: 2000 W/m^2/K, perfect: true }\n"
                      "sph: { spacing: -1 mm, kernel: gauss }\n"
                      "time: { end: 10 ms, step: soon }\n"
                      "output: { folder: results }\n";
  CastError err = {0};
  CastConfig *config = NULL;
  assert_int_equal(cast_config_read("cast.yaml", text, &config, &err), CAST_ERR_INPUT);
  assert_null(config);
  const char *const parts[] = {"cast.yaml:2: preheat",
                               "no-such-alloy",
                               "cast.yaml:4: melt: where is the melt?",
                               "cast.yaml:5: forces: key 'gravity' is missing",
                               "gravty",
                               "did you mean",
                               "cast.yaml:6: contact: exactly one",
                               "cast.yaml:7: sph.spacing",
                               "cast.yaml:7: sph.kernel",
                               "cast.yaml:8: time.step",
                               "cast.yaml:9: output: key 'every' is missing"};
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
    if (!strstr(err.message, parts[i])) fail_msg("'%s' is not said in:\n%s", parts[i], err.message);
}

static void the_interval_of_the_moulds_steps_is_read_and_resolved(void **state)
{
  (void)state;
  static const char *const words[] = {"auto", "each", "20 us"};
  static const double expected[] = {(double)INFINITY, 0.0, 20e-6};
  for (int k = 0; k < 3; k++) {
    char text[4096];
    snprintf(text, sizeof text, "%scoupling: { mould_step: %s }\n", CONFIG_LEAST, words[k]);
    CastConfig *config = config_case_read(text, "cast.yaml");
    const double found = config->coupling.mould_interval;
    assert_true(found == expected[k] || fabs(found - expected[k]) < 1e-15 * expected[k]); // units rounded
    CastConfig *again = config_case_again(config);
    assert_true(again->coupling.mould_interval == found);
    cast_config_destroy(&config);
    cast_config_destroy(&again);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_input_of_the_least_keys_gets_the_defaults),
      cmocka_unit_test(every_option_arrives),
      cmocka_unit_test(the_resolved_input_reads_again_to_the_same_bits),
      cmocka_unit_test(a_sound_speed_that_was_chosen_stands_in_the_resolved_input),
      cmocka_unit_test(all_faults_are_told_at_once),
      cmocka_unit_test(the_interval_of_the_moulds_steps_is_read_and_resolved),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
