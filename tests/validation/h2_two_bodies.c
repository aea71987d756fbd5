/* H2: two bodies in contact, one 10 to 1000 times better a conductor than the other (Cleary & Monaghan 1999, J. Comput.
 * Phys. 148:227), on a lattice and on places that are disordered. Body 1 fills x < 0, body 2 the slab 0 < x < L, behind
 * which all repeats as in a mirror. With e = sqrt(kappa rho c), r = (e2 - e1)/(e1 + e2) and y_i = |x|/(2 sqrt(alpha_i
 * t)), T1 = 0, T2 = 1 at the start, Laplace's transform and a geometric series give T2 = 1 - e1/(e1 + e2) sum_n r^n
 * [erfc(a_n + y_2) + erfc(a_(n+1) - y_2)],  a_n = n L/sqrt(alpha_2 t), T1 = erfc(y_1) - e1/(e1 + e2) sum_n r^n
 * [erfc(a_n + y_1) + erfc(a_(n+1) + y_1)]. The sum over pairs is that of the cooling stage; its weights have the bits
 * of the filling's. Time steps are implicit: the good conductor would need tens of thousands of explicit ones. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cast/cool/graph.h"
#include "tests/support/assert_ok.h"
#include "tests/support/lattice_tank.h"
#include "tests/support/random_numbers.h"
#include "tests/support/validation.h"

static const double DX = 1e-4, RHO = 7000.0, C = 500.0, KAPPA = 1.0; // of body 1
enum { SIDE = 10 };                                                  // particles across

typedef struct Bodies {
  int layers[2]; // of body 1 and of body 2, each between two mirrors
  double ratio, end;
  LatticeTank tank;
  CoolGraph graph;
  double capacity; // J/K of a particle
} Bodies;

static double place(const Bodies *b, double z) // m from the contact, below 0 in body 1
{
  const double first = b->layers[0] * DX, all = first + b->layers[1] * DX;
  const double from_low = z - first, from_high = all - z; // body 1 is [0, first): contacts at first and at 0 = all
  if (z < first) return -fmin(first - z, z);
  return fmin(from_low, from_high);
}

static double exact(const Bodies *b, double x)
{
  const double alpha[2] = {KAPPA / (RHO * C), b->ratio * KAPPA / (RHO * C)};
  const double e1 = 1.0, e2 = sqrt(b->ratio), r = (e2 - e1) / (e1 + e2), L = 0.5 * b->layers[1] * DX;
  const double y = fabs(x) / (2.0 * sqrt(alpha[x < 0.0 ? 0 : 1] * b->end));
  double sum = 0.0, power = 1.0;
  for (int n = 0; n < 400; n++, power *= r) {
    const double here = n * L / sqrt(alpha[1] * b->end), next = (n + 1) * L / sqrt(alpha[1] * b->end);
    sum += power * (erfc(here + y) + erfc(x < 0.0 ? next + y : next - y));
  }
  return (x < 0.0 ? erfc(y) : 1.0) - e1 / (e1 + e2) * sum;
}

/* Disorder: each place moved by up to this many spacings along each axis. */
static void create(Bodies *b, double disorder)
{
  CastError err = {0};
  const int n = b->layers[0] + b->layers[1];
  b->tank = (LatticeTank){.fluid = {SIDE, SIDE, n},
                          .box = {SIDE, SIDE, n},
                          .sph = {.kernel = KERNEL_WENDLAND_C2,
                                  .h = 1.5 * DX,
                                  .spacing = DX,
                                  .rho0 = RHO,
                                  .c0 = 1.0,
                                  .gamma = 7.0,
                                  .frozen_flow = true}};
  lattice_tank_create(&b->tank);
  Particles *p = &b->tank.particles;
  uint64_t seed = 11;
  const double period[3] = {SIDE * DX, SIDE * DX, n * DX};
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const bool second = p->x[2][i] > b->layers[0] * DX;
    p->kappa[i] = second ? b->ratio * KAPPA : KAPPA;
    p->T[i] = second ? 1.0 : 0.0;
    for (int d = 0; d < 3; d++)
      p->x[d][i] = fmod(p->x[d][i] + 2.0 * disorder * DX * (random_unit(&seed) - 0.5) + period[d], period[d]);
  }
  ok(neighbours_update(b->tank.neighbours, p, true, NULL, &err), &err);
  ok(cool_graph_create(&b->tank.sph, p, b->tank.neighbours, &b->graph, &err), &err);
  cool_graph_set_conductances(&b->graph, p->kappa);
  b->capacity = RHO * DX * DX * DX * C;
}

static double dot(ptrdiff_t n, const double *x, const double *y)
{
  double sum = 0.0;
  for (ptrdiff_t i = 0; i < n; i++) sum += x[i] * y[i];
  return sum;
}

/* (capacity/step + G) k = f by conjugate gradients, preconditioned by the diagonal; work [5*n]. */
static void solve(const Bodies *b, double step, const double *f, double *k, double *work)
{
  const ptrdiff_t n = b->graph.n;
  double *r = work, *p = work + n, *q = work + 2 * n, *z = work + 3 * n, *diagonal = work + 4 * n;
  cool_graph_diagonal(&b->graph, diagonal);
  memset(k, 0, (size_t)n * sizeof *k);
  for (ptrdiff_t i = 0; i < n; i++) {
    diagonal[i] += b->capacity / step;
    r[i] = f[i];
    p[i] = z[i] = r[i] / diagonal[i];
  }
  double rz = dot(n, r, z);
  const double small = 1e-20 * rz;
  for (int iteration = 0; iteration < 5000 && rz > small; iteration++) {
    cool_graph_apply(&b->graph, p, q);
    for (ptrdiff_t i = 0; i < n; i++) q[i] += b->capacity / step * p[i];
    const double a = rz / dot(n, p, q);
    for (ptrdiff_t i = 0; i < n; i++) {
      k[i] += a * p[i];
      r[i] -= a * q[i];
      z[i] = r[i] / diagonal[i];
    }
    const double before = rz;
    rz = dot(n, r, z);
    for (ptrdiff_t i = 0; i < n; i++) p[i] = z[i] + rz / before * p[i];
  }
}

/* The L-stable method of order 2 with two stages (Alexander 1977), steps growing up to a fortieth of the whole time. */
static void advance(Bodies *b)
{
  const double gamma = 1.0 - sqrt(0.5);
  const ptrdiff_t n = b->graph.n;
  double *room = malloc(9 * (size_t)n * sizeof *room), *T = b->tank.particles.T;
  assert_non_null(room);
  double *f = room, *k1 = room + n, *k2 = room + 2 * n, *U = room + 3 * n, *work = room + 4 * n;
  double time = 0.0, dt = 1e-5 * b->end;
  while (time < b->end * (1.0 - 1e-12)) {
    dt = fmin(fmin(1.2 * dt, b->end / 40.0), b->end - time);
    // increments d = dt dT/dt of each stage: (capacity/(gamma dt) + G) d = -G U/gamma, times constants
    cool_graph_apply(&b->graph, T, f);
    for (ptrdiff_t i = 0; i < n; i++) f[i] *= -1.0 / gamma;
    solve(b, gamma * dt, f, k1, work);
    for (ptrdiff_t i = 0; i < n; i++) U[i] = T[i] + (1.0 - gamma) * k1[i];
    cool_graph_apply(&b->graph, U, f);
    for (ptrdiff_t i = 0; i < n; i++) f[i] *= -1.0 / gamma;
    solve(b, gamma * dt, f, k2, work);
    for (ptrdiff_t i = 0; i < n; i++) T[i] += (1.0 - gamma) * k1[i] + gamma * k2[i];
    time += dt;
  }
  free(room);
}

typedef struct Errors {
  double largest, rms, contact; // 1, of the difference at the start
} Errors;

/* Contact temperature: that at which the layers to both sides, half a spacing away, give and take the same heat. */
static Errors run(double ratio, int low, double disorder)
{
  Bodies b = {.layers = {6 * low, 4 * low}, .ratio = ratio, .end = 0.25 * low * low * DX * DX * RHO * C / KAPPA};
  create(&b, disorder);
  advance(&b);
  const Particles *p = &b.tank.particles;
  Errors e = {0};
  double near[2] = {0.0, 0.0}, count[2] = {0.0, 0.0};
  for (ptrdiff_t i = 0; i < p->n_fluid; i++) {
    const double x = place(&b, p->x[2][i]), error = p->T[i] - exact(&b, x);
    e.largest = fmax(e.largest, fabs(error));
    e.rms += error * error / (double)p->n_fluid;
    if (fabs(x) > 0.9 * DX) continue;
    near[x > 0.0] += p->T[i];
    count[x > 0.0] += 1.0;
  }
  const double contact = (near[0] / count[0] + ratio * near[1] / count[1]) / (1.0 + ratio);
  e.contact = fabs(contact - exact(&b, 1e-12));
  e.rms = sqrt(e.rms);
  cool_graph_destroy(&b.graph);
  lattice_tank_destroy(&b.tank);
  return e;
}

static void two_bodies_in_contact_have_the_temperatures_of_the_closed_form(void **state)
{
  (void)state;
  static const double ratios[3] = {10.0, 100.0, 1000.0}, disorders[2] = {0.0, 0.2};
  enum { LOW = 8 }; // spacings in sqrt(4 alpha_1 t)
  validation_begin("H2");
  for (int k = 0; k < 3; k++)
    for (int d = 0; d < 2; d++) {
      const double start = validation_cpu_time();
      const Errors coarse = run(ratios[k], LOW / 2, disorders[d]), fine = run(ratios[k], LOW, disorders[d]);
      const Errors *const e = &fine;
      const double target = d ? 0.02 : 0.01;
      validation_write(&(ValidationRow){
          "H2",
          validation_text("conductivities 1:%g, %s: temperature anywhere", ratios[k],
                          d ? "places disordered by 0.2 spacings" : "lattice"),
          "closed form", validation_text("contact %.2f %% off", 100.0 * e->contact),
          validation_text("%.2f %% of the difference at most, rms %.2f %%", 100.0 * e->largest, 100.0 * e->rms),
          validation_text("%g %%%s", 100.0 * target, e->largest > target ? " (missed)" : ""),
          validation_text("%d spacings in sqrt(4 alpha t) of the poor conductor; with half of them %.2f %%", LOW,
                          100.0 * coarse.largest),
          validation_cpu_time() - start});
      assert_true(fine.contact < target);
    }
}

int main(void)
{
  omp_set_num_threads(1); // too few particles for more
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(two_bodies_in_contact_have_the_temperatures_of_the_closed_form),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
