#include "tests/support/lattice_melt.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "cast/geometry/placement.h"
#include "tests/support/assert_ok.h"

Particles lattice_melt(const double corner[3], const int n[3], double spacing)
{
  PointSet points = {.n = (ptrdiff_t)n[0] * n[1] * n[2]};
  for (int d = 0; d < 3; d++) points.x[d] = malloc((size_t)points.n * sizeof(double));
  ptrdiff_t i = 0;
  for (int a = 0; a < n[0]; a++)
    for (int b = 0; b < n[1]; b++)
      for (int c = 0; c < n[2]; c++, i++) {
        points.x[0][i] = corner[0] + (a + 0.5) * spacing;
        points.x[1][i] = corner[1] + (b + 0.5) * spacing;
        points.x[2][i] = corner[2] + (c + 0.5) * spacing;
      }
  Particles p = {0};
  CastError err = {0};
  ok(particles_create(points.n, points.x, spacing, 7000.0, NULL, &p, &err), &err);
  for (i = 0; i < p.n; i++) p.T[i] = 1300.0 + 1e4 * p.x[0][i];
  for (int d = 0; d < 3; d++) free(points.x[d]);
  return p;
}
