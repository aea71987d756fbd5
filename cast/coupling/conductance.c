/* Conductances between melt and mould: of each pair from where its particle is now, and their sums by patch.
 * References  docs/theory, section 5 */
#include "cast/coupling/coupling_private.h"
#include "cast/kernel/pair.h"

/* What stands between melt and mould beside the interface: 1/resistance. */
static double in_series(double size, double h, double resistance)
{
  return size / (1.0 / h + resistance);
}

/* One pair with the interface's h of now, and what it may become with the law's largest. */
typedef struct Conductance {
  double now, most; // W/K
} Conductance;

static Conductance surface_conductance(const Coupling *c, const Particles *p, ptrdiff_t i, ptrdiff_t contact)
{
  const double *plane = c->contacts.plane[contact];
  const ContactLaw *law = c->law[c->contacts.patch[contact]];
  const double along = plane[0] * p->x[0][i] + plane[1] * p->x[1][i] + plane[2] * p->x[2][i] + plane[3];
  const double resistance = fmax(along, c->rules.least_distance) / p->kappa[i], area = c->contacts.area[contact];
  const double now = in_series(area, contact_law_at(law, c->sph->melt, p->T[i]), resistance);
  const bool constant = law->basis == CONTACT_CONSTANT;
  return (Conductance){now, constant ? now : in_series(area, contact_law_most(law), resistance)};
}

/* The pair formula with three resistances in series, of which the outer two are as thick as the bodies are:
 * 2 V_i V_j F (r_ij . n_j) (T_i - T_j)/(d_i/kappa_i + 1/h_contact + d_j/kappa_j). For equal distances and perfect
 * contact it is the paper's, V_i V_j F 4 kappa_i kappa_j/(kappa_i + kappa_j). Volumes V_j are those of the cut cells:
 * with them sum_j over a flat wall gives its area wherever the lattice stands. */
static Conductance embedded_conductance(const Coupling *c, const Particles *p, ptrdiff_t i, ptrdiff_t k)
{
  const ptrdiff_t j = p->n_fluid + k;
  double way[3], across = 0.0, lift = 0.0;
  const double r2 = particles_offset(p, i, j, c->period, way);
  for (int d = 0; d < 3; d++) {
    across += way[d] * p->normal[d][k];
    lift += (p->x[d][j] - p->foot[d][k]) * p->normal[d][k];
  }
  const double h = c->sph->h, distance = across + lift;
  if (across <= 0.0 || distance < -contact_behind * c->sph->spacing) return (Conductance){0.0, 0.0};
  const double F = shape_norm(c->sph->kernel) / (h * h * h * h * h) * shape_slope(c->sph->kernel, sqrt(r2) / h);
  const ContactLaw *law = c->law[p->patch[k]];
  const double resistance =
      fmax(distance, c->rules.least_distance) / p->kappa[i] + wall_temperature_depth(c->walls)[k] / c->mould_kappa;
  const double size = 2.0 * p->volume[i] * p->volume[j] * F * across;
  const double now = in_series(size, contact_law_at(law, c->sph->melt, p->T[i]), resistance);
  const bool constant = law->basis == CONTACT_CONSTANT;
  return (Conductance){now, constant ? now : in_series(size, contact_law_most(law), resistance)};
}

/* Conductances of the pairs of near particle k; returns the sum of what they may become. */
static double set_conductances_of(Coupling *c, const Particles *p, ptrdiff_t k)
{
  Contacts *contacts = &c->contacts;
  const bool surface = c->parameters.kind == COUPLING_SURFACE;
  const ptrdiff_t i = contacts->near[k];
  double all = 0.0;
  for (ptrdiff_t e = contacts->first[k]; e < contacts->first[k + 1]; e++) {
    contacts->most[e] = 0.0;
    for (ptrdiff_t pair = contacts->pair_start[e]; pair < contacts->pair_start[e + 1]; pair++) {
      const Conductance found =
          surface ? surface_conductance(c, p, i, e) : embedded_conductance(c, p, i, contacts->sink[pair]);
      contacts->conductance[pair] = found.now;
      contacts->most[e] += found.most;
    }
    all += contacts->most[e];
  }
  return all;
}

void coupling_set_conductances(Coupling *c, const Particles *p)
{
  Contacts *contacts = &c->contacts;
  double rate = 0.0;
#pragma omp parallel for schedule(dynamic, 64) reduction(max : rate)
  for (ptrdiff_t k = 0; k < contacts->n_near; k++)
    rate = fmax(rate, set_conductances_of(c, p, k) / p->mass[contacts->near[k]]);
  c->particle_rate = c->least_heat > 0.0 ? rate / c->least_heat : 0.0;
#pragma omp parallel for schedule(dynamic, 8)
  for (size_t l = 0; l < c->rom->m; l++) {
    double sum = 0.0;
    for (ptrdiff_t k = contacts->of_patch_start[l]; k < contacts->of_patch_start[l + 1]; k++)
      sum += contacts->most[contacts->of_patch[k]];
    c->sum[l] = sum;
  }
  c->conductance = 0.0;
  for (size_t l = 0; l < c->rom->m; l++) c->conductance = fmax(c->conductance, c->sum[l] / c->rom->patch[l].area);
}
