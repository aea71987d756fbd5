/* petsc_test.h - what every cmocka program that uses PETSc needs. */
#ifndef TESTS_SUPPORT_PETSC_TEST_H
#define TESTS_SUPPORT_PETSC_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <petscsys.h>

/* A PETSc call that must succeed: the trace goes to stderr, the test fails. */
#define TEST_PETSC(call) assert_int_equal((int)(call), 0)

/* cmocka's assert_float_equal works in single precision: too coarse for what is compared here. NaN fails. */
#define ASSERT_CLOSE(value, expected, tolerance)                                                                       \
  do {                                                                                                                 \
    const double value_ = (value), expected_ = (expected), tolerance_ = (tolerance);                                   \
    if (!(fabs(value_ - expected_) <= tolerance_))                                                                     \
      fail_msg("%s = %.17g, expected %.17g, off by %.3g > %.3g", #value, value_, expected_, fabs(value_ - expected_),  \
               tolerance_);                                                                                            \
  } while (0)

#endif
