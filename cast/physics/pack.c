/* What is made ready before the sums over pairs: scales, records, and the grains that pair terms are counted in.
 * Method   a pair's term, computed in single precision, is rounded to whole grains, a power of two such that no term of
 *          the step has more than 2^27 of them; grains are added up as integers. So sums are exact, whatever their
 *          order, what two particles exchange stays one number with two signs, and nothing is turned into double for
 *          each pair. A grain is 2^-27 of a bound on all terms: less than what single precision leaves of those that
 *          matter.
 * Formulas cast/kernel/pair.h; docs/theory, eq. 13-16 */
#include "cast/physics/sweep.h"

#include "cast/kernel/dispatch.h"
#include "cast/kernel/pair.h"
#include "cast/physics/spin.h"

enum { ROWS_PER_TASK = 128 };

Sweep sweep_begin(const SphParameters *sph, Particles *particles, const Neighbours *neighbours)
{
  const double h = sph->h, *period = neighbours_period(neighbours), norm = shape_norm(sph->kernel);
  Sweep s = {.sph = sph,
             .p = particles,
             .spins = !spin_is_none(&sph->spin),
             .fluid_fluid = neighbours_fluid_fluid(neighbours),
             .fluid_wall = neighbours_fluid_wall(neighbours),
             .wall_fluid = neighbours_wall_fluid(neighbours),
             .scale = {.slope = norm / (h * h * h * h * h),
                       .value = norm / (h * h * h),
                       .per_h = 1.0 / h,
                       .mass = particles->n_fluid > 0 ? particles->mass[0] : 0.0,
                       .diffusion = 2.0 * sph->delta * h * sph->c0,
                       .artificial = sph->alpha * sph->c0 * h / sph->rho0,
                       .soften = 0.01 * h * h,
                       .apart = APART_STRENGTH * sph->c0 * sph->c0 / sph->rho0,
                       .per_q_apart = h / (APART_BELOW * sph->spacing),
                       .wall_least = -2.0 * sph->wall_pull / (sph->rho0 * sph->rho0),
                       .T0 = particles->n_fluid > 0 ? particles->T[0] : 0.0}};
  const double h2 = h * h, h6 = h2 * h2 * h2;
  s.scale.si.heat = s.scale.slope * h6;
  s.scale.si.drho = s.scale.slope * h6 * h;
  s.scale.si.a = s.scale.slope * h * s.scale.mass;
  s.scale.si.away = s.scale.slope * h2 * h2;
  for (int d = 0; d < 3; d++) {
    const double unit = period[d] > 0.0 ? 0x1p-32 * period[d] : 0x1p-24 * h;
    s.scale.body[d] = sph->gravity[d] + sph->extra[d];
    s.scale.held[d] = period[d] > 0.0 ? 0.0 : s.scale.body[d];
    s.scale.period[d] = period[d];
    s.scale.per_period[d] = period[d] > 0.0 ? 1.0 / period[d] : 0.0;
    s.scale.per_unit[d] = 1.0 / unit;
    s.scale.step[d] = (float)(unit / h);
  }
  return s;
}

/* ---- spans ---- */

enum { OF_VX, OF_VY, OF_VZ, OF_T, OF_RHO, OF_P, OF_MU, OF_KAPPA, OF_VOLUME, OF_ETA, SPANS };

/* The least and the most of some of the melt's fields. */
typedef struct Spans {
  double low[SPANS], high[SPANS];
} Spans;

static Spans empty_spans(void)
{
  Spans spans;
  for (int f = 0; f < SPANS; f++) {
    spans.low[f] = INFINITY;
    spans.high[f] = -INFINITY;
  }
  return spans;
}

static Spans join(Spans a, const Spans *b)
{
  for (int f = 0; f < SPANS; f++) {
    a.low[f] = b->low[f] < a.low[f] ? b->low[f] : a.low[f];
    a.high[f] = b->high[f] > a.high[f] ? b->high[f] : a.high[f];
  }
  return a;
}

#pragma omp declare reduction(join:Spans : omp_out = join(omp_out, &omp_in)) initializer(omp_priv = empty_spans())

/* Of all but eta. */
SIMD_CLONES static void span_rows(const Particles *p, ptrdiff_t first, ptrdiff_t end, Spans *spans)
{
  const double *const field[OF_ETA] = {p->v[0], p->v[1], p->v[2], p->T, p->rho, p->p, p->mu, p->kappa, p->volume};
  for (int f = 0; f < OF_ETA; f++) {
    const double *x = field[f];
    double low = INFINITY, high = -INFINITY;
#pragma omp simd reduction(min : low) reduction(max : high)
    for (ptrdiff_t i = first; i < end; i++) { // not fmin, fmax: they care for NaN and are calls
      low = x[i] < low ? x[i] : low;
      high = x[i] > high ? x[i] : high;
    }
    spans->low[f] = low;
    spans->high[f] = high;
  }
}

/* ---- records ---- */

/* x in units of place, wrapped into [-2^31, 2^31). */
PAIR_INLINE int32_t wrapped_place(double x, double per_unit)
{
  const double place = x * per_unit;
  return (int32_t)(place - 0x1p32 * floor(place * 0x1p-32) - 0x1p31);
}

RecordField sweep_place(const SweepScales *scale, int axis, double x)
{
  return (RecordField){.place = (uint32_t)wrapped_place(x, scale->per_unit[axis])};
}

/* What turns a viscosity into a record's: h^5/m^2. */
static double viscosity_scale(const SweepScales *c)
{
  const double per_h2 = c->per_h * c->per_h;
  return 1.0 / (c->mass * c->mass * per_h2 * per_h2 * c->per_h);
}

SIMD_CLONES static void pack_rows(const Sweep *s, ptrdiff_t first, ptrdiff_t end, Spans *spans)
{
  const Particles *p = s->p;
  const SphParameters *sph = s->sph;
  const SweepScales *c = &s->scale;
  const double rho0 = sph->rho0, c0 = sph->c0, gamma = sph->gamma, *g = c->held, T0 = c->T0;
  const double per_h3 = c->per_h * c->per_h * c->per_h, per_mu = viscosity_scale(c);
  const bool cut = sph->cut_tension;
  const Spin spin = sph->spin;
  double low = INFINITY, high = -INFINITY;
#pragma omp simd reduction(min : low) reduction(max : high)
  for (ptrdiff_t i = first; i < end; i++) {
    const double whole = whole_density(p->rho[i], rho0);
    const double held = g[0] * p->x[0][i] + g[1] * p->x[1][i] + g[2] * p->x[2][i] +
                        spin_potential(&spin, p->x[0][i], p->x[1][i], p->x[2][i]);
    p->p[i] = melt_pressure(p->rho[i], rho0, c0, gamma, cut);
    p->volume[i] = p->mass[i] / whole;
    RecordField *record = p->record + i * RECORD_SIZE;
    record[REC_X].place = (uint32_t)wrapped_place(p->x[0][i], c->per_unit[0]);
    record[REC_Y].place = (uint32_t)wrapped_place(p->x[1][i], c->per_unit[1]);
    record[REC_Z].place = (uint32_t)wrapped_place(p->x[2][i], c->per_unit[2]);
    record[REC_VOLUME].value = (float)(p->volume[i] * per_h3);
    record[REC_VX].value = (float)p->v[0][i];
    record[REC_VY].value = (float)p->v[1][i];
    record[REC_VZ].value = (float)p->v[2][i];
    const double eta = diffused_density(whole, rho0, c0, gamma, held);
    record[REC_P].value = (float)(p->p[i] / (whole * whole));
    record[REC_ETA].value = (float)eta;
    record[REC_MU].value = (float)(p->mu[i] * per_mu + SWEEP_TINY);
    record[REC_KAPPA].value = (float)(p->kappa[i] + SWEEP_TINY);
    record[REC_T].value = (float)(p->T[i] - T0);
    low = eta < low ? eta : low;
    high = eta > high ? eta : high;
  }
  spans->low[OF_ETA] = low;
  spans->high[OF_ETA] = high;
}

/* ---- grains ---- */

/* A power of two of which a term below the bound has less than 2^SWEEP_GRAIN_BITS; NaN for a bound that is not finite.
 */
static double grain_below(double bound)
{
  enum { LEAST = -60 }; // of a bound's exponent: single precision has room for 1/grain times any field
  int exponent;
  frexp(1.001 * bound, &exponent); // terms are rounded to single
  return isfinite(bound) ? ldexp(1.0, (exponent > LEAST ? exponent : LEAST) - SWEEP_GRAIN_BITS) : (double)NAN;
}

static double span(const Spans *s, int field)
{
  return s->high[field] - s->low[field];
}

/* No pair's term is above these bounds, in the units of the fast form: F <= F(0), q F <= the steepest slope, u <= the
 * diagonal of the box of velocities, means of mu and kappa <= twice the largest. Differences alone enter, so a melt
 * that moves as one has the grains of a melt at rest. */
static void choose_grains(const Spans *s, KernelKind kernel, SweepScales *c)
{
  const double F = shape_slope(kernel, 0.0), qF = shape_steepest(kernel), per_h = c->per_h;
  const double per_h3 = per_h * per_h * per_h, volumes = pow(s->high[OF_VOLUME] * per_h3, 2.0);
  const double u = sqrt(pow(span(s, OF_VX), 2.0) + pow(span(s, OF_VY), 2.0) + pow(span(s, OF_VZ), 2.0));
  const double p = s->high[OF_P] > -s->low[OF_P] ? s->high[OF_P] : -s->low[OF_P];
  const double P = p * pow(s->high[OF_VOLUME] / c->mass, 2.0); // the volume is mass/whole_density
  const double mu = s->high[OF_MU] * viscosity_scale(c) + SWEEP_TINY, kappa = s->high[OF_KAPPA] + SWEEP_TINY;
  const double artificial = c->artificial * per_h * u, diffused = c->diffusion * per_h * span(s, OF_ETA);
  c->grain.drho = grain_below(volumes * (s->high[OF_RHO] * qF * u + F * diffused));
  const double apart = 0.25 * c->apart / c->per_q_apart; // above all apart (1 - q per_q_apart) q
  c->grain.a = grain_below(qF * 2.0 * P + F * (apart + artificial + volumes * 2.0 * mu * u));
  c->grain.heat = grain_below(volumes * F * 2.0 * kappa * span(s, OF_T));
}

void sweep_pack_fluid(Sweep *s)
{
  const ptrdiff_t n = s->p->n_fluid;
  Spans all = empty_spans();
#pragma omp parallel for reduction(join : all)
  for (ptrdiff_t first = 0; first < n; first += ROWS_PER_TASK) {
    const ptrdiff_t end = first + ROWS_PER_TASK < n ? first + ROWS_PER_TASK : n;
    Spans here;
    pack_rows(s, first, end, &here);
    span_rows(s->p, first, end, &here);
    all = join(all, &here);
  }
  choose_grains(&all, s->sph->kernel, &s->scale);
}
