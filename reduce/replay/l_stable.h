/* l_stable.h - a one-step scheme of order 5 for E theta' + K theta = F with one shifted matrix for all its stages.
 * Method: R(z) = sum_j c_j w^j, w = 1/(1 - gamma z), order 5 with the gamma that makes the numerator's degree 4: then
 * R(infinity) = 0 (Hairer & Wanner 1996, Solving Ordinary Differential Equations II, table IV.6.4). For constant F
 *   theta' = theta + sum_k d_k v_k,  v_1 = (s E + K)^-1 (F - K theta),  v_k+1 = s (s E + K)^-1 E v_k,  s = 1/(gamma
 * dt), d_k = sum_{j >= k} c_j, and the c_j solve sum_j c_j (j + i - 1 over i) gamma^i = 1/i!, i < 5. */
#ifndef REDUCE_REPLAY_L_STABLE_H
#define REDUCE_REPLAY_L_STABLE_H

#include <petscsystypes.h>

enum { L_STABLE_STAGES = 5 };
#define L_STABLE_GAMMA 0.278053841136452

void l_stable_weights(PetscReal d[L_STABLE_STAGES]);

#endif
