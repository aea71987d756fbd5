#include "cast/physics/gradient.h"

#include "cast/kernel/pair.h"

static const double least_spread = 0.03; // of M's eigenvalues: below it a direction has too few neighbours

typedef struct Sums {
  double M[3][3], b[GRADIENT_FIELDS][3];
} Sums;

static void add_pairs(const SphParameters *sph, const Particles *p, const Neighbours *neighbours, ptrdiff_t i, int n,
                      const double *const value[], Sums *sums)
{
  const PairList *list = neighbours_fluid_fluid(neighbours);
  const double *period = neighbours_period(neighbours);
  const double h = sph->h, slope = shape_norm(sph->kernel) / (h * h * h * h * h);
  for (ptrdiff_t l = list->start[i]; l < pair_list_end(list, i); l++) {
    const ptrdiff_t j = list->index[l];
    double d[3];
    const double r2 = particles_offset(p, i, j, period, d);
    const double w = p->volume[j] * slope * shape_slope(sph->kernel, sqrt(r2) / h);
    for (int a = 0; a < 3; a++) {
      for (int c = 0; c < 3; c++) sums->M[a][c] += w * d[a] * d[c];
      for (int f = 0; f < n; f++) sums->b[f][a] += w * (value[f][i] - value[f][j]) * d[a];
    }
  }
}

/* One rotation of Jacobi's method: makes M[a][c] zero, keeps the axes in the columns of Q. */
static void rotate(double M[3][3], double Q[3][3], int a, int c)
{
  if (M[a][c] == 0.0) return;
  const double theta = 0.5 * (M[c][c] - M[a][a]) / M[a][c];
  const double t = (theta >= 0.0 ? 1.0 : -1.0) / (fabs(theta) + sqrt(theta * theta + 1.0));
  const double cosine = 1.0 / sqrt(t * t + 1.0), sine = t * cosine;
  for (int k = 0; k < 3; k++) {
    const double ka = M[k][a], kc = M[k][c];
    M[k][a] = cosine * ka - sine * kc;
    M[k][c] = sine * ka + cosine * kc;
  }
  for (int k = 0; k < 3; k++) {
    const double ak = M[a][k], ck = M[c][k], qa = Q[k][a], qc = Q[k][c];
    M[a][k] = cosine * ak - sine * ck;
    M[c][k] = sine * ak + cosine * ck;
    Q[k][a] = cosine * qa - sine * qc;
    Q[k][c] = sine * qa + cosine * qc;
  }
}

/* x = M^+ b, without the directions in which M is too small. M is overwritten. */
static void solve(Sums *sums, int n, double gradient[][3])
{
  enum { SWEEPS = 12 }; // convergence is quadratic: 5 suffice for double
  double Q[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  for (int sweep = 0; sweep < SWEEPS; sweep++) {
    rotate(sums->M, Q, 0, 1);
    rotate(sums->M, Q, 0, 2);
    rotate(sums->M, Q, 1, 2);
  }
  for (int f = 0; f < n; f++) {
    for (int a = 0; a < 3; a++) gradient[f][a] = 0.0;
    for (int k = 0; k < 3; k++) {
      if (sums->M[k][k] < least_spread) continue;
      const double along = Q[0][k] * sums->b[f][0] + Q[1][k] * sums->b[f][1] + Q[2][k] * sums->b[f][2];
      for (int a = 0; a < 3; a++) gradient[f][a] += Q[a][k] * along / sums->M[k][k];
    }
  }
}

void gradient_at(const SphParameters *sph, const Particles *p, const Neighbours *neighbours, ptrdiff_t i, int n,
                 const double *const value[], double gradient[][3])
{
  Sums sums = {0};
  add_pairs(sph, p, neighbours, i, n, value, &sums);
  solve(&sums, n, gradient);
}
