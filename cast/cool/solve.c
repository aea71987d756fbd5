/* One backward Euler step of melt and mould together.
 *
 * Equations  m_i (E_i - E_i^n)/dt + sum_j k_ij (T_i - T_j) + sum_e K_e (T_i - T_l(e)) = 0,   T = T(E)
 *            with the patch temperatures T_l eliminated (mould_response.h). k_ij and K_e are those of the step's start.
 * Method     Newton in E. With dT = T'(E) dE the Jacobian is symmetric positive definite,
 *              diag(m_i/(dt T'_i)) + L + K - C^T W C,
 *            and is solved by conjugate gradients with its diagonal as preconditioner. T(E) has kinks where freezing
 *            begins and ends: an enthalpy does not go farther than just beyond the first kink in its way, as Newton's
 *            slope says nothing of what is behind it.
 * Books      At the end E_i = E_i^n - dt/m_i (what i gives), from the temperatures of the last iterate, and the mould
 *            is stepped with the flows that belong to them: what is given is what is got, to rounding.
 * References docs/theory, eq. 21-23 */
#include "cast/cool/solve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cast/physics/properties.h"

enum { MOST_NEWTON = 40, MOST_GRADIENTS = 400, CHUNK = 4096 };
static const double gradient_accuracy = 1e-3; // of each correction: Newton gains three digits an iteration
static const double kink = 2.0;               // ratio of slopes of T(E) from which a corner counts as one

/* ---- life ---- */

static CastStatus find_owners(CoolSolver *s, CastError *err)
{
  const CouplingContacts *c = &s->contacts;
  s->owner = malloc(((size_t)c->first[c->n_near] + 1) * sizeof *s->owner);
  CAST_CHECK(s->owner, err, CAST_ERR_MEMORY, "cooling: no memory for the contacts");
  for (ptrdiff_t k = 0; k < c->n_near; k++)
    for (ptrdiff_t e = c->first[k]; e < c->first[k + 1]; e++) s->owner[e] = c->near[k];
  return CAST_OK;
}

static bool allocate(CoolSolver *s, size_t n, size_t m)
{
  bool ok = true;
  for (int w = 0; w < COOL_WORK; w++) ok = (s->work[w] = calloc(n + 1, sizeof(double))) && ok;
  double **const names[COOL_WORK] = {&s->E_start, &s->T,           &s->slope,    &s->given,     &s->diagonal,
                                     &s->step,    &s->conductance, &s->residual, &s->direction, &s->image};
  for (int w = 0; w < COOL_WORK; w++) *names[w] = s->work[w];
  s->flow = calloc(m + 1, sizeof *s->flow);
  s->sums = calloc(m + 1, sizeof *s->sums);
  s->answer = calloc(m + 1, sizeof *s->answer);
  return ok && s->flow && s->sums && s->answer;
}

CastStatus cool_solver_create(const CoolSystem *system, CoolSolver *s, CastError *err)
{
  Particles *p = system->particles;
  const size_t m = rom_state_n_patches(system->state);
  *s = (CoolSolver){.sph = system->sph, .p = p, .coupling = system->coupling, .state = system->state};
  s->contacts = coupling_conductances(system->coupling, p);
  CastStatus status = cool_graph_create(system->sph, p, system->neighbours, &s->graph, err);
  if (status == CAST_OK) status = mould_response_create(m, system->state, &s->response, err);
  if (status == CAST_OK) status = find_owners(s, err);
  if (status == CAST_OK && !allocate(s, (size_t)p->n_fluid, m))
    status = cast_error_set(err, CAST_ERR_MEMORY, "cooling: no memory for %td particles", p->n_fluid);
  if (status != CAST_OK) cool_solver_destroy(s);
  return status;
}

void cool_solver_destroy(CoolSolver *s)
{
  cool_graph_destroy(&s->graph);
  mould_response_destroy(&s->response);
  for (int w = 0; w < COOL_WORK; w++) free(s->work[w]);
  free(s->owner);
  free(s->flow);
  free(s->sums);
  free(s->answer);
  *s = (CoolSolver){0};
}

/* ---- sums in a fixed order ---- */

static double ordered_dot(const double *a, const double *b, ptrdiff_t n)
{
  double total = 0.0;
  double part[1024];
  for (ptrdiff_t begin = 0; begin < n; begin += (ptrdiff_t)CHUNK * 1024) {
    const ptrdiff_t left = n - begin, chunks = (left + CHUNK - 1) / CHUNK < 1024 ? (left + CHUNK - 1) / CHUNK : 1024;
#pragma omp parallel for schedule(static)
    for (ptrdiff_t k = 0; k < chunks; k++) {
      const ptrdiff_t first = begin + k * CHUNK, end = first + CHUNK < n ? first + CHUNK : n;
      double sum = 0.0;
#pragma omp simd reduction(+ : sum)
      for (ptrdiff_t i = first; i < end; i++) sum += a[i] * b[i];
      part[k] = sum;
    }
    for (ptrdiff_t k = 0; k < chunks; k++) total += part[k];
  }
  return total;
}

/* S_l = sum K_e x_i */
static void sum_over_contacts(const CoolSolver *s, const double *x, double *S)
{
  const CouplingContacts *c = &s->contacts;
#pragma omp parallel for schedule(dynamic, 8)
  for (size_t l = 0; l < s->response.m; l++) {
    double sum = 0.0;
    for (ptrdiff_t k = c->of_patch_start[l]; k < c->of_patch_start[l + 1]; k++) {
      const ptrdiff_t e = c->of_patch[k];
      sum += c->conductance[e] * x[s->owner[e]];
    }
    S[l] = sum;
  }
}

/* y_i += sum_e K_e (x_i - T_l) */
static void add_wall(const CoolSolver *s, const double *x, const double *T_patch, double *y)
{
  const CouplingContacts *c = &s->contacts;
#pragma omp parallel for schedule(static)
  for (ptrdiff_t k = 0; k < c->n_near; k++) {
    const ptrdiff_t i = c->near[k];
    double sum = 0.0;
    for (ptrdiff_t e = c->first[k]; e < c->first[k + 1]; e++) sum += c->conductance[e] * (x[i] - T_patch[c->patch[e]]);
    y[i] += sum;
  }
}

/* ---- the equations ---- */

/* T, its slope, what each particle gives, and the largest defect in J/kg (infinite where one is not finite). */
static double evaluate(CoolSolver *s, double dt)
{
  const Particles *p = s->p;
  const Table *curve = &s->sph->melt->enthalpy;
#pragma omp parallel for schedule(static)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const size_t k = table_segment(curve->y, curve->n, p->E[i]);
    s->slope[i] = (curve->x[k + 1] - curve->x[k]) / (curve->y[k + 1] - curve->y[k]);
    s->T[i] = material_temperature(s->sph->melt, p->E[i]);
  }
  cool_graph_apply(&s->graph, s->T, s->given);
  sum_over_contacts(s, s->T, s->sums);
  mould_response_temperatures(&s->response, s->sums);
  add_wall(s, s->T, s->response.T, s->given);
  double worst = 0.0;
  long bad = 0; // fmax ignores what is not a number
#pragma omp parallel for schedule(static) reduction(max : worst) reduction(+ : bad)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    s->residual[i] = -(p->mass[i] * (p->E[i] - s->E_start[i]) / dt + s->given[i]);
    worst = fmax(worst, fabs(s->residual[i]) * dt / p->mass[i]);
    bad += !isfinite(s->residual[i]);
  }
  return bad ? (double)INFINITY : worst;
}

/* image = Jacobian times x */
static void apply_jacobian(CoolSolver *s, const double *x, double dt)
{
  const Particles *p = s->p;
  cool_graph_apply(&s->graph, x, s->image);
  sum_over_contacts(s, x, s->sums);
  mould_response_apply(&s->response, s->sums, s->answer);
  add_wall(s, x, s->answer, s->image);
#pragma omp parallel for simd schedule(static)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) s->image[i] += p->mass[i] / (dt * s->slope[i]) * x[i];
}

static void set_preconditioner(CoolSolver *s, double dt)
{
  const Particles *p = s->p;
  cool_graph_diagonal(&s->graph, s->diagonal);
#pragma omp parallel for simd schedule(static)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++)
    s->diagonal[i] = 1.0 / (s->diagonal[i] + s->conductance[i] + p->mass[i] / (dt * s->slope[i]));
}

/* Preconditioned conjugate gradients from zero: step = Jacobian^-1 residual; residual is used up. */
static bool correct(CoolSolver *s, double dt)
{
  const ptrdiff_t n = s->p->n_fluid;
  double *z = s->given; // not needed any more
  set_preconditioner(s, dt);
  const double start = sqrt(ordered_dot(s->residual, s->residual, n));
  const double floor = 0.1 * s->accuracy * s->p->mass[0] / dt; // far below what Newton must reach
  const double goal = fmax(gradient_accuracy * start, floor * sqrt((double)n) * 1e-2);
  double last = 1.0;
  memset(s->step, 0, (size_t)n * sizeof *s->step);
  for (int k = 0; k < MOST_GRADIENTS; k++) {
#pragma omp parallel for simd schedule(static)
    for (ptrdiff_t i = 0; i < n; i++) z[i] = s->diagonal[i] * s->residual[i];
    const double rho = ordered_dot(s->residual, z, n), beta = k ? rho / last : 0.0;
#pragma omp parallel for simd schedule(static)
    for (ptrdiff_t i = 0; i < n; i++) s->direction[i] = z[i] + beta * s->direction[i];
    last = rho;
    apply_jacobian(s, s->direction, dt);
    const double alpha = rho / ordered_dot(s->direction, s->image, n);
#pragma omp parallel for simd schedule(static)
    for (ptrdiff_t i = 0; i < n; i++) {
      s->step[i] += alpha * s->direction[i];
      s->residual[i] -= alpha * s->image[i];
    }
    s->gradients++;
    const double norm = sqrt(ordered_dot(s->residual, s->residual, n));
    if (!isfinite(norm)) return false;
    if (norm <= goal) return true;
  }
  return true; // Newton judges what came of it
}

/* From E towards `wanted`, but not beyond the first kink. */
static double up_to_the_kink(const Table *curve, double E, double wanted)
{
  const double *x = curve->x, *y = curve->y;
  const size_t n = curve->n, from = table_segment(y, n, E), to = table_segment(y, n, wanted);
  const double slope = (x[from + 1] - x[from]) / (y[from + 1] - y[from]);
  size_t k = from;
  while (k != to) {
    const size_t next = to > from ? k + 1 : k - 1;
    const double other = (x[next + 1] - x[next]) / (y[next + 1] - y[next]), ratio = other / slope;
    if (ratio > kink || ratio < 1.0 / kink) {
      const double margin = 1e-6 * (y[next + 1] - y[next]);
      const double stop = to > from ? y[next] + margin : y[next + 1] - margin;
      return to > from ? fmin(stop, wanted) : fmax(stop, wanted);
    }
    k = next;
  }
  return wanted;
}

static void advance_enthalpies(CoolSolver *s)
{
  const Particles *p = s->p;
  const Table *curve = &s->sph->melt->enthalpy;
#pragma omp parallel for schedule(static)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++)
    p->E[i] = up_to_the_kink(curve, p->E[i], p->E[i] + s->step[i] / s->slope[i]);
}

/* ---- the step ---- */

static CastStatus begin(CoolSolver *s, const double *guess, double dt, CastError *err)
{
  Particles *p = s->p;
  const size_t bytes = (size_t)p->n_fluid * sizeof(double);
  memcpy(s->E_start, p->E, bytes);
  properties_update(s->sph->melt, p);
  s->contacts = coupling_conductances(s->coupling, p);
  cool_graph_set_conductances(&s->graph, p->kappa);
  memset(s->conductance, 0, bytes);
  for (ptrdiff_t k = 0; k < s->contacts.n_near; k++)
    for (ptrdiff_t e = s->contacts.first[k]; e < s->contacts.first[k + 1]; e++)
      s->conductance[s->contacts.near[k]] += s->contacts.conductance[e];
  memcpy(p->E, guess, bytes);
  return mould_response_prepare(&s->response, &s->contacts, s->state, coupling_mould_frozen(s->coupling), dt, err);
}

static void end(CoolSolver *s, double dt)
{
  const Particles *p = s->p;
  const CouplingContacts *c = &s->contacts;
#pragma omp parallel for simd schedule(static)
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) p->E[i] = s->E_start[i] - s->given[i] * dt / p->mass[i];
#pragma omp parallel for schedule(dynamic, 8)
  for (size_t l = 0; l < s->response.m; l++) {
    double sum = 0.0;
    for (ptrdiff_t k = c->of_patch_start[l]; k < c->of_patch_start[l + 1]; k++) {
      const ptrdiff_t e = c->of_patch[k];
      sum += c->conductance[e] * (s->T[s->owner[e]] - s->response.T[l]);
    }
    s->flow[l] = sum;
  }
  if (!coupling_mould_frozen(s->coupling)) rom_state_step(s->state, s->flow, dt);
}

CastStatus cool_solver_step(CoolSolver *s, const double *guess, double dt, bool *converged, CastError *err)
{
  CAST_CALL(begin(s, guess, dt, err));
  for (int k = 0; k < MOST_NEWTON; k++) {
    *converged = evaluate(s, dt) <= s->accuracy;
    if (*converged) {
      end(s, dt);
      return CAST_OK;
    }
    s->newton++;
    if (!correct(s, dt)) break;
    advance_enthalpies(s);
  }
  memcpy(s->p->E, s->E_start, (size_t)s->p->n_fluid * sizeof(double));
  return CAST_OK;
}
