#include "cast/results/probes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double ENOUGH_MELT = 0.25; // of the kernel's weight

struct Probes {
  size_t n, r;
  KernelKind kernel;
  double h;
  double (*x)[3];
  ProbeHome *home;
  double *row; // [n*r] K/sqrt(J K): the basis at the probe
};

/* Barycentric weights of x in the tetrahedron; true if it is inside (a hair's breadth allowed). */
static bool weights_in(const RomData *rom, size_t t, const double x[3], double w[4])
{
  const double *p[4];
  for (int k = 0; k < 4; k++) p[k] = &rom->points[3 * rom->tetrahedra[4 * t + (size_t)k]];
  double e[3][3], d[3];
  for (int a = 0; a < 3; a++) {
    for (int k = 0; k < 3; k++) e[k][a] = p[k + 1][a] - p[0][a];
    d[a] = x[a] - p[0][a];
  }
  const double c[3][3] = {{e[1][1] * e[2][2] - e[1][2] * e[2][1], e[1][2] * e[2][0] - e[1][0] * e[2][2],
                           e[1][0] * e[2][1] - e[1][1] * e[2][0]},
                          {e[2][1] * e[0][2] - e[2][2] * e[0][1], e[2][2] * e[0][0] - e[2][0] * e[0][2],
                           e[2][0] * e[0][1] - e[2][1] * e[0][0]},
                          {e[0][1] * e[1][2] - e[0][2] * e[1][1], e[0][2] * e[1][0] - e[0][0] * e[1][2],
                           e[0][0] * e[1][1] - e[0][1] * e[1][0]}};
  const double volume = e[0][0] * c[0][0] + e[0][1] * c[0][1] + e[0][2] * c[0][2];
  w[0] = 1.0;
  for (int k = 0; k < 3; k++) {
    w[k + 1] = (d[0] * c[k][0] + d[1] * c[k][1] + d[2] * c[k][2]) / volume;
    w[0] -= w[k + 1];
  }
  for (int k = 0; k < 4; k++)
    if (!(w[k] >= -1e-9)) return false;
  return true;
}

static void locate(Probes *probes, size_t i, const RomData *rom, const Surface *surface)
{
  probes->home[i] = surface_inside_mould(surface, probes->x[i]) ? PROBE_DEEP : PROBE_CAVITY;
  double *row = &probes->row[i * probes->r], w[4];
  for (size_t t = 0; t < rom->n_tetrahedra && probes->home[i] == PROBE_DEEP; t++) {
    if (!weights_in(rom, t, probes->x[i], w)) continue;
    probes->home[i] = PROBE_BAND;
    for (int c = 0; c < 4; c++)
      for (size_t k = 0; k < rom->r; k++)
        row[k] += w[c] * (double)rom->basis[(size_t)rom->tetrahedra[4 * t + (size_t)c] * rom->r + k];
  }
}

CastStatus probes_create(size_t n, const double (*x)[3], const RomData *rom, const Surface *surface,
                         const SphParameters *sph, Probes **probes, CastError *err)
{
  Probes *made = *probes = calloc(1, sizeof *made);
  CAST_CHECK(made, err, CAST_ERR_MEMORY, "no memory for probes");
  made->n = n;
  made->r = rom->r;
  made->kernel = sph->kernel;
  made->h = sph->h;
  made->x = malloc((n + 1) * sizeof *made->x);
  made->home = calloc(n + 1, sizeof *made->home);
  made->row = calloc(n * rom->r + 1, sizeof *made->row);
  if (!made->x || !made->home || !made->row) {
    probes_destroy(probes);
    return cast_error_set(err, CAST_ERR_MEMORY, "no memory for %zu probes", n);
  }
  if (n > 0) memcpy(made->x, x, n * sizeof *x);
  for (size_t i = 0; i < n; i++) locate(made, i, rom, surface);
  return CAST_OK;
}

void probes_destroy(Probes **probes)
{
  if (!probes || !*probes) return;
  free((*probes)->x);
  free((*probes)->home);
  free((*probes)->row);
  free(*probes);
  *probes = NULL;
}

ProbeHome probes_home(const Probes *probes, size_t i)
{
  return probes->home[i];
}

double probes_melt_temperature(const Probes *probes, size_t i, const Particles *p)
{
  if (probes->home[i] != PROBE_CAVITY) return NAN;
  const double *x = probes->x[i], reach = kernel_support(probes->kernel) * probes->h;
  double weight = 0.0, sum = 0.0;
  for (ptrdiff_t j = 0; j < p->n_fluid; j++) {
    const double dx = p->x[0][j] - x[0], dy = p->x[1][j] - x[1], dz = p->x[2][j] - x[2];
    const double r2 = dx * dx + dy * dy + dz * dz;
    if (r2 >= reach * reach) continue;
    const double share = p->volume[j] * kernel_value(probes->kernel, sqrt(r2), probes->h);
    weight += share;
    sum += share * p->T[j];
  }
  return weight >= ENOUGH_MELT ? sum / weight : (double)NAN;
}

double probes_mould_temperature(const Probes *probes, size_t i, const RomState *state)
{
  if (probes->home[i] != PROBE_BAND) return NAN;
  const double *z = rom_state_z(state), *row = &probes->row[i * probes->r];
  double rise = 0.0;
  for (size_t k = 0; k < probes->r; k++) rise += row[k] * z[k];
  return rom_state_preheat(state) + rise;
}
