/* panel_kernels.c
 * Reference: Eisenstat 1981, SIAM J. Sci. Stat. Comput. 2, 1 (one sweep each way in place of product and sweeps). */
#include "reduce/linear/panel_kernels.h"

/* AVX-512, AVX2 or what the compiler was told: chosen where the program runs. */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define PANEL_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define PANEL_CLONES
#endif

enum { CHUNK = 256 }; // rows summed in single precision before they go to a double

static inline __attribute__((always_inline)) void gather(double dot[PANEL], const PanelRow *sum)
{
  for (int c = 0; c < PANEL; c++) dot[c] += (double)(*sum)[c];
}

/* *row -= sum over [first, last) of value x; by address, as the registers' size differs from form to form */
static inline __attribute__((always_inline)) void subtract(PanelRow *row, const PanelMatrix *A, int first, int last,
                                                           const PanelRow *x)
{
  PanelRow one = *row, two = {0.0F}; // two chains of sums
  int e = first;
  for (; e + 2 <= last; e += 2) {
    one -= A->value[e] * x[A->column[e]];
    two -= A->value[e + 1] * x[A->column[e + 1]];
  }
  if (e < last) one -= A->value[e] * x[A->column[e]];
  *row = one + two;
}

PANEL_CLONES void panel_sweep_forward(const PanelMatrix *A, PanelRow *v)
{
  for (int i = 0; i < A->n; i++) subtract(&v[i], A, A->start[i], A->upper[i], v);
}

PANEL_CLONES void panel_sweep_backward(const PanelMatrix *A, const PanelRow *beta, const PanelRow *r, PanelRow *p,
                                       PanelRow *t)
{
  const PanelRow factor = *beta;
  for (int i = A->n - 1; i >= 0; i--) {
    p[i] = r[i] + factor * p[i];
    t[i] = p[i];
    subtract(&t[i], A, A->upper[i], A->beyond[i], t);
  }
}

PANEL_CLONES void panel_apply(const PanelMatrix *A, const PanelRow *p, const PanelRow *t, const PanelRow *t_beyond,
                              PanelRow *v, double dot[PANEL])
{
  for (int first = 0; first < A->n; first += CHUNK) {
    const int last = first + CHUNK < A->n ? first + CHUNK : A->n;
    PanelRow sum = {0.0F};
    for (int i = first; i < last; i++) {
      PanelRow row = p[i] + A->middle[i] * t[i];
      for (int e = A->beyond[i]; e < A->start[i + 1]; e++) row += A->value[e] * t_beyond[A->column[e]];
      subtract(&row, A, A->start[i], A->upper[i], v);
      v[i] = row;
      sum += p[i] * (t[i] + v[i]);
    }
    gather(dot, &sum);
  }
}

PANEL_CLONES void panel_update(const PanelMatrix *A, const PanelRow *alpha, const PanelRow *t, const PanelRow *v,
                               PanelRow *x, PanelRow *r, double dot[PANEL])
{
  const PanelRow factor = *alpha;
  for (int first = 0; first < A->n; first += CHUNK) {
    const int last = first + CHUNK < A->n ? first + CHUNK : A->n;
    PanelRow sum = {0.0F};
    for (int i = first; i < last; i++) {
      x[i] += factor * t[i];
      r[i] -= factor * (t[i] + v[i]);
      sum += r[i] * r[i];
    }
    gather(dot, &sum);
  }
}

PANEL_CLONES void panel_residual(const PanelMatrix *A, const float *root, const PanelRow *r, double dot[PANEL])
{
  for (int first = 0; first < A->n; first += CHUNK) {
    const int last = first + CHUNK < A->n ? first + CHUNK : A->n;
    PanelRow sum = {0.0F};
    for (int i = first; i < last; i++) {
      PanelRow lower = {0.0F}; // -L r
      subtract(&lower, A, A->start[i], A->upper[i], r);
      const PanelRow row = root[i] * (r[i] - lower);
      sum += row * row;
    }
    gather(dot, &sum);
  }
}
