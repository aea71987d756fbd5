/* random_numbers.h - a fixed sequence of random numbers, the same on every machine: the upper bits of a linear
 * congruential generator of 64 bits (Knuth, TAOCP 2, 3.3.4). */
#ifndef TESTS_SUPPORT_RANDOM_NUMBERS_H
#define TESTS_SUPPORT_RANDOM_NUMBERS_H

#include <stdint.h>

static inline double random_unit(uint64_t *seed) // in [0, 1)
{
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) * 0x1p-53;
}

static inline void random_point(uint64_t *seed, const double low[3], const double high[3], double x[3])
{
  for (int d = 0; d < 3; d++) x[d] = low[d] + (high[d] - low[d]) * random_unit(seed);
}

#endif
