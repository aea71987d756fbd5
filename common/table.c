#include "common/table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

CastStatus table_create(size_t n, const double *x, const double *y, Table *table, CastError *err)
{
  *table = (Table){0};
  CAST_CHECK(n > 0, err, CAST_ERR_ARGUMENT, "a table needs at least one point");
  for (size_t i = 0; i < n; i++) {
    CAST_CHECK(isfinite(x[i]) && isfinite(y[i]), err, CAST_ERR_INPUT, "point %zu of the table is not finite", i + 1);
    CAST_CHECK(i == 0 || x[i] > x[i - 1], err, CAST_ERR_INPUT,
               "point %zu of the table: %g follows %g, strictly increasing values are expected", i + 1, x[i],
               i ? x[i - 1] : 0.0);
  }
  table->x = malloc(n * sizeof *x);
  table->y = malloc(n * sizeof *y);
  if (!table->x || !table->y) {
    table_destroy(table);
    return cast_error_set(err, CAST_ERR_MEMORY, "no memory for a table of %zu points", n);
  }
  memcpy(table->x, x, n * sizeof *x);
  memcpy(table->y, y, n * sizeof *y);
  table->n = n;
  return CAST_OK;
}

void table_destroy(Table *table)
{
  if (!table) return;
  free(table->x);
  free(table->y);
  *table = (Table){0};
}

/* Halving without branches: particles come in any order of temperature, and a mispredicted branch costs more than the
 * whole search. */
size_t table_segment(const double *x, size_t n, double at)
{
  size_t low = 0, length = n - 1; // segments that are still possible
  while (length > 1) {
    const size_t half = length / 2;
    low += x[low + half] <= at ? half : 0;
    length -= half;
  }
  return low;
}

double table_evaluate(const Table *table, double x)
{
  if (table->n == 1 || x <= table->x[0]) return table->y[0];
  if (x >= table->x[table->n - 1]) return table->y[table->n - 1];
  const size_t i = table_segment(table->x, table->n, x);
  return table->y[i] + (table->y[i + 1] - table->y[i]) * ((x - table->x[i]) / (table->x[i + 1] - table->x[i]));
}

double table_slope(const Table *table, double x)
{
  if (table->n < 2 || x < table->x[0] || x > table->x[table->n - 1]) return 0.0;
  const size_t i = table_segment(table->x, table->n, x);
  return (table->y[i + 1] - table->y[i]) / (table->x[i + 1] - table->x[i]);
}

/* From the first point to x. */
static double integral_to(const Table *t, double x)
{
  double sum = 0.0;
  if (x <= t->x[0]) return (x - t->x[0]) * t->y[0];
  for (size_t i = 0; i + 1 < t->n && t->x[i] < x; i++) {
    const double end = x < t->x[i + 1] ? x : t->x[i + 1];
    sum += 0.5 * (t->y[i] + table_evaluate(t, end)) * (end - t->x[i]);
  }
  const double last = t->x[t->n - 1];
  return x > last ? sum + (x - last) * t->y[t->n - 1] : sum;
}

double table_integral(const Table *table, double from, double to)
{
  return integral_to(table, to) - integral_to(table, from);
}

double table_interpolate_open(const double *x, const double *y, size_t n, double at)
{
  const size_t i = table_segment(x, n, at);
  return y[i] + (y[i + 1] - y[i]) * ((at - x[i]) / (x[i + 1] - x[i]));
}
