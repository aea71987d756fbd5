/* panel_kernels.h - the arithmetic of conjugate gradients on panels of 16 columns: row i of a panel is one vector of 16
 * floats, so that sweeps, whose rows depend on each other, still fill the registers.
 * The matrix is A = L + D + U, scaled by its pivots, so that the preconditioner is M = (I + L)(I + U). */
#ifndef REDUCE_LINEAR_PANEL_KERNELS_H
#define REDUCE_LINEAR_PANEL_KERNELS_H

#include <stddef.h>

enum { PANEL = 16 };

typedef float PanelRow __attribute__((vector_size(PANEL * sizeof(float))));

typedef struct PanelMatrix {   // rows of one process; symmetric over all of them
  int n;                       // own rows
  int *start, *upper, *beyond; // [n + 1], [n], [n]: row i has columns below i from start[i], above i from upper[i],
                               // of other processes from beyond[i]
  int *column;                 // own row, or number among those of other processes
  float *value;                // of the scaled matrix, without the diagonal
  float *middle;               // [n] its diagonal less 2
} PanelMatrix;

/* v = (I + L)^-1 v */
void panel_sweep_forward(const PanelMatrix *A, PanelRow *v);
/* p = r + beta p,  t = (I + U)^-1 p */
void panel_sweep_backward(const PanelMatrix *A, const PanelRow *beta, const PanelRow *r, PanelRow *p, PanelRow *t);
/* v = (I + L)^-1 (p + (D - 2) t + A_beyond t_beyond); so t + v = (I + L)^-1 A (I + U)^-1 p (Eisenstat 1981).
 *   dot  += p . (t + v) of each column */
void panel_apply(const PanelMatrix *A, const PanelRow *p, const PanelRow *t, const PanelRow *t_beyond, PanelRow *v,
                 double dot[PANEL]);
/* x += alpha t,  r -= alpha (t + v);  dot += r . r of each column */
void panel_update(const PanelMatrix *A, const PanelRow *alpha, const PanelRow *t, const PanelRow *v, PanelRow *x,
                  PanelRow *r, double dot[PANEL]);
/* dot += |D^(1/2) (I + L) r|^2: the residual of the matrix as it was before it was scaled;  root [n] of the pivots */
void panel_residual(const PanelMatrix *A, const float *root, const PanelRow *r, double dot[PANEL]);

#endif
