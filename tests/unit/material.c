/* Materials: the four ways to give an enthalpy curve, and the files that come with the programs. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "cast_build_config.h"
#include "common/hash.h"
#include "common/material/material.h"
#include "tests/support/assert_close.h"

static const double ZERO_CELSIUS = 273.15; // K

/* The material that stands under the key `m` of the text. */
static Material read_text(const char *text)
{
  YamlInput *input = NULL;
  CastError err;
  Material material;
  if (yaml_input_parse(text, "cast.yaml", &input, &err) != CAST_OK) fail_msg("%s", err.message);
  if (material_read(yaml_get(yaml_root(input), "m"), &material, &err) != CAST_OK) fail_msg("%s", err.message);
  if (yaml_input_finish(input, &err) != CAST_OK) fail_msg("%s", err.message);
  yaml_input_destroy(&input);
  return material;
}

static Material read_name(const char *name)
{
  char text[256];
  snprintf(text, sizeof text, "m: %s\n", name);
  return read_text(text);
}

static void latent_heat_stands_between_solidus_and_liquidus(void **state)
{
  (void)state;
  Material m = read_text("m: { density: 6900 kg/m^3, conductivity: 30 W/m/K, latent_heat: 230 kJ/kg,\n"
                         "     specific_heat: { solid: 440 J/kg/K, liquid: 560 J/kg/K },\n"
                         "     solidus: 1300 K, liquidus: 1311 K, viscosity: 5 mPa.s }\n");
  const double E_s = material_enthalpy(&m, 1300.0), E_l = material_enthalpy(&m, 1311.0);
  assert_close(E_s, 440.0 * 1300.0, 1e-9);                             // from absolute zero, to rounding
  assert_close(E_l - E_s, 230e3 + 0.5 * (440.0 + 560.0) * 11.0, 1e-9); // fs is linear, so c averages
  assert_close(material_enthalpy(&m, 1411.0) - E_l, 56e3, 1e-9);
  assert_close(material_enthalpy(&m, 5000.0) - E_l, 560.0 * (5000.0 - 1311.0), 1e-8); // goes on beyond its last point
  assert_close(material_specific_heat_min(&m), 440.0, 1e-9);
  assert_close(table_evaluate(&m.solid_fraction, 1302.75), 0.75, 1e-14);
  assert_true(m.specific_heat == 560.0 && m.latent_heat == 230e3);
  material_destroy(&m);
  assert_null(m.text);
}

static void solid_fraction_given_by_points_releases_heat_as_it_says(void **state)
{
  (void)state;
  Material m = read_text("m: { density: 2400 kg/m^3, conductivity: 65 W/m/K, latent_heat: 389 kJ/kg,\n"
                         "     specific_heat: 1000 J/kg/K, viscosity: 1.3 mPa.s,\n"
                         "     solid_fraction: [[828 K, 1], [850 K, 0.5], [888 K, 0]] }\n");
  assert_true(m.solidus == 828.0 && m.liquidus == 888.0);
  const double half = material_enthalpy(&m, 888.0) - material_enthalpy(&m, 850.0);
  assert_close(half, 0.5 * 389e3 + 38e3, 1e-9);
  assert_close(material_enthalpy(&m, 850.0) - material_enthalpy(&m, 828.0), 0.5 * 389e3 + 22e3, 1e-9);
  material_destroy(&m);
}

static void identity_makes_enthalpy_and_temperature_the_same_number(void **state)
{
  (void)state;
  Material m = read_name("paper-melt");
  for (double T = 0.0; T < 3000.0; T += 17.3) {
    assert_close(material_temperature(&m, T), T, 4e-16 * T); // rounding of one product and one quotient
    assert_close(material_enthalpy(&m, T), T, 4e-16 * T);
  }
  assert_true(isnan(m.solidus) && m.solid_fraction.n == 0 && m.latent_heat == 0.0);
  material_destroy(&m);
}

static void constant_extraction_gives_back_the_cooling_curve(void **state)
{
  (void)state;
  // 50 J/cm3/s on 6900 kg/m3: 14 K/s outside a plateau of 34 s (the paper's Fig. 3)
  Material m = read_text("m:\n  density: 6900 kg/m^3\n  conductivity: 30 W/m/K\n  viscosity: 5 mPa.s\n"
                         "  cooling_curve:\n    rate: 50 J/cm^3/s\n"
                         "    curve: [[0 s, 1400 K], [6 s, 1316 K], [40 s, 1315 K], [50 s, 1175 K]]\n"
                         "  solidus: 1315 K\n  liquidus: 1316 K\n");
  const double t[] = {0.0, 6.0, 40.0, 50.0}, T[] = {1400.0, 1316.0, 1315.0, 1175.0};
  const double start = material_enthalpy(&m, 1400.0);
  for (int i = 0; i < 3; i++)
    for (int k = 0; k <= 10; k++) {
      const double now = t[i] + 0.1 * k * (t[i + 1] - t[i]);
      const double expected = T[i] + 0.1 * k * (T[i + 1] - T[i]);
      assert_close(material_temperature(&m, start - 50e6 * now / 6900.0), expected, 1e-10); // rounding over 1400 K
    }
  assert_close(m.specific_heat, 50e6 / 6900.0 / 14.0, 1e-9); // of the liquid
  const double sensible = 50e6 / 6900.0 / 14.0;              // 14 K/s on both sides, 1 K of it in the plateau
  assert_close(m.latent_heat, 50e6 / 6900.0 * 34.0 - sensible, 1e-8);
  assert_close(table_evaluate(&m.solid_fraction, 1315.5), 0.5, 1e-12);
  material_destroy(&m);
}

static void fraction_of_a_given_curve_follows_its_enthalpy(void **state)
{
  (void)state;
  Material m =
      read_text("m: { density: 1 kg/m^3, conductivity: 1 W/m/K, viscosity: 1 Pa.s, solidus: 950 K, liquidus: 1050 K,\n"
                "     enthalpy: [[900 K, 0 J/kg], [950 K, 50 kJ/kg], [1000 K, 250 kJ/kg], [1050 K, 350 kJ/kg],"
                " [1100 K, 400 kJ/kg]] }\n");
  assert_int_equal(m.solid_fraction.n, 3);
  assert_close(table_evaluate(&m.solid_fraction, 1000.0), 1.0 / 3.0, 1e-15); // (350 - 250)/(350 - 50)
  assert_close(m.latent_heat, 300e3 - 1000.0 * 100.0, 1e-8);
  assert_close(m.specific_heat, 1000.0, 1e-12);
  material_destroy(&m);
  // without a freezing range the curve is used as it is
  m = read_text("m: { density: 1 kg/m^3, conductivity: 1 W/m/K, enthalpy: [[900 K, 0 J/kg], [950 K, 50 kJ/kg]] }\n");
  assert_true(isnan(m.solidus) && m.solid_fraction.n == 0 && m.latent_heat == 0.0);
  material_destroy(&m);
}

static void properties_may_depend_on_temperature(void **state)
{
  (void)state;
  Material m =
      read_text("m: { density: 1 kg/m^3, specific_heat: 1 J/kg/K, conductivity: [[300 K, 2 W/m/K], [400 K, 4 W/m/K]],\n"
                "     viscosity: { value: [[300 K, 9 mPa.s], [310 K, 7 mPa.s]], source: here, quality: ours },\n"
                "     contact_angle: 180 deg }\n");
  assert_close(table_evaluate(&m.conductivity_of_t, 350.0), 3.0, 1e-15 * 3.0);
  assert_close(table_evaluate(&m.viscosity_of_t, 305.0), 8e-3, 1e-17);
  assert_true(m.conductivity == 4.0);
  assert_close(m.contact_angle, 3.14159265358979, 1e-14);
  CastError err;
  assert_int_equal(material_check_mould(&m, &err), CAST_ERR_INPUT);
  assert_non_null(strstr(err.message, "must be one constant value"));
  material_destroy(&m);
}

static void melts_and_moulds_are_told_apart(void **state)
{
  (void)state;
  static const char *const MELTS[] = {"cual10", "au57ag25cu13pd4", "a356", "aluminium", "tin", "gallium", "paper-melt"};
  static const char *const MOULDS[] = {"phosphate-bonded", "gypsum", "ceramic-shell", "h13-steel", "paper-mould"};
  CastError err;
  for (size_t i = 0; i < sizeof MELTS / sizeof *MELTS; i++) {
    Material m = read_name(MELTS[i]);
    assert_int_equal(material_check_melt(&m, &err), CAST_OK);
    if (isfinite(m.solidus)) assert_int_equal(material_check_mould(&m, &err), CAST_ERR_INPUT);
    material_destroy(&m);
  }
  for (size_t i = 0; i < sizeof MOULDS / sizeof *MOULDS; i++) {
    Material m = read_name(MOULDS[i]);
    assert_int_equal(material_check_mould(&m, &err), CAST_OK);
    assert_int_equal(material_check_melt(&m, &err), CAST_ERR_INPUT);
    material_destroy(&m);
  }
}

static void shipped_numbers_are_in_si(void **state)
{
  (void)state;
  Material m = read_name("cual10");
  assert_close(m.solidus, 1027.0 + ZERO_CELSIUS, 1e-9);
  assert_close(m.contact_angle, 130.0 * 3.14159265358979 / 180.0, 1e-12);
  assert_true(m.density == 6900.0 && m.latent_heat == 230e3 && m.conductivity == 30.0 && m.surface_tension == 1.25);
  material_destroy(&m);
  m = read_name("ceramic-shell");
  assert_close(m.reference_temperature, 1000.0 + ZERO_CELSIUS, 1e-9);
  assert_true(m.conductivity == 1.89);
  material_destroy(&m);
}

/* Every property of a material is a map that says where it comes from and how good it is. */
static size_t check_provenance(const char *path)
{
  static const char *const BARE[] = {"name", "identity", "reference_temperature"};
  YamlInput *input = NULL;
  CastError err;
  if (yaml_input_load(path, &input, &err) != CAST_OK) fail_msg("%s", err.message);
  const YamlNode root = yaml_root(input);
  size_t properties = 0;
  for (size_t i = 0; i < yaml_count(root); i++) {
    bool bare = false;
    for (size_t k = 0; k < 3; k++) bare = bare || strcmp(yaml_key(root, i), BARE[k]) == 0;
    if (bare) continue;
    const YamlNode property = yaml_value(root, i);
    if (!yaml_is_map(property) || !yaml_exists(yaml_get(property, "source")) ||
        !yaml_exists(yaml_get(property, "quality")))
      fail_msg("%s: %s has no source or no quality", path, yaml_key(root, i));
    properties++;
  }
  yaml_input_destroy(&input);
  return properties;
}

static void every_shipped_property_says_its_source_and_quality(void **state)
{
  (void)state;
  char folder[4096], path[8192];
  snprintf(folder, sizeof folder, "%s/materials", CAST_SHARE_SOURCE);
  DIR *directory = opendir(folder);
  assert_non_null(directory);
  size_t files = 0;
  const struct dirent *entry;
  while ((entry = readdir(directory))) {
    if (!strstr(entry->d_name, ".yaml")) continue;
    snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
    assert_true(check_provenance(path) >= 3);
    files++;
  }
  closedir(directory);
  assert_true(files >= 12);
}

static void write_file(const char *path, const char *text)
{
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
}

static void share_folder_of_the_environment_comes_first(void **state)
{
  (void)state;
  char folder[] = "/tmp/share_XXXXXX", path[256], saved[4096];
  assert_non_null(mkdtemp(folder));
  const char *before = getenv("CAST_SHARE");
  snprintf(saved, sizeof saved, "%s", before ? before : "");
  snprintf(path, sizeof path, "%s/materials", folder);
  assert_int_equal(mkdir(path, 0700), 0);
  snprintf(path, sizeof path, "%s/materials/gypsum.yaml", folder);
  write_file(path, "name: our own gypsum\ndensity: 7 kg/m^3\nspecific_heat: 1 J/kg/K\nconductivity: 1 W/m/K\n");
  setenv("CAST_SHARE", folder, 1);
  Material ours = read_name("gypsum"), shipped = read_name("h13-steel");
  if (before)
    setenv("CAST_SHARE", saved, 1);
  else
    unsetenv("CAST_SHARE");
  assert_string_equal(ours.name, "our own gypsum");
  assert_string_equal(shipped.name, "H13 steel");
  material_destroy(&ours);
  material_destroy(&shipped);
  unlink(path);
  *strrchr(path, '/') = '\0';
  rmdir(path);
  rmdir(folder);
}

static void path_is_taken_beside_the_input_file(void **state)
{
  (void)state;
  char folder[] = "/tmp/input_XXXXXX", input_path[256], path[256], hex[65];
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/mine.yaml", folder);
  snprintf(input_path, sizeof input_path, "%s/mould.yaml", folder);
  const char *text = "density: 7 kg/m^3\nspecific_heat: 1 J/kg/K\nconductivity: 1 W/m/K\n";
  write_file(path, text);
  write_file(input_path, "m: mine.yaml\n");
  YamlInput *input = NULL;
  CastError err;
  Material m;
  assert_int_equal(yaml_input_load(input_path, &input, &err), CAST_OK);
  assert_int_equal(material_read(yaml_get(yaml_root(input), "m"), &m, &err), CAST_OK);
  assert_int_equal(yaml_input_finish(input, &err), CAST_OK);
  assert_string_equal(m.name, "mine");
  assert_string_equal(m.text, text);
  hash_bytes(text, strlen(text), hex);
  assert_string_equal(m.sha256, hex);
  material_destroy(&m);
  yaml_input_destroy(&input);
  unlink(path);
  unlink(input_path);
  rmdir(folder);
}

static void inline_material_keeps_its_own_text_only(void **state)
{
  (void)state;
  Material m = read_text(
      "# 20 °C\nm:\n  density: 7 kg/m^3 # heavy\n  specific_heat: 1 J/kg/K\n  conductivity: 1 W/m/K\n# after\n");
  const char *text = "density: 7 kg/m^3 # heavy\n  specific_heat: 1 J/kg/K\n  conductivity: 1 W/m/K";
  char hex[65];
  hash_bytes(text, strlen(text), hex);
  assert_string_equal(m.text, text);
  assert_string_equal(m.sha256, hex);
  assert_string_equal(m.name, "inline");
  material_destroy(&m);
}

static void unknown_name_lists_the_known_ones(void **state)
{
  (void)state;
  YamlInput *input = NULL;
  CastError err;
  Material m;
  assert_int_equal(yaml_input_parse("m: gipsum\n", "cast.yaml", &input, &err), CAST_OK);
  assert_int_equal(material_read(yaml_get(yaml_root(input), "m"), &m, &err), CAST_OK); // a problem of the input
  assert_int_equal(yaml_input_finish(input, &err), CAST_ERR_INPUT);
  assert_non_null(
      strstr(err.message, "cast.yaml:1: m: there is no material 'gipsum'; known by name: a356, aluminium, "));
  assert_non_null(strstr(err.message, ", gypsum, h13-steel, "));
  material_destroy(&m);
  yaml_input_destroy(&input);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(latent_heat_stands_between_solidus_and_liquidus),
      cmocka_unit_test(solid_fraction_given_by_points_releases_heat_as_it_says),
      cmocka_unit_test(identity_makes_enthalpy_and_temperature_the_same_number),
      cmocka_unit_test(constant_extraction_gives_back_the_cooling_curve),
      cmocka_unit_test(fraction_of_a_given_curve_follows_its_enthalpy),
      cmocka_unit_test(properties_may_depend_on_temperature),
      cmocka_unit_test(melts_and_moulds_are_told_apart),
      cmocka_unit_test(shipped_numbers_are_in_si),
      cmocka_unit_test(every_shipped_property_says_its_source_and_quality),
      cmocka_unit_test(share_folder_of_the_environment_comes_first),
      cmocka_unit_test(path_is_taken_beside_the_input_file),
      cmocka_unit_test(inline_material_keeps_its_own_text_only),
      cmocka_unit_test(unknown_name_lists_the_known_ones),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
