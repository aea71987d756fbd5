/* Velocity Verlet with the density predicted for the forces and corrected afterwards; see sph.h.
 * What stops a run (a number that is not finite, a particle faster than sound) is looked for here, once a step. */
#include <math.h>

#include "cast/kernel/dispatch.h"
#include "cast/kernel/pair.h"
#include "cast/physics/properties.h"
#include "cast/physics/solidification.h"
#include "cast/physics/sph.h"
#include "cast/physics/wall_guard.h"

enum { ROWS_PER_TASK = 512 };

typedef struct Drift {
  const SphParameters *sph;
  Particles *p;
  double dt;
} Drift;

SIMD_CLONES static void drift_rows(const Drift *d, ptrdiff_t first, ptrdiff_t end)
{
  const Particles *p = d->p;
  const double dt = d->dt, half = 0.5 * dt;
  const bool continuity = d->sph->density == SPH_CONTINUITY;
  const double lock = solidification_of(d->sph->melt).lock_enthalpy;
  const double *w = d->sph->spin.rate;
#pragma omp simd
  for (ptrdiff_t i = first; i < end; i++) {
    const double free = p->E[i] > lock ? 1.0 : 0.0; // a skeleton of solid stands where it is
    // Coriolis' acceleration of the velocity at the step's start: -2 w x v dt/2
    const double turned[3] = {dt * (p->v[1][i] * w[2] - p->v[2][i] * w[1]),
                              dt * (p->v[2][i] * w[0] - p->v[0][i] * w[2]),
                              dt * (p->v[0][i] * w[1] - p->v[1][i] * w[0])};
    double moved2 = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      const double v = free * (p->v[axis][i] + p->a[axis][i] * half + turned[axis]);
      p->v[axis][i] = v;
      p->x[axis][i] += v * dt;
      moved2 += v * v;
    }
    p->clearance[i] -= sqrt(moved2) * dt;
    p->rho_start[i] = p->rho[i];
    const double last = isnan(p->drho_last[i]) ? p->drho[i] : p->drho_last[i]; // NaN: this is the first step
    const double predicted = p->rho[i] + dt * (2.0 * p->drho[i] - last);
    p->rho[i] = continuity ? predicted : p->rho[i];
    p->drho_last[i] = p->drho[i];
  }
}

static ptrdiff_t first_not_finite(const Particles *p)
{
  ptrdiff_t bad = p->n_fluid;
#pragma omp parallel for simd reduction(min : bad)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const double all = p->x[0][i] + p->x[1][i] + p->x[2][i] + p->v[0][i] + p->v[1][i] + p->v[2][i];
    const ptrdiff_t found = isfinite(all) ? p->n_fluid : i;
    bad = found < bad ? found : bad;
  }
  return bad;
}

CastStatus sph_drift(const SphParameters *sph, Particles *p, const Surface *surface, double dt, long *guarded,
                     CastError *err)
{
  if (guarded) *guarded = 0;
  if (sph->frozen_flow) return CAST_OK;
  const Drift drift = {sph, p, dt};
  const WallGuard guard = {sph, surface, dt};
  long set_back = 0;
#pragma omp parallel for reduction(+ : set_back)
  for (ptrdiff_t first = 0; first < p->n_fluid; first += ROWS_PER_TASK) {
    const ptrdiff_t end = first + ROWS_PER_TASK < p->n_fluid ? first + ROWS_PER_TASK : p->n_fluid;
    drift_rows(&drift, first, end);
    if (surface) set_back += wall_guard_rows(&guard, p, first, end);
  }
  if (guarded) *guarded = set_back;
  const ptrdiff_t bad = first_not_finite(p);
  CAST_CHECK(bad == p->n_fluid, err, CAST_ERR_NUMERIC,
             "particle %d: its place (%g, %g, %g) m or velocity (%g, %g, %g) m/s is not finite", p->id[bad],
             p->x[0][bad], p->x[1][bad], p->x[2][bad], p->v[0][bad], p->v[1][bad], p->v[2][bad]);
  return CAST_OK;
}

/* ---- end of the step ---- */

/* v' = -v mu_l/(rho K), implicit: the drag of a dense mush is far stiffer than any step. */
static void drag_rows(const Material *melt, const Solidification *freezing, Particles *p, double dt, ptrdiff_t first,
                      ptrdiff_t end)
{
  for (ptrdiff_t i = first; i < end; i++) {
    if (p->T[i] >= freezing->liquidus || p->E[i] <= freezing->lock_enthalpy) continue;
    const double mu = table_evaluate(&melt->viscosity_of_t, p->T[i]),
                 fs = table_evaluate(&melt->solid_fraction, p->T[i]);
    const double keep = 1.0 / (1.0 + dt * mu / p->rho[i] * solidification_drag(fs, freezing->arm));
    for (int axis = 0; axis < 3; axis++) p->v[axis][i] *= keep;
  }
}

SIMD_CLONES static void finish_rows(const SphParameters *sph, Particles *p, double dt, ptrdiff_t first, ptrdiff_t end)
{
  const bool flow = !sph->frozen_flow, continuity = flow && sph->density == SPH_CONTINUITY;
  const double lock_enthalpy = solidification_of(sph->melt).lock_enthalpy;
  const double w[3] = {dt * sph->spin.rate[0], dt * sph->spin.rate[1], dt * sph->spin.rate[2]};
  const double scale = 1.0 / (1.0 + w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
#pragma omp simd
  for (ptrdiff_t i = first; i < end; i++) {
    const double free = p->E[i] > lock_enthalpy ? 1.0 : 0.0;
    if (flow) {
      double u[3];
      for (int axis = 0; axis < 3; axis++) u[axis] = p->v[axis][i] + p->a[axis][i] * 0.5 * dt;
      // Coriolis' acceleration of the velocity at the step's end, v + dt w x v = u: with its other half, taken at the
      // next step's start, a turn that neither gains nor loses speed
      const double along = w[0] * u[0] + w[1] * u[1] + w[2] * u[2];
      const double cross[3] = {w[1] * u[2] - w[2] * u[1], w[2] * u[0] - w[0] * u[2], w[0] * u[1] - w[1] * u[0]};
      for (int axis = 0; axis < 3; axis++) p->v[axis][i] = free * scale * (u[axis] - cross[axis] + w[axis] * along);
    }
    p->rho[i] = continuity ? p->rho_start[i] + p->drho[i] * dt : p->rho[i];
    p->volume[i] = p->mass[i] / whole_density(p->rho[i], sph->rho0);
    p->E[i] += p->heat[i] * dt / p->mass[i];
  }
}

typedef enum Fault { FAULT_NONE, FAULT_SPEED, FAULT_DENSITY, FAULT_ENTHALPY, FAULT_TEMPERATURE, FAULT_FAST } Fault;

/* What is wrong with particle i, the first of all there may be. */
static Fault fault_of(const SphParameters *sph, const Particles *p, ptrdiff_t i)
{
  const double v2 = p->v[0][i] * p->v[0][i] + p->v[1][i] * p->v[1][i] + p->v[2][i] * p->v[2][i];
  if (!isfinite(v2)) return FAULT_SPEED;
  if (!(p->rho[i] > 0.0) || !isfinite(p->rho[i])) return FAULT_DENSITY;
  if (!isfinite(p->E[i])) return FAULT_ENTHALPY;
  if (sph->melt && !(p->T[i] >= 0.0 && isfinite(p->T[i]))) return FAULT_TEMPERATURE;
  return v2 > sph->c0 * sph->c0 ? FAULT_FAST : FAULT_NONE;
}

/* Is none of them at fault? The same as fault_of for whole vectors: differences of numbers that are not finite are no
 * zero. */
SIMD_CLONES static bool rows_are_sound(const SphParameters *sph, const Particles *p, ptrdiff_t first, ptrdiff_t end)
{
  const double most2 = sph->c0 * sph->c0;
  const bool melt = sph->melt != NULL;
  int faults = 0;
#pragma omp simd reduction(+ : faults)
  for (ptrdiff_t i = first; i < end; i++) {
    const double v2 = p->v[0][i] * p->v[0][i] + p->v[1][i] * p->v[1][i] + p->v[2][i] * p->v[2][i];
    const double rho = p->rho[i], T = melt ? p->T[i] : 0.0;
    const double finite = (v2 - v2) + (rho - rho) + (p->E[i] - p->E[i]) + (T - T);
    faults += !(v2 <= most2) | !(rho > 0.0) | !(T >= 0.0) | !(finite == 0.0);
  }
  return faults == 0;
}

static CastStatus report_fault(const SphParameters *sph, const Particles *p, ptrdiff_t i, CastError *err)
{
  const Fault fault = fault_of(sph, p, i);
  const double x = p->x[0][i], y = p->x[1][i], z = p->x[2][i];
  const double v = sqrt(p->v[0][i] * p->v[0][i] + p->v[1][i] * p->v[1][i] + p->v[2][i] * p->v[2][i]);
  if (fault == FAULT_FAST)
    return cast_error_set(err, CAST_ERR_NUMERIC,
                          "particle %d at (%g, %g, %g) m: its speed %g m/s is beyond the numerical sound speed %g m/s",
                          p->id[i], x, y, z, v, sph->c0);
  const struct {
    const char *name, *unit;
    double value;
  } found[] = {[FAULT_NONE] = {"state", "", 0.0},
               [FAULT_SPEED] = {"speed", "m/s", v},
               [FAULT_DENSITY] = {"density", "kg/m3", p->rho[i]},
               [FAULT_ENTHALPY] = {"enthalpy", "J/kg", p->E[i]},
               [FAULT_TEMPERATURE] = {"temperature", "K", p->T[i]}};
  return cast_error_set(err, CAST_ERR_NUMERIC, "particle %d at (%g, %g, %g) m: its %s of %g %s is not possible",
                        p->id[i], x, y, z, found[fault].name, found[fault].value, found[fault].unit);
}

CastStatus sph_finish(const SphParameters *sph, Particles *p, double dt, CastError *err)
{
  ptrdiff_t bad = p->n_fluid;
  const Solidification freezing = solidification_of(sph->melt);
  const bool mush = !sph->frozen_flow && freezing.arm > 0.0;
#pragma omp parallel for reduction(min : bad)
  for (ptrdiff_t first = 0; first < p->n_fluid; first += ROWS_PER_TASK) {
    const ptrdiff_t end = first + ROWS_PER_TASK < p->n_fluid ? first + ROWS_PER_TASK : p->n_fluid;
    finish_rows(sph, p, dt, first, end);
    properties_of_rows(sph->melt, p, first, end);
    if (mush) drag_rows(sph->melt, &freezing, p, dt, first, end);
    if (rows_are_sound(sph, p, first, end)) continue;
    for (ptrdiff_t i = first; i < end; i++)
      if (fault_of(sph, p, i) != FAULT_NONE) bad = i < bad ? i : bad;
  }
  return bad == p->n_fluid ? CAST_OK : report_fault(sph, p, bad, err);
}
