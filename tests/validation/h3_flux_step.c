/* H3: heat flux switched on at the wall of a half-space, dT = 2 q sqrt(t/pi)/e, e = sqrt(kappa rho c). The full FEM
 * model and the reduced one on a column of mould, insulated on its sides, deep enough (80 mm) that 100 s do not reach
 * its end: exp(-x^2/(4 alpha t)) = 4e-14. */
#include "tests/support/petsc_test.h"

#include <math.h>
#include <slepcsys.h>

#include "tests/support/mould_case.h"
#include "tests/support/validation.h"

enum { OCTAVES = 17, STEPS = 10, LAYERS = 96 }; // 1 ms to 65 s
static const double T_FIRST = 1e-3, TARGET = 0.01, GRADING = 3.0;

static BoxMould column(int layers, double grading)
{
  const BoxMould box = {.size = {0.002, 0.002, 0.08},
                        .cells = {2, 2, layers},
                        .grading = grading,
                        .patches = {1, 1},
                        .kappa = {1.0},
                        .rho = {1800.0},
                        .c = {1100.0}};
  return box;
}

static double effusivity(const BoxMould *box)
{
  return sqrt(box->kappa[0] * box->rho[0] * box->c[0]);
}

static double exact_rise(const BoxMould *box, double flux, double t)
{
  return 2.0 * flux * sqrt(t / M_PI) / effusivity(box);
}

typedef struct Errors {
  double full, reduced; // largest relative error from 1 ms to 65 s
  double full_at_1s;    // K, for a flux of 1e5 W/m2
  double first_layer;   // m
  int order;            // of the reduced model
} Errors;

static Errors measure(int layers, double grading, bool reduce)
{
  const BoxMould box = column(layers, grading);
  const double area = box.size[0] * box.size[1];
  Errors errors = {.first_layer = box.size[2] * pow(1.0 / layers, grading)};
  MouldCase mould;
  ReducedModel *model = NULL;
  ReductionConfig config = rational_config();
  double temperature[OCTAVES * 3 * 3], *now, reduced[3];
  TEST_PETSC(mould_case_create(PETSC_COMM_WORLD, &box, &mould));
  TEST_PETSC(full_step_responses(mould.system, mould.system->B, T_FIRST, 2.0, OCTAVES, STEPS, temperature));
  if (reduce) TEST_PETSC(reduced_model_create(mould.system, &config, NULL, &model));
  for (int i = 0; i < OCTAVES; i++) { // input and output: patch 0 of 3, 1 W
    const double t = T_FIRST * pow(2.0, i), exact = exact_rise(&box, 1.0 / area, t);
    now = temperature + (size_t)i * 9;
    errors.full = fmax(errors.full, fabs(now[0] / exact - 1.0));
    if (i == 10) errors.full_at_1s = now[0] * 1e5 * area * sqrt(1.0 / t); // 1.024 s, scaled with the exact law
    if (!reduce) continue;
    reduced_step_response(model, 0, t, reduced);
    errors.reduced = fmax(errors.reduced, fabs(reduced[0] / exact - 1.0));
  }
  if (reduce) errors.order = (int)model->r;
  TEST_PETSC(reduced_model_destroy(&model));
  TEST_PETSC(mould_case_destroy(&mould));
  return errors;
}

static void wall_temperature_follows_the_half_space_law(void **state)
{
  (void)state;
  const double start = validation_cpu_time();
  validation_begin("H3");
  const Errors fine = measure(LAYERS, GRADING, true), coarse = measure(LAYERS / 2, GRADING, false);
  const char *resolution =
      validation_text("%d layers, the first %.1f um; with half of them %.2f %%, order %.2f", LAYERS,
                      1e6 * fine.first_layer, 100 * coarse.full, log2(coarse.full / fine.full));
  const BoxMould box = column(LAYERS, GRADING);
  validation_write(&(ValidationRow){
      .id = "H3",
      .quantity = "rise of the wall under a constant flux, full FEM, 1 ms to 65 s",
      .reference = validation_text("2 q sqrt(t/pi)/e; %.1f K at 1 s for 1e5 W/m2", exact_rise(&box, 1e5, 1.0)),
      .ours = validation_text("%.2f K at 1 s", fine.full_at_1s),
      .error = validation_text("%.3f %% at most", 100 * fine.full),
      .target = "1 %",
      .resolution = resolution,
      .cpu_seconds = validation_cpu_time() - start});
  validation_write(&(ValidationRow){.id = "H3",
                                    .quantity = "the same, reduced model (tolerance 1e-3)",
                                    .reference = "2 q sqrt(t/pi)/e",
                                    .ours = validation_text("%d states", fine.order),
                                    .error = validation_text("%.3f %% at most", 100 * fine.reduced),
                                    .target = "1 %",
                                    .resolution = resolution,
                                    .cpu_seconds = validation_cpu_time() - start});
  assert_true(fine.full < TARGET);
  assert_true(fine.reduced < TARGET);
  assert_true(fine.full < coarse.full / 2.5); // at least order 1.3: the mesh is what is left of the error
}

/* A first layer thicker than the heat's depth sqrt(alpha t) is wrong whatever the reduction. */
static void thick_first_layer_spoils_early_times(void **state)
{
  (void)state;
  const Errors uniform = measure(LAYERS, 1.0, false);
  validation_write(&(ValidationRow){.id = "H3",
                                    .quantity = "the same on a mesh too coarse at the wall (a warning to users)",
                                    .reference = "2 q sqrt(t/pi)/e",
                                    .ours = "",
                                    .error = validation_text("%.0f %% at most", 100 * uniform.full),
                                    .target = "none",
                                    .resolution = validation_text("first layer %.0f um against %.0f um at 1 ms",
                                                                  1e6 * uniform.first_layer,
                                                                  1e6 * sqrt(T_FIRST / (1800.0 * 1100.0))),
                                    .cpu_seconds = 0.0});
  assert_true(uniform.full > 0.5);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(wall_temperature_follows_the_half_space_law),
      cmocka_unit_test(thick_first_layer_spoils_early_times),
  };
  if (SlepcInitialize(&argc, &argv, NULL, NULL)) return 1;
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  return SlepcFinalize() ? 1 : failed;
}
