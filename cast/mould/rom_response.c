/* rom_response.c - how the patches' temperatures answer to flows within one step: G(dt) = B^T phi(Lambda, dt) B, K/W,
 * whole or by its largest eigenvalue, which decides on the stability of the exchange (docs/theory, section 5). */
#include <math.h>
#include <stdlib.h>

#include "cast/mould/dense.h"
#include "cast/mould/rom_state_private.h"

/* image = S B^T phi B S v, S = diag(root); returns v . image */
static double apply_step_matrix(const RomState *s, const double *root, double dt, const double *v, double *scaled,
                                double *image)
{
  const RomData *rom = rom_state_model(s);
  const size_t m = rom->m;
  for (size_t l = 0; l < m; l++) {
    scaled[l] = root[l] * v[l];
    image[l] = 0.0;
  }
  for (size_t k = 0; k < rom->r; k++) {
    const double *row = rom->B + k * m;
    dense_add(rom_state_gain(rom_state_scheme(s), rom->lambda[k], dt) * dense_dot(row, scaled, m), row, image, m);
  }
  double product = 0.0;
  for (size_t l = 0; l < m; l++) {
    image[l] *= root[l];
    product += v[l] * image[l];
  }
  return product;
}

/* Power iteration; the matrix is symmetric, positive semi-definite and, being the response of temperatures to heat,
 * nearly non-negative: a positive vector is a good start. */
static double largest_eigenvalue(const RomState *s, const double *root, double dt, double *room)
{
  const RomData *rom = rom_state_model(s);
  const size_t m = rom->m;
  double *v = room, *scaled = room + m, *image = room + 2 * m, value = 0.0;
  double norm = sqrt(dense_dot(root, root, m));
  for (size_t l = 0; l < m; l++) v[l] = norm > 0.0 ? root[l] / norm : 0.0;
  for (int step = 0; step < 300 && norm > 0.0; step++) {
    const double last = value;
    value = apply_step_matrix(s, root, dt, v, scaled, image);
    norm = sqrt(dense_dot(image, image, m));
    for (size_t l = 0; l < m && norm > 0.0; l++) v[l] = image[l] / norm;
    if (fabs(value - last) <= 1e-7 * value) break;
  }
  return value;
}

double rom_state_stiffness_of(const RomState *s, const double *conductance, double dt)
{
  const RomData *rom = rom_state_model(s);
  const size_t m = rom->m;
  double *room = calloc(4 * m, sizeof *room);
  if (!room) return INFINITY; // unknown is unstable
  double *root = room + 3 * m;
  for (size_t l = 0; l < m; l++) root[l] = sqrt(conductance[l]);
  const double value = largest_eigenvalue(s, root, dt, room);
  free(room);
  return value;
}

double rom_state_stiffness(const RomState *s, double h_eff, double dt)
{
  const RomData *rom = rom_state_model(s);
  if (!isfinite(h_eff)) return INFINITY;
  const size_t m = rom->m;
  double *area = malloc(m * sizeof *area);
  if (!area) return INFINITY;
  for (size_t l = 0; l < m; l++) area[l] = rom->patch[l].outer ? 0.0 : rom->patch[l].area;
  const double value = h_eff * rom_state_stiffness_of(s, area, dt);
  free(area);
  return value;
}

/* Columns of sqrt(phi) B, one patch after the other, so that each entry of G is one dot product. */
static double *scaled_columns(const RomState *s, double dt, size_t n, const int32_t *patch)
{
  const RomData *rom = rom_state_model(s);
  const size_t r = rom->r, m = rom->m;
  double *column = malloc((n * r + 1) * sizeof *column);
  for (size_t k = 0; k < r && column; k++) {
    const double root = sqrt(rom_state_gain(rom_state_scheme(s), rom->lambda[k], dt));
    for (size_t a = 0; a < n; a++) column[a * r + k] = root * rom->B[k * m + (size_t)patch[a]];
  }
  return column;
}

CastStatus rom_state_step_matrix(const RomState *s, double dt, size_t n, const int32_t *patch, double *G,
                                 CastError *err)
{
  const RomData *rom = rom_state_model(s);
  const size_t r = rom->r;
  double *column = scaled_columns(s, dt, n, patch);
  CAST_CHECK(column, err, CAST_ERR_MEMORY, "mould: no memory for the step matrix of %zu patches", n);
#pragma omp parallel for schedule(dynamic, 4)
  for (size_t a = 0; a < n; a++)
    for (size_t b = 0; b <= a; b++) G[a * n + b] = G[b * n + a] = dense_dot(column + a * r, column + b * r, r);
  free(column);
  return CAST_OK;
}
