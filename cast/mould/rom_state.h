/* rom_state.h - the mould during a run: modal state, its step, what it holds and what it has lost.
 *   dz/dt = -Lambda z + B q + ambient (T_ambient - T_preheat), z(0) = 0          (docs/theory, mould online) */
#ifndef CAST_MOULD_ROM_STATE_H
#define CAST_MOULD_ROM_STATE_H

#include "cast/mould/outer_walls.h"

typedef enum RomScheme { ROM_EXPONENTIAL, ROM_BACKWARD_EULER } RomScheme;

typedef struct RomState RomState;

/*  rom  borrowed, must outlive the state */
CastStatus rom_state_create(const RomData *rom, RomScheme scheme, double preheat, double ambient, RomState **state,
                            CastError *err);
void rom_state_destroy(RomState **state);
/* From now on these conditions hold on outer surfaces; what they take counts as lost. Before the first step.
 *   walls  borrowed, must outlive the state. Errors: CAST_ERR_MEMORY. */
CastStatus rom_state_set_walls(RomState *state, OuterWalls *walls, CastError *err);
/* Add the joules that came in through such walls since this was last asked to heat [m]. */
void rom_state_take_wall_heat(RomState *state, double *heat);
/* One step of dt with the heat flows q [m] W, constant over it; patch temperatures are refreshed. */
void rom_state_step(RomState *state, const double *q, double dt);
/* The same, and what the patch temperatures would be after another such step with the same flows, ahead [m] K. */
void rom_state_step_ahead(RomState *state, const double *q, double dt, double *ahead);
double rom_state_time(const RomState *state);
size_t rom_state_n_patches(const RomState *state);
const double *rom_state_patch_temperature(const RomState *state); // [m] K
const double *rom_state_z(const RomState *state);                 // [r]
double rom_state_preheat(const RomState *state);
double rom_state_heat(const RomState *state); // J above preheat, constant^T z: from the state, not from the flows
double rom_state_lost(const RomState *state); // J to the surroundings so far: exact integral of the losses over each
                                              // step, and what left through walls with conditions of their own
/* Largest eigenvalue of D^(1/2) G(dt) D^(1/2), dimensionless: G(dt) = B^T phi(Lambda, dt) B, K/W, is what a flow of one
 * step adds to the patch temperatures, D = diag(conductance) what a patch temperature takes off the flows.
 *   conductance  [m] W/K, >= 0 */
double rom_state_stiffness_of(const RomState *state, const double *conductance, double dt);
/* The same with D = h_eff times the areas of the cavity's patches: all of the cavity in contact. The staggered exchange
 * is stable below 1, and 0.5 is the limit used. INFINITY for an infinite h_eff. */
double rom_state_stiffness(const RomState *state, double h_eff, double dt);
/* G(dt) between n of the patches, K/W, row-major [n*n], symmetric. Errors: CAST_ERR_MEMORY. */
CastStatus rom_state_step_matrix(const RomState *state, double dt, size_t n, const int32_t *patch, double *G,
                                 CastError *err);
/* Temperature, K, at the ROM's geometry points [n_points]. */
void rom_state_point_temperature(const RomState *state, double *temperature);
const RomData *rom_state_model(const RomState *state);
/* Multiplications and additions of one step: what the paper counts. */
double rom_state_flops(const RomState *state);
/* For checkpoints: everything that changes during a run. */
size_t rom_state_size(const RomState *state); // doubles
void rom_state_save(const RomState *state, double *buffer);
void rom_state_restore(RomState *state, const double *buffer);
#endif
