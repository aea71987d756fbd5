/* config_reduction.c - how the model is reduced. A setting of the other method is refused, for it would do nothing. */
#include "reduce/config_private.h"

#include <math.h>

static void refuse(YamlNode node, const char *method)
{
  if (yaml_exists(node)) yaml_problem(node, "has no meaning for method %s", method);
}

static void read_times(YamlNode times, ReductionConfig *config)
{
  config->t_start = config->t_end = NAN;
  if (!yaml_exists(times)) return;
  if (!yaml_is_sequence(times) || yaml_count(times) != 2) {
    yaml_problem(times, "two times are expected: '[1 ms, 100 s]'");
    return;
  }
  config->t_start = yaml_quantity(yaml_item(times, 0), "s", YAML_POSITIVE, NAN);
  config->t_end = yaml_quantity(yaml_item(times, 1), "s", YAML_POSITIVE, NAN);
  if (config->t_end <= config->t_start)
    yaml_problem(times, "the second time, %g s, must be after the first, %g s", config->t_end, config->t_start);
}

static CastStatus read_shifts(YamlNode shifts, ReductionConfig *config, CastError *err)
{
  if (!yaml_exists(shifts)) return CAST_OK;
  if (!yaml_is_sequence(shifts) || yaml_count(shifts) == 0) {
    yaml_problem(shifts, "a list of rates is expected: '[0.01 1/s, 10 1/s]'");
    return CAST_OK;
  }
  config->shifts = config_array(yaml_count(shifts), sizeof *config->shifts);
  CAST_CHECK(config->shifts, err, CAST_ERR_MEMORY, CONFIG_NO_MEMORY);
  config->n_shifts = yaml_count(shifts);
  for (size_t i = 0; i < config->n_shifts; i++) {
    config->shifts[i] = yaml_quantity(yaml_item(shifts, i), "1/s", YAML_POSITIVE, NAN);
    for (size_t k = 0; k < i; k++)
      if (config->shifts[k] == config->shifts[i])
        yaml_problem(yaml_item(shifts, i), "%g 1/s stands here already", config->shifts[i]);
  }
  return CAST_OK;
}

CastStatus config_read_reduction(YamlNode reduction, ReductionConfig *config, CastError *err)
{
  static const char *const methods[] = {"rational", "arnoldi", NULL}, *const solvers[] = {"automatic", "iterative",
                                                                                          NULL};
  config->method = (ReductionMethod)yaml_choice(yaml_get(reduction, "method"), methods, REDUCTION_RATIONAL);
  read_times(yaml_require(reduction, "times"), config);
  config->tolerance = yaml_quantity(yaml_get(reduction, "tolerance"), "1", (YamlRange){0.0, 1.0, true}, 1e-3);
  config->deflation = yaml_quantity(yaml_get(reduction, "deflation"), "1", (YamlRange){0.0, 0.1, true}, 1e-8);
  config->second_stage = yaml_boolean(yaml_get(reduction, "second_stage"), config->method == REDUCTION_RATIONAL);
  config->iterative = yaml_choice(yaml_get(reduction, "solver"), solvers, 0) == 1;
  // moments build on one another and must be exact; a basis need only be much better than the model made of it
  const double rtol = config->method == REDUCTION_ARNOLDI ? 1e-12 : 1e-2 * config->tolerance;
  config->solver_rtol = yaml_quantity(yaml_get(reduction, "solver_tolerance"), "1", (YamlRange){0.0, 0.1, true}, rtol);
  const YamlNode moments = yaml_get(reduction, "moments"), s0 = yaml_get(reduction, "s0");
  const YamlNode shifts = yaml_get(reduction, "shifts");
  if (config->method == REDUCTION_ARNOLDI) {
    refuse(shifts, "arnoldi");
    config->moments = yaml_integer(moments, 1, 1000, 5);
    config->s0 = yaml_quantity(s0, "1/s", YAML_NON_NEGATIVE, 0.0);
    return CAST_OK;
  }
  refuse(moments, "rational");
  refuse(s0, "rational");
  return read_shifts(shifts, config, err);
}
