/* mould_response.h - what the mould answers within one implicit step: patch temperatures as a linear function of the
 * melt's, with the flows between them eliminated.
 *   T_l = T0_l + (G Q)_l,  Q_l = S_l - D_l T_l,  S_l = sum K_e T_i, D_l = sum K_e over the contacts of patch l
 * so T = T0 + W (S - D T0), W = G (1 + D G)^-1 = D^(-1/2) [1 - (1 + H)^-1] D^(-1/2), H = D^(1/2) G D^(1/2), symmetric
 * positive: the Schur complement of the mould's states.                                (docs/theory, eq. 23) */
#ifndef CAST_COOL_MOULD_RESPONSE_H
#define CAST_COOL_MOULD_RESPONSE_H

#include "cast/coupling/coupling.h"

typedef struct MouldResponse {
  size_t n;       // patches that melt touches
  int32_t *patch; // [n]
  double *root;   // [n] sqrt(D), sqrt(W/K)
  double *factor; // [n*n] Cholesky factor L of 1 + H = L L^T, lower triangle; NULL: the mould's temperature is fixed
  double *T0;     // [m] K, at the end of the step if nothing flowed
  double *T;      // [m] K
  double *scaled, *work; // [n]
  double *state;         // [rom_state_size] room to look ahead
  size_t room, m;
} MouldResponse;

CastStatus mould_response_create(size_t n_patches, const RomState *state, MouldResponse *response, CastError *err);
void mould_response_destroy(MouldResponse *response);
/* For a step of dt from `state`, which is left as it was, with these contacts. frozen: nothing changes the mould.
 * Errors: CAST_ERR_MEMORY; CAST_ERR_NUMERIC where 1 + H is not positive. */
CastStatus mould_response_prepare(MouldResponse *response, const CouplingContacts *contacts, RomState *state,
                                  bool frozen, double dt, CastError *err);
/* Patch temperatures [m] K for the sums S [m] W: in response->T. */
void mould_response_temperatures(MouldResponse *response, const double *S);
/* y = W x, patch by patch (0 where no melt is); x, y [m], y may be x. */
void mould_response_apply(MouldResponse *response, const double *x, double *y);

#endif
