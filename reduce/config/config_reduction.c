/* config_reduction.c - how the model is reduced. A setting of the other method is refused, for it would do nothing. */
#include "reduce/config/config_private.h"

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

static const char *const METHODS[] = {"rational", "arnoldi", "modal", NULL}; // in the order of ReductionMethod

const char *reduce_config_method(ReductionMethod method)
{
  return METHODS[method];
}

/* A basis need only be much better than the model made of it; but what its solves leave over the certificate has to add,
 * and with more than this it may be more than the model's own error where that is far below the tolerance. Where
 * iterations do not get there a factor is made; without one, rounding limits what can be asked for. */
double reduce_config_solver_rtol(double tolerance, bool iterative)
{
  return fmin((iterative ? 1e-5 : 1e-6) * tolerance, 1e-6);
}

/* The settings of the methods; those of the others are refused. */
static CastStatus read_method(YamlNode reduction, ReductionConfig *config, CastError *err)
{
  const YamlNode moments = yaml_get(reduction, "moments"), s0 = yaml_get(reduction, "s0");
  const YamlNode shifts = yaml_get(reduction, "shifts"), modes = yaml_get(reduction, "modes");
  const char *method = METHODS[config->method];
  if (config->method != REDUCTION_ARNOLDI) {
    refuse(moments, method);
    refuse(s0, method);
  }
  if (config->method != REDUCTION_MODAL) refuse(modes, method);
  if (config->method != REDUCTION_RATIONAL) refuse(shifts, method);
  if (config->method == REDUCTION_ARNOLDI) {
    config->moments = yaml_integer(moments, 1, 1000, 5);
    config->s0 = yaml_quantity(s0, "1/s", YAML_NON_NEGATIVE, 0.0);
  }
  if (config->method == REDUCTION_MODAL) config->modes = yaml_integer(modes, 1, 100000, 0);
  return config->method == REDUCTION_RATIONAL ? read_shifts(shifts, config, err) : CAST_OK;
}

CastStatus config_read_reduction(YamlNode reduction, ReductionConfig *config, CastError *err)
{
  static const char *const solvers[] = {"automatic", "iterative", NULL};
  static const char *const bases[] = {"automatic", "memory", "disk", NULL};
  config->method = (ReductionMethod)yaml_choice(yaml_get(reduction, "method"), METHODS, REDUCTION_RATIONAL);
  read_times(yaml_require(reduction, "times"), config);
  config->tolerance = yaml_quantity(yaml_get(reduction, "tolerance"), "1", (YamlRange){0.0, 1.0, true}, 1e-3);
  config->deflation = yaml_quantity(yaml_get(reduction, "deflation"), "1", (YamlRange){0.0, 0.1, true}, 1e-8);
  config->second_stage = yaml_boolean(yaml_get(reduction, "second_stage"), config->method == REDUCTION_RATIONAL);
  config->iterative = yaml_choice(yaml_get(reduction, "solver"), solvers, 0) == 1;
  const YamlNode early = yaml_get(reduction, "second_stage_weight");
  if (!config->second_stage && yaml_exists(early)) yaml_problem(early, "there is no second stage");
  config->early_weight = yaml_quantity(early, "1", (YamlRange){0.0, 0.9, false}, 0.4);
  const bool arnoldi = config->method == REDUCTION_ARNOLDI; // whose moments build on one another: they must be exact
  const double rtol = arnoldi ? 1e-12 : reduce_config_solver_rtol(config->tolerance, config->iterative);
  config->solver_rtol = yaml_quantity(yaml_get(reduction, "solver_tolerance"), "1", (YamlRange){0.0, 0.1, true}, rtol);
  const YamlNode basis = yaml_get(reduction, "basis");
  if (config->method != REDUCTION_RATIONAL) refuse(basis, METHODS[config->method]);
  config->basis = (ReductionBasis)yaml_choice(basis, bases, BASIS_AUTOMATIC);
  return read_method(reduction, config, err);
}
