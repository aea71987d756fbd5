/* rom_rows.c
 * Single precision errs by 6e-8 of each entry: of a patch's rise by less than 1e-6, measured (unit rom_state), where a
 * model is made for 1e-3. */
#include "cast/mould/rom_rows.h"

#include <stdlib.h>

#include "cast/kernel/dispatch.h"
#include "cast/mould/dense.h"

static const double WIDE_NUMBERS = 1e6; // 8 MB: a core's share of the last cache

static CastStatus make_narrow(const RomData *rom, RomRows *rows, CastError *err)
{
  const size_t r = rom->r, m = rom->m;
  double length = 0.0;
  rows->narrow = malloc(r * m * sizeof *rows->narrow);
  rows->missing = calloc(m, sizeof *rows->missing);
  rows->share = malloc(r * sizeof *rows->share);
  CAST_CHECK(rows->narrow && rows->missing && rows->share, err, CAST_ERR_MEMORY,
             "mould: no memory for %zu states and %zu patches", r, m);
  for (size_t k = 0; k < r; k++) {
    const double c = rom->constant[k];
    for (size_t l = 0; l < m; l++) {
      const float entry = rows->narrow[k * m + l] = (float)rom->B[k * m + l];
      rows->missing[l] += c * (rom->B[k * m + l] - (double)entry);
    }
    length += c * c;
  }
  for (size_t k = 0; k < r; k++) rows->share[k] = length > 0.0 ? rom->constant[k] / length : 0.0;
  return CAST_OK;
}

CastStatus rom_rows_create(const RomData *rom, RomRows *rows, CastError *err)
{
  *rows = (RomRows){.r = rom->r, .m = rom->m, .wide = rom->B};
  return (double)rom->r * (double)rom->m > WIDE_NUMBERS ? make_narrow(rom, rows, err) : CAST_OK;
}

void rom_rows_free(RomRows *rows)
{
  free(rows->narrow);
  free(rows->missing);
  free(rows->share);
  *rows = (RomRows){0};
}

/* ---- rows in single precision ---- */

SIMD_CLONES static double dot_narrow(const float *a, const double *q, size_t m)
{
  double sum = 0.0;
#pragma omp simd reduction(+ : sum)
  for (size_t l = 0; l < m; l++) sum += (double)a[l] * q[l];
  return sum;
}

SIMD_CLONES static void add_narrow(double scale, const float *a, double *sum, size_t m)
{
#pragma omp simd
  for (size_t l = 0; l < m; l++) sum[l] += scale * (double)a[l];
}

SIMD_CLONES static void dot_four(const float *a, const double *q, double *product, size_t m)
{
  const float *b = a + m, *c = b + m, *d = c + m;
  double of_a = 0.0, of_b = 0.0, of_c = 0.0, of_d = 0.0;
#pragma omp simd reduction(+ : of_a, of_b, of_c, of_d)
  for (size_t l = 0; l < m; l++) {
    of_a += (double)a[l] * q[l];
    of_b += (double)b[l] * q[l];
    of_c += (double)c[l] * q[l];
    of_d += (double)d[l] * q[l];
  }
  product[0] = of_a;
  product[1] = of_b;
  product[2] = of_c;
  product[3] = of_d;
}

SIMD_CLONES static void add_four(const double *s, const float *a, double *sum, size_t m)
{
  const float *b = a + m, *c = b + m, *d = c + m;
#pragma omp simd
  for (size_t l = 0; l < m; l++)
    sum[l] += (s[0] * (double)a[l] + s[1] * (double)b[l]) + (s[2] * (double)c[l] + s[3] * (double)d[l]);
}

SIMD_CLONES static void add_four_twice(const double *s, const float *a, double *sum, const double *t, double *other,
                                       size_t m)
{
  const float *b = a + m, *c = b + m, *d = c + m;
#pragma omp simd
  for (size_t l = 0; l < m; l++) {
    const double A = (double)a[l], B = (double)b[l], C = (double)c[l], D = (double)d[l];
    sum[l] += (s[0] * A + s[1] * B) + (s[2] * C + s[3] * D);
    other[l] += (t[0] * A + t[1] * B) + (t[2] * C + t[3] * D);
  }
}

/* ---- what a step asks for ---- */

double rom_rows_missing(const RomRows *rows, const double *q)
{
  return rows->narrow ? dense_dot(rows->missing, q, rows->m) : 0.0;
}

void rom_rows_dot(const RomRows *rows, size_t k, size_t n, const double *q, double *product)
{
  const size_t m = rows->m;
  if (rows->narrow && n == ROM_ROWS_AT_ONCE) {
    dot_four(rows->narrow + k * m, q, product, m);
    return;
  }
  for (size_t i = 0; i < n; i++)
    product[i] = rows->narrow ? dot_narrow(rows->narrow + (k + i) * m, q, m) : dense_dot(rows->wide + (k + i) * m, q, m);
}

static void add_one(const RomRows *rows, size_t k, double scale, double *sum)
{
  if (rows->narrow)
    add_narrow(scale, rows->narrow + k * rows->m, sum, rows->m);
  else
    dense_add(scale, rows->wide + k * rows->m, sum, rows->m);
}

void rom_rows_add(const RomRows *rows, size_t k, size_t n, const double *scale, double *sum, const double *further,
                  double *other)
{
  const size_t m = rows->m;
  const bool four = rows->narrow && n == ROM_ROWS_AT_ONCE;
  if (four && other)
    add_four_twice(scale, rows->narrow + k * m, sum, further, other, m);
  else if (four)
    add_four(scale, rows->narrow + k * m, sum, m);
  for (size_t i = 0; i < n && !four; i++) {
    add_one(rows, k + i, scale[i], sum);
    if (other) add_one(rows, k + i, further[i], other);
  }
}
