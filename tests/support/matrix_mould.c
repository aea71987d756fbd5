#include "tests/support/matrix_mould.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double EDGE = 1e-3, KAPPA = 1.0, RHO_C = 2e6; // m, W/(m K), J/(m3 K)

static void conduct(MatrixMould *mould, size_t a, size_t b, double G)
{
  mould->K[a * mould->n + a] += G;
  mould->K[b * mould->n + b] += G;
  mould->K[a * mould->n + b] -= G;
  mould->K[b * mould->n + a] -= G;
}

void matrix_mould_create(size_t cells, double h, MatrixMould *mould)
{
  const size_t n = cells * cells * cells;
  *mould = (MatrixMould){.n = n, .m = 4, .area = EDGE * EDGE * (double)(cells * cells) / 4.0};
  mould->E = calloc(n * n, sizeof(double));
  mould->K = calloc(n * n, sizeof(double));
  mould->B = calloc(n * mould->m, sizeof(double));
  if (!mould->E || !mould->K || !mould->B) abort();
  for (size_t i = 0; i < n; i++) {
    const size_t x = i % cells, y = i / cells % cells, z = i / (cells * cells);
    mould->E[i * n + i] = RHO_C * EDGE * EDGE * EDGE;
    if (x + 1 < cells) conduct(mould, i, i + 1, KAPPA * EDGE);
    if (y + 1 < cells) conduct(mould, i, i + cells, KAPPA * EDGE);
    if (z + 1 < cells) conduct(mould, i, i + cells * cells, KAPPA * EDGE);
    if (z + 1 == cells) mould->K[i * n + i] += h * EDGE * EDGE;
    if (z == 0) mould->B[i * mould->m + 2 * (2 * y / cells) + 2 * x / cells] = 4.0 / (double)(cells * cells);
  }
}

void matrix_mould_destroy(MatrixMould *mould)
{
  free(mould->E);
  free(mould->K);
  free(mould->B);
  *mould = (MatrixMould){0};
}

void matrix_write(const char *path, const char *form, size_t rows, size_t columns, const double *A, double factor)
{
  const int symmetric = strstr(form, "symmetric") != NULL, array = strncmp(form, "array", 5) == 0;
  size_t count = 0;
  for (size_t i = 0; i < rows; i++)
    for (size_t j = 0; j < columns; j++) count += A[i * columns + j] != 0.0 && (!symmetric || i >= j);
  FILE *file = fopen(path, "w");
  if (!file) abort();
  fprintf(file, "%%%%MatrixMarket matrix %s\n%% written by a test\n%zu %zu", form, rows, columns);
  if (!array) fprintf(file, " %zu", count);
  fprintf(file, "\n");
  for (size_t j = 0; j < columns; j++)
    for (size_t i = 0; i < rows; i++) {
      const double value = factor * A[i * columns + j];
      if (array)
        fprintf(file, "%.17g\n", value);
      else if (value != 0.0 && (!symmetric || i >= j))
        fprintf(file, "%zu %zu %.17g\n", i + 1, j + 1, value);
    }
  if (fclose(file) != 0) abort();
}

void matrix_mould_transfer(const MatrixMould *mould, double s, double *H)
{
  const size_t n = mould->n, m = mould->m;
  double *L = calloc(n * n, sizeof *L), *Y = calloc(n * m, sizeof *Y);
  if (!L || !Y) abort();
  for (size_t j = 0; j < n; j++)
    for (size_t i = j; i < n; i++) {
      double sum = s * mould->E[i * n + j] + mould->K[i * n + j];
      for (size_t k = 0; k < j; k++) sum -= L[i * n + k] * L[j * n + k];
      L[i * n + j] = i == j ? sqrt(sum) : sum / L[j * n + j];
    }
  for (size_t l = 0; l < m; l++)
    for (size_t i = 0; i < n; i++) {
      double sum = mould->B[i * m + l];
      for (size_t k = 0; k < i; k++) sum -= L[i * n + k] * Y[k * m + l];
      Y[i * m + l] = sum / L[i * n + i];
    }
  for (size_t a = 0; a < m; a++) // H = (L^-1 B)^T (L^-1 B)
    for (size_t b = 0; b < m; b++) {
      H[a * m + b] = 0.0;
      for (size_t i = 0; i < n; i++) H[a * m + b] += Y[i * m + a] * Y[i * m + b];
    }
  free(L);
  free(Y);
}
