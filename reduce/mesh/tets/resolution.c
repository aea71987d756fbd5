#include "reduce/mesh/tets/resolution.h"

#include <math.h>

double resolution_depth(const Material *material, double t)
{
  return sqrt(material->conductivity / (material->density * material->specific_heat) * t);
}

double resolution_layer(const ReduceConfig *config, const Material *material)
{
  const bool linear = config->order == 1;
  const double depth = (linear ? 0.25 : 1.0) * resolution_depth(material, config->reduction.t_start);
  if (!(config->contact > 0)) return depth;
  return fmax(depth, (linear ? 0.05 : 0.12) * material->conductivity / config->contact);
}

/* `ratio`: first layer over sqrt(alpha t) */
static double error_of_ratio(int order, double ratio)
{
  const double f = order == 1 ? ratio : fmax(ratio - 3.0, 0.0);
  return fmin(1.0, (order == 1 ? 4e-3 : 4e-4) + f * f / (f * f + (order == 1 ? 30.0 : 80.0)));
}

double resolution_error(const ReduceConfig *config, const Material *material, double height)
{
  enum { PER_OCTAVE = 4, MOST = 400 };
  const double kappa = material->conductivity;
  double worst = 0.0, t = config->reduction.t_start;
  for (int i = 0; i < MOST && t <= config->reduction.t_end; i++, t *= exp2(1.0 / PER_OCTAVE)) {
    const double depth = resolution_depth(material, t);
    const double impedance = config->contact * M_2_SQRTPI * depth / kappa; // h Z(t)
    const double part = config->contact > 0 ? impedance / (1.0 + impedance) : 1.0;
    worst = fmax(worst, part * error_of_ratio(config->order, height / depth));
  }
  return worst;
}
