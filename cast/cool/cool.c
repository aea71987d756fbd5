/* Cooling in adaptive implicit steps.
 *
 * Method  A step of dt is taken once, and again as two of dt/2. Half the difference is the error of the two, of first
 *         order; the result, 2 (two halves) - (the whole), is of second order (Richardson; Hairer, Norsett & Wanner
 * 1993, section II.4), and stable for any stiffness as backward Euler is. Enthalpies, the mould's state and its losses
 *         are all taken so, hence the books close. The next step goes by the square root of the error.
 * References docs/theory, section 6 */
#include "cast/cool/cool.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cast/cool/solve.h"
#include "cast/physics/properties.h"

enum { MOST_TRIES = 40 };
static const double solver_share = 1e-3; // of the tolerance, left by Newton's method in each solution

struct Cool {
  CoolParameters parameters;
  CoolSolver solver;
  double heat;               // J/(kg K), the liquid's, by which enthalpies are told in K
  double next;               // s, the step that the last one suggests
  double *E0, *E1, *guess;   // [n] J/kg: start, after the whole step
  double *mould0, *mould1;   // [rom_state_size]
  double *T1, *flow1, *flow; // [m] K, W, W
  CoolCounts counts;
};

/* ---- life ---- */

static CastStatus allocate(Cool *c, size_t n, size_t m, size_t states, CastError *err)
{
  double **const of_melt[] = {&c->E0, &c->E1, &c->guess}, **const of_mould[] = {&c->mould0, &c->mould1},
                 **const of_patches[] = {&c->T1, &c->flow1, &c->flow};
  bool ok = true;
  for (int k = 0; k < 3; k++) ok = (*of_melt[k] = calloc(n + 1, sizeof(double))) && ok;
  for (int k = 0; k < 2; k++) ok = (*of_mould[k] = calloc(states, sizeof(double))) && ok;
  for (int k = 0; k < 3; k++) ok = (*of_patches[k] = calloc(m + 1, sizeof(double))) && ok;
  CAST_CHECK(ok, err, CAST_ERR_MEMORY, "cooling: no memory for %zu particles", n);
  return CAST_OK;
}

CastStatus cool_create(const CoolParameters *parameters, const CoolSystem *system, Cool **out, CastError *err)
{
  *out = NULL;
  const Material *melt = system->sph->melt;
  CAST_CHECK(melt, err, CAST_ERR_ARGUMENT, "cooling: the melt has no material");
  Cool *c = calloc(1, sizeof *c);
  CAST_CHECK(c, err, CAST_ERR_MEMORY, "cooling: no memory");
  const Table *curve = &melt->enthalpy;
  const size_t last = curve->n - 1;
  c->parameters = *parameters;
  c->heat = (curve->y[last] - curve->y[last - 1]) / (curve->x[last] - curve->x[last - 1]);
  c->next = parameters->first_step;
  CastStatus status = cool_solver_create(system, &c->solver, err);
  c->solver.accuracy = solver_share * parameters->tolerance * material_specific_heat_min(melt);
  if (status == CAST_OK)
    status = allocate(c, (size_t)system->particles->n_fluid, rom_state_n_patches(system->state),
                      rom_state_size(system->state), err);
  if (status != CAST_OK) cool_destroy(&c);
  *out = c;
  return status;
}

void cool_destroy(Cool **cool)
{
  if (!cool || !*cool) return;
  Cool *c = *cool;
  cool_solver_destroy(&c->solver);
  double *const arrays[] = {c->E0, c->E1, c->guess, c->mould0, c->mould1, c->T1, c->flow1, c->flow};
  for (size_t a = 0; a < sizeof arrays / sizeof *arrays; a++) free(arrays[a]);
  free(c);
  *cool = NULL;
}

/* ---- one try ---- */

static size_t bytes_of(const Cool *c)
{
  return (size_t)c->solver.p->n_fluid * sizeof(double);
}

static void go_back(Cool *c)
{
  memcpy(c->solver.p->E, c->E0, bytes_of(c));
  rom_state_restore(c->solver.state, c->mould0);
}

static CastStatus whole_step(Cool *c, double dt, bool *converged, CastError *err)
{
  CoolSolver *s = &c->solver;
  const size_t m = rom_state_n_patches(s->state);
  CAST_CALL(cool_solver_step(s, c->E0, dt, converged, err));
  memcpy(c->E1, s->p->E, bytes_of(c));
  rom_state_save(s->state, c->mould1);
  memcpy(c->T1, rom_state_patch_temperature(s->state), m * sizeof *c->T1);
  memcpy(c->flow1, s->flow, m * sizeof *c->flow1);
  return CAST_OK;
}

static CastStatus two_halves(Cool *c, double dt, bool *converged, CastError *err)
{
  CoolSolver *s = &c->solver;
  for (ptrdiff_t i = 0; i < s->p->n_fluid; i++) c->guess[i] = 0.5 * (c->E0[i] + c->E1[i]);
  CAST_CALL(cool_solver_step(s, c->guess, 0.5 * dt, converged, err));
  if (!*converged) return CAST_OK;
  memcpy(c->flow, s->flow, rom_state_n_patches(s->state) * sizeof *c->flow);
  return cool_solver_step(s, c->E1, 0.5 * dt, converged, err);
}

/* Over the tolerance. */
static double error_of(const Cool *c)
{
  const CoolSolver *s = &c->solver;
  const ptrdiff_t n = s->p->n_fluid;
  const double *T = rom_state_patch_temperature(s->state);
  double squares = 0.0, most = 0.0, patches = 0.0;
  for (ptrdiff_t i = 0; i < n; i++) {
    const double off = (s->p->E[i] - c->E1[i]) / c->heat;
    squares += off * off;
    most = fmax(most, fabs(off));
  }
  for (size_t a = 0; a < s->response.n; a++) {
    const double off = T[s->response.patch[a]] - c->T1[s->response.patch[a]];
    patches += off * off;
  }
  const double melt = sqrt(squares / (double)(n > 0 ? n : 1)), mould = sqrt(patches / fmax((double)s->response.n, 1.0));
  return fmax(fmax(melt, mould), 0.1 * most) / c->parameters.tolerance;
}

/* 2 (two halves) - (the whole), of all that changes. */
static void extrapolate(Cool *c, double dt)
{
  CoolSolver *s = &c->solver;
  const size_t states = rom_state_size(s->state), m = rom_state_n_patches(s->state);
  for (ptrdiff_t i = 0; i < s->p->n_fluid; i++) s->p->E[i] = 2.0 * s->p->E[i] - c->E1[i];
  for (size_t l = 0; l < m; l++) c->flow[l] = c->flow[l] + s->flow[l] - c->flow1[l];
  double *mould = c->mould0; // of no use any more
  rom_state_save(s->state, mould);
  for (size_t k = 0; k < states; k++) mould[k] = 2.0 * mould[k] - c->mould1[k];
  rom_state_restore(s->state, mould);
  properties_update(s->sph->melt, s->p);
  coupling_record_flows(s->coupling, s->state, s->p, c->flow, dt);
}

static CastStatus try_step(Cool *c, double dt, double *error, CastError *err)
{
  bool converged = false;
  *error = 25.0; // a fifth of the step, where Newton's method fails
  CAST_CALL(whole_step(c, dt, &converged, err));
  go_back(c);
  if (!converged) return CAST_OK;
  CAST_CALL(two_halves(c, dt, &converged, err));
  if (converged) *error = error_of(c);
  return CAST_OK;
}

CastStatus cool_step(Cool *c, double most, double *taken, CastError *err)
{
  CoolSolver *s = &c->solver;
  double dt = fmin(c->next, most), error = 0.0;
  memcpy(c->E0, s->p->E, bytes_of(c));
  rom_state_save(s->state, c->mould0);
  for (int k = 0; k < MOST_TRIES; k++) {
    CAST_CALL(try_step(c, dt, &error, err));
    const double factor = error > 0.0 ? 0.9 / sqrt(error) : 3.0;
    if (error <= 1.0) {
      extrapolate(c, dt);
      const double next = dt * fmin(fmax(factor, 0.3), 3.0);
      c->next = dt < c->next ? fmax(next, c->next) : next; // a step cut short by `most` says nothing of longer ones
      c->counts.steps++;
      c->counts.shortest = c->counts.steps > 1.0 ? fmin(c->counts.shortest, dt) : dt;
      c->counts.longest = fmax(c->counts.longest, dt);
      *taken = dt;
      return CAST_OK;
    }
    c->counts.rejected++;
    go_back(c);
    dt *= fmin(fmax(factor, 0.2), 0.7);
    c->next = dt;
  }
  return cast_error_set(err, CAST_ERR_NUMERIC, "cooling: even a step of %.3g s does not reach the tolerance of %g K",
                        dt, c->parameters.tolerance);
}

/* ---- what it tells ---- */

CoolCounts cool_counts(const Cool *c)
{
  CoolCounts counts = c->counts;
  counts.newton += (double)c->solver.newton;
  counts.gradients += (double)c->solver.gradients;
  return counts;
}

void cool_save(const Cool *c, double buffer[COOL_SIZE])
{
  const CoolCounts n = cool_counts(c);
  const double all[COOL_SIZE] = {c->next, n.steps, n.rejected, n.newton, n.gradients, n.shortest, n.longest};
  memcpy(buffer, all, sizeof all);
}

void cool_restore(Cool *c, const double buffer[COOL_SIZE])
{
  c->next = buffer[0];
  c->counts = (CoolCounts){buffer[1], buffer[2], buffer[3], buffer[4], buffer[5], buffer[6]};
}
