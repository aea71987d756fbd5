#include "reduce/replay/l_stable.h"

#include <math.h>

void l_stable_weights(PetscReal d[L_STABLE_STAGES])
{
  PetscReal A[L_STABLE_STAGES][L_STABLE_STAGES + 1], factorial = 1.0, sum = 0.0;
  for (int i = 0; i < L_STABLE_STAGES; i++) {
    if (i > 0) factorial *= i;
    A[i][L_STABLE_STAGES] = 1.0 / factorial;
    for (int j = 1; j <= L_STABLE_STAGES; j++) {
      A[i][j - 1] = pow(L_STABLE_GAMMA, i);
      for (int a = 1; a <= i; a++) A[i][j - 1] *= (PetscReal)(j - 1 + a) / a;
    }
  }
  for (int p = 0; p < L_STABLE_STAGES; p++) // Gauss-Jordan; the pivots are well away from 0 here
    for (int i = 0; i < L_STABLE_STAGES; i++) {
      if (i == p) continue;
      const PetscReal factor = A[i][p] / A[p][p];
      for (int j = p; j <= L_STABLE_STAGES; j++) A[i][j] -= factor * A[p][j];
    }
  for (int j = L_STABLE_STAGES - 1; j >= 0; j--) d[j] = sum += A[j][L_STABLE_STAGES] / A[j][j];
}
