/* H3 on meshes that castreduce makes: heat flux switched on at the wall of a mould, dT = 2 q sqrt(t/pi)/e at a plane
 * wall, dT = (q R/kappa) (1 - exp(x^2) erfc(x)), x = sqrt(alpha t)/R, at a spherical cavity (Carslaw and Jaeger,
 * section 9.10). With thin layers at the wall the error is below 1 % from t_start on; without them it is not, and the
 * estimate behind castreduce's warning says so. */
#include "tests/support/petsc_test.h"

#include <math.h>
#include <slepcsys.h>
#include <stdio.h>

#include "reduce/mesh/tets/resolution.h"
#include "tests/support/mould_case.h"
#include "tests/support/mould_files.h"
#include "tests/support/validation.h"

enum { OCTAVES = 14, STEPS = 10 }; // 1 ms to 8 s
static const double T_FIRST = 1e-3, TARGET = 0.01, RADIUS = 3e-3;

/* Deep enough: after 8 s the far end of 20 mm feels exp(-L^2/(4 alpha t)) = 2e-11. */
static const char PLANE[] =
    "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 4, 4, 20};\n"
    "Physical Volume(\"body\") = {1};\nwall() = Surface In BoundingBox{-1, -1, -1, 5, 5, 0.1};\n"
    "out() = Surface{:}; out() -= wall();\n"
    "Physical Surface(\"wall\") = {wall()}; Physical Surface(\"outer\") = {out()};\n";
static const char SPHERE[] = "SetFactory(\"OpenCASCADE\");\nBox(1) = {-15, -15, -15, 30, 30, 30};\n"
                             "Sphere(2) = {0, 0, 0, 3};\n"
                             "BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; }\n"
                             "Physical Volume(\"body\") = {Volume{:}};\n"
                             "wall() = Surface In BoundingBox{-4, -4, -4, 4, 4, 4};\n"
                             "out() = Surface{:}; out() -= wall();\n"
                             "Physical Surface(\"wall\") = {wall()}; Physical Surface(\"outer\") = {out()};\n";

typedef struct Case {
  const char *name, *geo, *mesh_size, *layers;
  bool sphere;
  int order;
} Case;

typedef struct Errors {
  double at_start, largest; // at 1 ms; from then to 8 s
  double estimate;          // of the first, as castreduce's warning has it
  PetscInt unknowns;
  double first_layer, mesh_size; // m
} Errors;

static ReduceConfig *config_of(const MouldFiles *files, const Case *of)
{
  char yaml[2048], path[128];
  CastError err;
  ReduceConfig *config = NULL;
  mould_files_write(files, "shape.geo", of->geo);
  snprintf(yaml, sizeof yaml,
           "geometry: { file: shape.geo, unit: mm }\n"
           "regions:\n"
           "  body: { material: { name: sand, density: 1800 kg/m^3, specific_heat: 1100 J/kg/K, conductivity: 1 W/m/K "
           "} }\n"
           "boundaries: { outer: { type: insulated } }\n"
           "cavity: { layers: %s, surfaces: { wall: { one_patch: true, mesh_size: %s } } }\n"
           "mesh: { outside_size: 4 mm, growth: 0.25, order: %d }\n"
           "reduction: { times: [1 ms, 8 s], tolerance: 1e-3 }\n"
           "output: { file: shape.rom.h5, band: 0.5 mm }\n",
           of->layers, of->mesh_size, of->order);
  snprintf(path, sizeof path, "%s/shape.yaml", files->folder);
  if (reduce_config_read(path, yaml, &config, &err) != CAST_OK) fail_msg("%s", err.message);
  return config;
}

static double exact_rise(const Case *of, double flux, double t)
{
  const double kappa = 1.0, alpha = kappa / (1800.0 * 1100.0), x = sqrt(alpha * t) / RADIUS;
  if (of->sphere) return flux * RADIUS / kappa * (1.0 - exp(x * x) * erfc(x));
  return 2.0 * flux * sqrt(alpha * t / M_PI) / kappa;
}

static Errors measure(const Case *of)
{
  MouldFiles files;
  MouldMesh *mesh = NULL;
  ThermalSystem *system = NULL;
  double temperature[OCTAVES * 2 * 2];
  mould_files_create(&files);
  ReduceConfig *config = config_of(&files, of);
  TEST_PETSC(mould_mesh_create(PETSC_COMM_WORLD, config, &mesh));
  TEST_PETSC(thermal_system_create(mesh, config, &system));
  TEST_PETSC(full_step_responses(system, system->B, T_FIRST, 2.0, OCTAVES, STEPS, temperature));
  Errors errors = {.unknowns = system->n, .first_layer = mesh->first_layer, .mesh_size = config->cavity[0].mesh_size};
  errors.estimate = resolution_error(config, &config->region[0].material, mesh->first_layer);
  for (int i = 0; i < OCTAVES; i++) { // the wall's answer to 1 W at the wall
    const double exact = exact_rise(of, 1.0 / system->area[0], T_FIRST * pow(2.0, i));
    const double error = fabs(temperature[(size_t)i * 4] / exact - 1.0);
    if (i == 0) errors.at_start = error;
    errors.largest = fmax(errors.largest, error);
  }
  TEST_PETSC(thermal_system_destroy(&system));
  TEST_PETSC(mould_mesh_destroy(&mesh));
  reduce_config_destroy(&config);
  mould_files_remove(&files);
  return errors;
}

static Errors measure_and_write(const Case *of, bool target)
{
  const double start = validation_cpu_time();
  const Errors errors = measure(of);
  ValidationRow row = {.id = "H3 mould mesh",
                       .quantity = validation_text("rise of the wall after 1 ms, %s", of->name),
                       .reference = of->sphere ? "closed form of a spherical hole" : "2 q sqrt(t/pi)/e",
                       .ours = validation_text("%" PetscInt_FMT " unknowns", errors.unknowns),
                       .error = validation_text("%.2f %% (castreduce's own estimate: %.1f %%)", 100 * errors.at_start,
                                                100 * errors.estimate),
                       .target = target ? "1 %" : "none",
                       .resolution = validation_text("triangles of %.1f mm at the wall, the first layer %.1f um",
                                                     1e3 * errors.mesh_size, 1e6 * errors.first_layer),
                       .cpu_seconds = validation_cpu_time() - start};
  validation_write(&row);
  row.quantity = validation_text("the same at any time from 1 ms to 8 s, %s", of->name);
  row.error = validation_text("%.2f %% at most", 100 * errors.largest);
  row.target = !target ? "none" : errors.largest < TARGET ? "1 %" : "1 % (missed)";
  validation_write(&row);
  printf("%s: %.3f %% at 1 ms, %.3f %% at most, estimate %.2f %%, %d unknowns\n", of->name, 100 * errors.at_start,
         100 * errors.largest, 100 * errors.estimate, (int)errors.unknowns);
  return errors;
}

static void thin_layers_meet_the_half_space_law_on_a_made_mesh(void **state)
{
  (void)state;
  const Case plane = {"plane wall, layers: auto", PLANE, "0.4 mm", "auto", false, 1};
  validation_begin("H3 mould mesh");
  const Errors errors = measure_and_write(&plane, true);
  assert_true(errors.at_start < TARGET);
  assert_true(errors.estimate < TARGET);
  assert_true(errors.largest < 1.5 * TARGET); // what elements of 0.4 mm behind the layers leave at 0.3 s
}

static void thin_layers_meet_the_law_of_a_spherical_cavity(void **state)
{
  (void)state;
  const Case sphere = {"spherical cavity of 3 mm, layers: auto", SPHERE, "0.4 mm", "auto", true, 1};
  const Errors errors = measure_and_write(&sphere, true);
  assert_true(errors.at_start < TARGET);
  assert_true(errors.largest < 3.0 * TARGET); // the same, and facets of an eighth of the radius
}

static void quadratic_elements_need_fewer_layers(void **state)
{
  (void)state;
  const Case plane = {"plane wall, layers: auto, order: 2", PLANE, "0.4 mm", "auto", false, 2};
  const Case sphere = {"spherical cavity of 3 mm, layers: auto, order: 2", SPHERE, "0.8 mm", "auto", true, 2};
  const Errors errors = measure_and_write(&plane, true), of_sphere = measure_and_write(&sphere, true);
  assert_true(errors.largest < TARGET);
  assert_true(errors.estimate < TARGET);
  assert_true(of_sphere.at_start < TARGET);
}

static void without_layers_the_mesh_is_wrong_and_the_estimate_says_so(void **state)
{
  (void)state;
  const Case plane = {"plane wall, no layers (a warning to users)", PLANE, "0.4 mm", "none", false, 1};
  const Errors errors = measure_and_write(&plane, false);
  assert_true(errors.at_start > 0.5);
  assert_true(fabs(errors.estimate - errors.at_start) < 0.2);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(thin_layers_meet_the_half_space_law_on_a_made_mesh),
      cmocka_unit_test(thin_layers_meet_the_law_of_a_spherical_cavity),
      cmocka_unit_test(quadratic_elements_need_fewer_layers),
      cmocka_unit_test(without_layers_the_mesh_is_wrong_and_the_estimate_says_so),
  };
  if (SlepcInitialize(&argc, &argv, NULL, NULL)) return 1;
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  return SlepcFinalize() ? 1 : failed;
}
