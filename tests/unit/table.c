/* Functions given by points. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "common/table.h"
#include "tests/support/assert_close.h"

static const double X[] = {1.0, 2.0, 4.0, 4.5}, Y[] = {3.0, 7.0, 5.0, 11.0};

static void value_is_exact_at_points_and_linear_between(void **state)
{
  (void)state;
  Table table;
  CastError err;
  assert_int_equal(table_create(4, X, Y, &table, &err), CAST_OK);
  for (int i = 0; i < 4; i++) assert_true(table_evaluate(&table, X[i]) == Y[i]);
  assert_close(table_evaluate(&table, 1.25), 4.0, 1e-15 * 4.0);
  assert_close(table_evaluate(&table, 3.0), 6.0, 1e-15 * 6.0);
  assert_close(table_evaluate(&table, 4.25), 8.0, 1e-15 * 8.0);
  assert_close(table_slope(&table, 3.0), -1.0, 1e-15);
  table_destroy(&table);
  assert_int_equal(table.n, 0);
}

static void value_is_constant_outside_and_open_ends_go_on_straight(void **state)
{
  (void)state;
  Table table;
  CastError err;
  assert_int_equal(table_create(4, X, Y, &table, &err), CAST_OK);
  assert_true(table_evaluate(&table, -1e9) == 3.0 && table_evaluate(&table, 1e9) == 11.0);
  assert_true(table_slope(&table, 0.0) == 0.0 && table_slope(&table, 5.0) == 0.0);
  assert_close(table_interpolate_open(X, Y, 4, 0.0), -1.0, 1e-15);
  assert_close(table_interpolate_open(X, Y, 4, 5.5), 23.0, 23e-15);
  for (int i = 0; i < 4; i++) assert_close(table_interpolate_open(X, Y, 4, X[i]), Y[i], 0.0);
  table_destroy(&table);
}

static void one_point_is_a_constant_and_nan_stays_nan(void **state)
{
  (void)state;
  Table one, many;
  CastError err;
  assert_int_equal(table_create(1, X, Y, &one, &err), CAST_OK);
  assert_int_equal(table_create(4, X, Y, &many, &err), CAST_OK);
  assert_true(table_evaluate(&one, -5.0) == 3.0 && table_evaluate(&one, 5.0) == 3.0 && table_slope(&one, 1.0) == 0.0);
  assert_true(table_evaluate(&one, NAN) == 3.0); // and no read outside
  assert_true(isnan(table_evaluate(&many, NAN)) && isnan(table_interpolate_open(X, Y, 4, NAN)));
  table_destroy(&one);
  table_destroy(&many);
}

static void segment_found_is_the_one_a_linear_search_finds(void **state)
{
  (void)state;
  double x[37], y[37];
  for (int n = 2; n <= 37; n++) {
    for (int i = 0; i < n; i++) {
      x[i] = i * i + 0.5;
      y[i] = i % 3 + 0.1 * i;
    }
    for (double at = -2.0; at < x[n - 1] + 3.0; at += 0.37) {
      int k = 0;
      while (k < n - 2 && x[k + 1] <= at) k++;
      const double expected = y[k] + (y[k + 1] - y[k]) * ((at - x[k]) / (x[k + 1] - x[k]));
      assert_true(table_interpolate_open(x, y, (size_t)n, at) == expected);
    }
  }
}

static void points_out_of_order_or_not_finite_are_refused(void **state)
{
  (void)state;
  const double equal[] = {1.0, 1.0}, falling[] = {2.0, 1.0}, bad[] = {1.0, NAN}, endless[] = {1.0, INFINITY};
  const double *const wrong[] = {equal, falling, bad, endless};
  Table table;
  CastError err;
  for (int i = 0; i < 4; i++) {
    assert_int_equal(table_create(2, wrong[i], Y, &table, &err), CAST_ERR_INPUT);
    assert_non_null(strstr(err.message, "point 2"));
    assert_null(table.x);
  }
  assert_int_equal(table_create(2, X, bad, &table, &err), CAST_ERR_INPUT);
  assert_int_equal(table_create(0, X, Y, &table, &err), CAST_ERR_ARGUMENT);
}

static void the_integral_is_that_of_the_straight_lines(void **state)
{
  (void)state;
  CastError err;
  Table table;
  const double x[] = {1.0, 2.0, 4.0}, y[] = {3.0, 5.0, -1.0};
  assert_int_equal(table_create(3, x, y, &table, &err), CAST_OK);
  assert_close(table_integral(&table, 1.0, 4.0), 4.0 + 4.0, 1e-15);
  assert_close(table_integral(&table, 0.0, 1.5), 3.0 + 1.75, 1e-15);
  assert_close(table_integral(&table, 3.0, 6.0), 0.5 - 2.0, 1e-15);
  assert_close(table_integral(&table, 6.0, 3.0), 1.5, 1e-15);
  assert_close(table_integral(&table, 5.0, 7.0), -2.0, 1e-15);
  table_destroy(&table);
  assert_int_equal(table_create(1, x, y, &table, &err), CAST_OK);
  assert_close(table_integral(&table, -1.0, 4.0), 15.0, 1e-15);
  table_destroy(&table);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(value_is_exact_at_points_and_linear_between),
      cmocka_unit_test(value_is_constant_outside_and_open_ends_go_on_straight),
      cmocka_unit_test(one_point_is_a_constant_and_nan_stays_nan),
      cmocka_unit_test(segment_found_is_the_one_a_linear_search_finds),
      cmocka_unit_test(the_integral_is_that_of_the_straight_lines),
      cmocka_unit_test(points_out_of_order_or_not_finite_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
