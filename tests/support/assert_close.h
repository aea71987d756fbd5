/* assert_close.h - comparison of doubles (cmocka 1.1.5 compares in float). NaN is close to nothing. */
#ifndef TESTS_SUPPORT_ASSERT_CLOSE_H
#define TESTS_SUPPORT_ASSERT_CLOSE_H

#include <math.h>

#define assert_close(value, expected, tolerance)                                                                       \
  do {                                                                                                                 \
    const double value_ = (value), expected_ = (expected), tolerance_ = (tolerance);                                   \
    if (!(fabs(value_ - expected_) <= tolerance_))                                                                     \
      fail_msg(#value " is %.12g, %.12g within %.3g is expected", value_, expected_, tolerance_);                      \
  } while (0)

#endif
